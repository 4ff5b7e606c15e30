#include "cleave/io/file.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <fstream>
#include <ios>
#include <system_error>

#include "text.hpp"

namespace cleave::io {
namespace {

constexpr std::uintmax_t largest_file = std::uintmax_t{4} << 30U;

}  // namespace

std::expected<std::string, ReadError> read_file(const std::filesystem::path& path) {
  const auto fail = [&](ReadFault fault, std::string what, std::string remedy) {
    return std::unexpected(whole_file(fault, path.string(), std::move(what), std::move(remedy)));
  };
  std::error_code failure;
  const auto status = std::filesystem::status(path, failure);
  if (status.type() == std::filesystem::file_type::not_found) {
    return fail(ReadFault::cannot_open, "there is no such file", "check the name and the folder it is looked for in");
  }
  if (failure) {
    return fail(ReadFault::cannot_open, fmt::format("cannot be opened ({})", failure.message()),
                "check the name and the permissions");
  }
  if (!std::filesystem::is_regular_file(status)) {
    return fail(ReadFault::not_a_file, "is not a regular file", "name a file, not a folder or a device");
  }
  const std::uintmax_t size = std::filesystem::file_size(path, failure);
  if (failure) return fail(ReadFault::cannot_open, "its size cannot be read", "check the permissions");
  if (size > largest_file) {
    return fail(ReadFault::too_large,
                fmt::format("has {:.1f} GiB, allowed are 4", static_cast<double>(size) / (1U << 30U)),
                "split it, or leave out what is far from the model");
  }
  std::ifstream stream{path, std::ios::binary};
  if (!stream) return fail(ReadFault::cannot_open, "cannot be opened for reading", "check the permissions");
  std::string bytes(size, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(size));
  if (static_cast<std::uintmax_t>(stream.gcount()) != size) {
    return fail(ReadFault::truncated, fmt::format("only {} of {} bytes could be read", stream.gcount(), size),
                "check the disk, and that nobody writes to the file");
  }
  return bytes;
}

}  // namespace cleave::io
