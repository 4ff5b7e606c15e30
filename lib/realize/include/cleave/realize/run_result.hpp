#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <expected>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "cleave/core/fields.hpp"
#include "cleave/core/id.hpp"
#include "cleave/core/quantity.hpp"
#include "cleave/facets/cut_input.hpp"
#include "cleave/geometry/vec3.hpp"
#include "cleave/motion/world.hpp"
#include "cleave/realize/figures.hpp"
#include "cleave/realize/flow_result.hpp"
#include "cleave/realize/sequence.hpp"
#include "cleave/scene/plan.hpp"
#include "cleave/scene3d/scene.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/stability/block_theory.hpp"
#include "cleave/stability/key_groups.hpp"
#include "cleave/stability/result.hpp"
#include "cleave/stability/support.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::scene {

/// A block that was let go.
struct MotionBlock {
  topology::BlockId block;
  bool moved = false;                         ///< its centroid by more than a millimetre
  std::optional<Time> first_motion = {};      ///< when it had moved so far
  Length fall = {}, runout = {};              ///< of the centroid: downwards, and level
  double fastest = 0;                         ///< speed of the centroid
  geometry::Vec3 centroid;                    ///< at the end, absolute
  Length front = {};                          ///< farthest that a corner came, level, at any time
  bool left = false;                          ///< left the domain and was followed no further
  double leaving_speed = 0;                   ///< of the centroid, as it left
  std::uint64_t bolts = 0, bolts_broken = 0;  ///< that tied it to other rock
  bool locked = false;                        ///< did not move, and may stand by forces locked between blocks alone
};

/// A bolt that tied a block that was let go to other rock.
struct MotionBolt {
  std::uint32_t bolt = 0;              ///< its place in SupportResult::bolts
  Force largest = {};                  ///< in any step, wherever it leaves a block
  Length lengthened = {};              ///< for good
  std::optional<Time> broken_at = {};  ///< end of the step in which it gave, between two blocks at least
};

/// Where the blocks are at one time, in the order of `MotionResult::blocks`.
struct MotionFrame {
  struct Place {
    geometry::Vec3 shift;  ///< of the centroid since the start
    motion::Turn turn;
    geometry::Vec3 velocity;
  };
  Time time;
  std::vector<Place> places;
};

/// A block, and rock that it presses against at an edge or a corner alone: the two share no face.
struct MotionTip {
  topology::BlockId block{0U}, rock{0U};
  friend auto operator<=>(const MotionTip&, const MotionTip&) = default;
};

/// What acted on blocks in motion beside gravity.
struct MotionLoads {
  std::uint64_t in_joints = 0;  ///< contacts of blocks in which water presses
  std::uint64_t drained = 0;    ///< of those, in which it does no more
  std::uint64_t on_faces = 0;   ///< surcharges, point and line forces, standing water: forces on free faces
  bool still_water = false;     ///< about all blocks, up to the table
  double work = 0;              ///< of all loads
};

struct MotionResult {
  bool converged = false;
  std::string stopped_why = {};  ///< when not
  bool refused = false;          ///< before the first step
  bool at_rest = false;
  Time end = {};
  std::uint64_t steps = 0, walls = 0, contacts = 0;
  std::uint64_t may_be_locked = 0;  ///< the most blocks at a time in groups for which the law may have another answer
  std::uint64_t rough_steps = 0;    ///< in which the best answer found did not meet the law to what is accepted
  double missed_speed = 0;          ///< largest by which a contact missed the law in those
  double residual = 0;
  Length penetration = {};
  double overlap = 0;  ///< over the size of the smaller block
  double potential_lost = 0, kinetic = 0, dissipated = 0, energy_error = 0, momentum_error = 0;
  double carried_out = 0;                     ///< kinetic energy of blocks as they left
  double lifted = 0;                          ///< brought in by parting overlaps and drawing ties to their length
  std::uint64_t key_blocks_standing = 0;      ///< key blocks and blocks of groups that move which did not move
  std::optional<double> work_of_ground = {};  ///< empty: the ground is at rest
  std::optional<MotionLoads> loads = {};      ///< empty: gravity alone
  std::optional<Length> error = {};           ///< estimate, by runs with half and twice the step
  std::optional<Time> determined = {};        ///< until then; chaotic impacts part the two runs after it
  std::vector<MotionBlock> blocks = {};
  std::vector<MotionBolt> bolts = {};  ///< that act; by number
  bool supported = false;              ///< the scene has bolts, and they are asked for
  std::vector<MotionFrame> frames = {};
  std::vector<MotionTip> at_tips = {};  ///< as blocks were let go, by block
  std::vector<std::string> notes = {};
  bool interrupted = false;  ///< `RunOptions::motion` said so
  std::string state = {};    ///< what a later run goes on from, see SavedRun

