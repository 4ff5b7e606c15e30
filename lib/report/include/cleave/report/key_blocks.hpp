#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/stability/result.hpp"
#include "cleave/stability/support.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::report {

inline constexpr std::string_view key_blocks_header =
    "block,batch,key,mode,volume_m3,weight_n,direction_x,direction_y,direction_z,net_force_n,factor_of_safety,faces,"
    "joints";
/// Follows when force transfer ran: the same block with the forces that later batches pass to it, and what it passes on
/// (N).
inline constexpr std::string_view key_blocks_transferred_header =
    ",key_transferred,mode_transferred,direction_x_transferred,direction_y_transferred,direction_z_transferred,"
    "net_force_n_transferred,factor_of_safety_transferred,passed_n_transferred";

/// Follows when [support] was checked. Blocks that need no support keep their values: means `none needed`.
inline constexpr std::string_view key_blocks_supported_header =
    ",held_by_supported,bolts_supported,mobilised_share_supported,factor_of_safety_supported,missing_force_n_supported,"
    "required_force_n_supported,required_pressure_pa_supported";

/// key_blocks.csv: one row for every removable block that would move without friction, in order of the block's number.
///
/// block: number from 0, as in blocks.vtu. batch: from 1, empty for a block that stays. key: 1 when unstable.
/// direction: unit vector of first motion. factor_of_safety: `inf` when nothing drives the block. faces: how many faces
/// the block has. joints: numbers (from 0, in the order of the scene) of the joints it touches, ascending, joined by
/// `;`. LF line ends.
[[nodiscard]] std::string key_blocks_csv(const topology::BlockComplex& complex, const stability::Analysis& analysis,
                                         const stability::SupportResult* support = nullptr);

/// bolts.csv: one row a bolt, in the order of the scene, then spot bolts. blocks: those it goes through, with the
/// metres from the collar at which it enters and leaves each (`12:0-1.5;7:1.5-3`). The block served is the one that
/// takes most.
[[nodiscard]] std::string bolts_csv(const stability::SupportResult& support, std::span<const std::string> groups);

struct NamedAnalysis {
  std::string_view name;
  const stability::Analysis* analysis;  ///< not null
};
/// load_cases.csv: the rows of key_blocks.csv (fewer columns) of every named load case, the base case first.
[[nodiscard]] std::string load_cases_csv(const topology::BlockComplex& complex, std::span<const NamedAnalysis> cases);

/// Numbers of the joints that bound a block, ascending.
[[nodiscard]] std::vector<topology::JointId> joints_of(const topology::BlockComplex& complex, topology::BlockId block);

}  // namespace cleave::report
