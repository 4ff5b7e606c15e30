#pragma once

#include <expected>
#include <string>
#include <variant>
#include <vector>

#include "cleave/scene/bodies.hpp"
#include "cleave/scene/contact.hpp"
#include "cleave/scene/parse.hpp"
#include "cleave/scene/survey_file.hpp"

/// Scenes from disk. Files that they name are looked for beside them. Not regular files and files beyond 64 MB (the
/// scene) or 1 GB (what it names) are refused without reading them.
namespace cleave::scene {

/// A scene by its problem: blocks in three dimensions, elastic bodies, bodies in contact.
using AnyScene = std::variant<Scene, BodiesScene, ContactScene>;
/// Reads the file once; what it holds says which scene it is.
[[nodiscard]] std::expected<AnyScene, std::vector<Problem>> load(const std::string& path);
/// Where only blocks make sense.
[[nodiscard]] std::expected<Scene, std::vector<Problem>> load_blocks(const std::string& path);
[[nodiscard]] std::expected<SurveyScene, std::vector<Problem>> load_survey(const std::string& path);

}  // namespace cleave::scene
