#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "cleave/report/json.hpp"
#include "cleave/stability/key_groups.hpp"
#include "cleave/stability/result.hpp"
#include "cleave/stability/support.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::report {

struct PlanRow {
  std::string stage;  ///< "read", "draw", "cut", ...
  bool run;
  std::string why;
};

struct CostRow {
  std::string stage;
  double wall_s, cpu_s, peak_rss_mb;
};

struct CostTable {
  double wall_s = 0, cpu_s = 0, peak_rss_mb = 0;
  unsigned threads = 1;
  std::vector<CostRow> stages;
};

/// What the scene's `snap` changed of one joint.
struct SnappedRow {
  std::uint64_t joint = 0;
  double moved_m = 0;
  bool plane_merged = false;
  std::uint64_t edges_adopted = 0;
};

struct InputFigures {
  std::uint64_t joints = 0;
  double lattice_pitch_m = 0;
  double largest_snap_m = 0;
  std::uint64_t merged_planes = 0;
  std::vector<SnappedRow> snapped = {};  ///< written when there are any
};

/// What can be counted of the blocks themselves.
struct BlockFigures {
  std::uint64_t count = 0;
  double volume_m3 = 0;
  double domain_volume_m3 = 0;      ///< of the domain less what is excavated
  std::uint64_t concave = 0;        ///< blocks that are not convex (a block with a hole or a cavity is not)
  std::uint64_t with_holes = 0;     ///< blocks with a hole through them (genus > 0) or a face with a hole in it
  std::uint64_t with_cavities = 0;  ///< blocks with more than one shell
  std::uint64_t slivers = 0;
  std::string hash;
  double exact_share = 0;  ///< part of the cutter's predicate calls that needed exact numbers
};

struct BatchFigures {
  std::uint32_t batch;
  std::uint64_t count = 0;
  double volume_m3 = 0;
  std::array<std::uint64_t, 4> modes{};  ///< falling, lifting, sliding, wedge
};

struct KeyBlockFigures {
  std::uint64_t count = 0;  ///< blocks that leave, in all batches
  double volume_m3 = 0;
  std::vector<BatchFigures> batches;
  bool stopped_at_max_batches = false;
  double lowest_factor_of_safety = std::numeric_limits<double>::infinity();  ///< of the blocks judged
  std::optional<std::uint64_t> below_target = {};  ///< judged blocks below the scene's target, where it has one
  double equilibrium_residual = 0;                 ///< largest, relative; statics and force transfer
  std::optional<std::uint64_t> turning = {};       ///< judged blocks that turn; none without the rotational check
  std::string hash = {};                           ///< of the blocks that leave
};

/// Blocks judged together.
struct KeyGroupFigures {
  std::uint64_t count = 0;  ///< of groups that move or may
  double volume_m3 = 0;     ///< of those
  std::uint64_t certain = 0, unsafe = 0, in_doubt = 0;
  double factor = std::numeric_limits<double>::infinity();  ///< least factor of safety of those that have one
};

struct CaseFigures {
  std::string name;
  KeyBlockFigures figures;
};

/// When only the rock near free faces was cut.
struct WindowFigures {
  std::array<double, 3> min, max;
  std::uint64_t rounds = 1, truncated = 0;
};

/// [micro_blocks] of the scene, where it does not keep silent about them.
struct MicroBlockFigures {
  std::string policy;  ///< "report" or "exclude"
  std::uint64_t count = 0;
  double volume_m3 = 0;
  double thinnest_m = 0;  ///< 0 when there are none
};

/// Parts of joints that bound no block, where the scene keeps them.
struct DanglingFigures {
  std::uint64_t pieces = 0;
  double area_m2 = 0;
  std::uint64_t free_edges = 0;
  double free_edge_length_m = 0;
  std::uint64_t joints = 0;
  std::uint64_t isolated_joints = 0;
};

