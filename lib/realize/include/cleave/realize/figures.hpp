#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/core/fields.hpp"
#include "cleave/core/quantity.hpp"
#include "cleave/geometry/vec3.hpp"
#include "cleave/realize/block_sizes.hpp"
#include "cleave/scene/plan.hpp"
#include "cleave/scene3d/scene.hpp"
#include "cleave/stability/key_groups.hpp"
#include "cleave/stability/result.hpp"
#include "cleave/stability/support.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::topology {
template <class V>
void fields(V& v, const SnappedJoint& x) {
  v("joint", x.joint);
  v("moved_m", x.moved, "the farthest that a corner, or a corner of a side, was moved");
  v("plane_merged", x.plane_merged, "it took an earlier polygon's plane");
  v("edges_adopted", x.adopted_edges, "sides that now end on another joint's plane");
}
template <class V>
void fields(V& v, const CoarseSnap& x) {
  v("polygons", x.polygons,
    "polygons with sides shorter than twice `snap`: their corners became one or passed each other");
  v("shortest_m", x.shortest, "their shortest side; a `snap` of less than half of it keeps all polygons as they are");
  v("joint", x.joint, "whose side that is");
}
template <class V>
void fields(V& v, const Misfit& x) {
  v("block", x.block);
  v("face", x.face, "absent: of the block as a whole");
  v("of", one_of(x.of), "which figure; corners: off the face's plane, owner: the face is not one of that block");
}
template <class V>
void fields(V& v, const Certificate& x) {
  v("passed", x.passed);
  v("euler_violations", x.euler_violations);
  v("open_shells", x.open_shells);
  v("face_vector_max_relative", x.face_vector_max_relative,
    "largest |sum of face vectors| / sum of areas over the blocks");
  v("unpaired_patches", x.unpaired_patches, "joint patches whose area the neighbour does not match");
  v("misfits", x.misfits,
    "faces and blocks whose stored place, areas, volumes or flags are not those of their corners");
  v("first_misfits", when_any(x.first_misfits), "by block and face, at most 20");
  v("offenders", when_any(x.offenders), "numbers of blocks that did not pass, at most 20");
}
template <class V>
void fields(V& v, const NearMisses& x) {
  v("sides", x.sides, "sides of joints that miss another polygon by less than 1e-6 of the domain's extent");
  v("largest_m", x.largest, "the most that one of them misses by; `snap` of a little more closes them all");
  v("joint", x.joint, "whose side that is");
  v("other_joint", x.other, "which joint it misses; absent: a side of the domain or of an excavation");
}
}  // namespace cleave::topology
template <>
struct cleave::Sample<cleave::topology::SnappedJoint> {
  static topology::SnappedJoint make() { return {topology::JointId{0U}, {}, false, 0}; }
};
template <>
struct cleave::Sample<cleave::topology::Misfit> {
  static topology::Misfit make() { return {{}, topology::BlockId{0U}, {}}; }
};