  [[nodiscard]] std::uint64_t moved() const noexcept;
  [[nodiscard]] std::uint64_t left() const noexcept;
  [[nodiscard]] std::uint64_t locked() const noexcept;  ///< blocks at the end
  [[nodiscard]] double fastest_left() const noexcept;
  [[nodiscard]] Length front_runout() const noexcept;
  [[nodiscard]] std::uint64_t bolts_broken() const noexcept;
  [[nodiscard]] Force largest_bolt_force() const noexcept;
};
/// File of a result that holds its `state`.
inline constexpr std::string_view motion_state_name = "motion.state";
template <class V>
void fields(V& v, const MotionResult& x) {
  v("status",
    one_of(x.refused           ? "refused"
           : !x.converged      ? "stopped"
           : x.rough_steps > 0 ? "rough"
                               : "converged",
           {"converged", "rough", "stopped", "refused"}),
    "refused: nothing ran, for the reason stated; rough: the run went on with the best answers found where none met "
    "the contact law to 1e-5 (rough_steps, "
    "residual); "
    "stopped: a step could not be solved so or without overlap, and the run ends there");
  v("reason", when(!x.converged, x.stopped_why));
  v("at_rest", x.at_rest);
  v("end_s", x.end);
  v("steps", x.steps);
  v("residual", x.residual, "of the contact law, the worst of all steps");
  v("rough_steps", x.rough_steps, "steps that went on with an answer between 1e-5 and 1e-3");
  v("missed_speed_m_s", x.missed_speed, "largest velocity by which a contact missed the law in those steps");
  v("max_penetration_m", x.penetration, "deepest overlap before bodies were parted, of all steps");
  v("max_overlap_relative", x.overlap, "deepest overlap left, over the size of the smaller block");
  v("may_be_locked", x.may_be_locked,
    "the most blocks at a time in groups that rest in one answer of the contact law and move in another, or may");
  v("released", x.blocks.size(), "blocks let go");
  v("walls", x.walls, "blocks that never move and may be touched");
  v("moved", x.moved(), "blocks whose centroid moved by more than a millimetre");
  v("key_blocks_standing", x.key_blocks_standing,
    "blocks with a factor of safety below 1, their own or that of their group, that were let go and did not move so "
    "far; not those that bolts tie. Their verdict stays: motion is no proof");
  v("standing_by_locked_forces", x.locked(),
    "blocks that were let go, stand at the end and would move in another answer of the contact law, or may: only "
    "forces "
    "locked between blocks are known to hold them. Do not count on them");
  v("left", x.left(), "blocks that left the domain and were followed no further");
  v("fastest_left_m_s", when(x.left() > 0, x.fastest_left()), "largest speed of a centroid as it left");
  v("front_runout_m", x.front_runout(), "farthest level way of any corner of a block from where it was, at any time");
  v("energy", group([&](auto& w) {
      w("potential_lost", x.potential_lost,
        "J; with lifted, work_of_ground and work_of_loads it is kinetic + dissipated + carried_out, to relative_error");
      w("kinetic", x.kinetic, "J, at the end");
      w("dissipated", x.dissipated, "J, by friction, impacts, bolts that yield and the scheme");
      w("carried_out", x.carried_out, "J, kinetic energy of blocks as they left the domain");
      w("lifted", x.lifted, "J, brought in by parting overlaps and drawing bolts to their length");
      w("work_of_ground", when(x.work_of_ground.has_value(), x.work_of_ground),
        "J, on the blocks as seen from the ground; absent where it is at rest");
      w("work_of_loads", when(x.loads.has_value(), x.loads ? x.loads->work : 0),
        "J, of water, surcharges, point and line forces; absent where none acts");
      w("relative_error", x.energy_error, "of the balance, over its largest term");
    }));
  v("loads",
    when(x.loads.has_value(), group([&](auto& w) {
           const MotionLoads loads = x.loads.value_or(MotionLoads{});
           w("in_joints", loads.in_joints, "contacts of two blocks in which water presses");
           w("drained", loads.drained, "of those, in which it does no more: they have opened, or slid apart");
           w("on_faces", loads.on_faces, "forces on free faces: surcharges, point and line forces, standing water");
           w("still_water", loads.still_water, "whether water stands about the blocks, too");
         })),
    "What acts beside gravity; absent where nothing does, and with motion.loads = false.");
  v("bolts", when(x.supported, group([&](auto& w) {
                    w("acting", x.bolts.size(), "that tie a block that is let go to other rock");
                    w("broken", x.bolts_broken());
                    w("largest_force_n", x.largest_bolt_force(), "in a bolt, in any step");
                  })),
    "Bolts of `[support]`; absent without, and with motion.support = false.");
  v("momentum_relative_error", x.momentum_error);
  v("estimated_error_m", or_null(x.error ? x.error->si() : std::numeric_limits<double>::infinity()),
    "of corners at any written time until determined_s, by runs with half and twice the step; null: error = false, or "
    "that with half the step stopped");
  v("estimated_error_reason", when(!x.error, "error = false, or the run with half the step stopped"));
  v("determined_s", x.determined, "time until which the two runs tell the same path: impacts are chaotic");
}

