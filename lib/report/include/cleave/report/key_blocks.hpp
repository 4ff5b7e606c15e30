#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/scene/field_stress.hpp"
#include "cleave/stability/maximum_blocks.hpp"
#include "cleave/stability/result.hpp"
#include "cleave/stability/support.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::report {

inline constexpr std::string_view key_blocks_header =
    "block,batch,key,mode,volume_m3,weight_n,direction_x,direction_y,direction_z,net_force_n,factor_of_safety,faces,"
    "joints";
/// Follows when force transfer ran: the same block with the forces that later batches pass to it, what it passes on
/// (N), and what of it the scene's reading of the transfer loses (N; 0 with the default).
inline constexpr std::string_view key_blocks_transferred_header =
    ",key_transferred,mode_transferred,direction_x_transferred,direction_y_transferred,direction_z_transferred,"
    "net_force_n_transferred,factor_of_safety_transferred,passed_n_transferred,lost_n_transferred";

/// Follows when the rotational check ran: 1 when no statics holds the block against turning, 0 when some does, empty
/// for a block that translation moves.
inline constexpr std::string_view key_blocks_rotation_header = ",turns";

/// Follows when [support] was checked. Blocks that need no support keep their values: means `none needed`.
inline constexpr std::string_view key_blocks_supported_header =
    ",held_by_supported,bolts_supported,mobilised_share_supported,factor_of_safety_supported,missing_force_n_supported,"
    "required_force_n_supported,required_pressure_pa_supported";

/// Follows with [field_stress]: the same block with the stress of the rock across its joints, and how much of it is
/// compression and tension (N); empty for blocks that are not at the tunnel.
inline constexpr std::string_view key_blocks_clamped_header =
    ",key_clamped,factor_of_safety_clamped,compression_n_clamped,tension_n_clamped";

/// key_blocks.csv: one row for every removable block that would move without friction, in order of the block's number.
///
/// block: number from 0, as in blocks.vtu. batch: from 1, empty for a block that stays. key: 1 when unstable.
/// direction: unit vector of first motion. factor_of_safety: `inf` when nothing drives the block. faces: how many faces
/// the block has. joints: numbers (from 0, in the order of the scene) of the joints it touches, ascending, joined by
/// `;`. LF line ends.
[[nodiscard]] std::string key_blocks_csv(const topology::BlockComplex& complex, const stability::Analysis& analysis,
                                         const stability::SupportResult* support = nullptr,
                                         const scene::FieldStressResult* field_stress = nullptr);

/// bolts.csv: one row a bolt, in the order of the scene, then spot bolts. blocks: those it goes through, with the
/// metres from the collar at which it enters and leaves each (`12:0-1.5;7:1.5-3`). The block served is the one that
/// takes most.
[[nodiscard]] std::string bolts_csv(const stability::SupportResult& support, std::span<const std::string> groups);

struct NamedSupport {
  std::string_view name;                    ///< of the load case; "base"
  const stability::SupportResult* support;  ///< not null
};
/// support_blocks.csv: every block that needs support under a load case, and what holds it.
[[nodiscard]] std::string support_blocks_csv(std::span<const NamedSupport> cases);
/// combined_blocks.csv: the bodies that bolts stitch together, under every load case. members: joined by `;`.
[[nodiscard]] std::string combined_blocks_csv(std::span<const NamedSupport> cases);

struct MaximumBlockRow {
  std::array<std::string, 3> sets;
  std::string where;
  stability::MaximumKeyBlock block;
};
/// maximum_blocks.csv: largest key blocks of block theory.
[[nodiscard]] std::string maximum_blocks_csv(std::span<const MaximumBlockRow> rows);

struct NamedAnalysis {
  std::string_view name;
  const stability::Analysis* analysis;  ///< not null
};
/// load_cases.csv: the rows of key_blocks.csv (fewer columns) of every named load case, the base case first.
[[nodiscard]] std::string load_cases_csv(const topology::BlockComplex& complex, std::span<const NamedAnalysis> cases);

/// Numbers of the joints that bound a block, ascending.
[[nodiscard]] std::vector<topology::JointId> joints_of(const topology::BlockComplex& complex, topology::BlockId block);

}  // namespace cleave::report
