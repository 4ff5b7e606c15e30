#include "cleave/assembly/groups.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "branch.hpp"
#include "elements.hpp"
#include "newton.hpp"
#include "settle.hpp"

namespace cleave::assembly {
namespace {

using Eigen::VectorXd;
using geometry::Vec3;

constexpr double infinite = std::numeric_limits<double>::infinity();
/// Factors beyond are reported as infinity and 0.
constexpr double largest_factor = 1e4, least_factor = 1e-4;
/// Larger assemblies take larger steps, and end sooner: to 1e-4.
constexpr std::size_t few_for_factors = 16;
/// A body belongs to a motion when it has this share of its largest rate.
constexpr double belongs = 1e-6;

std::vector<double> speeds(const Elements& elements, const VectorXd& v) {
  std::vector<double> out(elements.bodies());
  for (std::size_t b = 0; b < out.size(); ++b) {
    out[b] = v.segment(elements.width() * static_cast<Eigen::Index>(b), elements.width()).norm();
  }
  return out;
}

Problem static_problem(double factor) {
  if (factor == infinite) return {.law = Law::frictionless};
  return {.law = Law::cone, .divisor = factor};
}

/// Speed of the projection, 0 when forces hold the loads.
class Drive final {
 public:
  explicit Drive(const Elements& elements) : newton_{elements}, state_{newton_.none()} {}
  double operator()(double factor) {
    State state = state_;
    const Settled how = newton_.solve(static_problem(factor), state, 1e-2);
    settled_ = settled_ && how.off < 1e-8;
    const double speed = state.v.lpNorm<Eigen::Infinity>();
    state_ = std::move(state);
    return speed > 1e-10 ? speed : 0;
  }
  [[nodiscard]] bool settled() const noexcept { return settled_; }

