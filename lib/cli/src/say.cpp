#include <cstdio>

#include "commands.hpp"

namespace cleave::cli {

void complain(const std::string& what) {
  const std::string line = "error: " + what + "\n";
  std::fwrite(line.data(), 1, line.size(), stderr);
}
void say(const std::string& text) { std::fwrite(text.data(), 1, text.size(), stdout); }

}  // namespace cleave::cli
