#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "cleave/linear/block_system.hpp"

namespace cleave::linear {

namespace cones {

/// From impulses (n, t) to the cone |t| <= n of axes of one length: n is stretched by this.
[[nodiscard]] double stretch(const auto& e) { return e.mu > 0 ? e.mu : 1; }
/// How far below none the stretched n may go: without friction cohesion is not in the way of opening.
[[nodiscard]] double apex(const auto& e) { return e.mu > 0 || e.shear ? e.cohesion : e.tension; }
/// Whether it carries anything along the plane.
[[nodiscard]] bool slides(const auto& e) { return e.mu > 0 || e.shear; }

/// n^2 - t^2 of a vector inside the cone, without the loss of digits near its skin.
[[nodiscard]] inline double square(const Eigen::Vector3d& x) {
  const double t = x.tail<2>().norm();
  return (x[0] - t) * (x[0] + t);
}

/// Product of the algebra of the cone.
[[nodiscard]] inline Eigen::Vector3d product(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  Eigen::Vector3d out;
  out << a.dot(b), a[0] * b.tail<2>() + b[0] * a.tail<2>();
  return out;
}
/// z with a o z = b.
[[nodiscard]] inline Eigen::Vector3d quotient(const Eigen::Vector3d& b, const Eigen::Vector3d& a) {
  const double det = square(a);
  const double across = a.tail<2>().dot(b.tail<2>());
  Eigen::Vector3d out;
  out[0] = (a[0] * b[0] - across) / det;
  out.tail<2>() = (b.tail<2>() - out[0] * a.tail<2>()) / a[0];
  return out;
}

/// Largest share of a step, at most 1, that stays inside the cone.
[[nodiscard]] inline double room(const Eigen::Vector3d& x, const Eigen::Vector3d& d) {
  const double a = d[0] * d[0] - d.tail<2>().squaredNorm(), b = x[0] * d[0] - x.tail<2>().dot(d.tail<2>()),
               c = square(x);
  double most = 1;
  if (d[0] < 0) most = std::min(most, -x[0] / d[0]);
  // a s^2 + 2 b s + c = 0, its smallest positive root.
  const double root = b * b - a * c;
  if (a < 0) {
    const double far = std::sqrt(std::max(0.0, root));
    if (b > 0) {
      most = std::min(most, (b + far) / -a);
    } else if (far - b > 0) {
      most = std::min(most, c / (far - b));
    }
  } else if (b < 0 && root >= 0) {
    most = std::min(most, c / (std::sqrt(root) - b));
  }
  return most;
}

/// Of one contact: scaled force and velocity, and what the linearised system needs.
struct Cone {
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), speed = Eigen::Vector3d::Zero();
  Eigen::Vector3d unit = Eigen::Vector3d::Zero();  ///< of a force of the cone: impulse by component
  Eigen::Matrix3d scaling = Eigen::Matrix3d::Zero(), back = Eigen::Matrix3d::Zero();
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  Eigen::Matrix3d compliance = Eigen::Matrix3d::Zero(), turn = Eigen::Matrix3d::Identity();
  Eigen::Vector3d off = Eigen::Vector3d::Zero();
  Eigen::Vector3d d_force = Eigen::Vector3d::Zero(), d_speed = Eigen::Vector3d::Zero();
  /// `scaling` P and `back` P^-1 such that P speed = P^-1 force, which is `middle`.
  void scale();
};

inline void Cone::scale() {
  const double f = std::sqrt(square(force)), s = std::sqrt(square(speed));
  const Eigen::Vector3d fn = force / f, sn = speed / s;
  const double gamma = std::sqrt(0.5 * (1 + fn.dot(sn)));
  Eigen::Vector3d w = sn;
  w.tail<2>() *= -1;
  w = ((fn + w) / (2 * gamma)).eval();
  const double by = std::sqrt(f / s);
  scaling << w[0], w[1], w[2], w[1], 1 + w[1] * w[1] / (1 + w[0]), w[1] * w[2] / (1 + w[0]), w[2],
      w[1] * w[2] / (1 + w[0]), 1 + w[2] * w[2] / (1 + w[0]);
  back = scaling;
  back.row(0).tail<2>() *= -1;
  back.col(0).tail<2>() *= -1;
  scaling *= by;
  back /= by;
  middle = scaling * speed;
}

}  // namespace cones

