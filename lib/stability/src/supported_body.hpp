#pragma once

#include <limits>

#include "cleave/stability/support.hpp"
#include "contacts.hpp"
#include "verdict.hpp"

namespace cleave::stability {

/// A body under its loads, before any support.
struct Body {
  Contacts contacts;
  Resultant resultant;
  Verdict bare;
  double target = 1;
  /// N: what it lacks to reach its target, on the side of the driving force; > 0 needs support.
  [[nodiscard]] double lack() const { return bare.driving - bare.resistance.least / target; }
  [[nodiscard]] bool lacks() const { return lack() > 0x1p-40 * bare.driving; }
};

[[nodiscard]] double target_of(Mode mode, const SupportPlan& plan);

struct Least {
  double share = std::numeric_limits<double>::infinity();  ///< infinite: not found up to the limit
  Mode mode = Mode::stable;
};
/// Smallest share of `force` in [0, limit] that holds the body, strength and force both reduced by the target: 32
/// steps, then bisection in the first that does. (The lack of hold is continuous but where cohesion is lost with a
/// wall, so a scan comes first.)
[[nodiscard]] Least least_share(const Body& body, geometry::Vec3 force, const Settings& settings, double limit);

/// Factor of safety in the mode without bolts (Fu 2014, 4.8 to 4.10) under the sum of the bolts' forces.
[[nodiscard]] double fixed_mode_factor(const Body& body, geometry::Vec3 bolts, bool active);

/// Direction of the best single force: at the friction angle to a plane, else straight against the motion.
[[nodiscard]] geometry::Vec3 best_direction(const Body& body);

}  // namespace cleave::stability
