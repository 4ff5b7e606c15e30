#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <expected>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "cleave/core/id.hpp"
#include "cleave/core/quantity.hpp"
#include "cleave/dfn/joint_set.hpp"
#include "cleave/dfn/sample.hpp"
#include "cleave/facets/cut_input.hpp"
#include "cleave/geometry/solid.hpp"
#include "cleave/geometry/vec3.hpp"
#include "cleave/scene/output.hpp"
#include "cleave/scene/problem.hpp"
#include "cleave/scene/time_course.hpp"
#include "cleave/stability/actions.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/stability/key_groups.hpp"
#include "cleave/stability/support.hpp"
#include "cleave/stochastic/statistics.hpp"

/// A validated scene: what `scene::parse` makes of a TOML file and the files it names. Past this border nothing is
/// re-checked. Units: metres, degrees (in their own types), Pa, kg/m3, m/s2. Dip directions are already turned by
/// `north`, so they count clockwise from +y.
namespace cleave::scene {

using SetId = Id<struct JointSetTag>;  ///< a joint set by name; index into Scene::sets

/// Friction of the joints of one set, degrees in [0, 90): one value drawn per joint.
/// `mean` and `std` are those of the law before it is cut to [min, max].
struct FrictionLaw {
  enum class Kind : std::uint8_t { uniform, normal, lognormal, exponential, constant };
  Kind kind = Kind::constant;
  double mean = 30;  ///< constant: the value; not used by uniform
  double std = 0;    ///< normal, lognormal
  double min = 0;    ///< uniform: lower end; else what is below is cut off
  double max = 89;