/// The figures of a run: what is counted, once, when it ends. summary.json, its schema, the console, report.html and
/// `cleave diff` show these. A new figure is a member here and a line in the `fields` below it.
namespace cleave::scene {

/// What one opening takes.
struct ExcavationFigures {
  std::string name;
  Volume volume;
  std::optional<double> outside_share = {};
};
template <class V>
void fields(V& v, const ExcavationFigures& x) {
  v("name", x.name);
  v("volume_m3", x.volume, "rock removed; what several openings take counts for the first of them");
  v("outside_share", x.outside_share,
    "of the opening's own volume, what lies outside the domain; absent for slopes and benches, which reach beyond it");
}

template <class V>
void fields(V& v, const InputFile& x) {
  v("path", x.name, "as the scene names it");
  v("sha256", x.sha256, "of its bytes");
  v("bytes", x.bytes);
}

struct CutFigures : InputFigures {
  std::vector<InputFile> files = {};
  std::vector<ExcavationFigures> excavations = {};
  std::vector<topology::SnappedJoint> snapped = {};
  topology::CoarseSnap coarse_snap = {};
  topology::NearMisses near_misses = {};
  std::vector<SetFigures> sets = {};
  std::vector<LineFigures> lines = {};
};
template <class V>
void fields(V& v, const CutFigures& x) {
  fields(v, static_cast<const InputFigures&>(x));
  v("files", when_any(x.files), "read for the scene, beside the scene file itself (scene_sha256)");
  v("excavations", when_any(x.excavations), "in the order of the scene");
  v("sets", when_any(x.sets), "joint sets as they lie in the box around the domain");
  v("lines", when_any(x.lines), "what the joints cut the scanlines into");
  v("snapped", when_any(x.snapped), "the joints that `snap` changed, by number; absent when there are none");
  v("coarse_snap", when(x.coarse_snap.polygons > 0, x.coarse_snap),
    "polygons that are smaller than `snap`: what they part may be other than what was meant");
  v("near_misses", when(x.near_misses.sides > 0, x.near_misses),
    "sides of joints that nearly reach another polygon: rock that was perhaps meant to be parted there is not");
}

/// What can be counted of the blocks themselves.
struct BlockFigures {
  std::uint64_t count = 0;
  double volume_m3 = 0;
  double domain_volume_m3 = 0;
  std::uint64_t concave = 0;
  std::uint64_t with_holes = 0;
  std::uint64_t with_cavities = 0;
  std::uint64_t slivers = 0;
  std::string hash;
  double exact_share = 0;
  std::optional<BlockSizes> sizes = {};
};

/// When only the rock near free faces was cut.
struct WindowInfo {
  geometry::Vec3 min, max;      ///< m
  std::uint64_t rounds = 1;     ///< how many windows were cut before this one was large enough
  std::uint64_t truncated = 0;  ///< blocks that go on outside it
};
template <class V>
void fields(V& v, const WindowInfo& x) {
  v("min", x.min);
  v("max", x.max);
  v("rounds", x.rounds, "windows cut, each larger, until no block they cut through could move");
  v("truncated", x.truncated, "blocks that go on outside the box");
}

/// Section `blocks`; without `blocks` the certificate did not pass.
template <class V>
void block_fields(V& v, const std::optional<BlockFigures>& blocks, const topology::Certificate& certificate,
                  const std::optional<WindowInfo>& window) {
  using B = BlockFigures;
  v("count", or_null(blocks, &B::count));
  v("volume_m3", blocks ? blocks->volume_m3 : certificate.volume.si(), "sum over the blocks");
  v("domain_volume_m3", or_null(blocks, &B::domain_volume_m3), "of the domain less what is excavated");
  v("volume_relative_error", certificate.volume_relative_error, "of the sum against the domain's");
  v("concave", or_null(blocks, &B::concave), "blocks that are not convex");
  v("with_holes", or_null(blocks, &B::with_holes), "blocks with a hole through them (genus > 0) or a hole in a face");
  v("with_cavities", or_null(blocks, &B::with_cavities), "blocks with more than one shell");
  v("slivers", or_null(blocks, &B::slivers), "blocks thinner than 1e-6 of the domain's extent; they are kept");
  v("hash", or_null(blocks, &B::hash),
    "of the block system: the same for every thread count, compiler and optimisation level");
  v("certificate", certificate);
  v("exact_share", or_null(blocks, &B::exact_share), "part of the cutter's decisions that needed exact numbers, 0..1");
  v("sizes", blocks ? blocks->sizes : std::nullopt, "block sizes and shapes");
  v("window", window,
    "present when only the rock near free faces was cut ([output] blocks = \"key\"): the other figures are of this "
    "box");
  v("reason", when(!blocks, "the certificate did not pass, so no block of this run is to be trusted"),
    "why figures are null");
}

struct BatchFigures {
  std::uint32_t batch = 1;
  std::uint64_t count = 0;
  double volume_m3 = 0;
  std::array<std::uint64_t, 4> modes{};  ///< falling, lifting, sliding, wedge
};
template <class V>
void fields(V& v, const BatchFigures& x) {
  v("batch", x.batch, "from 1");
  v("count", x.count);
  v("volume_m3", x.volume_m3);
  v("modes", group([&](auto& w) {
      w("falling", x.modes[0]);
      w("lifting", x.modes[1]);
      w("sliding", x.modes[2]);
      w("wedge", x.modes[3]);
    }));
}

/// Blocks that only a side of the domain that is not free holds.
struct DomainHeldFigures {
  std::uint64_t count = 0;
  Volume volume;
  double share = 0;
  std::uint64_t together = 0;  ///< of `count`: only together with others
};

/// Single blocks that reach their target only by what may not be there, at strengths over that for sliding; those of
/// groups, too, where groups decide.
struct HeldAtTarget {
  struct Kind {
    std::uint64_t count = 0;
    Volume volume = {};
  };
  Kind border;   ///< sides of the domain that are not free
  Kind tapered;  ///< a slight taper of joints
};

struct KeyBlockFigures {
  std::uint64_t count = 0;  ///< blocks that leave, in all batches
  double volume_m3 = 0;
  std::vector<BatchFigures> batches;
  bool stopped_at_max_batches = false;
  double lowest_factor_of_safety = std::numeric_limits<double>::infinity();  ///< of the blocks judged
  double equilibrium_residual = 0;
  std::optional<std::uint64_t> below_target = {};  ///< where the scene has a target
  std::optional<std::uint64_t> turning = {};       ///< none without the rotational check
  std::optional<DomainHeldFigures> domain_held = {};
  std::optional<HeldAtTarget> held_at_target = {};  ///< where the scene or its support has a target
};
template <class V>
void fields(V& v, const KeyBlockFigures& x) {
  v("count", x.count);
  v("volume_m3", x.volume_m3);
  v("batches", x.batches);
  v("stopped_at_max_batches", x.stopped_at_max_batches, "true when more batches may follow");
  v("lowest_factor_of_safety", or_null(x.lowest_factor_of_safety), "of all judged blocks; null when none is finite");
  v("lowest_factor_of_safety_reason",
    when(!std::isfinite(x.lowest_factor_of_safety), "no judged block has a finite factor"));
  v("equilibrium_residual", x.equilibrium_residual,
    "largest unbalanced force over the applied ones, with and without force transfer");
  v("below_target", x.below_target, "judged blocks below the scene's target");
  v("turning", x.turning, "judged blocks that no statics holds against turning, though they cannot slide");
  const DomainHeldFigures held = x.domain_held.value_or(DomainHeldFigures{});
  v("domain_held", when(x.domain_held.has_value(), held.count),
    "blocks at free faces that would move, were the sides of the domain that hold them smooth joints; not in count");
  v("domain_held_volume_m3", when(x.domain_held.has_value(), held.volume));
  v("domain_held_together", when(x.domain_held.has_value(), held.together),
    "of those, blocks that move only together with others");
  v("domain_held_share", when(x.domain_held.has_value(), held.share), "of the area of all free faces, theirs");
  const HeldAtTarget target = x.held_at_target.value_or(HeldAtTarget{});
  const bool asked = x.held_at_target.has_value();
  v("domain_held_at_target_count", when(asked, target.border.count),
    "blocks by themselves (with groups = \"decide\" those of groups, too) that reach the target for sliding, of the "
    "scene or its support, only by sides of the domain that are not free; not in below_target");
  v("domain_held_at_target_volume_m3", when(asked, target.border.volume));
  v("slight_taper_at_target_count", when(asked, target.tapered.count), "the same, only by a slight taper of joints");
  v("slight_taper_at_target_volume_m3", when(asked, target.tapered.volume));
}

/// All that leaves, alone or in groups that are not in doubt.
struct InAll {
  std::uint64_t count = 0;
  Volume volume = {};
};

/// Blocks judged together.
struct KeyGroupFigures {
  bool judged = false;
  std::uint64_t count = 0;
  double volume_m3 = 0;
  std::uint64_t certain = 0, unsafe = 0, in_doubt = 0;
  double factor = std::numeric_limits<double>::infinity();        ///< least of the groups that have one
  double least_factor = std::numeric_limits<double>::infinity();  ///< with moments, too
  /// Of the largest block of the largest group that has factors.
  std::optional<double> factor_of_largest = {};
  /// Groups that move at strengths over the target, where it was asked.
  std::optional<std::uint64_t> below_target = {};
  Volume below_target_volume = {};
  std::optional<stability::FactorTogether> together = {};  ///< where it was asked
  std::optional<InAll> in_all = {};                        ///< empty: not judged
};
template <class V>
void fields(V& v, const KeyGroupFigures& x) {
  v("judged", x.judged, "false: more blocks near free faces than are judged together, nothing was decided");
  v("count", x.count, "groups that move (certain) or may (unsafe)");
  v("volume_m3", x.volume_m3, "of those");
  v("certain", x.certain);
  v("unsafe", x.unsafe);
  v("in_doubt", x.in_doubt, "could not be decided; not in count");
  v("factor", or_null(x.factor), "least factor of safety of the groups; null without groups");
  v("factor_with_moments", when(std::isfinite(x.least_factor), x.least_factor),
    "the same with moments of what translation alone moves, too: the lesser of both of each group counts");
  v("factor_reason", when(!std::isfinite(x.factor), "no group has a finite factor"));
  v("factor_of_largest", x.factor_of_largest,
    "at which the largest block of the largest group with factors starts to move: the least factor may be that of a "
    "crumb");
  v("below_target", x.below_target,
    "groups that move at strengths over the scene's target for sliding; without support");
  v("below_target_volume_m3", when(x.below_target.has_value(), x.below_target_volume));
  const stability::FactorTogether factor = x.together.value_or(stability::FactorTogether{});
  const bool asked = x.together.has_value();
  v("stands_to", when(asked, factor.stands),
    "with `group_factor`: strengths over this nothing moves nor is in doubt, to 1 %; 0: below 0.1");
  v("moves_at", when(asked, or_null(factor.moves)),
    "with `group_factor`: strengths over this something moves, to 1 %; null: nothing does up to 10; 0: below 0.1");
  v("moves_at_reason", when(asked && !std::isfinite(factor.moves), "nothing moves at strengths over 10"));
  const InAll in_all = x.in_all.value_or(InAll{});
  v("in_all_count", when(x.in_all.has_value(), in_all.count),
    "key blocks and blocks of groups that move or may: all that moves, alone or together");
  v("in_all_volume_m3", when(x.in_all.has_value(), in_all.volume));
}
[[nodiscard]] KeyGroupFigures count_key_groups(const stability::KeyGroups& groups);
/// `found`: at strengths over the target.
void add_below_target(const stability::KeyGroups& found, KeyGroupFigures& figures);

/// Key blocks under one [[load]].
struct CaseFigures {
  std::string name;
  KeyBlockFigures figures;
  std::optional<KeyGroupFigures> groups = {};
};
template <class V>
void fields(V& v, const CaseFigures& x) {
  v("name", x.name);
  fields(v, x.figures);
  const KeyGroupFigures groups = x.groups.value_or(KeyGroupFigures{});
  v("key_groups", when(x.groups.has_value(), group([&](auto& w) { fields(w, groups); })),
    "blocks judged together under this load; absent with groups = \"off\"");
}

/// Blocks judged together with the support.
struct SupportedGroupFigures {
  std::uint64_t count = 0, not_held = 0, in_doubt = 0;
  Volume not_held_volume = {};
  /// What is in doubt is not held.
  [[nodiscard]] bool all_held() const noexcept { return not_held == 0 && in_doubt == 0; }
};
template <class V>
void fields(V& v, const SupportedGroupFigures& x) {
  v("count", x.count, "groups below their target without support, those in doubt counted");
  v("not_held", x.not_held, "that still move at their target with it");
  v("in_doubt", x.in_doubt,
    "of which that could not be decided, or within 5 %; blocks beyond those judged together, where a group reaches "
    "them, count as one");
  v("not_held_volume_m3", x.not_held_volume);
}
template <class V>
void supported_groups_field(V& v, const std::optional<SupportedGroupFigures>& x) {
  const SupportedGroupFigures groups = x.value_or(SupportedGroupFigures{});
  v("groups", when(x.has_value(), group([&](auto& w) { fields(w, groups); })),
    "Blocks judged together with the support; absent where they were not.");
}
[[nodiscard]] SupportedGroupFigures count_supported_groups(const stability::GroupSupport& groups);

/// What the search for a pattern found for one length of bolt.
struct DesignResult {
  double length = 0;
  bool found = false;
  double scale = 0;  ///< on the scene's spacings
  std::size_t bolts = 0;
  std::size_t spot_bolts = 0;  ///< beside them, where they count
  double cost = 0;
  /// Of the first pattern, m: along a tunnel's axis and around its section, or across and down a grid.
  std::array<double, 2> spacing{};
  std::optional<std::size_t> rings = {};  ///< of the first pattern; empty: a grid
  /// Offsets drawn at random in both directions, and how many of them fail.
  std::uint64_t offsets = 0, failing = 0;
  std::array<double, 2> failing_share{};  ///< Clopper-Pearson, 95 %
  /// The block that decides: misses its target at the most of these offsets; where none fails, with the least factor
  /// over target. Where no pattern is found, of the tightest one.
  std::optional<std::uint32_t> governing = {};
  Volume governing_volume = {};
  bool at_widest = false;  ///< the widest that `scale` lets the search try holds
  /// Blocks judged together at the spacing found, at the worst of the places tried; empty where they were not.
  std::optional<SupportedGroupFigures> groups = {};
};
template <class V>
void fields(V& v, const DesignResult& x) {
  v("length_m", x.length);
  v("found", x.found);
  v("spacing_scale", x.scale, "on the scene's spacings");
  v("bolts", x.bolts, "of the patterns");
  v("cost", x.cost, "of all bolts");
  v("spacing_m", x.spacing, "of the first pattern, of the tightest where none is found");
  v("rings", x.rings.value_or(0), "of the first pattern; 0: a grid");
  v("offsets", x.offsets, "drawn at random, at which the pattern was tried");
  v("offsets_failing", x.failing);
  v("failing_share_low", x.failing_share[0], "95 % interval of the share of offsets that fail");
  v("failing_share_high", x.failing_share[1]);
  v("governing_block", x.governing, "misses its target most often, or has the least margin");
  v("governing_volume_m3", when(x.governing.has_value(), x.governing_volume), "of that block");
  v("at_widest", x.at_widest, "true: the widest spacing that `scale` lets the search try holds, so it is no optimum");
  v("spot_bolts", x.spot_bolts, "beside the pattern, where `spot` counts them");
  supported_groups_field(v, x.groups);
}

/// Support pressure at one part of the openings: how the faces that the blocks below their target come out through
/// share it.
struct PressureFigures {
  std::string place;
  Area area = {};
  Stress p50 = {}, p90 = {}, p95 = {}, largest = {};
  Area opening_area = {};
};
template <class V>
void fields(V& v, const PressureFigures& x) {
  v("place", x.place, "roof, left wall, right wall, floor (looking along the tunnel), face elsewhere");
  v("area_m2", x.area,
    "faces there that blocks below their target come out through, each face at its own place; the shares are of this "
    "area; 0: nothing loads the place, and its pressures are 0");
  v("p50_pa", or_null(x.p50.si()), "half of `area_m2` needs no more; null: no pressure is enough");
  v("p90_pa", or_null(x.p90.si()));
  v("p95_pa", or_null(x.p95.si()));
  v("largest_pa", or_null(x.largest.si()), "of the neediest block, however small its face");
  v("reason", when(!std::isfinite(x.largest.si()), "no pressure is enough for a block there"));
  v("opening_area_m2", x.opening_area, "all walls of excavations there, loaded or not; 0 on the ground");
}

/// Whether groups of blocks were judged with the support.
enum class GroupsJudged : std::uint8_t {
  yes,
  not_asked,  ///< groups = "off"
  too_many    ///< more blocks near free faces than are judged together
};
/// Blocks that miss their target but for what may not be there: sides of the domain, joints that close on them by next
/// to nothing, what lies inside them. Nothing asks the support to hold them.
struct NotAsked {
  std::uint64_t count = 0;
  Volume volume = {};
  double lowest_factor_of_safety = std::numeric_limits<double>::infinity();  ///< without that, of those by themselves
};

struct SupportFigures {
  Targets targets = {};
  NotAsked not_asked = {};
  bool block_by_block = false;  ///< every block reaches its target, alone and stitched to its neighbours
  GroupsJudged groups_judged = GroupsJudged::not_asked;
  /// What could not be judged does not pass; what was not asked is left out.
  [[nodiscard]] bool passes() const noexcept {
    return block_by_block && turning_not_held == 0 && groups_judged != GroupsJudged::too_many &&
           (!groups || groups->all_held());
  }
  /// Only groups of blocks are below their target, so that forces and pressures of single blocks say nothing.
  [[nodiscard]] bool only_groups() const noexcept { return blocks == 0 && groups && groups->count > 0; }
  /// Infinite where these are of no use.
  [[nodiscard]] double of_blocks(double figure) const noexcept {
    return only_groups() ? std::numeric_limits<double>::infinity() : figure;
  }
  [[nodiscard]] std::string_view why_not(std::string_view reason) const noexcept {
    return only_groups() ? "only groups of blocks are below their target, and this is of single blocks" : reason;
  }
  std::uint64_t blocks = 0, held_by_bolts = 0, held_by_shotcrete = 0, held_by_both = 0, not_held = 0;
  std::uint64_t held_in_failing_groups = 0;  ///< held by themselves, in groups that are not held or in doubt
  std::uint64_t key_blocks_behind = 0;       ///< not among these
  /// Key blocks that only turn, not among these either, and those of them that nothing is known to hold.
  std::uint64_t turning = 0, turning_not_held = 0;
  std::uint64_t bolts = 0, spot_bolts = 0, bolts_used = 0, bolts_of_groups = 0, bolts_redundant = 0,
                bolts_too_short = 0;
  std::uint64_t combined = 0, combined_failing = 0;
  double required_force_n = 0, largest_required_pressure_pa = 0, missing_force_n = 0;
  /// Blocks with less free face than `spot_area`.
  std::uint64_t small_blocks = 0, small_not_held = 0;
  double small_required_force_n = 0;
  /// Blocks whose free faces cannot take what others pass to them.
  std::uint64_t passed_on_blocks = 0, passed_on_not_held = 0;
  double passed_on_required_force_n = 0;
  std::vector<PressureFigures> pressures = {};
  /// Groups of blocks below their target; empty where blocks were not judged together.
  std::optional<SupportedGroupFigures> groups = {};
  /// Stages of the excavation after which what is installed by then does not pass; empty without [sequence].
  std::optional<std::vector<std::uint32_t>> failing_stages = {};
};
/// The support under one named load case.
struct SupportCaseFigures {
  std::string name;
  SupportFigures figures;
};
template <class V>
void fields(V& v, const SupportCaseFigures& x) {
  v("name", x.name);
  v("passes", x.figures.passes());
  v("groups_judged", one_of(x.figures.groups_judged));
  v("blocks", x.figures.blocks);
  v("not_held", x.figures.not_held);
  v("target_falling", x.figures.targets.falling, "required factors of safety under this load");
  v("target_sliding", x.figures.targets.sliding);
  const double force = x.figures.of_blocks(x.figures.required_force_n);
  v("required_force_n", or_null(force), "as without load");
  v("required_force_reason", when(!std::isfinite(force), x.figures.why_not("no single force is enough for a block")));
  const double lack = x.figures.of_blocks(x.figures.missing_force_n);
  v("missing_force_n", or_null(lack), "as without load");
  v("missing_force_reason",
    when(!std::isfinite(lack), x.figures.why_not("no force is enough for a block that is not held")));
  v("turning_not_held", when(x.figures.turning > 0, x.figures.turning_not_held), "as without load");
  const double pressure = x.figures.of_blocks(x.figures.largest_required_pressure_pa);
  v("largest_required_pressure_pa", or_null(pressure), "as without load");
  v("largest_required_pressure_reason",
    when(!std::isfinite(pressure), x.figures.why_not("no pressure is enough at the neediest place")));
  v("combined_blocks", x.figures.combined);
  v("combined_failing", x.figures.combined_failing);
  supported_groups_field(v, x.figures.groups);
}
/// Names of the load cases that the support does not pass.
[[nodiscard]] std::vector<std::string> failing_cases(const std::vector<SupportCaseFigures>& cases);
/// Of a support that passes when all is excavated and without load, in words: "without load" and "under quake"; `fails`
/// is empty where it passes everywhere.
struct FailsElsewhere {
  std::string passes, fails;
};
[[nodiscard]] FailsElsewhere fails_elsewhere(const SupportFigures& support,
                                             const std::vector<SupportCaseFigures>& cases);
/// `tunnel_length`: empty where there is no tunnel.
template <class V>
void support_fields(V& v, const SupportFigures& x, std::optional<Length> tunnel_length,
                    const std::vector<DesignResult>& designs, const std::vector<SupportCaseFigures>& cases) {
  v("passes", x.passes(),
    "every block reaches its target, alone and stitched to its neighbours, and no group of blocks still moves or is in "
    "doubt; without `[[load]]`, when all is excavated");
  v("target_falling", x.targets.falling, "required factors of safety: of what falls or is lifted");
  v("target_sliding", x.targets.sliding, "and of what slides, or moves in a group");
  v("groups_judged", one_of(x.groups_judged),
    "not asked: with groups = \"off\", where `passes` is of single and stitched blocks alone; too many: near free "
    "faces, "
    "where nothing passes");
  v("passes_every_load", when(!cases.empty(), x.passes() && failing_cases(cases).empty()),
    "so it is without load and under each `[[load]]`");
  v("passes_every_stage",
    when(x.failing_stages.has_value(), x.passes() && x.failing_stages && x.failing_stages->empty()),
    "so it is when all is excavated and after each stage, with what is installed by then");
  v("blocks", x.blocks, "blocks that by themselves are below their target without support");
  v("not_asked", x.not_asked.count,
    "beside them: blocks, in all states that were judged, that only sides of the domain, a slight taper of joints or "
    "what lies inside them bring to their target: the support is not asked to hold them, see the notes");
  v("not_asked_volume_m3", x.not_asked.volume);
  v("not_asked_lowest_factor_of_safety",
    when(std::isfinite(x.not_asked.lowest_factor_of_safety), x.not_asked.lowest_factor_of_safety),
    "without those, of blocks by themselves");
  v("key_blocks_behind", x.key_blocks_behind,
    "beside them: key blocks that leave only after others have left, and so stay where those are held");
  v("turning", when(x.turning > 0, x.turning),
    "beside them: key blocks only because they turn (`rotation = \"decide\"`), of which translation says nothing");
  v("turning_not_held", when(x.turning > 0, x.turning_not_held),
    "of these, not held where blocks are judged together with moments, or not judged so: then nothing passes");
  v("held_by_bolts", x.held_by_bolts);
  v("held_by_shotcrete", x.held_by_shotcrete);
  v("held_by_both", x.held_by_both, "neither bolts nor shotcrete alone, both together");
  v("not_held", x.not_held);
  v("held_in_failing_groups", when(x.groups.has_value(), x.held_in_failing_groups),
    "of these that are held by themselves: blocks of groups that are not held or in doubt, where `passes` is false");
  v("bolts", x.bolts);
  v("spot_bolts", x.spot_bolts);
  v("bolts_used", x.bolts_used, "that a block, or a stitched body, does not do without");
  v("bolts_of_groups", x.bolts_of_groups,
    "beside them: that pull at a group of blocks below its target; whether it would do without was not asked");
  v("bolts_redundant", x.bolts_redundant);
  v("bolts_too_short", x.bolts_too_short);
  v("combined_blocks", x.combined);
  v("combined_failing", x.combined_failing);
  const double force = x.of_blocks(x.required_force_n), lack = x.of_blocks(x.missing_force_n);
  v("required_force_n", or_null(force),
    "sum over these blocks of the least single force, nothing for groups; null: none is enough, or only groups are "
    "below their target");
  v("required_force_reason", when(!std::isfinite(force), x.why_not("no single force is enough for a block")));
  v("required_force_n_per_metre",
    when(tunnel_length.has_value(), or_null(force / tunnel_length.value_or(metres(1)).si())), "of tunnel in the rock");
  const double pressure = x.of_blocks(x.largest_required_pressure_pa);
  v("largest_required_pressure_pa", or_null(pressure),
    "that 95 % of `area_m2` need at the neediest place of `pressures`, nothing for groups; null: none is enough, or "
    "only groups are below their target");
  v("largest_required_pressure_reason",
    when(!std::isfinite(pressure), x.why_not("no pressure is enough at the neediest place")));
  v("pressures", when_any(x.pressures),
    "pressure diagram of single blocks: by place, as percentiles of `area_m2`; groups are not in it");
  v("small_blocks", x.small_blocks, "with less free face than spot_area");
  v("small_not_held", x.small_not_held);
  v("small_required_force_n", or_null(x.small_required_force_n), "null: none is enough");
  v("small_required_force_reason",
    when(!std::isfinite(x.small_required_force_n), "no single force is enough for a block"));
  v("passed_on_blocks", x.passed_on_blocks,
    "whose free faces would need more than most_pressure for what others pass to them, and not without: hold the "
    "others. In `pressures` with what they need by themselves");
  v("passed_on_not_held", x.passed_on_not_held);
  v("passed_on_required_force_n", or_null(x.passed_on_required_force_n), "null: none is enough");
  v("passed_on_required_force_reason",
    when(!std::isfinite(x.passed_on_required_force_n), "no single force is enough for a block"));
  supported_groups_field(v, x.groups);
  v("missing_force_n", or_null(lack), "null: no force is enough, or only groups are below their target");
  v("missing_force_reason", when(!std::isfinite(lack), x.why_not("no force is enough for a block that is not held")));
  v("designs", when_any(designs), "[support.design]: what was found for each length");
  v("load_cases", when_any(cases), "the same check under each [[load]]");
}

/// Largest key blocks of block theory.
struct MaximumFigures {
  std::uint64_t count = 0;
  double largest_volume_m3 = 0;
  double lowest_factor_of_safety = std::numeric_limits<double>::infinity();
  double largest_required_pressure_pa = 0;
};
template <class V>
void fields(V& v, const MaximumFigures& x) {
  v("count", x.count);
  v("largest_volume_m3", x.largest_volume_m3);
  v("lowest_factor_of_safety", or_null(x.lowest_factor_of_safety));
  v("lowest_factor_of_safety_reason", when(!std::isfinite(x.lowest_factor_of_safety), "none of them can move"));
  v("largest_required_pressure_pa", or_null(x.largest_required_pressure_pa),
    "on the block's free face; null: none reaches the target");
  v("largest_required_pressure_reason",
    when(!std::isfinite(x.largest_required_pressure_pa), "no pressure brings one of them to its target"));
}

/// [micro_blocks] of the scene, where it does not keep silent about them.
struct MicroBlockFigures {
  MicroBlockPolicy policy = MicroBlockPolicy::report;
  std::uint64_t count = 0;
  double volume_m3 = 0;
  double thinnest_m = 0;
};
template <class V>
void fields(V& v, const MicroBlockFigures& x) {
  v("policy", one_of(x.policy == MicroBlockPolicy::report ? "report" : "exclude", {"report", "exclude"}),
    "exclude: left out of stability");
  v("count", x.count);
  v("volume_m3", x.volume_m3);
  v("thinnest_m", x.thinnest_m, "least thickness; 0 when there are none");
}

/// Everything that is counted of a run of blocks.
struct Figures {
  CutFigures input;
  std::optional<BlockFigures> blocks;  ///< none when the certificate did not pass
  std::optional<KeyBlockFigures> key_blocks;
  std::vector<CaseFigures> load_cases;         ///< of [[load]]
  std::optional<KeyGroupFigures> groups = {};  ///< of the base case
  /// Under which load most moves; "base" is that of [stability]. With load cases.
  std::optional<std::string> governing_case = {};
  std::optional<SupportFigures> support;
  std::vector<SupportCaseFigures> support_cases;  ///< of [[load]]
  std::optional<MaximumFigures> maximum_blocks;
  std::optional<MicroBlockFigures> micro_blocks;
};

/// Whether a judged block has less than its target.
[[nodiscard]] bool below(const stability::Judgement& judgement, const Targets& target);
[[nodiscard]] BlockFigures count_blocks(const topology::BlockComplex& complex, std::string hash);
[[nodiscard]] KeyBlockFigures count_key_blocks(const stability::Analysis& analysis,
                                               const std::optional<Targets>& target = {});
/// The pressure diagram of some blocks: pressure and area of each, by place.
struct PressureAt {
  std::string_view place;
  Area area;
  Stress pressure;
};
/// What a block asks of a lining, which presses on those that pass to it, too.
[[nodiscard]] Stress pressure_asked_at(const stability::SupportedBlock& block);
/// `walls`: areas of openings; a place with walls has a row where nothing loads it, too.
[[nodiscard]] std::vector<PressureFigures> pressure_diagram(std::vector<PressureAt> blocks,
                                                            std::span<const PressureAt> walls = {});
/// Pressure that this share of the blocks' area needs no more than; zero without area.
[[nodiscard]] Stress pressure_of_share(std::vector<PressureAt> blocks, double share);
/// Without the pressures, for which `count` needs the whole result.
[[nodiscard]] SupportFigures count_support(const stability::SupportResult& support);

struct RunResult;
/// A result that holds nothing, not even blocks: for the schema, and to be filled by hand in tests.
[[nodiscard]] RunResult empty_result();
/// Everything that is counted of a run that has ended.
[[nodiscard]] Figures count(const RunResult& result);

}  // namespace cleave::scene
