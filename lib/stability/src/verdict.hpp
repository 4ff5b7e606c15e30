#pragma once

#include <limits>
#include <vector>

#include "cleave/stability/result.hpp"
#include "contacts.hpp"
#include "resistance.hpp"

namespace cleave::stability {

/// A block under one resultant: what both judgement and transfer are filled from.
struct Verdict {
  Mode mode = Mode::stable;
  bool key = false;
  geometry::Vec3 direction;
  double driving = 0;  ///< N
  double net = 0;      ///< N
  double factor_of_safety = std::numeric_limits<double>::infinity();
  Resistance resistance;
  bool tie = false;
  double residual = 0;  ///< |r + sum N n - s| / scale of r
};

/// Precondition: the block is removable.
[[nodiscard]] Verdict judge(const Contacts& contacts, const Resultant& resultant, const Settings& settings);

/// The planes that a verdict leans on, with what presses on them and shears along them.
[[nodiscard]] std::vector<Pressing> pressing_of(const Contacts& contacts, const Verdict& verdict);

}  // namespace cleave::stability
