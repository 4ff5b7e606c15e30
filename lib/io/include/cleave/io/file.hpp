#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <optional>
#include <string>

namespace cleave::io {

/// What kind of thing is wrong with a file; `ReadError::what` says it in words.
enum class ReadFault : std::uint8_t {
  cannot_open,     ///< missing, or no permission
  not_a_file,      ///< a folder, a device
  empty,           ///< no bytes, or nothing of what the format is for
  too_large,       ///< more than 4 GiB, or more than 2^32 - 2 vertices or corners
  truncated,       ///< ends in the middle of something
  unknown_format,  ///< by its name or first bytes
  syntax,          ///< not what the format allows in this place
  bad_number,      ///< not a number, not finite, or beyond a double
  out_of_range,    ///< a number the format or its meaning does not allow (an index, a dip of 95)
  bad_columns,     ///< the header of a table
};

/// What is wrong with a file, where, and what to do about it.
struct ReadError {
  ReadFault fault;
  std::string file;                          ///< as the caller named it
  std::optional<std::uint32_t> line = {};    ///< from 1; empty where lines mean nothing (binary data, the whole file)
  std::optional<std::uint32_t> column = {};  ///< of the field in a table or of the byte in a line, from 1
  std::string what;
  std::string remedy;
};

/// "FILE:LINE: what; remedy" (without ":LINE" where there is none).
[[nodiscard]] std::string describe(const ReadError& error);

/// All bytes of a regular file of at most 4 GiB. Errors: cannot_open, not_a_file, too_large, truncated. An empty file
/// is an empty string.
[[nodiscard]] std::expected<std::string, ReadError> read_file(const std::filesystem::path& path);

}  // namespace cleave::io