  /// Inverse of the distribution function: larger u, larger friction. Precondition: 0 < u < 1.
  [[nodiscard]] FrictionAngle quantile(double u) const;
};

/// Cohesion or tension of the joints of one set, Pa: one value drawn per joint, by the same laws.
struct StressLaw {
  FrictionLaw::Kind kind = FrictionLaw::Kind::constant;
  double mean = 0, std = 0, min = 0, max = 1e15;
  [[nodiscard]] Stress quantile(double u) const;
};

/// A number drawn once a realization (a factor on the seismic coefficient), by the same laws.
struct NumberLaw {
  FrictionLaw::Kind kind = FrictionLaw::Kind::constant;
  double mean = 1, std = 0, min = 0, max = 1e3;
  [[nodiscard]] double quantile(double u) const;
};

/// Properties of the joints of one set ([joints.NAME], or [joints.default]).
struct JointProperties {
  FrictionLaw friction;
  StressLaw cohesion;
  StressLaw tension;
  /// Correlation of the normal scores of a joint's friction and cohesion (Gaussian copula), -1..1.
  double friction_cohesion = 0;
  std::optional<stability::Roughness> roughness = {};       ///< Barton-Bandis: `friction` is the residual angle
  std::optional<stability::JointStiffness> stiffness = {};  ///< for [field_stress]
  std::optional<NumberLaw> aperture = {};                   ///< m, for [flow]; one value a joint
};
/// A joint's strength from its properties: the straight law, or with a roughness the curved one, which has no cohesion.
[[nodiscard]] std::expected<stability::JointStrength, stability::StrengthError> joint_strength(
    FrictionAngle friction, Stress cohesion, Stress tension, const std::optional<stability::Roughness>& roughness);

struct NamedSet {
  std::string name;  ///< "default" for joints without a set
  JointProperties properties;
};

/// The strength that a joint states for itself (keys of [[joint]], CSV columns friction and cohesion).
struct OwnStrength {
  std::optional<FrictionAngle> friction;
  std::optional<Stress> cohesion;
  std::optional<Stress> tension = {};
};

/// A joint that is given, not drawn.
struct MeasuredJoint {
  std::variant<topology::Joint, topology::PersistentJoint> geometry;
  SetId set;
  OwnStrength own;
  std::string file;  ///< where it stands: a joint file or the scene file, as messages name it
  std::uint32_t line;
  std::string name = {};                  ///< for `ends_on` of others; may be empty
  std::vector<std::string> ends_on = {};  ///< names of the joints it ends on
};

/// A [[joint_set]]: joints drawn at random. Its number in Scene::joint_sets is the `set_index` of dfn::sample.
struct RandomSet {
  SetId set;
  dfn::JointSet law;
  std::uint32_t line;  ///< in the scene file
};

/// Where a tunnel's walls are, for bolt patterns.
struct TunnelLine {
  std::vector<geometry::Vec3> axis;
  geometry::Vec3 up;
  std::vector<std::array<double, 2>> outline;  ///< (u, v) in m, counter-clockwise
};

struct Excavation {
  std::string name;
  std::uint32_t stage = 1;
  geometry::Solid solid;
  std::vector<geometry::Vec3> axis;  ///< of a tunnel; else empty
  std::uint32_t line;                ///< in the scene file
  std::optional<TunnelLine> tunnel = {};
  /// What its walls are called: "slope" and "bench" of cuts from above, which reach as far as the domain; else "face".
  std::string_view wall = "face";
  [[nodiscard]] bool own_shape() const noexcept { return wall == "face"; }
};
/// Whether one lies in the rock: is no cut from above.
[[nodiscard]] inline bool has_own_opening(const std::vector<Excavation>& excavations) {
  return std::ranges::any_of(excavations, &Excavation::own_shape);
}

struct Rock {
  stability::RockMass mass = stability::RockMass::usual();
  std::optional<double> poisson = {};
};

/// What acts on the rock.
struct LoadSet {
  stability::Loads body = stability::Loads::usual();
  /// Joint pressures are those of the sets, by their number. The water table is at its median level.
  stability::Actions actions = {};
  std::optional<NumberLaw> water_level = {};  ///< m: of a table whose level is drawn once a realization
  std::optional<UnitWeight> flow = {};        ///< of water whose pressures [flow] finds, in place of other water
  std::uint32_t line = 1;                     ///< in the scene file
  /// No water at all.
  [[nodiscard]] bool dry() const noexcept { return actions.dry() && !flow; }
  /// Something beside weight may push upwards: without it no block moves off all its joints against gravity.
  [[nodiscard]] bool lifts() const noexcept {
    const stability::ActionSpec& spec = actions.spec();
    return !dry() || !spec.surcharges.empty() || !spec.points.empty() || !spec.lines.empty() ||
           geometry::dot(body.seismic(), body.gravity()) < 0;
  }
};

/// A [[load]]: the loads of [stability] and its own, judged apart.
/// Required factors of safety.
struct Targets {
  double falling = 1.5;  ///< also of lifting
  double sliding = 1.3;  ///< also of wedges
};

struct LoadCase {
  std::string name;
  LoadSet loads;
  std::optional<Targets> target = {};  ///< empty: that of [stability]
};

/// Largest key blocks of block theory (maximum_blocks of [stability]).
struct MaximumBlockSettings {
  std::uint32_t excavation = 0;  ///< of kind tunnel, straight, with a convex section
  std::vector<SetId> sets;       ///< three at least; empty: all that have joints
  /// Of every set: medians of its laws.
  IdVector<SetId, stability::JointStrength> medians;
  /// m: longest trace on the wall, largest extent of a joint face.
  double trace = std::numeric_limits<double>::infinity(), size = trace;
  std::uint32_t line = 1;  ///< in the scene file
};

struct StabilitySettings {
  LoadSet loads = {};                ///< of the base case
  std::vector<LoadCase> cases = {};  ///< in scene order
  stability::PartialFactors partial = {};
  bool force_transfer = true;
  stability::TransferReadings transfer = {};
  stability::RotationCheck rotation = stability::RotationCheck::flag;
  stability::GroupsCheck groups = stability::GroupsCheck::note;
  /// Blocks of groups that move are key blocks too.
  [[nodiscard]] bool decides_by_groups() const noexcept { return groups == stability::GroupsCheck::decide; }
  bool group_factor = false;  ///< the factor of all of them together is looked for
  std::optional<MaximumBlockSettings> maximum_blocks = {};
  std::uint32_t max_batches = 50;
  std::optional<Targets> target = {};
  bool strict = false;            ///< wedged slots (cone without interior) do not count as removable
  bool parallel_contact = false;  ///< cohesion on brushed faces too
  stability::GroupFriction group_friction = stability::GroupFriction::area_mean;
};
/// The choices of the scene that are the analysis's own: a new one is a member of both and a line here.
inline void hand_over(const StabilitySettings& scene, stability::Settings& analysis) {
  analysis.group_friction = scene.group_friction;
  analysis.strict = scene.strict;
  analysis.parallel_contact = scene.parallel_contact;
  analysis.force_transfer = scene.force_transfer;
  analysis.transfer = scene.transfer;
  analysis.max_batches = scene.max_batches;
  analysis.rotation = scene.rotation;
}

/// Search for spacing and length of the patterns (design of [support]).
struct DesignSettings {
  std::vector<double> lengths;         ///< m
  double tightest = 0.25, widest = 4;  ///< factors on the scene's spacings
  std::uint32_t phases = 4;            ///< offsets of the pattern that must all pass
  double cost_per_bolt = 0, cost_per_metre = 1;
  std::uint32_t offsets = 40;  ///< drawn at random, at which the pattern found is tried
  bool spot = false;           ///< spot bolts count too
};

struct SupportSettings {
  stability::SupportPlan plan;      ///< with all bolts of the patterns
  std::vector<std::string> groups;  ///< names, by group number
  std::vector<std::variant<stability::RingPattern, stability::GridPattern>> patterns;
  std::vector<stability::Bolt> single;  ///< given one by one
  std::optional<DesignSettings> design;
  std::uint32_t line = 1;
};

enum class MicroBlockPolicy : std::uint8_t {
  keep,    ///< as all others, and nothing is said
  report,  ///< as all others; counted
  exclude  ///< counted, and left out of stability: not judged, and holding nothing
};
/// [micro_blocks]: blocks thinner or smaller than a limit; without limits those thinner than 1e-6 of the domain
/// (topology::Block::sliver).
struct MicroBlocks {
  MicroBlockPolicy policy = MicroBlockPolicy::report;
  std::optional<Length> thickness;
  std::optional<Volume> volume;
};

/// [[scanline]]: a line or borehole through the rock whose joints are counted.
struct ScanLine {
  std::string name;
  std::vector<geometry::Vec3> points;  ///< a polyline with a length above 0
};

/// [monte_carlo]: many realizations instead of one run.
struct MonteCarloSettings {
  std::uint64_t realizations = 0;                   ///< fixed number, or the largest one of `stop`
  std::optional<stochastic::Stop> stop;             ///< empty: exactly `realizations`
  double confidence = 0.95;                         ///< of all intervals
  std::vector<double> volumes = {0.1, 1, 10, 100};  ///< m3: probabilities of a key block above each
  std::uint32_t chainage_parts = 20;                ///< along the axis of the first tunnel
  NumberLaw seismic_factor;                         ///< multiplies the seismic coefficient, drawn once a realization
  /// Nested design: realizations k with the same k / strengths_per_geometry have the same joints.
  std::uint64_t strengths_per_geometry = 1;
};

/// [field_stress]: stress of the rock around tunnels.
struct FieldStressSettings {
  std::vector<std::uint32_t> tunnels;  ///< excavations, straight tunnels, in their order
  std::array<double, 6> stress{};      ///< Pa at `level`: xx, yy, zz, xy, yz, zx; compression negative
  std::array<double, 6> gradient{};    ///< Pa per metre upwards
  double level = 0;                    ///< z, m
  std::optional<double> surface;       ///< z of the free ground surface; empty: infinite rock
  double poisson = 0.25;
  /// Normal over shear stiffness of the joints; empty: the least factor over a range of them.
  std::optional<double> stiffness_ratio;
  double tolerance = 1e-3;  ///< of displacements of the section, relative
  std::uint32_t line = 1;   ///< in the scene file
};

/// A face of the domain and what water finds there.
struct FlowSide {
  std::uint32_t tag;
  std::optional<Length> level;  ///< z; empty: closed
};
/// [flow]: which joints hang together, and steady flow of water in them.
struct FlowSettings {
  std::optional<Length> level = {};  ///< z, on fixed sides that are not named
  std::vector<FlowSide> sides = {};
  Transmissivity viscosity = Transmissivity::from_si(1.004e-6);  ///< kinematic
  double tolerance = 0.02;
  std::size_t most_triangles = 1'000'000;
  bool pflotran = false;   ///< the mesh is written for programs of two-point fluxes
  std::uint32_t line = 1;  ///< in the scene file
  /// Water stands somewhere.
  [[nodiscard]] bool flows() const {
    return level || std::ranges::any_of(sides, [](const FlowSide& side) { return side.level.has_value(); });
  }
};

/// A row of a table of traces or picks.
struct MappedRow {
  std::string file;  ///< as messages name it
  std::uint32_t line = 0;
  bool pick = false;
};
/// [mapped]: what has been seen of random joints.
struct MappedSettings {
  dfn::Mapping seen;
  std::vector<std::string> faces, holes;  ///< names
  /// Of `seen.joints`, in their order.
  struct Source {
    std::string name;             ///< the id of its rows, or file and line of the first
    std::vector<MappedRow> rows;  ///< in the order of the files
  };
  std::vector<Source> sources;
  std::vector<std::uint8_t> sets;  ///< by number in Scene::joint_sets: 1 where mapped
  std::uint32_t line = 1;          ///< in the scene file
};

/// Which blocks are let go.
enum class Release : std::uint8_t {
  batches,  ///< those of the batches of key blocks
  all,      ///< every block that no side of the domain holds
  groups,   ///< those of the batches and of key groups that move or may
  stage,    ///< those that leave in the stages of [sequence], one stage after the other
};
/// [motion]: blocks in motion.
struct MotionSettings {
  Release release = Release::batches;
  Time duration = Time::from_si(10);
  bool to_rest = false;  ///< ends when all are at rest, after `duration` at the latest
  Time step = Time::from_si(0.01);
  std::optional<Time> frame = {};  ///< between two written states; empty: a fiftieth of `duration`
  double restitution = 0;
  FrictionAngle surface_friction = FrictionAngle::degrees(35);  ///< of faces that are no joints
  bool support = true;                                          ///< bolts of [support] hold what they tie
  std::optional<TimeCourse<geometry::Vec3>> ground = {};        ///< m/s2, of all that is fixed; empty: at rest
  bool loads = true;               ///< water, surcharges, point and line forces of [stability] act
  bool seismic = false;            ///< its static seismic force acts all the time
  Length drains_at = metres(0.1);  ///< opening of a joint beyond which its water presses no more
  bool error = true;               ///< a second run with half the step
  std::uint32_t line = 1;          ///< in the scene file
};

/// What becomes of the blocks that leave in one stage before the next is excavated; with [support] always `put_back`.
enum class Fallen : std::uint8_t {
  stay_out,  ///< they have fallen: their room is void from then on
  put_back,  ///< they were held in place: the next stage finds them where they were
};

/// [sequence]: the excavations are taken out stage by stage.
struct SequenceSettings {
  Fallen fallen = Fallen::stay_out;
  /// Stage numbers of the excavations in ascending order, each once.
  std::vector<std::uint32_t> stages;
  /// Other orders of the same stages to compare with that one.
  std::vector<std::vector<std::uint32_t>> orders;
};

/// What a scene of blocks asks for, validated.
struct SceneContent {
  Length snap;
  double north = 0;  ///< degrees from y to true north, clockwise; only for display: orientations are turned already

