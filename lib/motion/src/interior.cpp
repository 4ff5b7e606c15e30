#include "interior.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace cleave::motion {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// From impulses (n, t) to the cone |t| <= n of axes of one length: n is stretched by this.
double stretch(const Scaled::Element& e) { return e.mu > 0 ? e.mu : 1; }
/// How far below none the stretched n may go: without friction cohesion is not in the way of opening.
double apex(const Scaled::Element& e) { return e.mu > 0 || e.shear ? e.cohesion : e.tension; }
/// Whether it carries anything along the plane.
bool slides(const Scaled::Element& e) { return e.mu > 0 || e.shear; }

/// n^2 - t^2 of a vector inside the cone, without the loss of digits near its skin.
double square(const Vector3d& x) {
  const double t = x.tail<2>().norm();
  return (x[0] - t) * (x[0] + t);
}

/// Product of the algebra of the cone.
Vector3d product(const Vector3d& a, const Vector3d& b) {
  Vector3d out;
  out << a.dot(b), a[0] * b.tail<2>() + b[0] * a.tail<2>();
  return out;
}
/// z with a o z = b.
Vector3d quotient(const Vector3d& b, const Vector3d& a) {
  const double det = square(a);
  const double across = a.tail<2>().dot(b.tail<2>());
  Vector3d out;
  out[0] = (a[0] * b[0] - across) / det;
  out.tail<2>() = (b.tail<2>() - out[0] * a.tail<2>()) / a[0];
  return out;
}

/// Largest share of a step, at most 1, that stays inside the cone.
double room(const Vector3d& x, const Vector3d& d) {
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

}  // namespace

Interior::Interior(const Scaled& scaled)
    : scaled_{&scaled}, system_{scaled.bodies, 6, linear::links_of(scaled.elements)} {}

void Interior::begin(std::vector<Vector3d>& x, const Options& options) {
  cones_.assign(x.size(), {});
  v_ = VectorXd::Zero(row(static_cast<std::uint32_t>(scaled_->bodies)));
  for (std::size_t k = 0; k < x.size(); ++k) {
    const Scaled::Element& e = scaled_->elements[k];
    const double wide = stretch(e);
    const Vector3d at{wide * x[k][0] + apex(e), slides(e) ? x[k][1] : 0, slides(e) ? x[k][2] : 0};
    Cone& cone = cones_[k];
    cone.force = at;
    cone.force[0] = std::max(at[0], at.tail<2>().norm()) + options.start;
    // The height of a disc is its radius.
    if (e.shear) cone.force = {e.cohesion, 0, 0};
    cone.speed = {1, 0, 0};
    cone.unit = {e.shear ? 0 : 1 / wide, slides(e) ? 1.0 : 0.0, slides(e) ? 1.0 : 0.0};
    x[k] = cone.force;
    x[k][0] = (x[k][0] - apex(e)) / wide;
  }
  for (std::size_t k = 0; k < x.size(); ++k) scaled_->add(scaled_->elements[k], x[k], v_);
}

double Interior::mean_product(double share) const {
  double sum = 0;
  for (const Cone& c : cones_) {
    sum += share > 0 ? (c.force + share * c.d_force).dot(c.speed + share * c.d_speed) : c.force.dot(c.speed);
  }
  return sum / static_cast<double>(cones_.size());
}

void Interior::Cone::scale() {
  const double f = std::sqrt(square(force)), s = std::sqrt(square(speed));
  const Vector3d fn = force / f, sn = speed / s;
  const double gamma = std::sqrt(0.5 * (1 + fn.dot(sn)));
  Vector3d w = sn;
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

double Interior::linearise(const std::vector<Vector3d>& x, const std::vector<Vector3d>& centre, double blunt,
                           const Options& options) {
  double off = 0;
  off_v_ = v_;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const Scaled::Element& e = scaled_->elements[k];
    Cone& c = cones_[k];
    c.scale();
    // Velocities, opened by the slip.
    Vector3d u = scaled_->relative(e, v_);
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
    if (!slides(e)) c.off.tail<2>() = -c.speed.tail<2>();
    if (e.shear) c.off[0] = 0;
    off = std::max(off, c.off.lpNorm<Eigen::Infinity>());
    Matrix3d stiff = c.back * c.back;
    stiff.diagonal() += options.weight * c.unit.cwiseProduct(c.unit);
    if (e.shear) {
      c.compliance.setZero();
      c.compliance.bottomRightCorner<2, 2>() = Eigen::Matrix2d{stiff.bottomRightCorner<2, 2>()}.inverse();
    } else {
      c.compliance = stiff.inverse();
    }
    scaled_->add(e, -x[k], off_v_);
  }
  return std::max(off, off_v_.lpNorm<Eigen::Infinity>());
}

