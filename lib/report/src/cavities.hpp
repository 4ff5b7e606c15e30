#pragma once

#include <optional>

#include "cleave/topology/block_complex.hpp"

namespace cleave::report::detail {

/// A block with cavities, cut by a few axis-parallel planes so that each cavity meets one of them: then no piece has a cavity.
/// Coordinates are relative to the complex's origin. Empty when the block's surface is too fine to be cut again.
[[nodiscard]] std::optional<topology::BlockComplex> cut_through_cavities(const topology::BlockComplex& complex,
                                                                         topology::BlockId block);

}  // namespace cleave::report::detail
