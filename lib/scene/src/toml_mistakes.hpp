#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace cleave::scene {

/// What a person did, and what helps.
struct Mistake {
  std::string what, remedy;
};

/// What is wrong with bytes that are no text at all: a workbook, another encoding.
[[nodiscard]] std::optional<Mistake> not_a_text(std::string_view bytes);

/// A backslash between double quotes on that line, in what looks like a path: "data\new.csv".
[[nodiscard]] std::optional<Mistake> backslash_in_path(std::string_view text, std::uint32_t line);

/// The mistake that people make most often on such a line, if it is one of those: a decimal comma, a path with
/// backslashes, quotes of a word processor, a word without quotes, a table that is written twice or with single
/// brackets where there may be several. `line` counts from 1.
[[nodiscard]] std::optional<Mistake> likely_mistake(std::string_view text, std::uint32_t line);

}  // namespace cleave::scene