/// Coulomb's law on the cone by interior points (Kojima, Mizuno and Yoshise 1989; scaling of Nesterov and Todd 1997;
/// for friction Acary, Armand, Nguyen and Shpakovych 2023): forces x inside the cone and velocities inside its dual,
/// opened by mu |slip|, with products that fall to zero along a path. The slip is part of the linearised system.
/// A weight about given forces keeps those near them that the law leaves open.
///
/// `Contacts` has `bodies`, `width()` rows each, and `elements`: `body`, `other` (optional), `on_body` and `on_other`
/// (rows that a force gives), `mu`, `cohesion`, `tension`, `shear` (a disc of that cohesion, without a normal force).
/// `start()`: velocities without forces; `relative(e, v)`: opening and slip; `change(e, dv)`: of these;
/// `add(e, x, v)`: what a force adds.
template <class Contacts>
class Interior final {
 public:
  explicit Interior(const Contacts& contacts);
  Interior(const Contacts&&) = delete;

  struct Options {
    double weight = 1e-8;   ///< of x - centre
    double goal = 1e-13;    ///< of the mean product
    double start = 1e3;     ///< how far inside the cone forces begin, of what moves a body by 1
    bool coupled = true;    ///< slip in the linearised system, else renewed from step to step
    std::size_t most = 60;  ///< factors
    /// Slip of each point, as if it were known: one convex programme. Empty: it is found.
    std::span<const double> given = {};
  };
  /// Forces near the end of the path; the products left. `x`: the centre, then the answer.
  double solve(std::vector<Eigen::Vector3d>& x, const Options& options);
  [[nodiscard]] std::size_t factors() const noexcept { return system_.factors(); }

 private:
  /// Forces inside their cones, and not nearer to the skin than `start`.
  void begin(std::vector<Eigen::Vector3d>& x, const Options& options);
  [[nodiscard]] bool all_inside(Eigen::Vector3d cones::Cone::* which) const {
    return std::ranges::all_of(cones_, [&](const cones::Cone& c) { return cones::square(c.*which) > 0; });
  }
  /// Of the cones, after a share of the step.
  [[nodiscard]] double mean_product(double share) const;
  /// The largest lack of balance; slips below `blunt` are smoothed.
  double linearise(const std::vector<Eigen::Vector3d>& x, const std::vector<Eigen::Vector3d>& centre, double blunt,
                   const Options& options);
  [[nodiscard]] bool factor(bool symmetric);
  /// The step to products of `target`, `corrected` by that of the step before. Returns the share that stays inside.
  double direct(double target, bool corrected, double weight);
  void step(double share, std::vector<Eigen::Vector3d>& x);

  const Contacts* contacts_;
  BlockSystem system_;
  std::vector<cones::Cone> cones_;
  Eigen::VectorXd v_, off_v_, dv_;  ///< velocities of the bodies, their lack of balance, the step
};

template <class Contacts>
Interior<Contacts>::Interior(const Contacts& contacts)
    : contacts_{&contacts}, system_{contacts.bodies, contacts.width(), links_of(contacts.elements)} {}

