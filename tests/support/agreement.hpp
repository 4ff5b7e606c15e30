#pragma once

/// Arguments of programs that compare on as many random cases as one likes: PROGRAM [COUNT [SEED [WORD]]].

#include <charconv>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>

namespace cleave::support {

struct AgreementArguments {
  std::uint64_t count, seed = 1;
  bool word = false;  ///< given
};

[[nodiscard]] inline std::optional<std::uint64_t> number_of(const char* text) {
  std::uint64_t value = 0;
  const std::string word{text};
  const auto [end, failure] = std::from_chars(word.data(), std::to_address(word.end()), value);
  if (failure != std::errc{} || end != std::to_address(word.end())) return std::nullopt;
  return value;
}

/// Empty, with a line on how to call it, when they are wrong. No `word`: none is taken.
[[nodiscard]] inline std::optional<AgreementArguments> agreement_arguments(int argc, char** argv,
                                                                           std::string_view program,
                                                                           std::uint64_t default_count,
                                                                           std::string_view word = {}) {
#ifdef __clang__
#pragma clang unsafe_buffer_usage begin
#endif
  const std::span arguments{argv, static_cast<std::size_t>(argc)};
#ifdef __clang__
#pragma clang unsafe_buffer_usage end
#endif
  const auto count = arguments.size() > 1 ? number_of(arguments[1]) : std::optional{default_count};
  const auto seed = arguments.size() > 2 ? number_of(arguments[2]) : std::optional{std::uint64_t{1}};
  const bool last = arguments.size() > 3;
  const bool known = !last || (arguments.size() == 4 && !word.empty() && std::string_view{arguments[3]} == word);
  if (count && seed && known) return AgreementArguments{*count, *seed, last};
  const std::string more = word.empty() ? std::string{} : " [" + std::string{word} + "]";
  std::fputs(("usage: " + std::string{program} + " [COUNT [SEED" + more + "]]\n").c_str(), stderr);
  return std::nullopt;
}

}  // namespace cleave::support
