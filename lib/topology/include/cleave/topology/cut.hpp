#pragma once

#include <cstddef>
#include <expected>
#include <string>
#include <variant>

#include "cleave/topology/block_complex.hpp"
#include "cleave/topology/cut_input.hpp"

namespace cleave::topology {

struct JointCollapsed {  ///< a joint polygon too small for the lattice
  JointId joint;
  Length pitch;
};
struct SolidCollapsed {  ///< a face of the domain (no excavation index) or of an excavation too small for the lattice
  std::optional<std::uint32_t> excavation;
  std::uint32_t face;
  Length pitch;
};
struct TerminationUndecided {  ///< a joint ends on another whose plane passes through its middle, or is no one plane
  JointId joint, at;
};
struct DomainSwallowed {};  ///< the excavations leave no rock
struct WindowOutside {};    ///< the window and the domain's box have no volume in common
struct TooLarge {           ///< more than 2^31 vertices, edges or faces
  std::string what;
};
struct NotFinite {  ///< a number that is none, or infinite; a normal without length counts
  std::string what;
  std::optional<JointId> joint;
};
struct SnapNegative {
  Length snap;
};
struct UnknownTag {  ///< of a free side that the domain does not have
  std::uint32_t tag;
};
struct UnknownJoint {  ///< of a termination
  JointId joint;
};
using CutError = std::variant<JointCollapsed, SolidCollapsed, TerminationUndecided, DomainSwallowed, WindowOutside,
                              TooLarge, NotFinite, SnapNegative, UnknownTag, UnknownJoint>;
[[nodiscard]] std::string describe(const CutError& error);

struct CutOptions {
  unsigned threads = 1;
};

/// Cuts the domain into blocks: the connected parts of the domain less the excavations and the joints. Exact: every
/// combinatorial decision is the sign of a determinant of integers. No joint, no excavation: one block. Whatever the
/// input holds, what comes out is blocks or an error.
[[nodiscard]] std::expected<BlockComplex, CutError> cut(const CutInput& input, const CutOptions& options = {});

}  // namespace cleave::topology
