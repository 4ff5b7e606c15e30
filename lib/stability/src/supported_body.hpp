#pragma once

#include <optional>

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

/// No face has more cohesion under support than counts without it (`bare`, under `resultant`): what a body opens as it
/// moves has parted before support holds it, and what presses it shut again does not bring that back.
void keep_cohesion_of(const Verdict& bare, const Resultant& resultant, bool parallel_contact, Contacts& contacts);

[[nodiscard]] double target_of(Mode mode, const SupportPlan& plan);

/// What support can do for a body.
struct Help {
  geometry::Vec3 force = {};  ///< N: forces with a direction, of which as much is mobilised as holds it
  double resistance = 0;      ///< N against the motion, whichever it is
};

/// A share of a force that holds a body, and its mode then.
struct Share {
  double share = 0;
  Mode mode = Mode::stable;
};
/// Smallest share of `help.force` in [0, limit] that holds the body, strengths, force and resistance all reduced by its
/// target; empty where none does. The driving force is convex along the line of shares, so where it is least is found
/// first: a body that can move both ways is held on a narrow interval around there. The lack of hold is continuous but
/// where cohesion is lost with a wall, so 32 steps are looked at too; bisection then finds where the first interval
/// begins.
[[nodiscard]] std::optional<Share> least_share(const Body& body, const Help& help, const Settings& settings,
                                               double limit = 1);

/// The largest factor on strengths, force and resistance at which some share in [0, 1] holds the body: it is >= its
/// target exactly where `least_share` finds a share. Relative error 1e-6; infinite above 1e6.
[[nodiscard]] double factor_with(Body body, const Help& help, const Settings& settings);

/// Factor of safety in the mode without bolts (Fu 2014, 4.8 to 4.10) under the sum of the bolts' forces.
[[nodiscard]] double fixed_mode_factor(const Body& body, geometry::Vec3 bolts, bool active);

/// A force at one point of no matter: its direction (unit) and what of it brings the body to its target, N; infinite
/// where none does.
struct SingleForce {
  geometry::Vec3 direction = {};
  double force = 0;
};
/// The smaller of two: that along which the lack of hold falls fastest in the mode without support, at
/// atan(tan(friction)/target) to the planes that press, and that straight against the motion.
[[nodiscard]] SingleForce best_force(const Body& body, const Settings& settings);

/// Where spot bolts point first, whatever the target: at the friction angle to the one plane that presses, else
/// straight against the motion.
[[nodiscard]] geometry::Vec3 spot_direction(const Body& body);

}  // namespace cleave::stability
