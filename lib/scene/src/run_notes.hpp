#pragma once

#include <string>
#include <vector>

#include "cleave/scene/run.hpp"

namespace cleave::scene {

/// What a user should know of a run: what was left out, what may move beyond it, what does not reach its aim.
[[nodiscard]] std::vector<std::string> notes_of(const Scene& scene, const Realization& made);

}  // namespace cleave::scene
