#include <fmt/format.h>

#include <cmath>

#include "block_build.hpp"
#include "cleave/bem/motion.hpp"
#include "cleave/core/assert.hpp"
#include "cleave/core/overloaded.hpp"

namespace cleave::bem {

std::string describe(const MotionError& error) {
  return std::visit(
      overloaded{[](const BadStep& e) { return fmt::format("the time step is {} s; it must be above 0", e.step_s); },
                 [](const NotConverged& e) {
                   return fmt::format(
                       "the step at {:.6g} s did not converge (residual {:.1e}); use a shorter time step", e.time_s,
                       e.residual);
                 }},
      error);
}

Vibration::Vibration(const BlockOperator& block, Modes modes, Scheme scheme, double step, Damping damping,
                     std::vector<TimedLoad> loads)
    : block_{&block},
      modes_{std::move(modes)},
      scheme_{scheme},
      step_{step},
      damping_{damping},
      loads_{std::move(loads)} {
  CLEAVE_ASSERT(step > 0);
  const std::size_t n = modes_.eigenvalues.size();
  for (const TimedLoad& load : loads_) {
    std::vector<double> p(n, 0.0);
    for (std::size_t k = 0; k < n; ++k) {
      for (std::size_t i = 0; i < load.forces.size(); ++i) p[k] += modes_.shapes(i, k) * load.forces[i];
    }
    projected_.push_back(std::move(p));
  }
  u_.assign(n, 0.0);
  v_ = before_ = before2_ = u_;
  a_.resize(n);
  for (std::size_t k = 0; k < n; ++k) a_[k] = force_at(k, 0);
}

double Vibration::force_at(std::size_t mode, double time) const {
  double f = 0;
  for (std::size_t l = 0; l < loads_.size(); ++l) f += projected_[l][mode] * loads_[l].factor(time);
  return f;
}

void Vibration::set_velocity(const std::vector<double>& freedoms) {
  const Eigen::Map<const Eigen::VectorXd> w{freedoms.data(), static_cast<Eigen::Index>(freedoms.size())};
  const Eigen::VectorXd p = view(modes_.shapes).transpose() * (view(block_->mass_matrix()) * w);
  v_.assign(p.begin(), p.end());
}

void Vibration::advance() {
  const double h = step_;
  const double now = time();
  std::vector<double> factor0(loads_.size()), factor1(loads_.size());
  for (std::size_t l = 0; l < loads_.size(); ++l) {
    factor0[l] = loads_[l].factor(now);
    factor1[l] = loads_[l].factor(now + h);
  }
  // Houbolt needs three states: two steps of average acceleration first.
  const bool houbolt = std::holds_alternative<Houbolt>(scheme_) && steps_ >= 2;
  const bool euler = std::holds_alternative<BackwardEuler>(scheme_);
  const AlphaNumbers n = numbers_of(scheme_);
  for (std::size_t k = 0; k < u_.size(); ++k) {
    const double l = modes_.eigenvalues[k];
    const double c = damping_.alpha + damping_.beta * l + 2 * damping_.share * std::sqrt(l);
    double f0 = 0, f1 = 0;
    for (std::size_t i = 0; i < loads_.size(); ++i) {
      f0 += projected_[i][k] * factor0[i];
      f1 += projected_[i][k] * factor1[i];
    }
    const double u = u_[k];
    if (houbolt) {
      const double past = (5 * u - 4 * before_[k] + before2_[k]) / (h * h);
      const double drag = c * (18 * u - 9 * before_[k] + 2 * before2_[k]) / (6 * h);
      u_[k] = (f1 + past + drag) / (2 / (h * h) + 11 * c / (6 * h) + l);
      v_[k] = (11 * u_[k] - 18 * u + 9 * before_[k] - 2 * before2_[k]) / (6 * h);
      a_[k] = (2 * u_[k] - 5 * u + 4 * before_[k] - before2_[k]) / (h * h);
    } else if (euler) {
      const double v = (v_[k] + h * (f1 - l * u)) / (1 + h * c + h * h * l);
      a_[k] = (v - v_[k]) / h;
      v_[k] = v;
      u_[k] = u + h * v;
    } else {
      const double up = u + h * v_[k] + h * h * (0.5 - n.beta) * a_[k];
      const double vp = v_[k] + h * (1 - n.gamma) * a_[k];
      const double right = (1 - n.af) * (f1 - l * up - c * vp) + n.af * (f0 - l * u - c * v_[k]) - n.am * a_[k];
      const double a = right / (1 - n.am + (1 - n.af) * (h * n.gamma * c + h * h * n.beta * l));
      u_[k] = up + h * h * n.beta * a;
      v_[k] = vp + h * n.gamma * a;
      a_[k] = a;
    }
    before2_[k] = before_[k];
    before_[k] = u;
  }
  ++steps_;
}

namespace {
std::vector<double> expand(const Modes& modes, const std::vector<double>& q) {
  std::vector<double> out(modes.shapes.rows, 0.0);
  for (std::size_t k = 0; k < q.size(); ++k) {
    for (std::size_t i = 0; i < out.size(); ++i) out[i] += modes.shapes(i, k) * q[k];
  }
  return out;
}
}  // namespace

std::vector<double> Vibration::displacement() const { return expand(modes_, u_); }
std::vector<double> Vibration::velocity() const { return expand(modes_, v_); }

Vec2 Vibration::displacement_at(BoundaryPlace place) const {
  const auto n = shape(block_->mesh().order, place.s);
  Vec2 out;
  for (std::size_t a = 0; a < block_->mesh().per_element(); ++a) {
    const std::size_t i = block_->mesh().elements[place.element].node[a];
    Vec2 u;
    for (std::size_t k = 0; k < u_.size(); ++k) {
      u += u_[k] * Vec2{modes_.shapes(2 * i, k), modes_.shapes(2 * i + 1, k)};
    }
    out += n[a] * u;
  }
  return out;
}

double Vibration::kinetic_energy() const {
  double e = 0;
  for (const double v : v_) e += 0.5 * v * v;
  return e;
}

double Vibration::elastic_energy() const {
  double e = 0;
  for (std::size_t k = 0; k < u_.size(); ++k) e += 0.5 * modes_.eigenvalues[k] * u_[k] * u_[k];
  return e;
}

}  // namespace cleave::bem