  geometry::Solid domain;
  std::vector<std::uint32_t> free_domain_tags;      ///< tag indices of `domain` that are free
  IdVector<SetId, NamedSet> sets;                   ///< in order of first mention; [0] is "default"
  std::vector<MeasuredJoint> joints;                ///< in scene order; they get the first JointIds
  std::vector<topology::Termination> terminations;  ///< of measured joints
  bool keep_dangling = false;
  std::vector<RandomSet> joint_sets;  ///< in scene order; their joints follow
  std::optional<MappedSettings> mapped = {};
  Rock rock;
  std::vector<Excavation> excavations;  ///< in scene order
  std::vector<ScanLine> lines = {};     ///< in scene order
  std::optional<SupportSettings> support;
  std::optional<StabilitySettings> stability;  ///< empty: the scene has no [stability] and no free face
  std::optional<FieldStressSettings> field_stress;
  std::optional<SequenceSettings> sequence;  ///< empty: all excavations are of one stage
  std::optional<MotionSettings> motion = {};
  std::optional<FlowSettings> flow = {};
  MicroBlocks micro_blocks;
  std::optional<MonteCarloSettings> monte_carlo;
  std::vector<InputFile> files = {};
};

struct Scene : SceneHead, SceneContent {};

/// Text of a scene file to a validated scene, or all that is wrong with it (never empty). `shown` is how messages name
/// the scene file. Touches no file but through `read_file`.
[[nodiscard]] std::expected<Scene, std::vector<Problem>> parse(std::string_view text, const std::string& shown,
                                                               const ReadFile& read_file);

}  // namespace cleave::scene
