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

/// A block that stays only because blocks that are smaller, or removable, stand in its way or under it.
struct Barred {
  topology::BlockId block;
  Volume volume = {};
  double factor_of_safety = 0;  ///< without them, the forces on the block as they are; below 1
};

/// Blocks with something open, no key blocks, that would be were the neighbours that are smaller or removable not
/// there, in the state that the analysis ends in: whether they can push those out is what key groups tell. Blocks that
/// a window cuts through are neither asked nor taken away.
[[nodiscard]] std::vector<Barred> barred_by_lesser(const topology::AuditedComplex& complex, const Settings& settings,
                                                   const Analysis& analysis);

/// What only the border of the domain holds.
struct DomainHeld {
  std::vector<topology::BlockId> blocks = {};  ///< ascending
  Volume volume = {};
  Area free_area = {};  ///< of their free faces
  Area all_free = {};   ///< of all free faces
};

/// Blocks at free faces (or beside what has left) that touch a side of the domain that is not free are never judged:
/// the rock beyond is unknown. This finds those of them that would be key blocks, in the state the analysis ends in,
/// were these sides smooth joints. A side that such a block would stand on (one that looks up by more than 45 degrees)
/// holds as rock does. Blocks that a window cuts through are not asked.
[[nodiscard]] DomainHeld domain_held(const topology::AuditedComplex& complex, const Settings& settings,
                                     const Analysis& analysis);

}  // namespace cleave::stability
