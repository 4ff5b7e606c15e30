#pragma once

#include <cstdint>
#include <expected>
#include <functional>
#include <string>
#include <vector>

namespace cleave::scene {

/// One thing that is wrong with a scene (or, as a note, worth knowing): where, what, and what to do about it.
struct Problem {
  std::string file;    ///< the scene file or a file it names, as the user wrote it
  std::uint32_t line;  ///< from 1; 1 when the file could not even be opened
  std::string key;     ///< "joint[2].disc.radius": tables of an array count from 1
  std::string what;
  std::string remedy;
  friend bool operator==(const Problem&, const Problem&) = default;
};

/// "FILE:LINE: KEY: what is wrong; what to do", without "error: " before it.
[[nodiscard]] std::string describe(const Problem& problem);

/// A file that the scene names, as read.
struct InputFile {
  std::string name;  ///< as written in the scene
  std::string sha256;
  std::uint64_t bytes;
};

/// The bytes of a file that a scene names.
struct LoadedFile {
  std::string bytes;
  std::string shown;  ///< how messages name it
};
/// Why a file cannot be had.
struct FileRefusal {
  std::string what;
  std::string remedy;
};
/// Gives the bytes of a file by the name that stands in the scene (relative to the scene's folder).
using ReadFile = std::function<std::expected<LoadedFile, FileRefusal>(const std::string& name)>;

}  // namespace cleave::scene