/// One stage of a sequential excavation.
struct StageFigures {
  std::uint32_t stage = 1;
  std::vector<std::string> excavations;
  bool passed = true;  ///< the certificate of this state
  std::uint64_t blocks = 0;
  double volume_m3 = 0;
  std::string hash;
  KeyBlockFigures key_blocks;
  std::uint64_t new_count = 0;  ///< without those that left in earlier stages
  double new_volume_m3 = 0;
};
struct OrderFigures {
  std::vector<std::uint32_t> stages;
  std::vector<std::uint64_t> new_count;
  std::vector<double> new_volume_m3;
  std::uint64_t count = 0;
  double volume_m3 = 0;
};
struct SequenceFigures {
  std::string fallen;  ///< "stay_out" or "put_back"
  std::vector<StageFigures> stages;
  std::vector<OrderFigures> orders;
  std::size_t best = 0;
};

struct DesignFigures {
  double length_m;
  bool found;
  double scale;  ///< of the scene's spacings
  std::uint64_t bolts;
  double cost;
};

/// The support under one named load case.
struct SupportCaseFigures {
  std::string name;
  bool passes;
  std::uint64_t blocks, not_held, combined, combined_failing;
};

/// Largest key blocks of block theory.
struct MaximumFigures {
  std::uint64_t count = 0;
  double largest_volume_m3 = 0;
  double lowest_factor_of_safety = std::numeric_limits<double>::infinity();
  double largest_required_pressure_pa = 0;
};

struct SupportFigures {
  bool passes = false;
  std::uint64_t blocks = 0, held_by_bolts = 0, held_by_shotcrete = 0, not_held = 0;
  std::uint64_t bolts = 0, spot_bolts = 0, bolts_used = 0, bolts_redundant = 0, bolts_too_short = 0;
  std::uint64_t combined = 0, combined_failing = 0;
  double required_force_n = 0, largest_required_pressure_pa = 0, missing_force_n = 0;
  std::optional<double> required_force_n_per_metre = {};  ///< of tunnel, where there is one
  std::vector<DesignFigures> designs = {};
  std::vector<SupportCaseFigures> cases = {};  ///< of [[load]]
};

/// [field_stress]: key blocks at the tunnel with the stress of the rock across their joints.
struct FieldStressFigures {
  std::string tunnel;
  std::uint64_t elements = 0;
  double error = 0, condition = 0, residual = 0;  ///< of the section's elastic solution
  std::uint64_t blocks = 0;                       ///< judged
  std::uint64_t held = 0;                         ///< unstable without, stable with it
  double lowest_factor_of_safety = std::numeric_limits<double>::infinity();
};

/// Everything of summary.json, as values.
struct Summary {
  std::string title;
  std::uint64_t seed = 1;
  std::string scene_sha256;
  std::vector<PlanRow> plan;
  CostTable cost;
  InputFigures input;
  std::optional<BlockFigures> blocks;  ///< none when the certificate did not pass
  topology::Certificate certificate;
  std::optional<WindowFigures> window;
  std::optional<KeyBlockFigures> key_blocks;
  std::optional<SequenceFigures> sequence;
  std::optional<DanglingFigures> dangling;
  std::optional<MicroBlockFigures> micro_blocks;
  std::vector<CaseFigures> load_cases;  ///< of [[load]]
  std::optional<KeyGroupFigures> key_groups = {};
  std::optional<SupportFigures> support;
  std::optional<MaximumFigures> maximum_blocks;
  std::optional<FieldStressFigures> field_stress;
};

[[nodiscard]] BlockFigures count_blocks(const topology::BlockComplex& complex, std::string hash);
struct TargetFactors {
  double falling, sliding;
};
[[nodiscard]] KeyBlockFigures count_key_blocks(const stability::Analysis& analysis,
                                               const std::optional<TargetFactors>& target = {});
/// Whether a judged block has less than its target.
[[nodiscard]] bool below(const stability::Judgement& judgement, const TargetFactors& target);

[[nodiscard]] KeyGroupFigures count_key_groups(const stability::KeyGroups& groups);
[[nodiscard]] SupportFigures count_support(const stability::SupportResult& support);

/// The head of summary.json: title, seed, plan and cost.
void write_summary_head(JsonWriter& json, const Summary& summary);
void write_summary_input(JsonWriter& json, const InputFigures& input);
/// summary.json; keys in the order of docs/summary.schema.json.
[[nodiscard]] std::string summary_json(const Summary& summary);

}  // namespace cleave::report