template <class Contacts>
void Interior<Contacts>::begin(std::vector<Eigen::Vector3d>& x, const Options& options) {
  cones_.assign(x.size(), {});
  v_ = contacts_->start();
  for (std::size_t k = 0; k < x.size(); ++k) {
    const auto& e = contacts_->elements[k];
    const double wide = cones::stretch(e);
    const Eigen::Vector3d at{wide * x[k][0] + cones::apex(e), cones::slides(e) ? x[k][1] : 0,
                             cones::slides(e) ? x[k][2] : 0};
    cones::Cone& cone = cones_[k];
    cone.force = at;
    cone.force[0] = std::max(at[0], at.tail<2>().norm()) + options.start;
    // The height of a disc is its radius.
    if (e.shear) cone.force = {e.cohesion, 0, 0};
    cone.speed = {1, 0, 0};
    cone.unit = {e.shear ? 0 : 1 / wide, cones::slides(e) ? 1.0 : 0.0, cones::slides(e) ? 1.0 : 0.0};
    x[k] = cone.force;
    x[k][0] = (x[k][0] - cones::apex(e)) / wide;
  }
  for (std::size_t k = 0; k < x.size(); ++k) contacts_->add(contacts_->elements[k], x[k], v_);
}

template <class Contacts>
double Interior<Contacts>::mean_product(double share) const {
  double sum = 0;
  for (const cones::Cone& c : cones_) {
    sum += share > 0 ? (c.force + share * c.d_force).dot(c.speed + share * c.d_speed) : c.force.dot(c.speed);
  }
  return sum / static_cast<double>(cones_.size());
}

template <class Contacts>
double Interior<Contacts>::linearise(const std::vector<Eigen::Vector3d>& x, const std::vector<Eigen::Vector3d>& centre,
                                     double blunt, const Options& options) {
  double off = 0;
  off_v_ = v_ - contacts_->start();
  for (std::size_t k = 0; k < x.size(); ++k) {
    const auto& e = contacts_->elements[k];
    cones::Cone& c = cones_[k];
    c.scale();
    // Velocities, opened by the slip.
    Eigen::Vector3d u = contacts_->relative(e, v_);
    c.turn.setIdentity();
    if (e.mu > 0 && !options.given.empty()) {
      u[0] += e.mu * options.given[k];
    } else if (e.mu > 0) {
      const double slip = std::sqrt(u.tail<2>().squaredNorm() + blunt * blunt);
      if (options.coupled) c.turn.row(0).tail<2>() = e.mu / slip * u.tail<2>().transpose();
      u[0] += e.mu * slip;
    } else if (!e.shear) {
      u.tail<2>().setZero();
    }
    c.off = c.unit.cwiseProduct(u + options.weight * (x[k] - centre[k])) - c.speed;
    if (!cones::slides(e)) c.off.tail<2>() = -c.speed.tail<2>();
    if (e.shear) c.off[0] = 0;
    off = std::max(off, c.off.lpNorm<Eigen::Infinity>());
    Eigen::Matrix3d stiff = c.back * c.back;
    stiff.diagonal() += options.weight * c.unit.cwiseProduct(c.unit);
    if (e.shear) {
      c.compliance.setZero();
      c.compliance.bottomRightCorner<2, 2>() = Eigen::Matrix2d{stiff.bottomRightCorner<2, 2>()}.inverse();
    } else {
      c.compliance = stiff.inverse();
    }
    contacts_->add(e, -x[k], off_v_);
  }
  return std::max(off, off_v_.lpNorm<Eigen::Infinity>());
}

template <class Contacts>
bool Interior<Contacts>::factor(bool symmetric) {
  // Dense factors are cheap: the one that bears rounding best.
  system_.clear(symmetric && !system_.is_dense());
  for (std::size_t k = 0; k < cones_.size(); ++k) {
    const cones::Cone& c = cones_[k];
    const Eigen::Matrix3d soft = c.unit.asDiagonal() * c.compliance * c.unit.asDiagonal();
    system_.add_element(contacts_->elements[k], (soft * c.turn).eval());
  }
  return system_.factorise();
}

