#pragma once

#include <expected>
#include <optional>

#include "cleave/facets/cut_input.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::topology {

struct CutOptions {
  unsigned threads = 1;
};

/// What `cut` would refuse of its input, found without cutting; empty: nothing. (Too many blocks show in the cut
/// alone.)
[[nodiscard]] std::optional<CutError> refusal_of(const CutInput& input);

/// Cuts the domain into blocks: the connected parts of the domain less the excavations and the joints. Exact: every
/// combinatorial decision is the sign of a determinant of integers. No joint, no excavation: one block. Whatever the
/// input holds, what comes out is blocks or an error.
[[nodiscard]] std::expected<BlockComplex, CutError> cut(const CutInput& input, const CutOptions& options = {});

}  // namespace cleave::topology
