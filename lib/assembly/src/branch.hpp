#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "cleave/assembly/groups.hpp"
#include "newton.hpp"

namespace cleave::assembly {

struct Solution;

/// Largest violation of the Coulomb problem from rest with strengths over `divisor`: balance, no pull, no overlap, no
/// pressure where it opens, friction within its bound and against the slip. Forces relative to the load, rates to the
/// largest.
[[nodiscard]] double violation(const Elements& elements, double divisor, const State& state);

/// By element: whether the patch of a bond presses.
[[nodiscard]] std::vector<std::uint8_t> pressing(const Elements& elements, const State& state);
[[nodiscard]] bool has_bonds(const Elements& elements);

/// Bodies that move in a state, and those beside a contact that violates the conditions.
[[nodiscard]] std::vector<std::uint8_t> unsettled_bodies(const Elements& elements, double divisor, const State& state);

/// What a search from rest leaves behind beside its verdict.
struct Ended {
  std::vector<std::uint8_t> unsettled;  ///< by body; empty where all is settled
  ContactForces forces;                 ///< of the state it ended in
};
[[nodiscard]] Start start_from_rest(const Assembly& assembly, double factor, Ended& ended);
/// By sweeps alone, in one of the orders of `settle`.
[[nodiscard]] Start start_by_sweeps(const Assembly& assembly, double factor, unsigned order, Ended& ended);
/// From rest with weaker bonds and strengths first, then on from there at those of `assembly`.
struct Twice {
  Start weaker, start;
  Ended weaker_ended, ended;
};
[[nodiscard]] Twice start_from_weaker(const Assembly& weaker, double factor, const Assembly& assembly);

/// Of factors. Quick ones are as fine, but give a search that does not settle less work; coarse ones are good to 1e-4,
/// of an assembly that moves at strengths as they are.
enum class Accuracy : std::uint8_t { fine, quick, coarse };
[[nodiscard]] StaticFactor static_factor(const Assembly& assembly, Accuracy accuracy);
[[nodiscard]] MovingFactor moving_factor(const Assembly& assembly, double up, Accuracy accuracy);
/// Where a factor is looked for, from `begin` down to `least`, which it is where what is looked for moves there
/// already; else as fine as this.
struct FactorRange {
  double least = 0, begin = 1, fine = 1e-3;
};
/// At which one of the bodies that are marked in `these` starts to move; infinite where none does at the begin.
[[nodiscard]] double factor_of(const std::vector<std::uint8_t>& these, const Assembly& assembly, FactorRange range,
                               Accuracy accuracy);
/// By speed: which bodies move.
[[nodiscard]] std::vector<std::uint8_t> moving_ones(const std::vector<double>& speed);

/// Solutions of the Coulomb problem from rest, from low strength to high: a solution that moves at one strength is the
/// start at the next.
class Branch final {
 public:
  explicit Branch(const Elements& elements);
  Branch(const Elements&&) = delete;

  /// Whether anything moves without friction. What follows needs it.
  [[nodiscard]] bool begin();
  struct Found {
    FromRest what = FromRest::unsettled;
    State state;
    double residual = 1;
    std::vector<std::uint8_t> unsettled = {};  ///< by body, of a search by sweeps: what else there is has settled
  };
  /// What sweeps found.
  [[nodiscard]] static Found of(Solution solution);
  enum class Effort : std::uint8_t { newton, thresholds, whole, sweeps };
  /// Looks for motion at this strength; goes on from the last motion found.
  [[nodiscard]] Found at(double divisor, Effort effort = Effort::whole);
  /// Linear solves that a search by thresholds may take, times the number of bodies.
  void allow(unsigned solves) { allowed_ = solves; }
  /// Motion that interior points come by, apart from what was found before; empty where they find none.
  [[nodiscard]] std::optional<Found> by_inner_points(double divisor) const;
  /// Makes what was found the start of what follows.
  void keep(const Found& found) { start_ = found.state; }
  [[nodiscard]] Newton& newton() noexcept { return newton_; }

 private:
  [[nodiscard]] Found judged(double divisor, State state) const;
  [[nodiscard]] Found by_newton(double divisor);
  [[nodiscard]] Found by_thresholds(double divisor);
  [[nodiscard]] Found by_sweeps(double divisor);
  [[nodiscard]] Found standing(double divisor);

  const Elements* elements_;
  Newton newton_;
  State start_;
  unsigned allowed_ = 60'000;
};

/// Work of a quick search, as of `Branch::allow`.
inline constexpr unsigned quick_search = 1'500;

/// Below this share of free fall nothing counts as moving.
inline constexpr double slow = 1e-8;
/// What a solution may violate.
inline constexpr double exact_enough = 1e-6;

}  // namespace cleave::assembly
