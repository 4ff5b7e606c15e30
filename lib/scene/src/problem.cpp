#include "cleave/scene/problem.hpp"

#include <fmt/format.h>

namespace cleave::scene {
namespace {

/// Keys, names and values come from files: control bytes in them must not reach a terminal.
std::string printable(const std::string& text) {
  std::string clean;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7F) {
      clean += fmt::format("\\x{:02x}", byte);
    } else {
      clean += c;
    }
  }
  return clean;
}

}  // namespace

std::string describe(const Problem& problem) {
  std::string text = fmt::format("{}:{}: {}: {}", printable(problem.file), problem.line, printable(problem.key),
                                 printable(problem.what));
  if (!problem.remedy.empty()) text += "; " + printable(problem.remedy);
  return text;
}

}  // namespace cleave::scene
