#include <algorithm>
#include <cmath>

#include "newton.hpp"

namespace cleave::motion {

void sweep(const Scaled& scaled, std::vector<Eigen::Vector3d>& x, int sweeps) {
  using Eigen::Matrix3d;
  using Eigen::Vector3d;
  Eigen::VectorXd v = Eigen::VectorXd::Zero(6 * static_cast<Eigen::Index>(scaled.bodies));
  std::vector<Matrix3d> own;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const Scaled::Element& e = scaled.elements[k];
    own.emplace_back(e.on_body.transpose() * e.on_body + e.on_other.transpose() * e.on_other);
    scaled.add(e, x[k], v);
  }
  for (int round = 0; round < sweeps; ++round) {
    double change = 0, largest = 0;
    for (std::size_t k = 0; k < x.size(); ++k) {
      const Scaled::Element& e = scaled.elements[k];
      const Matrix3d& w = own[k];
      const Vector3d b = scaled.relative(e, v) - w * x[k];
      const double rn = 1 / std::max(w(0, 0), 1e-300), rt = 1 / std::max(w(1, 1) + w(2, 2), 1e-300);
      Vector3d p = x[k];
      for (int inner = 0; inner < 8; ++inner) {
        const Vector3d before = p;
        p[0] = e.shear ? 0 : std::min(e.most, std::max(-e.tension, p[0] - rn * (b + w * p)[0]));
        const Vector3d y = b + w * p;
        Eigen::Vector2d t = p.tail<2>() - rt * y.tail<2>();
        const double bound = std::max(0.0, e.mu * p[0] + (e.shear || p[0] > -e.tension ? e.cohesion : 0));
        if (const double length = t.norm(); length > bound) t *= bound / length;
        p.tail<2>() = t;
        if ((p - before).lpNorm<Eigen::Infinity>() <= 1e-14 * p.lpNorm<Eigen::Infinity>()) break;
      }
      scaled.add(e, p - x[k], v);
      change = std::max(change, (p - x[k]).lpNorm<Eigen::Infinity>());
      largest = std::max(largest, p.lpNorm<Eigen::Infinity>());
      x[k] = p;
    }
    if (change <= 1e-14 * largest) break;
  }
}

}  // namespace cleave::motion
