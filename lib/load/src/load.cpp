#include "cleave/load/load.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace cleave::scene {
namespace {

constexpr std::uintmax_t largest_scene = 64'000'000;
constexpr std::uintmax_t largest_file = 1'000'000'000;

std::expected<std::string, FileRefusal> read_whole(const std::filesystem::path& path, std::uintmax_t largest) {
  std::error_code failed;
  const auto status = std::filesystem::status(path, failed);
  if (status.type() == std::filesystem::file_type::not_found) {
    return std::unexpected(
        FileRefusal{"the file does not exist", "check the name; it is looked for at " + path.generic_string()});
  }
  if (failed || status.type() == std::filesystem::file_type::none) {
    return std::unexpected(FileRefusal{fmt::format("the file cannot be looked at ({})", failed.message()),
                                       "check its folder's permissions"});
  }
  if (status.type() == std::filesystem::file_type::directory) {
    return std::unexpected(FileRefusal{"is a folder", "name a file in it"});
  }
  if (status.type() != std::filesystem::file_type::regular) {
    return std::unexpected(FileRefusal{"is not a regular file", "save it as a file first"});
  }
  const std::uintmax_t size = std::filesystem::file_size(path, failed);
  if (failed) return std::unexpected(FileRefusal{"the file's size cannot be read", "check its permissions"});
  if (size > largest) {
    return std::unexpected(
        FileRefusal{fmt::format("the file has {} bytes, more than the {} allowed here", size, largest),
                    "check that it is the right file, or split it"});
  }
  errno = 0;
  std::ifstream file{path, std::ios::binary};
  if (!file) {
    const int reason = errno;
    if (reason == EMFILE || reason == ENFILE || reason == ENOMEM || reason == EIO) {
      throw std::system_error{reason, std::generic_category(), path.generic_string() + " cannot be opened"};
    }
    return std::unexpected(FileRefusal{"the file cannot be opened", "check its permissions"});
  }
  std::string bytes(static_cast<std::size_t>(size), '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(size));
  if (static_cast<std::uintmax_t>(file.gcount()) != size) {
    return std::unexpected(
        FileRefusal{"the file became shorter while it was read", "wait until it is written, then try again"});
  }
  return bytes;
}

/// What a text is a scene of, by its tables; a text that is no TOML is left to the parser of blocks, which says why.
std::expected<AnyScene, std::vector<Problem>> parse_any(const std::string& text, const std::string& shown,
                                                        const ReadFile& beside) {
  const auto as_any = [](auto parsed) -> std::expected<AnyScene, std::vector<Problem>> {
    if (!parsed) return std::unexpected(std::move(parsed).error());
    return AnyScene{*std::move(parsed)};
  };
  const auto kind = kind2d_of(text);
  if (kind == Kind2d::elastic) return as_any(parse_bodies(text, shown));
  if (kind == Kind2d::contact) return as_any(parse_contact(text, shown));
  return as_any(parse(text, shown, beside));
}

ReadFile reader_beside(const std::filesystem::path& folder) {
  return [folder](const std::string& name) -> std::expected<LoadedFile, FileRefusal> {
    const std::filesystem::path whole = folder / name;
    auto bytes = read_whole(whole, largest_file);
    if (!bytes) return std::unexpected(std::move(bytes).error());
    return LoadedFile{std::move(*bytes), whole.generic_string()};
  };
}

/// Reads a file and gives its text, with what it names beside it, to `parse_text`.
template <class Parse>
auto load_with(const std::string& path, const char* key, const Parse& parse_text)
    -> decltype(parse_text(std::string{}, path, ReadFile{})) {
  const auto text = read_whole(path, largest_scene);
  if (!text) {
    return std::unexpected(std::vector{Problem{path, 1, key, text.error().what, text.error().remedy}});
  }
  return parse_text(*text, path, reader_beside(std::filesystem::path{path}.parent_path()));
}

}  // namespace

std::expected<std::string, FileRefusal> read_file(const std::filesystem::path& path) {
  return read_whole(path, largest_file);
}

std::expected<AnyScene, std::vector<Problem>> load(const std::string& path) {
  return load_with(path, "scene", parse_any);
}

std::expected<AnyScene, std::vector<Problem>> load_text(const std::string& text, const std::string& shown,
                                                        const std::filesystem::path& folder) {
  return parse_any(text, shown, reader_beside(folder));
}

std::expected<Scene, std::vector<Problem>> load_blocks(const std::string& path) {
  return load_with(path, "scene", parse);
}

std::expected<SurveyScene, std::vector<Problem>> load_survey(const std::string& path) {
  return load_with(path, "survey", parse_survey);
}

}  // namespace cleave::scene
