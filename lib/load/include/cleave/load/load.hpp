#pragma once

#include <expected>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "cleave/field_data/survey_file.hpp"
#include "cleave/scene2d/bodies.hpp"
#include "cleave/scene2d/contact.hpp"
#include "cleave/scene3d/scene.hpp"

/// Scenes from disk. Files that they name are looked for beside them. Not regular files and files beyond 64 MB (the
/// scene) or 1 GB (what it names) are refused without reading them.
namespace cleave::scene {

/// A scene by its problem: blocks in three dimensions, elastic bodies, bodies in contact.
using AnyScene = std::variant<Scene, BodiesScene, ContactScene>;
/// Reads the file once; what it holds says which scene it is.
[[nodiscard]] std::expected<AnyScene, std::vector<Problem>> load(const std::string& path);
/// The same of a text in memory; `shown` is how messages name it, and files that it names are looked for in `folder`.
[[nodiscard]] std::expected<AnyScene, std::vector<Problem>> load_text(const std::string& text, const std::string& shown,
                                                                      const std::filesystem::path& folder);
/// Where only blocks make sense.
[[nodiscard]] std::expected<Scene, std::vector<Problem>> load_blocks(const std::string& path);
[[nodiscard]] std::expected<SurveyScene, std::vector<Problem>> load_survey(const std::string& path);
/// The bytes of one file. Throws std::system_error, as all above do, where the machine is at fault and not the file:
/// too many open files, a disk that fails.
[[nodiscard]] std::expected<std::string, FileRefusal> read_file(const std::filesystem::path& path);

}  // namespace cleave::scene