template <class Contacts>
double Interior<Contacts>::direct(double target, bool corrected, double weight) {
  Eigen::VectorXd rhs = -off_v_;
  std::vector<Eigen::Vector3d> own(cones_.size());
  std::vector<double> height(cones_.size());  // of what a disc has in speed: nothing but the products gives it
  for (std::size_t k = 0; k < cones_.size(); ++k) {
    const cones::Cone& c = cones_[k];
    Eigen::Vector3d want = -cones::product(c.middle, c.middle);
    want[0] += target;
    if (corrected) want -= cones::product((c.back * c.d_force).eval(), (c.scaling * c.d_speed).eval());
    want = (c.back * cones::quotient(want, c.middle)).eval();
    if (contacts_->elements[k].shear) height[k] = want[0];
    own[k] = c.compliance * (want - c.off);
    contacts_->add(contacts_->elements[k], c.unit.cwiseProduct(own[k]), rhs);
  }
  dv_ = rhs;
  system_.solve(dv_);
  double share = 1;
  for (std::size_t k = 0; k < cones_.size(); ++k) {
    const auto& e = contacts_->elements[k];
    cones::Cone& c = cones_[k];
    const Eigen::Vector3d du = c.turn * contacts_->change(e, dv_);
    c.d_force = own[k] - c.compliance * c.unit.cwiseProduct(du);
    c.d_speed = c.unit.cwiseProduct(du) + weight * c.unit.cwiseProduct(c.unit).cwiseProduct(c.d_force) + c.off;
    if (e.shear) c.d_speed[0] = height[k] - (c.back * c.back).row(0).dot(c.d_force);
    share = std::min({share, cones::room(c.force, c.d_force), cones::room(c.speed, c.d_speed)});
  }
  return share;
}

template <class Contacts>
void Interior<Contacts>::step(double share, std::vector<Eigen::Vector3d>& x) {
  v_ += share * dv_;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const auto& e = contacts_->elements[k];
    cones::Cone& c = cones_[k];
    c.force += share * c.d_force;
    c.speed += share * c.d_speed;
    x[k] = c.force;
    x[k][0] = (c.force[0] - cones::apex(e)) / cones::stretch(e);
  }
}

template <class Contacts>
double Interior<Contacts>::solve(std::vector<Eigen::Vector3d>& x, const Options& options) {
  const std::vector<Eigen::Vector3d> centre = x;
  begin(x, options);
  double left = mean_product(0);
  std::vector<Eigen::Vector3d> best = x;
  double least = std::numeric_limits<double>::infinity();
  int stuck = 0;
  for (std::size_t round = 0; round < options.most; ++round) {
    if (!all_inside(&cones::Cone::force) || !all_inside(&cones::Cone::speed)) break;
    const double off = linearise(x, centre, 0.1 * std::min(1.0, left), options);
    const double now = std::max(left, off);
    if (now < least) {
      stuck = now < 0.8 * least ? 0 : stuck + 1;
      least = now;
      best = x;
    } else {
      ++stuck;
    }
    if ((left < options.goal && off < std::max(1e-12, 0.1 * options.goal)) || stuck > 12) break;
    // Near the skin rounding may put the scaled middle of what lies inside onto it.
    if (!all_inside(&cones::Cone::middle)) break;
    if (!factor(!options.coupled || !options.given.empty())) break;
    const double reach = direct(0, false, options.weight);
    const double centring = std::clamp(std::pow(std::max(0.0, mean_product(reach) / left), 3), 1e-6, 1.0);
    double share = direct(std::max(centring * left, 0.1 * options.goal), true, options.weight);
    share = std::min(1.0, std::max(0.9, 1 - left) * share);
    // Back to the middle of the path.
    if (share < 0.1) share = std::min(1.0, 0.9 * direct(0.9 * left, false, options.weight));
    if (!dv_.allFinite()) break;
    step(share, x);
    left = mean_product(0);
    if (!(left > 0) || !std::isfinite(left)) break;
  }
  x = best;
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (!cones::slides(contacts_->elements[k])) x[k].tail<2>().setZero();
  }
  return least;
}

}  // namespace cleave::linear
