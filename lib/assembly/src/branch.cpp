#include "branch.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "inner_points.hpp"
#include "settle.hpp"

namespace cleave::assembly {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

/// Below this share of the load a force counts as none: rounding would feed wedging.
constexpr double no_force = 1e-9;
/// Of the largest free fall: less than this may be what the balance of forces lacks, not motion.
constexpr double barely = 1e-4;

}  // namespace

std::vector<std::uint8_t> pressing(const Elements& elements, const State& state) {
  const std::vector<Element>& all = elements.all();
  std::vector<std::uint8_t> out(all.size(), 0);
  for (std::size_t first = 0; first < all.size();) {
    std::size_t last = first;
    bool presses = false;
    for (; last < all.size() && all[last].contact == all[first].contact; ++last) {
      presses = presses || (!all[last].bond && state.x[last][0] > no_force);
    }
    for (; first < last; ++first) out[first] = presses ? 1 : 0;
  }
  return out;
}

bool has_bonds(const Elements& elements) {
  return std::ranges::any_of(elements.all(), [](const Element& e) { return e.bond; });
}

double violation(const Elements& elements, double divisor, const State& state) {
  VectorXd left = state.v - elements.load();
  const double speed = std::max(state.v.lpNorm<Eigen::Infinity>(), slow);
  const std::vector<std::uint8_t> presses = pressing(elements, state);
  double most = 0;
  for (std::size_t k = 0; k < elements.all().size(); ++k) {
    const Element& e = elements.all()[k];
    const Vector3d& x = state.x[k];
    elements.add_force(e, -x, left);
    const Vector3d u = elements.relative(e, state.v) / speed;
    const double slip = u.tail<2>().norm(), shear = x.tail<2>().norm();
    const double open = e.bond ? -e.tension / divisor : 0;  // least normal force
    double cap = e.friction / divisor * std::max(0.0, x[0]);
    if (e.bond) {
      cap = presses[k] != 0 ? e.cohesion / divisor : 0;
      most = std::max({most, x[0], std::abs(x[0] * std::max(0.0, -u[0])), std::max(0.0, u[0]) * (x[0] - open)});
    } else {
      most = std::max({most, -u[0], x[0] * std::abs(u[0])});
    }
    most = std::max({most, open - x[0], shear - cap, std::abs(x.tail<2>().dot(u.tail<2>()) + cap * slip)});
  }
  return std::max(most, left.lpNorm<Eigen::Infinity>());
}

std::vector<std::uint8_t> unsettled_bodies(const Elements& elements, double divisor, const State& state) {
  std::vector<std::uint8_t> out(elements.bodies(), 0);
  const double speed = std::max(state.v.lpNorm<Eigen::Infinity>(), slow);
  for (std::size_t b = 0; b < out.size(); ++b) {
    const auto own = state.v.segment(elements.width() * static_cast<Eigen::Index>(b), elements.width());
    if (own.lpNorm<Eigen::Infinity>() > std::max(1e-6 * speed, slow)) out[b] = 1;
  }
  const std::vector<std::uint8_t> presses = pressing(elements, state);
  for (std::size_t k = 0; k < elements.all().size(); ++k) {
    const Element& e = elements.all()[k];
    const Vector3d& x = state.x[k];
    const Vector3d u = elements.relative(e, state.v) / speed;
    const double cohesion = e.bond && presses[k] != 0 ? e.cohesion / divisor : 0;
    const double cap = e.friction / divisor * std::max(0.0, x[0]) + cohesion, shear = x.tail<2>().norm();
    double wrong = std::max(shear - cap, std::abs(x.tail<2>().dot(u.tail<2>()) + cap * u.tail<2>().norm()));
    if (!e.bond) wrong = std::max({wrong, -u[0], x[0] * std::abs(u[0])});
    if (!(wrong > 1e-4)) continue;
    out[e.body] = 1;
    if (e.other) out[*e.other] = 1;
  }
  return out;
}

Branch::Branch(const Elements& elements) : elements_{&elements}, newton_{elements}, start_{newton_.none()} {}

bool Branch::begin() {
  start_ = newton_.none();
  (void)newton_.solve({.law = Law::frictionless}, start_);
  return start_.v.lpNorm<Eigen::Infinity>() > slow;
}

Branch::Found Branch::judged(double divisor, State state) const {
  Found found{.what = FromRest::unsettled, .state = std::move(state), .residual = 1, .unsettled = {}};
  found.residual = violation(*elements_, divisor, found.state);
  if (!(found.residual <= exact_enough)) return found;
  found.what = found.state.v.lpNorm<Eigen::Infinity>() > slow ? FromRest::moves : FromRest::rests;
  return found;
}

Branch::Found Branch::by_newton(double divisor) {
  // From no forces: what locks at one strength must not drive or hold at the next.
  State state = newton_.none();
  state.v = start_.v;
  Problem problem{.law = Law::coulomb, .divisor = divisor};
  const bool bonds = has_bonds(*elements_);
  for (int round = 0; round < (bonds ? 4 : 1); ++round) {
    if (bonds) problem.pressing = pressing(*elements_, state);
    (void)newton_.solve(problem, state, 1e-2);
  }
  return judged(divisor, std::move(state));
}