bool Interior::factor(bool symmetric) {
  // Dense factors are cheap: the one that bears rounding best.
  system_.clear(symmetric && !system_.is_dense());
  for (std::size_t k = 0; k < cones_.size(); ++k) {
    const Cone& c = cones_[k];
    const Matrix3d soft = c.unit.asDiagonal() * c.compliance * c.unit.asDiagonal();
    system_.add_element(scaled_->elements[k], (soft * c.turn).eval());
  }
  return system_.factorise();
}

double Interior::direct(double target, bool corrected, double weight) {
  VectorXd rhs = -off_v_;
  std::vector<Vector3d> own(cones_.size());
  std::vector<double> height(cones_.size());  // of what a disc has in speed: nothing but the products gives it
  for (std::size_t k = 0; k < cones_.size(); ++k) {
    const Cone& c = cones_[k];
    Vector3d want = -product(c.middle, c.middle);
    want[0] += target;
    if (corrected) want -= product((c.back * c.d_force).eval(), (c.scaling * c.d_speed).eval());
    want = (c.back * quotient(want, c.middle)).eval();
    if (scaled_->elements[k].shear) height[k] = want[0];
    own[k] = c.compliance * (want - c.off);
    scaled_->add(scaled_->elements[k], c.unit.cwiseProduct(own[k]), rhs);
  }
  dv_ = rhs;
  system_.solve(dv_);
  double share = 1;
  for (std::size_t k = 0; k < cones_.size(); ++k) {
    const Scaled::Element& e = scaled_->elements[k];
    Cone& c = cones_[k];
    Vector3d du = e.on_body.transpose() * dv_.segment<6>(row(e.body));
    if (e.other) du += e.on_other.transpose() * dv_.segment<6>(row(*e.other));
    du = (c.turn * du).eval();
    c.d_force = own[k] - c.compliance * c.unit.cwiseProduct(du);
    c.d_speed = c.unit.cwiseProduct(du) + weight * c.unit.cwiseProduct(c.unit).cwiseProduct(c.d_force) + c.off;
    if (e.shear) c.d_speed[0] = height[k] - (c.back * c.back).row(0).dot(c.d_force);
    share = std::min({share, room(c.force, c.d_force), room(c.speed, c.d_speed)});
  }
  return share;
}

void Interior::step(double share, std::vector<Vector3d>& x) {
  v_ += share * dv_;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const Scaled::Element& e = scaled_->elements[k];
    Cone& c = cones_[k];
    c.force += share * c.d_force;
    c.speed += share * c.d_speed;
    x[k] = c.force;
    x[k][0] = (c.force[0] - apex(e)) / stretch(e);
  }
}

double Interior::solve(std::vector<Vector3d>& x, const Options& options) {
  const std::vector<Vector3d> centre = x;
  begin(x, options);
  double left = mean_product(0);
  std::vector<Vector3d> best = x;
  double least = std::numeric_limits<double>::infinity();
  int stuck = 0;
  for (std::size_t round = 0; round < options.most; ++round) {
    const bool inside =
        std::ranges::all_of(cones_, [](const Cone& c) { return square(c.force) > 0 && square(c.speed) > 0; });
    if (!inside) break;
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
    if (!slides(scaled_->elements[k])) x[k].tail<2>().setZero();
  }
  return least;
}

}  // namespace cleave::motion
