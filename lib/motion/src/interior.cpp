#include "interior.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace cleave::motion {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// From impulses (n, t) to the cone |t| <= n of axes of one length: n is stretched by this.
double stretch(const Scaled::Element& e) { return e.mu > 0 ? e.mu : 1; }

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

Interior::Interior(const Scaled& scaled) : scaled_{&scaled}, dense_{scaled.bodies <= few_bodies} {
  if (!dense_) sparse_.emplace(scaled.bodies, 6, links(scaled));
}

bool Interior::factor(bool symmetric) {
  ++factors_;
  Eigen::MatrixXd whole;
  if (dense_) {
    const Index size = row(static_cast<std::uint32_t>(scaled_->bodies));
    whole = Eigen::MatrixXd::Identity(size, size);
  } else {
    sparse_->clear(symmetric);
    for (std::size_t b = 0; b < scaled_->bodies; ++b) sparse_->block(b, b).diagonal().setOnes();
  }
  const auto add = [&](std::uint32_t r, std::uint32_t c, const Matrix6& value) {
    if (dense_) {
      whole.block<6, 6>(row(r), row(c)) += value;
    } else {
      sparse_->block(r, c) += value;
    }
  };
  for (std::size_t k = 0; k < cones_.size(); ++k) {
    const Scaled::Element& e = scaled_->elements[k];
    const Matrix3d slope = cones_[k].soft * cones_[k].turn;
    const Rows left = e.on_body * slope;
    add(e.body, e.body, left * e.on_body.transpose());
    if (e.other == ground) continue;
    const Rows right = e.on_other * slope;
    add(e.other, e.other, right * e.on_other.transpose());
    add(e.body, e.other, left * e.on_other.transpose());
    add(e.other, e.body, right * e.on_body.transpose());
  }
  if (!dense_) return sparse_->factorise();
  lu_.compute(whole);
  return true;
}

void Interior::back_substitute(VectorXd& x) const {
  if (dense_) {
    x = lu_.solve(x).eval();
  } else {
    sparse_->solve(x);
  }
}