 private:
  Newton newton_;
  State state_;
  bool settled_ = true;
};

}  // namespace

Projection project(const Assembly& assembly, double factor) {
  const Elements elements{assembly};
  Newton newton{elements};
  State state = newton.none();
  const Settled how = newton.solve(static_problem(factor), state);
  Projection out{.motion = elements.motion_of(state.v), .speed = speeds(elements, state.v)};
  for (const double s : out.speed) out.largest = std::max(out.largest, s);
  out.settled = how.off < 1e-8 && how.violation < 1e-8;
  return out;
}

namespace {

/// Forces of a state, N.
ContactForces in_newtons(const Assembly& assembly, const Elements& elements, const std::vector<Eigen::Vector3d>& x) {
  ContactForces out;
  out.at_points.resize(assembly.contacts().size());
  out.at_bonds.resize(assembly.contacts().size());
  for (std::size_t c = 0; c < assembly.contacts().size(); ++c) {
    const Contact& contact = assembly.contacts()[c];
    const auto [t1, t2] = tangents(contact.normal);
    out.at_points[c].resize(contact.points.size());
    out.at_bonds[c].resize(contact.bonds.size());
    const auto [first, last] = elements.of_contact(c);
    std::size_t point = 0, bond = 0;
    for (std::size_t k = first; k < last; ++k) {
      const Element& e = elements.all()[k];
      const double unit = elements.newtons(e);
      const Vec3 force = unit * (x[k][0] * contact.normal + x[k][1] * t1 + x[k][2] * t2);
      if (!e.bond) {
        out.at_points[c][point++] = force;
        continue;
      }
      while (!(contact.bonds[bond].cohesion > 0) && !(contact.bonds[bond].tension > 0)) ++bond;
      out.at_bonds[c][bond++] = force;
    }
  }
  return out;
}

}  // namespace

ContactForces holding_forces(const Assembly& assembly, double factor, double prestress) {
  const Elements elements{assembly};
  Newton newton{elements};
  State state = newton.none();
  Problem problem = static_problem(factor);
  problem.least_normal = prestress;
  (void)newton.solve(problem, state);
  return in_newtons(assembly, elements, state.x);
}

StaticFactor static_factor(const Assembly& assembly) { return static_factor(assembly, Accuracy::fine); }

StaticFactor static_factor(const Assembly& assembly, Accuracy accuracy) {
  const Elements elements{assembly};
  Drive drive{elements};
  if (drive(largest_factor) == 0) return {infinite, infinite, drive.settled()};
  if (drive(least_factor) > 0) return {0, 0, drive.settled()};
  double low = least_factor, high = largest_factor;
  double before = 0, speed_before = 0, speed = drive(high);
  const auto look = [&](double f) {
    const double found = drive(f);
    if (found == 0) {
      low = f;
      return;
    }
    before = std::exchange(high, f);
    speed_before = std::exchange(speed, found);
  };
  const double enough = accuracy == Accuracy::coarse ? 1e-4 : 1e-9;
  for (int k = 0; k < 200 && high > low * (1 + enough); ++k) {
    look(std::sqrt(low * high));
    // The speed grows in proportion above the factor.
    if (!(before > high) || !(speed_before > speed) || high > 3 * low) continue;
    const double guess = high - speed * (before - high) / (speed_before - speed);
    for (const double f : {guess * (1 - 2e-10), guess * (1 + 2e-10), guess + 0.01 * (high - guess)}) {
      if (f > low && f < high) look(f);
    }
  }
  return {high, low, drive.settled()};
}

Start start_from_rest(const Assembly& assembly, double factor) {
  Ended ended;
  Start out = start_from_rest(assembly, factor, ended);
  out.forces = std::move(ended.forces);
  return out;
}

namespace {

/// Strength is over this where few bodies are looked at first: what rests there at once rests at more strength.
constexpr double well_below = 2;

/// Follows the motion of few bodies from no friction on; empty where nothing moves without. Ends where it comes to
/// rest: the forces that hold it hold it at more strength too.
std::optional<Branch::Found> followed(const Elements& elements, double factor) {
  Branch branch{elements};
  branch.allow(6'000);
  if (!branch.begin()) return std::nullopt;
  const bool fully = elements.bodies() <= followed_bodies;
  if (fully) {
    Branch::Found found = branch.at(well_below * factor, Branch::Effort::thresholds);
    if (found.what == FromRest::rests) return found;
  }
  for (double f = 30 * factor;; f = std::max(factor, 0.8 * f)) {
    Branch::Found found = branch.at(f, fully ? Branch::Effort::thresholds : Branch::Effort::newton);
    if (found.what == FromRest::moves) branch.keep(found);
    if (f <= factor || (fully && found.what == FromRest::rests)) return found;
  }
}

Start started(const Assembly& assembly, const Elements& elements, Branch::Found found, Ended& ended) {
  Start out{.found = found.what, .motion = elements.motion_of(found.state.v), .speed = speeds(elements, found.state.v)};
  out.residual = found.residual;
  ended.unsettled = found.what == FromRest::unsettled ? std::move(found.unsettled) : std::vector<std::uint8_t>{};
  ended.forces = in_newtons(assembly, elements, found.state.x);
  return out;
}

}  // namespace

Start start_from_rest(const Assembly& assembly, double factor, Ended& ended) {
  const Elements elements{assembly};
  // Contact by contact; where that finds no motion, few bodies are followed from no friction on as well, and looked at
  // by interior points, which find motion that no path leads to.
  Branch branch{elements};
  Branch::Found found = branch.at(factor, Branch::Effort::sweeps);
  if (found.what != FromRest::moves && elements.bodies() <= few_bodies) {
    auto other = followed(elements, factor);
    if (other && other->what != FromRest::moves) other = branch.by_inner_points(factor);
    if (other && other->what == FromRest::moves) found = std::move(*other);
  }
  return started(assembly, elements, std::move(found), ended);
}

Start start_by_sweeps(const Assembly& assembly, double factor, unsigned order, Ended& ended) {
  const Elements elements{assembly};
  return started(assembly, elements, Branch::of(settle(elements, factor, order)), ended);
}

Twice start_from_weaker(const Assembly& weaker, double factor, const Assembly& assembly) {
  const Elements weak{weaker}, whole{assembly};
  auto [first, then] = settle(weak, factor, whole, 1);
  Twice out;
  out.weaker = started(weaker, weak, Branch::of(std::move(first)), out.weaker_ended);
  out.start = started(assembly, whole, Branch::of(std::move(then)), out.ended);
  return out;
}

MovingFactor moving_factor(const Assembly& assembly, double up) { return moving_factor(assembly, up, Accuracy::fine); }

MovingFactor moving_factor(const Assembly& assembly, double up, Accuracy accuracy) {
  const Elements elements{assembly};
  Branch branch{elements};
  if (!branch.begin()) return {infinite, true};
  const bool coarse = accuracy == Accuracy::coarse;
  if (accuracy == Accuracy::quick) branch.allow(quick_search);
  // Above `up` it moves whether a solution was checked or not.
  double good = infinite, bad = 0;
  bool settled = true;
  const auto look = [&](double f) {
    // What is known to move needs no search: only a start for those that are not.
    const Branch::Effort effort = coarse ? Branch::Effort::sweeps : Branch::Effort::whole;
    const Branch::Found found = branch.at(f, f > 1.1 * up ? Branch::Effort::newton : effort);
    if (found.what == FromRest::moves) branch.keep(found);
    if (found.what == FromRest::moves || f > up * (1 + 1e-9)) {
      good = f;
      return true;
    }
    bad = f;
    settled = found.what == FromRest::rests;
    return false;
  };
  // So do assemblies that are known to move, which begin there.
  const bool large = coarse || elements.bodies() > few_for_factors;
  const double begin = large ? 32 : 1e3;
  for (double f = coarse ? 1 : begin; f > (large ? 1e-2 : least_factor) && look(f); f *= large ? 0.7 : 0.9) {
  }
  if (bad == 0) return {0, true};
  if (good == infinite) return {std::min(up, bad), false};
  while (good > bad * (1 + (large ? 1e-4 : 5e-8))) (void)look(std::sqrt(good * bad));
  return {std::min(good, up), settled};
}

std::vector<std::uint8_t> moving_ones(const std::vector<double>& speed) {
  double most = 0;
  for (const double s : speed) most = std::max(most, s);
  std::vector<std::uint8_t> out(speed.size(), 0);
  for (std::size_t b = 0; b < speed.size(); ++b) out[b] = most > slow && speed[b] > belongs * most ? 1 : 0;
  return out;
}

double factor_of(const std::vector<std::uint8_t>& these, const Assembly& assembly, FactorRange range,
                 Accuracy accuracy) {
  const Elements elements{assembly};
  Branch branch{elements};
  if (!branch.begin()) return infinite;
  if (accuracy == Accuracy::quick) branch.allow(quick_search);
  const Branch::Effort effort = accuracy == Accuracy::coarse ? Branch::Effort::sweeps : Branch::Effort::whole;
  const auto moves = [&](double f) {
    const Branch::Found found = branch.at(f, effort);
    if (found.what != FromRest::moves) return false;
    const std::vector<std::uint8_t> moving = moving_ones(speeds(elements, found.state.v));
    branch.keep(found);
    for (std::size_t b = 0; b < moving.size(); ++b) {
      if (these[b] != 0 && moving[b] != 0) return true;
    }
    return false;
  };
  if (range.least > 0 && moves((1 + range.fine) * range.least)) return range.least;
  double good = infinite, bad = range.begin;
  while (bad > least_factor && moves(bad)) {
    good = bad;
    bad *= 0.8;
  }
  if (!(bad > least_factor)) return 0;
  while (good < infinite && good > (1 + range.fine) * bad) {
    const double f = std::sqrt(good * bad);
    (moves(f) ? good : bad) = f;
  }
  return good;
}

}  // namespace cleave::assembly