Branch::Found Branch::by_thresholds(double divisor) {
  State state = start_;
  Problem problem{.law = Law::tresca, .divisor = divisor};
  const std::size_t count = elements_->all().size();
  problem.threshold.assign(count, 0);
  std::vector<double> normal(count);
  for (std::size_t k = 0; k < count; ++k) normal[k] = state.x[k][0];
  double least = 1;
  int worse = 0;
  const auto budget = static_cast<unsigned>(allowed_ / elements_->bodies()) + newton_.factors();
  for (int round = 0; round < 120 && newton_.factors() < budget; ++round) {
    for (std::size_t k = 0; k < count; ++k) {
      const double n = normal[k] > no_force ? normal[k] : 0;
      problem.threshold[k] = elements_->all()[k].friction / divisor * n;
    }
    problem.pressing = pressing(*elements_, state);
    State next = newton_.none();
    next.v = state.v;
    (void)newton_.solve(problem, next, 1e-2);
    double change = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const double n = next.x[k][0];
      change = std::max(change, std::abs(n - normal[k]));
      normal[k] = round < 30 ? n : 0.5 * (normal[k] + n);
    }
    state = std::move(next);
    if (change < 1e-12 || state.v.lpNorm<Eigen::Infinity>() < slow) break;
    worse = change > 0.9 * least ? worse + 1 : 0;
    least = std::min(least, change);
    if (worse > 25) break;
  }
  return judged(divisor, std::move(state));
}

Branch::Found Branch::of(Solution solution) {
  Found found{.what = FromRest::unsettled,
              .state = std::move(solution.state),
              .residual = solution.residual,
              .unsettled = std::move(solution.unsettled)};
  if (!solution.settled) return found;
  found.what = found.state.v.lpNorm<Eigen::Infinity>() > slow ? FromRest::moves : FromRest::rests;
  return found;
}

Branch::Found Branch::by_sweeps(double divisor) { return of(settle(*elements_, divisor)); }

std::optional<Branch::Found> Branch::by_inner_points(double divisor) const {
  const bool bonds = has_bonds(*elements_);
  std::vector<std::uint8_t> pressed(elements_->all().size(), 1);
  for (const bool coupled : {true, false}) {
    for (const double weight : {1e-9, 0.0}) {
      const Near near = assembly::by_inner_points(*elements_, divisor, pressed, {coupled, weight});
      const bool moves = near.state.v.lpNorm<Eigen::Infinity>() > barely;
      if (!moves && near.left < exact_enough) return std::nullopt;  // it rests
      if (!moves || !(near.left < 1e-2)) continue;
      for (const double rough : {1e-3, 1e-5, 1e-7}) {
        Newton newton{*elements_};
        State state = near.state;
        Problem problem{.law = Law::coulomb, .divisor = divisor};
        for (int round = 0; round < (bonds ? 3 : 1); ++round) {
          if (bonds) problem.pressing = pressing(*elements_, state);
          (void)newton.solve(problem, state, rough);
        }
        Found found = judged(divisor, std::move(state));
        if (found.what == FromRest::moves && found.state.v.lpNorm<Eigen::Infinity>() > barely) return found;
      }
      if (bonds) pressed = pressing(*elements_, near.state);
    }
  }
  return std::nullopt;
}

/// Nothing moved: at rest where forces are there that hold.
Branch::Found Branch::standing(double divisor) {
  State state = newton_.none();
  const Settled how = newton_.solve({.law = Law::cone, .divisor = divisor}, state);
  Found found{.what = FromRest::unsettled, .state = std::move(state), .residual = how.off, .unsettled = {}};
  if (found.state.v.lpNorm<Eigen::Infinity>() <= slow) found.what = FromRest::rests;
  return found;
}

Branch::Found Branch::at(double divisor, Effort effort) {
  if (effort == Effort::sweeps) return by_sweeps(divisor);
  Found found = by_newton(divisor);
  if (found.what == FromRest::moves || effort == Effort::newton) return found;
  // Thresholds are exact where they settle, sweeps cheap.
  const bool few = elements_->bodies() <= 4;
  if (!few && effort == Effort::whole) {
    Found swept = by_sweeps(divisor);
    if (swept.what != FromRest::unsettled) return swept;
  }
  found = by_thresholds(divisor);
  if (found.what == FromRest::moves) return found;
  if (effort == Effort::whole && elements_->bodies() <= few_bodies) {
    if (auto near = by_inner_points(divisor)) return *std::move(near);
  }
  if (found.state.v.lpNorm<Eigen::Infinity>() <= slow) return standing(divisor);
  if (few && effort == Effort::whole) {
    Found swept = by_sweeps(divisor);
    if (swept.what != FromRest::unsettled) return swept;
  }
  return found;
}

}  // namespace cleave::assembly
