#pragma once

#include <vector>

#include "cleave/stability/analyse.hpp"

namespace cleave::stability {

/// What only the border of the domain holds.
struct DomainHeld {
  std::vector<topology::BlockId> blocks = {};  ///< ascending
  Volume volume = {};
  double free_area = 0;  ///< m2, of their free faces
  double all_free = 0;   ///< m2, of all free faces
};

/// Blocks at free faces (or beside what has left) that touch a side of the domain that is not free are never judged:
/// the rock beyond is unknown. This finds those of them that would be key blocks, in the state the analysis ends in,
/// were these sides smooth joints. A side that such a block would stand on (one that looks up by more than 45 degrees)
/// holds as rock does. Blocks that a window cuts through are not asked.
[[nodiscard]] DomainHeld domain_held(const topology::AuditedComplex& complex, const Settings& settings,
                                     const Analysis& analysis);

}  // namespace cleave::stability
