#pragma once

#include <cstdint>
#include <expected>
#include <string>
#include <string_view>

#include "cleave/core/text.hpp"
#include "cleave/io/file.hpp"

namespace cleave::io {

[[nodiscard]] bool same_word(std::string_view text, std::string_view lower_case_word) noexcept;
/// Quoted for a message: cut at 40 bytes, control characters as '?'.
[[nodiscard]] std::string shown(std::string_view text);
/// Without the byte order mark of UTF-8.
[[nodiscard]] std::string_view without_bom(std::string_view bytes) noexcept;

/// A fault of the file as a whole.
[[nodiscard]] ReadError whole_file(ReadFault fault, std::string_view file, std::string what, std::string remedy);

/// Takes the bytes apart into lines and words; CR is a blank, so CRLF needs no care.
class LineReader final {
 public:
  LineReader(std::string_view bytes, std::string_view file) noexcept : rest_{bytes}, file_{file} {}

  /// The next line without its end; false at the end of the bytes.
  [[nodiscard]] bool next(std::string_view& line) noexcept;
  /// Number of the line that `next` gave last.
  [[nodiscard]] std::uint32_t number() const noexcept { return number_; }
  [[nodiscard]] std::string_view rest() const noexcept { return rest_; }
  [[nodiscard]] std::string_view file() const noexcept { return file_; }
  [[nodiscard]] ReadError error(ReadFault fault, std::string what, std::string remedy) const;

 private:
  std::string_view rest_;
  std::string_view file_;
  std::uint32_t number_ = 0;
};

/// Cuts the first word off `line`; empty at its end.
[[nodiscard]] std::string_view take_word(std::string_view& line) noexcept;

/// A finite number that is the whole word. A leading + is accepted; nan, inf and what a double cannot hold are not.
[[nodiscard]] std::expected<double, std::string> number_of(std::string_view word);

}  // namespace cleave::io