double Interior::solve(std::vector<Vector3d>& x, const Options& options) {
  const std::vector<Vector3d> centre = x;
  const std::size_t count = x.size();
  cones_.assign(count, {});
  VectorXd v = VectorXd::Zero(row(static_cast<std::uint32_t>(scaled_->bodies)));
  // Where a force may start: inside, and not nearer to the skin than 1.
  for (std::size_t k = 0; k < count; ++k) {
    const Scaled::Element& e = scaled_->elements[k];
    const double wide = stretch(e);
    const Vector3d at{wide * x[k][0] + e.cohesion, e.mu > 0 ? x[k][1] : 0, e.mu > 0 ? x[k][2] : 0};
    Cone& cone = cones_[k];
    cone.force = at;
    cone.force[0] = std::max(at[0], at.tail<2>().norm()) + options.start;
    cone.speed = {1, 0, 0};
    x[k] = cone.force;
    x[k][0] = (x[k][0] - e.cohesion) / wide;
  }
  for (std::size_t k = 0; k < count; ++k) scaled_->add(scaled_->elements[k], x[k], v);
  const auto measure = [&] {
    double sum = 0;
    for (const Cone& c : cones_) sum += c.force.dot(c.speed);
    return sum / static_cast<double>(count);
  };
  double left = measure();
  std::vector<Vector3d> best = x;
  double least = std::numeric_limits<double>::infinity();
  int stuck = 0;
  for (std::size_t round = 0; round < options.most; ++round) {
    const bool inside =
        std::ranges::all_of(cones_, [](const Cone& c) { return square(c.force) > 0 && square(c.speed) > 0; });
    if (!inside) break;
    const double blunt = 0.1 * std::min(1.0, left);
    double off = 0;
    VectorXd off_v = v;
    for (std::size_t k = 0; k < count; ++k) {
      const Scaled::Element& e = scaled_->elements[k];
      Cone& c = cones_[k];
      const double wide = stretch(e);
      // Scaling: P speed = P^-1 force.
      const double f = std::sqrt(square(c.force)), s = std::sqrt(square(c.speed));
      const Vector3d fn = c.force / f, sn = c.speed / s;
      const double gamma = std::sqrt(0.5 * (1 + fn.dot(sn)));
      Vector3d w = sn;
      w.tail<2>() *= -1;
      w = ((fn + w) / (2 * gamma)).eval();
      const double by = std::sqrt(f / s);
      c.scaling << w[0], w[1], w[2], w[1], 1 + w[1] * w[1] / (1 + w[0]), w[1] * w[2] / (1 + w[0]), w[2],
          w[1] * w[2] / (1 + w[0]), 1 + w[2] * w[2] / (1 + w[0]);
      c.back = c.scaling;
      c.back.row(0).tail<2>() *= -1;
      c.back.col(0).tail<2>() *= -1;
      c.scaling *= by;
      c.back /= by;
      c.middle = c.scaling * c.speed;
      // Velocities, opened by the slip.
      Vector3d u = scaled_->relative(e, v);
      c.turn.setIdentity();
      if (e.mu > 0) {
        const double slip = std::sqrt(u.tail<2>().squaredNorm() + blunt * blunt);
        if (options.coupled) c.turn.row(0).tail<2>() = e.mu / slip * u.tail<2>().transpose();
        u[0] += e.mu * slip;
      } else {
        u.tail<2>().setZero();
      }
      const Vector3d d{1 / wide, e.mu > 0 ? 1.0 : 0.0, e.mu > 0 ? 1.0 : 0.0};
      c.off = d.cwiseProduct(u + options.weight * (x[k] - centre[k])) - c.speed;
      if (!(e.mu > 0)) c.off.tail<2>() = -c.speed.tail<2>();
      off = std::max(off, c.off.lpNorm<Eigen::Infinity>());
      Matrix3d stiff = c.back * c.back;
      stiff.diagonal() += options.weight * d.cwiseProduct(d);
      const Matrix3d soft = stiff.inverse();
      c.soft = d.asDiagonal() * soft * d.asDiagonal();
      scaled_->add(e, -x[k], off_v);
    }
    off = std::max(off, off_v.lpNorm<Eigen::Infinity>());
    const double now = std::max(left, off);
    if (now < least) {
      stuck = now < 0.8 * least ? 0 : stuck + 1;
      least = now;
      best = x;
    } else {
      ++stuck;
    }
    if ((left < options.goal && off < 1e-12) || stuck > 12) break;
    if (!factor(!options.coupled)) break;
    VectorXd dv;
    const auto directions = [&](double target, bool corrected) {
      VectorXd rhs = -off_v;
      std::vector<Vector3d> own(count);
      for (std::size_t k = 0; k < count; ++k) {
        const Scaled::Element& e = scaled_->elements[k];
        Cone& c = cones_[k];
        const double wide = stretch(e);
        const Vector3d d{1 / wide, e.mu > 0 ? 1.0 : 0.0, e.mu > 0 ? 1.0 : 0.0};
        Vector3d want = -product(c.middle, c.middle);
        want[0] += target;
        if (corrected) want -= product((c.back * c.d_force).eval(), (c.scaling * c.d_speed).eval());
        Matrix3d stiff = c.back * c.back;
        stiff.diagonal() += options.weight * d.cwiseProduct(d);
        own[k] = stiff.inverse() * (c.back * quotient(want, c.middle) - c.off);
        scaled_->add(e, d.cwiseProduct(own[k]), rhs);
      }
      dv = rhs;
      back_substitute(dv);
      for (std::size_t k = 0; k < count; ++k) {
        const Scaled::Element& e = scaled_->elements[k];
        Cone& c = cones_[k];
        const double wide = stretch(e);
        const Vector3d d{1 / wide, e.mu > 0 ? 1.0 : 0.0, e.mu > 0 ? 1.0 : 0.0};
        Vector3d du = e.on_body.transpose() * dv.segment<6>(row(e.body));
        if (e.other != ground) du += e.on_other.transpose() * dv.segment<6>(row(e.other));
        du = (c.turn * du).eval();
        Matrix3d stiff = c.back * c.back;
        stiff.diagonal() += options.weight * d.cwiseProduct(d);
        c.d_force = own[k] - stiff.inverse() * d.cwiseProduct(du);
        c.d_speed = d.cwiseProduct(du) + options.weight * d.cwiseProduct(d).cwiseProduct(c.d_force) + c.off;
      }
      double share = 1;
      for (const Cone& c : cones_) share = std::min({share, room(c.force, c.d_force), room(c.speed, c.d_speed)});
      return share;
    };
    const double reach = directions(0, false);
    double after = 0;
    for (const Cone& c : cones_) after += (c.force + reach * c.d_force).dot(c.speed + reach * c.d_speed);
    after /= static_cast<double>(count);
    const double centring = std::clamp(std::pow(std::max(0.0, after / left), 3), 1e-6, 1.0);
    double share = directions(std::max(centring * left, 0.1 * options.goal), true);
    share = std::min(1.0, std::max(0.9, 1 - left) * share);
    if (share < 0.1) {
      // Back to the middle of the path.
      share = std::min(1.0, 0.9 * directions(0.9 * left, false));
    }
    if (!dv.allFinite()) break;
    v += share * dv;
    for (std::size_t k = 0; k < count; ++k) {
      const Scaled::Element& e = scaled_->elements[k];
      Cone& c = cones_[k];
      c.force += share * c.d_force;
      c.speed += share * c.d_speed;
      x[k] = c.force;
      x[k][0] = (c.force[0] - e.cohesion) / stretch(e);
    }
    left = measure();
    if (!(left > 0) || !std::isfinite(left)) break;
  }
  x = best;
  for (std::size_t k = 0; k < count; ++k) {
    if (!(scaled_->elements[k].mu > 0)) x[k].tail<2>().setZero();
  }
  return least;
}

}  // namespace cleave::motion
