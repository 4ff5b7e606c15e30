#pragma once

#include <cstddef>
#include <optional>
#include <utility>

#include "cleave/survey/traces.hpp"

namespace cleave::scene {

/// Two sides of a polygon that cross, by number from 0 (side i runs from corner i to the next); empty where none do,
/// and of circles.
[[nodiscard]] std::optional<std::pair<std::size_t, std::size_t>> sides_that_cross(const survey::Window& window);

}  // namespace cleave::scene
