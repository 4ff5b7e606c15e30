#pragma once

#include <expected>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/scene/problem.hpp"
#include "cleave/scene3d/scene.hpp"

namespace cleave::scene {

/// Text of a scene file to a validated scene, or all that is wrong with it (never empty). `shown` is how messages name
/// the scene file. Touches no file but through `read_file`.
[[nodiscard]] std::expected<Scene, std::vector<Problem>> parse(std::string_view text, const std::string& shown,
                                                               const ReadFile& read_file);

}  // namespace cleave::scene