/// The blocks judged under one named load case.
struct CaseResult {
  std::string name;
  stability::Analysis analysis;
  std::optional<stability::KeyGroups> groups = {};       ///< blocks judged together, where the scene asks for it
  std::optional<stability::DomainHeld> held_alone = {};  ///< by the border of the domain, of blocks one by one
  std::optional<stability::DomainHeld> domain_held = {};
  std::vector<stability::Barred> tapered = {};                   ///< held by next to nothing
  std::optional<HeldAtTarget> held_at_target = {};               ///< where it has a target
  std::optional<stability::KeyGroups> groups_below_target = {};  ///< as those of the base case, at its own target
};

/// The support checked under one named load case.
struct CaseSupport {
  std::string name;
  stability::SupportResult support;
  std::optional<stability::GroupSupport> groups = {};  ///< where blocks are judged together
};

/// What became of a group in doubt when its blocks and those around it were let go as rigid blocks in motion.
enum class LetGo : std::uint8_t {
  stayed,    ///< none of its blocks moved by a millimetre
  moved,     ///< one did
  stopped,   ///< the contact law could not be solved
  not_tried  ///< more blocks or groups than are let go, or partial factors, which blocks in motion do not have
};
/// "stayed", "moved", "stopped", "not_tried".
[[nodiscard]] std::string_view name_of(LetGo outcome) noexcept;

/// A largest key block of block theory.
struct MaximumRow {
  std::array<std::string, 3> sets;  ///< names
  stability::MaximumKeyBlock block;
  std::string where;          ///< "roof", "floor", "right wall", "left wall" (looking along the axis)
  std::string position = {};  ///< of eight: "roof", "upper right", "right", "lower right", "floor", ...
};

enum class JointOrigin : std::uint8_t { measured, drawn };

