#pragma once

#include <Eigen/Dense>

/// Projections of a force (n, t1, t2) on what a contact can carry, with their derivatives: what semismooth Newton
/// iterations on contacts are made of (Li, Sun and Toh 2018).
namespace cleave::linear {

struct Projection {
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  Eigen::Matrix3d slope = Eigen::Matrix3d::Zero();  ///< an element of the generalized derivative
  bool any = false;                                 ///< the slope counts: it is not zero
};

/// The tangential part of a projection: t on the disc of that radius. `any` is the caller's.
inline void onto_disc(const Eigen::Vector2d& t, double radius, Projection& out) {
  const double length = t.norm();
  if (length <= radius) {
    out.x.tail<2>() = t;
    out.slope.bottomRightCorner<2, 2>().setIdentity();
  } else if (radius > 0) {
    const Eigen::Vector2d e = t / length;
    out.x.tail<2>() = radius * e;
    out.slope.bottomRightCorner<2, 2>() = radius / length * (Eigen::Matrix2d::Identity() - e * e.transpose());
  }
}

/// Onto |t| <= mu (n + apex), n >= -apex.
[[nodiscard]] inline Projection onto_cone(Eigen::Vector3d w, double mu, double apex) {
  Projection out;
  w[0] += apex;
  const Eigen::Vector2d t = w.tail<2>();
  const double length = t.norm();
  if (length <= mu * w[0]) {
    out.x = w;
    out.slope.setIdentity();
    out.any = true;
  } else if (!(mu * length <= -w[0])) {
    const double normal = (w[0] + mu * length) / (1 + mu * mu);
    const Eigen::Vector2d e = t / length;
    out.x << normal, mu * normal * e;
    const Eigen::Vector3d along{1, mu * e[0], mu * e[1]};
    out.slope = along * along.transpose() / (1 + mu * mu);
    out.slope.bottomRightCorner<2, 2>() += mu * normal / length * (Eigen::Matrix2d::Identity() - e * e.transpose());
    out.any = true;
  }
  out.x[0] -= apex;
  return out;
}

}  // namespace cleave::linear
