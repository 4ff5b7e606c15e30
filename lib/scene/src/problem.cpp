#include "cleave/scene/problem.hpp"

#include <fmt/format.h>

#include <string_view>

#include "cleave/core/text.hpp"

namespace cleave::scene {
namespace {

/// Keys, names and values come from files: control bytes in them must not reach a terminal.
std::string printable(const std::string& text) {
  std::string clean;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if (byte < 0x20 || byte == 0x7F || (byte == 0xC2 && has_control_characters(std::string_view{text}.substr(i, 2)))) {
      clean += fmt::format("\\x{:02x}", byte);
    } else {
      clean += text[i];
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