/// A joint as it went into the cutter; its polygon(s) or plane are RunResult::input.joints[id.index()].
struct JointInfo {
  SetId set;
  JointOrigin origin;
  /// "joints.obj:120", "scene.toml:14"; for drawn joints "A #7" (set, number from 1), or "A seen 12" (a mapped one)
  std::string source;
  stability::JointStrength strength;
  geometry::Vec3 normal;  ///< upward unit normal (z >= 0); of the first polygon when the joint has several
  Dip dip;
  DipDirection dip_direction;           ///< clockwise from +y
  std::optional<Length> aperture = {};  ///< where the scene states one
};

struct SetInfo {
  std::string name;
  std::uint64_t joints = 0;
};

struct ExcavationInfo {
  std::string name;
  std::uint32_t stage = 1;
  std::optional<TunnelLine> tunnel = {};
  topology::ExcavatedVolume taken = {};
  /// Of its own volume, what lies outside the domain; empty for cuts from above, which are made to reach beyond it.
  std::optional<double> outside_share = {};
  std::string_view wall = "face";  ///< what its walls are called: "face", "slope" or "bench"
  /// What lies outside is no more than the ends of its axis, each by its width at most: made to come out there.
  bool ends_only_outside = false;
};

/// What micro-blocks hold.
struct HeldByCrumbs {
  struct Row {
    topology::BlockId block;  ///< of a group the first
    Volume volume = {};
    double factor_of_safety = 0;
    double alone = std::numeric_limits<double>::infinity();  ///< of a group: least of its blocks without crumbs
  };
  std::uint64_t crumbs = 0;
  Volume volume_of_crumbs = {};
  std::vector<Row> blocks = {};  ///< that move by themselves where these are left out, and not otherwise
  std::vector<Row> groups = {};  ///< key groups that have some among them or right beside them
};

/// Joint faces of a block on one plane.
struct ClampedPlane {
  topology::FaceId face;            ///< the first one
  Area area = {};                   ///< still in contact
  Force normal_force = {};          ///< of the field; compression positive
  geometry::Vec3 shear_force = {};  ///< N, of the field: of the rock outside on the block
};

/// A block of key_blocks.csv with the stress of the rock across its joints.
struct ClampedBlock {
  topology::BlockId block;
  /// Largest factor on all strengths at which normal and shear forces of its joints still balance its loads
  /// (stability/clamping.hpp).
  double factor_of_safety = 0;
  Force compression = {};  ///< sum over planes in compression
  Force tension = {};      ///< sum over planes in tension, >= 0: such joints open
  std::vector<ClampedPlane> planes = {};
};

struct FieldStressResult {
  std::vector<std::string> tunnels = {};
  std::size_t elements = 0;  ///< of all sections; the figures below are those of the worst one
  double error = 0;          ///< estimate, relative, of the section's displacements
  bool reached = true;
  double condition = 0, residual = 0;
  std::vector<ClampedBlock> blocks = {};  ///< in order of block; those that lie at a tunnel
  std::uint64_t undecided = 0;            ///< at a tunnel, and near another opening, a heading or the ground
  std::uint64_t held = 0;                 ///< unstable without, stable with the stress
  Volume held_volume = {};

  /// Infinite when no block has a finite one.
  [[nodiscard]] double lowest_factor_of_safety() const {
    double lowest = std::numeric_limits<double>::infinity();
    for (const ClampedBlock& block : blocks) lowest = std::min(lowest, block.factor_of_safety);
    return lowest;
  }
};
template <class V>
void fields(V& v, const FieldStressResult& x) {
  v("tunnels", x.tunnels);
  v("elements", x.elements);
  v("error", x.error, "estimate from two meshes, of displacement, relative");
  v("condition", x.condition);
  v("residual", x.residual);
  v("blocks", x.blocks.size(), "blocks at the tunnels that were judged");
  v("undecided", x.undecided,
    "blocks at the tunnels of which the section says nothing: another opening, a heading or the ground is nearer than "
    "two widths");
  v("held", x.held, "unstable without this stress, stable with it");
  v("held_m3", x.held_volume, "their volume");
  v("lowest_factor_of_safety", or_null(x.lowest_factor_of_safety()), "with it; null: none is finite");
  v("lowest_factor_of_safety_reason",
    when(!std::isfinite(x.lowest_factor_of_safety()), x.undecided > 0
                                                          ? "no block at the tunnel slides of which the stress is known"
                                                          : "no block at the tunnel slides"));
}

