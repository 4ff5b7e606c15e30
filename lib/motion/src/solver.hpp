#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "cleave/motion/world.hpp"

/// Coulomb's law on the round cone, solved for all contacts of a group at once.
namespace cleave::motion {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Rows = Eigen::Matrix<double, 6, 3>;

/// One contact point. Impulses p = (n, t) give y = b + H v = (opening, slip):
///   0 <= n + tension  _|_  y_n >= 0,   |t| <= mu n + cohesion,   slip 0 inside the bound, else opposite to t.
/// Cohesion counts while the point is closed; tension is at most cohesion / mu, the apex of the cone.
struct Point {
  std::uint32_t body = 0;
  std::optional<std::uint32_t> other = {};               ///< empty: what does not move
  Rows on_body = Rows::Zero(), on_other = Rows::Zero();  ///< columns: what an impulse along n, t1, t2 gives the body
  Eigen::Vector3d b = Eigen::Vector3d::Zero();           ///< m/s
  double mu = 0;
  double cohesion = 0, tension = 0;  ///< N s
  bool shear = false;                ///< no normal part (first columns 0), no friction: |t| <= cohesion, always
  /// No part along the plane (last columns 0), no strength: 0 <= n <= most, n = most where y_n < 0.
  bool axial = false;
  double most = std::numeric_limits<double>::infinity();  ///< N s
  Eigen::Vector3d start = Eigen::Vector3d::Zero();
};

/// Bodies (mass and inertia in the scene's axes, velocities without contacts) and their contact points.
struct Group {
  std::vector<Matrix6> mass;
  std::vector<Vector6> free;
  std::vector<Point> points;
  /// Where `start` of its points was the answer of this group at rest: it is taken again where it meets the law by far,
  /// else what Newton's method finds from there, and no other answer is searched. Whether it may be locked.
  std::optional<bool> settled = {};
  /// m/s by which an answer taken again may miss the law: it adds up, and bodies have to stay at rest.
  double still = std::numeric_limits<double>::infinity();
};

struct Solution {
  std::vector<Eigen::Vector3d> impulse;
  std::vector<Vector6> velocity;
  SolveReport report;
};

/// Cheapest way first; every answer is judged by its natural-map residual, recomputed whatever found it.
[[nodiscard]] Solution solve(const Group& group, const SolverOptions& options);

/// As if contacts gave way by `weight` of what moves their bodies: where nothing meets the law, as for a block between
/// walls that leave it no room, what is missed is shared out. Convex without friction: always solved.
[[nodiscard]] Solution solve_softly(const Group& group, double weight);

/// Residual of the natural map (Alart and Curnier 1991) of any impulses: the larger of that in impulses over
/// max(|p|, |b / diag W|), and that in velocities over max(|b|, 1e-6 |W p|).
[[nodiscard]] double natural_residual(const Group& group, const std::vector<Eigen::Vector3d>& impulse);
/// A second judge: distance from p to the projection of p - r y^ onto the cone (De Saxce and Feng 1998), relative; for
/// points without cohesion.
[[nodiscard]] double cone_residual(const Group& group, const std::vector<Eigen::Vector3d>& impulse);

/// Two unit vectors that make a right-handed frame with the normal (Duff et al. 2017).
struct Frame {
  Vec3 n, t1, t2;
};
[[nodiscard]] Frame frame_of(Vec3 normal) noexcept;
[[nodiscard]] inline Vec3 in_space(const Frame& frame, const Eigen::Vector3d& along) noexcept {
  return along[0] * frame.n + along[1] * frame.t1 + along[2] * frame.t2;
}
/// What impulses along the frame at an arm from the centroid give.
[[nodiscard]] Rows rows_of(const Frame& frame, Vec3 arm) noexcept;

}  // namespace cleave::motion
