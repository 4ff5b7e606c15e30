#pragma once

#include <expected>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/scene/problem.hpp"
#include "cleave/scene/scene.hpp"

namespace cleave::scene {

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

/// Text of a scene file to a validated scene, or all that is wrong with it (never empty). `shown` is how messages name
/// the scene file. Touches no file but through `read_file`.
[[nodiscard]] std::expected<Scene, std::vector<Problem>> parse(std::string_view text, const std::string& shown,
                                                               const ReadFile& read_file);

}  // namespace cleave::scene