/// A joint that was mapped, and the one that was drawn for it.
struct MappedJointResult {
  std::string source;  ///< the id of its rows, or file and line
  topology::JointId joint = topology::JointId{0U};
  std::string set;
  bool set_known = false;
  std::vector<std::string> rows = {};  ///< "traces.csv:12"
  std::uint64_t traces = 0, picks = 0;
  Length misfit = {};  ///< infinite: it misses a pick, or goes through a hole that shows nothing there
  bool honours = false;
  Dip dip = {};
  DipDirection dip_direction = {};  ///< clockwise from +y
  geometry::Vec3 centre = {};       ///< m
};
template <class V>
void fields(V& v, const MappedJointResult& x) {
  v("source", x.source, "`joint` of its rows, or file and line of the first");
  v("joint", x.joint, "number of the joint that was drawn for it, from 0");
  v("set", x.set);
  v("set_known", x.set_known, "0: the rows name no set, and it was drawn among those mapped");
  v("rows", x.rows, "files and lines, joined by `;`");
  v("traces", x.traces);
  v("picks", x.picks);
  v("misfit_m", x.misfit,
    "the farthest that an end of a trace or a pick lies from what was mapped, or the longest trace that was not; inf: "
    "it misses a pick, or goes through a hole that shows nothing there");
  v("honours", x.honours, "1: no more than mapped.error, and the set has joints that would be seen so");
  v("dip", x.dip.degrees(), "degrees");
  v("dip_direction", x.dip_direction.degrees(), "degrees clockwise from the y axis");
  v("x_m", x.centre.x, "centre of the joint");
  v("y_m", x.centre.y);
  v("z_m", x.centre.z);
}

/// What [mapped] came to in one realization.
struct MappedResult {
  std::uint64_t faces = 0, holes = 0;
  std::vector<MappedJointResult> joints = {};  ///< in the order of MappedSettings::seen
  std::uint64_t taken_out = 0;                 ///< random joints that would have been seen

  [[nodiscard]] std::uint64_t honoured() const {
    return static_cast<std::uint64_t>(std::ranges::count_if(joints, &MappedJointResult::honours));
  }
  /// Zero without joints.
  [[nodiscard]] Length largest_misfit() const {
    Length largest;
    for (const MappedJointResult& joint : joints) largest = std::max(largest, joint.misfit);
    return largest;
  }
};
template <class V>
void fields(V& v, const MappedResult& x) {
  v("faces", x.faces);
  v("holes", x.holes);
  v("joints", x.joints.size(), "that were mapped, each with all its traces and picks");
  v("honoured", x.honoured(),
    "of them: the joint that was drawn shows what was mapped, within mapped.error, and by the laws of its set");
  v("not_honoured", x.joints.size() - x.honoured());
  v("largest_misfit_m", or_null(x.largest_misfit().si()), "see mapped_joints.csv; null: a pick was missed");
  v("largest_misfit_reason",
    when(!std::isfinite(x.largest_misfit().si()), "a joint misses a pick, or shows one too many"));
  v("random_joints_taken_out", x.taken_out, "drawn as if nothing had been seen, they would have been seen");
}

/// Everything that goes into the cutter, and what each joint is.
struct SampledScene {
  topology::CutInput input;                             ///< domain, joints and excavations as cut
  IdVector<SetId, SetInfo> sets = {};                   ///< only sets with at least one joint have `joints` > 0
  IdVector<topology::JointId, JointInfo> joints = {};   ///< as many as input.joints, same order
  double seismic_factor = 1;                            ///< of this realization
  double water_quantile = 0.5;                          ///< of this realization: u of the laws of water tables
  std::optional<stability::FlowWater> flow_water = {};  ///< that [flow] found, where loads ask for it
  std::optional<MappedResult> mapped = {};              ///< where the scene has [mapped]
};

