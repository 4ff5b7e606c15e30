#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace cleave::scene {

/// What is wrong with bytes that are no text at all: a workbook, another encoding.
[[nodiscard]] std::optional<std::string> not_a_text(std::string_view bytes);

/// The mistake that people make most often on such a line, if it is one of those: a decimal comma, a path with
/// backslashes, quotes of a word processor, a word without quotes. `line` counts from 1.
[[nodiscard]] std::optional<std::string> likely_mistake(std::string_view text, std::uint32_t line);

}  // namespace cleave::scene
