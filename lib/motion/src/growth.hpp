#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "newton.hpp"

/// Answers that move, followed from motion without friction.
namespace cleave::motion {

using Unknowns = std::vector<Eigen::Vector3d>;
using Moves = std::function<bool(const Unknowns&)>;

/// Friction grows from none in small shares on forces without friction, some sweeps at each: so it acts against the
/// motion, and forces that only lock are not found. False where bodies come to rest on the way: they rest under more.
[[nodiscard]] bool grow_friction(Scaled& scaled, Unknowns& x, const Moves& moves);

/// One body of a group while all others go on at these velocities.
struct Alone {
  Group group;
  std::vector<std::size_t> from;  ///< places of its points in the whole group
};
[[nodiscard]] Alone alone(const Group& group, std::uint32_t body, const std::vector<Vector6>& velocity);

/// Impulses of the points of one body that moves so while friction grows from none; empty where it comes to rest.
[[nodiscard]] Unknowns moving_alone(const Group& own);

}  // namespace cleave::motion