/// What one realization of a scene came to: the blocks and all that was judged of them.
/// - `complex` holds the audited block system, or the certificate when it did not pass: then nothing is judged;
/// - free faces of the complex index the scene's excavations by topology::Face::excavation; faces of role joint index
///   `joints` by their JointId.
struct Realization : SampledScene {
  std::expected<topology::AuditedComplex, topology::Certificate> complex = std::unexpected(topology::Certificate{});
  topology::CutReport cut = {};
  std::string block_hash = {};  ///< topology::canonical_hash; empty when the certificate failed
  /// The same of the blocks of all batches: equal whether all the rock was cut or only that near free faces; empty
  /// without analysis.
  std::string key_block_hash = {};
  std::optional<WindowInfo> window = {};  ///< when not all the rock was cut
  std::optional<stability::Analysis> analysis = {};
  /// Stage by stage, where excavations have different stages; `complex` and `analysis` then are those of the rock when
  /// all are out and no block has left before.
  std::optional<SequenceResult> sequence = {};
  std::optional<stability::KeyGroups> key_groups = {};  ///< blocks judged together, where the scene asks for it
  /// At strengths over the scene's target for sliding; empty where the scene has none, or a support that asks for it.
  std::optional<stability::KeyGroups> groups_below_target = {};
  std::optional<stability::FactorTogether> group_factor = {};  ///< where the scene asks for it
  std::vector<std::optional<LetGo>> let_go = {};  ///< of `key_groups`, those in doubt; empty: none was asked
  std::vector<stability::InterlockedByInclusion> held_from_within = {};
  std::optional<HeldByCrumbs> held_by_crumbs = {};        ///< where micro-blocks are counted, not left out
  std::vector<stability::Barred> barred = {};             ///< where blocks were not judged together
  std::vector<stability::Barred> tapered = {};            ///< held by next to nothing, those of key groups too
  std::optional<stability::DomainHeld> domain_held = {};  ///< of the base case, with `analysis`
  std::optional<stability::DomainHeld> held_alone = {};   ///< of those, single blocks: what ensembles count
  std::optional<HeldAtTarget> held_at_target = {};        ///< where the scene or its support has a target
  std::vector<CaseResult> load_cases = {};                ///< of [[load]], in scene order; the base case is `analysis`
  std::vector<stability::Sensitivity> sensitivity = {};   ///< of the blocks of the first batch
  std::vector<MaximumRow> maximum_blocks = {};
  /// In all states, where a target is asked of blocks.
  NotAsked not_asked = {};
  std::optional<stability::SupportResult> support = {};
  /// Spot bolts of the stages, each put in after the first that needs it.
  std::vector<stability::Bolt> spot_bolts_of_stages = {};
  std::vector<CaseSupport> support_cases = {};  ///< of [[load]], in scene order
  /// Of the base case, where blocks are judged together; those of load cases are in `support_cases`.
  std::optional<stability::GroupSupport> group_support = {};
  std::vector<DesignResult> designs = {};
  /// Where the scene has [field_stress] and something is judged.
  std::optional<FieldStressResult> field_stress = {};
  /// Where the scene has [motion] and something is judged.
  std::optional<MotionResult> motion = {};
  /// Where the scene has [flow].
  std::optional<FlowResult> flow = {};
  /// Blocks cut by a window that cases or support depend on: then none of it holds, and a larger window is needed.
  std::vector<topology::BlockId> undecided = {};

  [[nodiscard]] const topology::Certificate& certificate() const noexcept {
    return complex ? complex->certificate() : complex.error();
  }
};

/// Everything that is known at the end of `scene::run`, and all that the writers need: they take it by const reference
/// and compute nothing but layout from it. `analysis` is present exactly when plan.runs(Step::stability) and the
/// certificate passed; sections of stages that did not run are absent from summary.json. `cost` covers read ..
/// elastic when `run` returns. The program adds `write` (VTU, CSV) and `report` (HTML) as it does them, and writes
/// summary.json last, so that all costs are in it but its own few milliseconds; report.html shows the costs known when
/// it is written.
struct RunResult : Realization, ResultHead {
  std::vector<InputFile> files = {};
  double north =
      0;  ///< degrees from +y to true north, clockwise: add nothing to dip directions, turn only the north arrow

