#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "cleave/exchange/cells.hpp"
#include "cleave/stability/result.hpp"

namespace cleave::report {

/// Number of `mode` in blocks.vtu: that of stability::Mode; this one for a block that was not judged.
inline constexpr std::uint8_t mode_not_judged = 255;
/// What `factor_of_safety` holds for an infinite factor (infinities spoil colour scales) and for a block without a
/// factor; `factor_known` tells which: 0 none, 1 a number, 2 infinite.
inline constexpr double factor_when_infinite = 1e9;
inline constexpr double factor_when_unknown = -1;

struct VtuText {
  std::string title;  ///< of the scene
  std::string scene_file;
  /// Sequential excavation: a number a block for the cell array `stage`; empty: no such array.
  std::span<const std::int32_t> stage_of_block = {};
};

/// blocks.vtu: polyhedra in the layout that every VTK reads (faces + faceoffsets), all arrays base64 inline, so the
/// file is valid XML.
///
/// Cell arrays: block (Int64, index from 0), volume (Float64, m3, of the cell), batch (Int32, -1: stays), mode (UInt8,
/// see mode_not_judged; names in the field data array mode_names), key (UInt8), factor_of_safety (Float64) with
/// factor_known (UInt8), net_force (Float64 x 3, N, along the first motion; against it for blocks that hold). Values
/// are those before force transfer. All but block and volume are absent when `analysis` is null. stage (Int32):
/// in blocks.vtu the first stage in which a part of the block left, -1 when it stays; in blocks_stage_K.vtu K.
[[nodiscard]] std::string blocks_vtu(const Cells& cells, const stability::Analysis* analysis, const VtuText& text);

}  // namespace cleave::report
