#include "settle.hpp"

#include <algorithm>
#include <utility>

#include "alternating.hpp"
#include "branch.hpp"
#include "parts.hpp"
#include "sweeps.hpp"

namespace cleave::assembly {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// Bodies that move and hang together, the others fixed.
struct Part {
  std::vector<std::uint32_t> members;
  Eigen::VectorXd v;
  double residual = 0;
  bool solved = false;
};

/// Violation that a solution of more than a few bodies may have.
constexpr double enough_of_many = 1e-4;
constexpr int sweeps_a_round = 100, sweeps_a_step = 40;
/// Times that parts may come no nearer to a solution.
constexpr int most_idle = 2;
/// Bodies of a part that Newton's method is tried on.
constexpr std::size_t most_of_newton = 200;

/// Largest rate that forces leave.
double lack(const Elements& elements, const State& state) {
  Eigen::VectorXd left = elements.load();
  for (std::size_t k = 0; k < state.x.size(); ++k) elements.add_force(elements.all()[k], state.x[k], left);
  return left.lpNorm<Eigen::Infinity>();
}

double enough_of(const Elements& part) { return part.bodies() > few_bodies ? enough_of_many : exact_enough; }

/// Whether a solution at rest may follow a state: what moves must not come to rest in forces that no sweep would have
/// led to.
bool may_rest(const Elements& part, const State& before, const State& found) {
  return before.v.lpNorm<Eigen::Infinity>() <= creeps && lack(part, found) <= slow;
}

/// Newton's method on one part from the forces that sweeps found: true when it solved it.
bool by_newton(const Elements& part, double divisor, State& state) {
  double before = violation(part, divisor, state);
  const State start = state;
  for (const double rough : {1e-2, 1e-3}) {
    Newton newton{part};
    State next = state;
    Problem problem{.law = Law::coulomb, .divisor = divisor};
    const bool bonds = has_bonds(part);
    for (int round = 0; round < (bonds ? 3 : 1); ++round) {
      if (bonds) problem.pressing = pressing(part, next);
      (void)newton.solve(problem, next, rough);
    }
    if (next.v.lpNorm<Eigen::Infinity>() <= slow) {
      if (!may_rest(part, start, next)) continue;
      state = std::move(next);
      return true;
    }
    const double after = violation(part, divisor, next);
    if (!(after < before)) continue;
    before = after;
    state = std::move(next);
    if (before <= enough_of(part)) return true;
  }
  return false;
}

/// Alternating directions on one part, likewise.
bool by_alternation(const Elements& part, double divisor, State& state) {
  State next = state;
  const bool solved = alternate(part, divisor, enough_of(part), next);
  if (next.v.lpNorm<Eigen::Infinity>() <= slow && !may_rest(part, state, next)) return false;
  state = std::move(next);
  return solved;
}

/// One part from the forces that sweeps found: true when a solution was found, and what comes nearer in any case.
bool polish(const Elements& part, double divisor, State& state) {
  if (violation(part, divisor, state) <= enough_of(part)) return true;
  if (part.bodies() <= most_of_newton && by_newton(part, divisor, state)) return true;
  return part.bodies() > few_bodies && by_alternation(part, divisor, state);
}

/// The search of `settle`, at one strength after another.
class Settling final {
 public:
  Settling(const Elements& elements, double divisor, unsigned order)
      : elements_{&elements},
        divisor_{divisor},
        few_{elements.bodies() <= few_bodies},
        still_{few_ ? at_rest_of_few : at_rest},
        sweeps_{elements, divisor, 0.1 * still_, order},
        width_{elements.width()} {
    // Friction grows on what moves, so that it acts against the motion: from free fall it would lock across it.
    grow_from(1e3 * divisor);
  }

  /// Goes on at a larger strength, and with other bonds.
  void go_on(const Elements& elements, double divisor) {
    elements_ = &elements;
    sweeps_.bonds_of(elements);
    const double before = std::exchange(divisor_, divisor);
    grow_from(0.85 * before);
  }

  Solution run() {
    const int rounds = few_ ? 16 : 48;
    solved_all_ = false;
    next_ = idle_ = 0;
    worst_ = 0;
    asked_.clear();  // what was solved at another strength says nothing here
    std::vector<std::uint8_t> before;
    for (int round = 0; round < rounds; ++round) {
      sweeps_.run(sweeps_a_round);
      // Rates anew from the forces: no rounding piles up.
      sweeps_.take(std::vector<Vector3d>{sweeps_.state().x});
      std::vector<std::uint8_t> moving = sweeps_.moving(still_);
      const bool last = round + 1 == rounds;
      if (std::ranges::none_of(moving, [](std::uint8_t m) { return m != 0; })) return rests();
      // What moves is what was solved: else some of it has come to rest since.
      if (solved_all_ && moving == asked_) return moves();
      if (last || (round >= next_ && alike(moving, before))) {
        if (!solve_parts(moving)) return moves();
        // What Newton's method cannot solve is left to sweeps for longer and longer.
        next_ = solved_all_ ? round + 1 : round + 2 + round / 4;
      }
      before = std::move(moving);
    }
    return moves();
  }

