#include "text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

#include "cleave/core/text.hpp"

namespace cleave::io {

bool same_word(std::string_view text, std::string_view lower_case_word) noexcept {
  return std::ranges::equal(text, lower_case_word, {}, [](char c) { return lower(c); });
}

std::string shown(std::string_view text) {
  constexpr std::size_t longest = 40;
  std::string result{text.substr(0, longest)};
  for (char& c : result) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f) c = '?';
  }
  if (!is_utf8(result)) result = on_one_line(result);
  return fmt::format("\"{}{}\"", result, text.size() > longest ? "..." : "");
}

std::string_view without_bom(std::string_view bytes) noexcept {
  return bytes.starts_with("\xEF\xBB\xBF") ? bytes.substr(3) : bytes;
}

bool LineReader::next(std::string_view& line) noexcept {
  if (rest_.empty()) return false;
  const std::size_t end = rest_.find('\n');
  line = rest_.substr(0, end);
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
  ++number_;
  return true;
}

ReadError whole_file(ReadFault fault, std::string_view file, std::string what, std::string remedy) {
  return {fault, std::string{file}, {}, {}, std::move(what), std::move(remedy)};
}

ReadError LineReader::error(ReadFault fault, std::string what, std::string remedy) const {
  const auto line = number_ > 0 ? std::optional{number_} : std::nullopt;
  return {fault, std::string{file_}, line, {}, std::move(what), std::move(remedy)};
}

std::string_view take_word(std::string_view& line) noexcept {
  std::size_t begin = 0;
  while (begin < line.size() && is_blank(line[begin])) ++begin;
  std::size_t end = begin;
  while (end < line.size() && !is_blank(line[end])) ++end;
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

std::expected<double, std::string> number_of(std::string_view word) {
  std::string_view digits = word;
  if (digits.size() > 1 && digits.front() == '+' && digits[1] != '-') digits.remove_prefix(1);
  double value = 0;
  const char* const end = std::to_address(digits.end());
  const auto [stop, failure] = std::from_chars(std::to_address(digits.begin()), end, value);
  if (failure == std::errc::result_out_of_range) {
    return std::unexpected(fmt::format("{} is beyond the range of numbers", shown(word)));
  }
  if (failure != std::errc{} || stop != end) return std::unexpected(fmt::format("{} is not a number", shown(word)));
  if (!std::isfinite(value)) return std::unexpected(fmt::format("{} is not a finite number", shown(word)));
  return value;
}

std::string describe(const ReadError& error) {
  const std::string line = error.line ? fmt::format(":{}", *error.line) : "";
  return fmt::format("{}{}: {}; {}", error.file, line, error.what, error.remedy);
}

}  // namespace cleave::io
