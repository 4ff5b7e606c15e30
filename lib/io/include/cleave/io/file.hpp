#pragma once

#include <expected>
#include <filesystem>
#include <string>

#include "cleave/io/read_error.hpp"

namespace cleave::io {

/// All bytes of a regular file of at most 4 GiB. Errors: cannot_open, not_a_file, too_large, truncated. An empty file
/// is an empty string.
[[nodiscard]] std::expected<std::string, ReadError> read_file(const std::filesystem::path& path);

}  // namespace cleave::io