 private:
  /// Strengths over so much, then over less and less.
  void grow_from(double most) {
    for (double over = most; over > 1.01 * divisor_;
         over = std::max(divisor_, (over > 4 * divisor_ ? 0.25 : 0.85) * over)) {
      sweeps_.strength_over(over);
      sweeps_.run(sweeps_a_step);
    }
    sweeps_.strength_over(divisor_);
  }
  /// Whether few bodies have come or gone.
  [[nodiscard]] static bool alike(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
    if (a.size() != b.size()) return false;
    std::size_t count = 0, different = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
      count += a[k];
      different += a[k] != b[k] ? 1U : 0U;
    }
    return 5 * different <= count;
  }

  /// False when sweeps have brought the same parts no nearer to a solution time and again.
  bool solve_parts(const std::vector<std::uint8_t>& moving) {
    std::vector<Vector3d> forces = sweeps_.state().x;
    parts_.clear();
    const bool same = alike(std::exchange(asked_, moving), moving);
    double worst = 0;
    solved_all_ = true;
    for (std::vector<std::uint32_t>& members : linked_parts(elements_->all(), moving)) {
      Part& found = parts_.emplace_back();
      found.members = std::move(members);
      found.solved = solve(found, forces);
      solved_all_ = solved_all_ && found.solved;
      if (!found.solved) worst = std::max(worst, found.residual);
    }
    sweeps_.take(forces);
    const double before = std::exchange(worst_, worst);
    idle_ = same && worst > 0.5 * before ? idle_ + 1 : 0;
    return solved_all_ || idle_ < most_idle;
  }

  bool solve(Part& found, std::vector<Vector3d>& forces) {
    std::vector<std::uint32_t> from;
    const Elements part = elements_->part(found.members, from);
    State state{Eigen::VectorXd(part.load().size()), {}};
    for (std::size_t k = 0; k < found.members.size(); ++k) {
      state.v.segment(width_ * static_cast<Index>(k), width_) =
          sweeps_.state().v.segment(width_ * static_cast<Index>(found.members[k]), width_);
    }
    for (const std::uint32_t k : from) state.x.push_back(forces[k]);
    const bool solved = polish(part, divisor_, state);
    for (std::size_t k = 0; k < from.size(); ++k) forces[from[k]] = state.x[k];
    found.v = std::move(state.v);
    found.residual = violation(part, divisor_, {found.v, std::move(state.x)});
    return solved;
  }

  Solution rests() {
    Solution out{.state = sweeps_.state()};
    out.residual = out.state.v.lpNorm<Eigen::Infinity>();
    out.unsettled.assign(elements_->bodies(), 0);
    out.state.v.setZero();
    return out;
  }

  /// What moves in parts that were solved, and what could not be.
  Solution moves() {
    Solution out{.state = sweeps_.state()};
    out.unsettled.assign(elements_->bodies(), 0);
    out.state.v.setZero();
    for (const Part& part : parts_) {
      for (std::size_t k = 0; k < part.members.size(); ++k) {
        if (!part.solved) {
          out.unsettled[part.members[k]] = 1;
        } else {
          out.state.v.segment(width_ * static_cast<Index>(part.members[k]), width_) =
              part.v.segment(width_ * static_cast<Index>(k), width_);
        }
      }
      if (part.solved) out.residual = std::max(out.residual, part.residual);
      out.settled = out.settled && part.solved;
    }
    return out;
  }

  const Elements* elements_;
  double divisor_;
  bool few_;
  double still_;
  Sweeps sweeps_;
  Index width_;
  std::vector<Part> parts_;
  std::vector<std::uint8_t> asked_;  ///< what moved when parts were solved
  bool solved_all_ = false;
  double worst_ = 0;  ///< residual of parts that were not solved
  int idle_ = 0;      ///< so often it did not fall
  int next_ = 0;      ///< round in which parts are solved again
};

}  // namespace

Solution settle(const Elements& elements, double divisor, unsigned order) {
  return Settling{elements, divisor, order}.run();
}

std::pair<Solution, Solution> settle(const Elements& weaker, double weaker_divisor, const Elements& elements,
                                     double divisor) {
  Settling settling{weaker, weaker_divisor, 0};
  Solution first = settling.run();
  settling.go_on(elements, divisor);
  return {std::move(first), settling.run()};
}

}  // namespace cleave::assembly
