#pragma once

#include <vector>

#include "cleave/stability/analyse.hpp"

namespace cleave::stability {

/// A block that stays only because of blocks wholly inside it: a closed box of joints in its middle.
struct HeldFromWithin {
  topology::BlockId block;
  std::vector<topology::BlockId> inside = {};  ///< ascending
  /// Of all of them as one body, without forces of later batches.
  Mode mode = Mode::stable;
  geometry::Vec3 direction = {};
  Force net = {};
  double factor_of_safety = 0;
};

/// Blocks are judged one by one, so a block and what it encloses hold each other for ever: the one inside has no way
/// out, and its faces leave the one around it none. Really they go together. This finds such blocks in the state that
/// the analysis ends in, and those of them that leave as one body. Blocks that a window cuts through are not asked.
[[nodiscard]] std::vector<HeldFromWithin> held_from_within(const topology::AuditedComplex& complex,
                                                           const Settings& settings, const Analysis& analysis);

}  // namespace cleave::stability
