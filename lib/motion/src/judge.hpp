#pragma once

#include <Eigen/Dense>
#include <vector>

#include "solver.hpp"

/// What an answer to the law of a group of contacts is judged by, whatever found it.
namespace cleave::motion {

/// Velocities under impulses, and of each point the diagonal of W and y.
struct Response {
  std::vector<Vector6> velocity;
  std::vector<Eigen::Vector3d> diagonal, y, from_impulse;
};

[[nodiscard]] Response respond(const Group& group, const std::vector<Eigen::Vector3d>& impulse);

/// `residual`: that of `natural_residual`. `missed`: largest velocity by which a contact misses the law.
struct Judged {
  double residual = 0, missed = 0;
};
[[nodiscard]] Judged judge(const Group& group, const std::vector<Eigen::Vector3d>& impulse, const Response& response);

}  // namespace cleave::motion
