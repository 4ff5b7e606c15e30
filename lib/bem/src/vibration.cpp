#include <fmt/format.h>

#include <cmath>

#include "block_build.hpp"
#include "cleave/bem/motion.hpp"
#include "cleave/core/assert.hpp"
#include "cleave/core/overloaded.hpp"

namespace cleave::bem {

std::string describe(const MotionError& error) {
  return std::visit(
      overloaded{
          [](const BadStep& e) { return fmt::format("the time step is {} s; it must be above 0", e.step_s); },
          [](const NotConverged& e) {
            return fmt::format("the step at {:.6g} s did not converge (residual {:.1e}); use a shorter time step",
                               e.time_s, e.residual);
          },
          [](const RebuildFailed& e) {
            return fmt::format("the body is too deformed at {:.6g} s to be rebuilt: {}", e.time_s, describe(e.why));
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
  project();
  u_.assign(modes_.eigenvalues.size(), 0.0);
  v_ = before_ = before2_ = a_ = u_;
  before_build_.assign(block.freedoms(), 0.0);
  internal_ = u_;
  for (std::size_t k = 0; k < u_.size(); ++k) a_[k] = force_at(k, 0);
}

void Vibration::rebuild_by(Rebuilding rule, std::vector<HeldFreedom> held, std::vector<NodeSpring> springs) {
  rule_ = std::move(rule);
  held_ = std::move(held);
  springs_ = std::move(springs);
  steep_ = steepest_of(*block_, modes_);
}

void Vibration::project() {
  projected_.clear();
  for (const TimedLoad& load : loads_) {
    std::vector<double> p(modes_.eigenvalues.size(), 0.0);
    for (std::size_t k = 0; k < p.size(); ++k) {
      for (std::size_t i = 0; i < load.forces.size(); ++i) p[k] += modes_.shapes(i, k) * load.forces[i];
    }
    projected_.push_back(std::move(p));
  }
}

double Vibration::force_at(std::size_t mode, double time) const {
  double f = -internal_[mode];
  for (std::size_t l = 0; l < loads_.size(); ++l) f += projected_[l][mode] * loads_[l].factor(time);
  return f;
}

double Vibration::drag_of(std::size_t mode) const {
  const double l = modes_.eigenvalues[mode];
  return damping_.alpha + damping_.beta * l + 2 * damping_.share * std::sqrt(l);
}

std::expected<void, MotionError> Vibration::rebuild() {
  const std::size_t n = block_->freedoms();
  const auto u = expanded(modes_, u_, n);
  const auto w = expanded(modes_, v_, n);
  for (InnerPoint& p : inner_) p.at += inner_state(*block_, p, u).displacement;
  if (!carried_) carried_.emplace(*block_);
  auto next = carried_->advance(*block_, u, rule_->build);
  if (!next) return std::unexpected(RebuildFailed{time(), next.error()});
  own_ = std::make_unique<BlockOperator>(*std::move(next));
  block_ = own_.get();
  for (std::size_t i = 0; i < n; ++i) before_build_[i] += u[i];
  modes_ = supported_modes(*block_, held_, springs_);
  for (TimedLoad& load : loads_) {
    if (load.again) load.forces = load.again(*block_);
  }
  project();
  steep_ = steepest_of(*block_, modes_);
  const auto size = static_cast<Eigen::Index>(n);
  Eigen::VectorXd forces =
      view(block_->stiffness()) * Eigen::Map<const Eigen::VectorXd>{carried_->strained().data(), size};
  for (const NodeSpring& s : springs_) {
    const auto i = static_cast<Eigen::Index>(2 * s.node);
    const double pull = s.stiffness * dot(s.direction, {before_build_[2 * s.node], before_build_[2 * s.node + 1]});
    forces(i) += pull * s.direction.x;
    forces(i + 1) += pull * s.direction.y;
  }
  const Eigen::VectorXd f = view(modes_.shapes).transpose() * forces;
  internal_.assign(f.begin(), f.end());
  u_.assign(internal_.size(), 0.0);
  before_ = before2_ = a_ = u_;
  set_velocity(w);
  for (std::size_t k = 0; k < u_.size(); ++k) a_[k] = force_at(k, time()) - drag_of(k) * v_[k];
  ++rebuilds_;
  since_build_ = 0;
  return {};
}

void Vibration::set_velocity(const std::vector<double>& freedoms) {
  const Eigen::Map<const Eigen::VectorXd> w{freedoms.data(), static_cast<Eigen::Index>(freedoms.size())};
  const Eigen::VectorXd p = view(modes_.shapes).transpose() * (view(block_->mass_matrix()) * w);
  v_.assign(p.begin(), p.end());
}

std::expected<void, MotionError> Vibration::advance() {
  const double h = step_;
  const double now = time();
  std::vector<double> factor0(loads_.size()), factor1(loads_.size());
  for (std::size_t l = 0; l < loads_.size(); ++l) {
    factor0[l] = loads_[l].factor(now);
    factor1[l] = loads_[l].factor(now + h);
  }
  // Houbolt needs three states: two steps of average acceleration first.
  const bool houbolt = std::holds_alternative<Houbolt>(scheme_) && since_build_ >= 2;
  const bool euler = std::holds_alternative<BackwardEuler>(scheme_);
  const AlphaNumbers n = numbers_of(scheme_);
  for (std::size_t k = 0; k < u_.size(); ++k) {
    const double l = modes_.eigenvalues[k];
    const double c = drag_of(k);
    double f0 = -internal_[k], f1 = f0;
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
  ++since_build_;
  if (steep_.empty()) return {};
  double bound = 0;
  for (std::size_t k = 0; k < u_.size(); ++k) bound += std::abs(u_[k]) * steep_[k];
  if (bound <= std::max(seen_, 0.5 * rule_->gradient)) return {};
  const double steep = steepest(*block_, expanded(modes_, u_, block_->freedoms()));
  seen_ = std::max(seen_, steep);
  return steep > rule_->gradient ? rebuild() : std::expected<void, MotionError>{};
}

std::vector<double> Vibration::displacement() const {
  auto out = expanded(modes_, u_, block_->freedoms());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] += before_build_[i];
  return out;
}
std::vector<double> Vibration::strained() const {
  auto out = expanded(modes_, u_, block_->freedoms());
  for (std::size_t i = 0; carried_ && i < out.size(); ++i) out[i] += carried_->strained()[i];
  return out;
}
std::vector<double> Vibration::velocity() const { return expanded(modes_, v_, block_->freedoms()); }

Vec2 Vibration::displacement_at(BoundaryPlace place) const {
  const auto n = shape(block_->mesh().order, place.s);
  Vec2 out;
  for (std::size_t a = 0; a < block_->mesh().per_element(); ++a) {
    const std::size_t i = block_->mesh().elements[place.element].node[a];
    Vec2 u{before_build_[2 * i], before_build_[2 * i + 1]};
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
  for (std::size_t k = 0; k < u_.size(); ++k) {
    e += 0.5 * modes_.eigenvalues[k] * u_[k] * u_[k] + internal_[k] * u_[k];
  }
  if (!carried_) return e;
  // Springs under the displacement up to the last build are part of it.
  for (const NodeSpring& s : springs_) {
    const double d = dot(s.direction, {before_build_[2 * s.node], before_build_[2 * s.node + 1]});
    e += 0.5 * s.stiffness * d * d;
  }
  return e + energy_of(*block_, carried_->strained());
}

std::size_t Vibration::follow(Vec2 inside) {
  CLEAVE_ASSERT(rebuilds_ == 0);
  inner_.push_back({inside, inside});
  return inner_.size() - 1;
}

InnerState Vibration::inner(std::size_t point) const {
  const InnerPoint& p = inner_[point];
  InnerState out = inner_state(*block_, p, expanded(modes_, u_, block_->freedoms()));
  if (rebuilds_ > 0) {
    out.displacement += p.at - p.reference;
    out.stress = inner_state(*block_, p, strained()).stress;
  }
  return out;
}

}  // namespace cleave::bem