  Rock rock = {};
  std::optional<StabilitySettings> stability = {};
  std::vector<ExcavationInfo> excavations = {};  ///< as many as input.excavations, same order
  MicroBlocks micro_blocks = {};                 ///< the scene's policy
  std::vector<std::string> bolt_groups = {};     ///< names, by Bolt::group
  std::optional<Length> tunnel_length = {};      ///< in the rock, of all tunnels; empty: there is none

  Figures figures = {};  ///< `count` of all that
};

template <class V>
void fields(V& v, const RunResult& x) {
  const Figures& f = x.figures;
  v("input", f.input);
  v("blocks", group([&](auto& w) { block_fields(w, f.blocks, x.certificate(), x.window); }),
    "When the certificate did not pass, the figures of the blocks are null and `reason` says so.");
  const KeyBlockFigures& key = f.key_blocks ? *f.key_blocks : KeyBlockFigures{};
  v("key_blocks", when(f.key_blocks.has_value(), group([&](auto& w) {
                         fields(w, key);
                         w("hash", x.key_block_hash,
                           "of the blocks of all batches: the same whether all the rock was cut or only that near "
                           "free faces");
                         w("governing_case", f.governing_case,
                           "the load case under which most volume moves, alone or together; of equal ones that with "
                           "the lowest factor of safety, then the first; `base`: the loads of [stability] alone; "
                           "absent without [[load]]");
                         w("load_cases", when_any(f.load_cases), "under each [[load]]");
                       })),
    "Blocks that leave.");
  const KeyGroupFigures groups = f.groups.value_or(KeyGroupFigures{});
  v("key_groups", when(f.groups.has_value(), group([&](auto& w) { fields(w, groups); })),
    "Blocks judged together; absent with groups = \"off\".");
  const SupportFigures& support = f.support ? *f.support : SupportFigures{};
  v("support", when(f.support.has_value(), group([&](auto& w) {
                      support_fields(w, support, x.tunnel_length, x.designs, f.support_cases);
                    })),
    "Check of [support] in the state after excavation; forces in N, pressures in Pa.");
  v("field_stress", x.field_stress,
    "Key blocks at a tunnel with the stress of the rock across their joints ([field_stress]); error, condition and "
    "residual are those of the elastic section.");
  v("motion", x.motion, "Blocks in motion ([motion]).");
  v("mapped", x.mapped, "Random joints that honour what has been seen ([mapped]).");
  v("flow", x.flow, "Which joints hang together, and steady flow of water in them ([flow]); rates in m3/s.");
  v("maximum_blocks", f.maximum_blocks,
    "Largest key blocks that persistent joints of the sets' mean orientations can make at a tunnel "
    "(stability.maximum_blocks).");
  v("micro_blocks", f.micro_blocks,
    "Blocks below the limits of [micro_blocks], or thinner than 1e-6 of the domain; absent with policy = \"keep\".");
  const topology::Dangling none{};
  const topology::Dangling* kept =
      x.complex && x.complex->complex().dangling() ? &*x.complex->complex().dangling() : nullptr;
  const topology::Dangling& d = kept != nullptr ? *kept : none;
  v("dangling", when(kept != nullptr, group([&](auto& w) {
                       w("pieces", d.pieces.size(), "flat parts, each inside one block");
                       w("area_m2", d.area);
                       w("free_edges", d.free_edges, "edges that end in the rock");
                       w("free_edge_length_m", d.free_edge_length);
                       w("joints", d.joints, "joints with such parts");
                       w("isolated_joints", d.isolated_joints, "of them those that meet no other joint and no face");
                     })),
    "Parts of joints that bound no block, with keep_dangling = true.");
  v("sequence", x.sequence, "Excavation in stages: the rock after each, and the orders that were compared.");
}

}  // namespace cleave::scene
