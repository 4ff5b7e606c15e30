#pragma once

#include <functional>
#include <span>
#include <vector>

#include "cleave/stability/support.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::stability {

/// N per gripped metre.
[[nodiscard]] double bond_of(const BoltType& type);

/// How a bolt grips one block.
struct Grip {
  double gripped = 0;          ///< m in the block, as its kind grips
  double first = 0, last = 0;  ///< m from the collar: where the bolt enters it first and leaves it last
  bool collar = false;
  double behind = 0;  ///< m gripped in rock beyond it
};
[[nodiscard]] Grip grip_of(const BoltResult& bolt, topology::BlockId block);
/// The same, `behind` in rock that `stays` alone.
[[nodiscard]] Grip grip_of(const BoltResult& bolt, topology::BlockId block,
                           const std::function<bool(topology::BlockId)>& stays);
/// Held by the plate or over the anchorage length.
[[nodiscard]] bool gripped(const Grip& grip, const BoltType& type);

/// How a bolt holds a body of stitched blocks to what lies outside and behind its last metre in it.
struct BodyGrip {
  bool gripped = false;  ///< some member of the body is
  double inside = 0;     ///< m in members
  double anchored = 0;   ///< m behind the body in blocks that stay
  bool collar = false;   ///< its head is on a member
};
[[nodiscard]] BodyGrip grip_of(const BoltResult& bolt, std::span<const topology::BlockId> members,
                               const std::function<bool(topology::BlockId)>& stays);

/// Blocks that bolts stitch together, of those that `count`: groups of two and more, ascending; by lowest id.
[[nodiscard]] std::vector<std::vector<topology::BlockId>> stitched(const topology::BlockComplex& complex,
                                                                   const std::vector<BoltResult>& bolts,
                                                                   const std::function<bool(topology::BlockId)>& count);

}  // namespace cleave::stability
