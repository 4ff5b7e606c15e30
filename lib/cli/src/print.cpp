#include <cstdio>

#include "commands.hpp"

namespace cleave::cli {

void print_error(const std::string& what) {
  const std::string line = "error: " + what + "\n";
  std::fwrite(line.data(), 1, line.size(), stderr);
}
void print(const std::string& text) { std::fwrite(text.data(), 1, text.size(), stdout); }

}  // namespace cleave::cli
