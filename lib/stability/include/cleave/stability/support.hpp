#pragma once

#include <array>
#include <cstdint>
#include <expected>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "cleave/stability/analyse.hpp"

namespace cleave::stability {

/// A bar in grout over its whole length.
struct GroutedBar {
  ForcePerLength bond = {};  ///< the weaker of grout-rock and grout-bar
  Force shear = {};          ///< across the bar
};
/// A tube that the rock clamps over its whole length (split set, Swellex): it slips at `bond`.
struct FrictionTube {
  ForcePerLength bond = {};
  Force shear = {};  ///< across the tube
};
/// Strands in grout, free in a sleeve behind the head; too flexible for shear.
struct Cable {
  ForcePerLength bond = {};
  Length free_length = {};  ///< from the collar
};
/// Held at its end over the anchorage (expansion shell, resin), free up to the plate. Loose in its hole: no shear.
struct MechanicalAnchor {
  Force capacity = {};  ///< of the whole anchor
};
using BoltKind = std::variant<GroutedBar, FrictionTube, Cable, MechanicalAnchor>;
/// By index of the variant.
inline constexpr std::array<std::string_view, 4> bolt_kind_names{"grouted", "friction", "cable", "mechanical"};

/// What of its capacity a bolt gives at the angle t between its axis and the movement, 0 in pure tension. Tension a T
/// and shear b V lie on the ellipse a^2 + b^2 = 1.
enum class AngleLaw : std::uint8_t {
  full,    ///< the pair that does the most work; without shear all of the tension whatever the angle
  cosine,  ///< a = cos t
  linear,  ///< a = 1 - t / 90 degrees
};

/// What a bolt can carry (Windsor and Thompson 1992): tendon, plate, and what its kind holds on both sides of a
/// section.
struct BoltType {
  Force tendon = {};
  Force plate = {};       ///< at the head
  Length anchorage = {};  ///< gripped for a block to count
  BoltKind kind = GroutedBar{};
  AngleLaw angle = AngleLaw::full;
  Length ductility = {};  ///< that it lengthens at its capacity before it breaks; the check does not ask for it
};

struct Bolt {
  geometry::Vec3 collar;     ///< m, on a free face
  geometry::Vec3 direction;  ///< unit, into the rock
  Length length = {};
  BoltType type;
  std::uint32_t group = 0;        ///< pattern it belongs to
  std::uint32_t after_stage = 0;  ///< of excavation: it is there in the next one
};

enum class BoltLimit : std::uint8_t { head, tendon, anchor, shear };
[[nodiscard]] std::string_view name(BoltLimit limit) noexcept;

/// How much of the bolt from `from` to `to` (m from its collar) its kind grips; m.
[[nodiscard]] double gripped_length(const BoltType& type, double length, double from, double to);
/// Whether `grip` metres are an anchorage.
[[nodiscard]] bool anchors(const BoltType& type, double grip);

/// Axial capacity at a section of a bolt that grips `before` metres on the collar's side of it and `behind` metres
/// beyond: the least of head (plate and grip), tendon and anchor; N.
struct Capacity {
  double force;
  BoltLimit limit;
};
[[nodiscard]] Capacity capacity(const BoltType& type, bool plate_on_block, double before, double behind);

/// What a bolt does against a movement: along its axis into the rock, and across it straight against the movement.
struct BoltForce {
  geometry::Vec3 force = {};  ///< N
  BoltLimit limit = BoltLimit::tendon;
};
/// `tension`: its axial capacity; a movement that shortens the bolt finds no tension. `dowel`: gripped on both sides
/// of the joint, so that its kind's shear counts. `movement` is a unit vector.
[[nodiscard]] BoltForce force_against(const Bolt& bolt, Capacity tension, bool dowel, geometry::Vec3 movement);

/// Ring shear along the edge of a small free face (Barrett and McCreath 1995), of those that the block moves out of.
struct Shotcrete {
  Length thickness = {};
  Stress shear_strength = {};
  std::optional<Stress> adhesion = {};  ///< where it limits what the layer holds
  Length bond_width = metres(0.03);
  std::vector<FreeSurface> on = {};  ///< where it is sprayed; empty: on the walls of all excavations
};

struct SpotBolts {
  BoltType type;
  Length length = {};
  std::uint32_t most = 20;  ///< per block
};

struct SupportPlan {
  std::vector<Bolt> bolts = {};
  std::optional<Shotcrete> shotcrete = {};
  std::optional<SpotBolts> spot = {};  ///< placed where all else fails on a face of `spot_area` or more
  std::vector<Bolt> placed = {};       ///< spot bolts that are there already
  double target_falling = 1.5;
  double target_sliding = 1.3;
  /// Bolts tensioned before the rock moves: they reduce the driving force (else they add to the resistance).
  bool active = false;
  Area spot_area = square_metres(0.5);  ///< of free face below which no spot bolts are placed
  Stress most_pressure = pascals(2e6);  ///< on free faces that support can give
  bool key_only = false;                ///< stitch only blocks that need support
  bool factors = true;                  ///< find each block's factor with the support: verdicts do without
};

/// Empty: the plan is sound.
[[nodiscard]] std::optional<std::string> problem_of(const SupportPlan& plan);

enum class BoltStatus : std::uint8_t {
  holds,        ///< serves a block, or holds a stitched body, that needs it
  group,        ///< no such block or body needs it, but it ties blocks of a group that needs support
  redundant,    ///< every block and body it serves reaches its target without it
  too_short,    ///< gripped less than the anchorage in the block or behind it
  compression,  ///< only crosses blocks that would push it together
  no_block,     ///< crosses no block that needs support
  off,          ///< its collar lies on no free face
};
[[nodiscard]] std::string_view name(BoltStatus status) noexcept;

struct Pierced {
  topology::BlockId block;
  double from, to;  ///< m from the collar
};

struct BoltResult {
  Bolt bolt;
  bool spot = false;
  std::vector<Pierced> pierced = {};
  Length outside = {};  ///< of that in the last block, beyond a side of the domain that is not free: rock, as it grips
  BoltStatus status = BoltStatus::no_block;
  std::optional<topology::BlockId> serves = {};  ///< the block that needs most of it; of a group's bolt one it pulls at
  BoltLimit limit = BoltLimit::tendon;
  double capacity = 0;  ///< N at the joint behind the block served, tension and shear
  double used = 0;      ///< N, mobilised share of it; of a group's bolt all of it: its share was not asked
  double angle = 0;     ///< degrees between its axis and the movement of the block served; 0: pure tension
  /// The combined body that it holds to the rock outside (index into `combined`), and the share of its capacity there
  /// that this takes, N. Of several bodies the one that takes most.
  std::optional<std::size_t> body = {};
  double body_used = 0;
};

/// One pull that a bolt carries, from the rock nearer its collar to rock farther in. Lengths are m from the collar.
struct BoltPull {
  std::optional<std::uint32_t> body, other;  ///< nearer the collar, and farther in; empty: rock that stays
  topology::BlockId block, behind;  ///< of theirs: where the bolt leaves the one and where it comes to the other
  double leaves = 0;                ///< where it leaves `block`
  double held = 0, anchored = 0;    ///< at the plate, else amid its grip; amid its grip farther in
  Force force = {};                 ///< along the axis
  BoltLimit limit = BoltLimit::tendon;
};
/// To which body a block belongs. Empty: it is not there any more; empty within: it stays.
using OwnerOf = std::function<std::optional<std::optional<std::uint32_t>>(topology::BlockId)>;
/// Pulls that plate, bond, anchor and tendon of a bolt carry all at once, whichever of the bodies move; none between
/// two blocks of one body. Bodies come before rock that stays and the outermost first, each first pulling at what lies
/// deepest: a bolt that cannot hold all of them holds what is outside.
[[nodiscard]] std::vector<BoltPull> pulls_of(const BoltResult& bolt, const OwnerOf& owner);
/// Share of its tension that counts by the bolt's angle law where what lies nearer the collar moves at `apart` against
/// what lies farther in. Empty: the law asks for a direction, and this movement is none that lengthens the bolt.
[[nodiscard]] std::optional<double> share_at_angle(const Bolt& bolt, geometry::Vec3 apart);

/// What brings a block to its target.
enum class Held : std::uint8_t {
  bolts,      ///< alone
  shotcrete,  ///< alone
  together,   ///< neither alone, both together
  not_held,
};
[[nodiscard]] std::string_view name(Held held) noexcept;

/// One block that misses its target without support, in the state after excavation, forces of later batches on it.
struct SupportedBlock {
  topology::BlockId block;
  Mode mode = Mode::stable;
  double target = 1;
  double net_force = 0;                              ///< N without support
  double factor_of_safety = 0;                       ///< without support
  double factor_with_bolts = 0;                      ///< bolts alone, fixed mode, passive or active form: a partial sum
  std::optional<double> factor_with_shotcrete = {};  ///< shotcrete alone, a partial sum; empty without shotcrete
  /// The factor of safety with everything: largest factor on all strengths and capacities at which some share of the
  /// bolts holds it. At least `target` exactly for blocks that are held. Empty where the plan asks for no factors.
  std::optional<double> factor_with_support = {};
  std::optional<double> mobilised = {};  ///< least share of the bolts that holds it; empty when no share does
  Mode mode_held = Mode::stable;         ///< at that share
  Held held = Held::not_held;
  std::uint32_t bolts = 0;  ///< that act on it
  Area free_area = {};
  bool small = false;                         ///< below the plan's `spot_area`
  std::vector<topology::FaceId> out_of = {};  ///< its open faces that it comes out through: a pressure acts on these
  geometry::Vec3 free_outward = {};        ///< mean of its free faces' outward normals by area; zero when they cancel
  double required_force = 0;               ///< N: least single force that reaches the target without other support
  geometry::Vec3 required_direction = {};  ///< unit, of that force
  double required_pressure = 0;            ///< Pa on the free faces it moves out of, for the target; inf when none does
  double received = 0;                     ///< N, what blocks of later batches pass to it
  double own_pressure = 0;                 ///< Pa, `required_pressure` without what it received
  /// Pa, `required_pressure` where the same pressure is on the blocks that pass to it: at what these need themselves
  /// they pass nothing on. Where that is beyond the plan's `most_pressure` too, and it is `passed_on`: `own_pressure`.
  double lining_pressure = 0;
  /// Its free faces cannot take what it received: the pressure is beyond the plan's `most_pressure`, its own is not.
  /// The blocks that pass it have to be held.
  bool passed_on = false;
  double missing_force = 0;  ///< N beyond all support, 0 when held
  /// m of shotcrete that would hold it alone; empty without shotcrete, and where none would: it has no edge against
  /// rock that stays, or the bond along it gives way first.
  std::optional<double> needed_thickness = {};
};

/// Blocks stitched together by bolts, tested as one body (step 2). Fixed blocks are never members: bolts that end in
/// them hold the body with what they can carry there.
struct CombinedBlock {
  std::vector<topology::BlockId> members = {};
  bool removable = false;
  Mode mode = Mode::stable;  ///< without bolts
  double target = 1;
  double net_force = 0;                            ///< N without bolts
  double factor_of_safety = 0;                     ///< without bolts
  std::uint32_t bolts = 0;                         ///< that hold it to rock outside
  double bolt_force = 0;                           ///< N, sum of what they can carry there
  std::optional<double> factor_with_support = {};  ///< with them; empty where the plan asks for no factors
  std::optional<double> mobilised = {};            ///< least share of them that holds it
  bool passes = true;
  double missing_force = 0;  ///< N beyond them
  double volume = 0;         ///< m3
};

/// A key block only because it turns: translation lets it stay at its target, and says nothing of what holds it.
struct OnlyTurns {
  topology::BlockId block;
  bool held = false;  ///< as blocks judged together with moments say (`judge_turning`); not asked: not held
};

struct SupportResult {
  std::vector<SupportedBlock> blocks = {};   ///< in order of id
  std::vector<OnlyTurns> turning = {};       ///< not among them, in order of id; `passes` leaves them out
  std::vector<BoltResult> bolts = {};        ///< plan order, then spot bolts: those placed already first
  std::vector<CombinedBlock> combined = {};  ///< two members and more, by lowest id
  std::size_t spot_bolts = 0;
  /// Blocks with bolts through them that only a side of the domain holds (`DomainHeld`), ascending. They count as rock
  /// that stays, as what lies beyond is unknown.
  std::vector<topology::BlockId> held_by_border = {};
  /// The same of blocks that shotcrete at the edges of others is held at.
  std::vector<topology::BlockId> sprayed_at_border = {};
  /// Blocks known in part only (topology::Block::truncated) that the check depends on: when there is one nothing else
  /// of the result holds, and a larger window is needed.
  std::vector<topology::BlockId> undecided = {};
  [[nodiscard]] bool passes() const noexcept;
  [[nodiscard]] bool holds_what_turns() const noexcept;
};

/// The spot bolts that a check of the plan placed beside those that were there.
[[nodiscard]] std::vector<Bolt> newly_placed(const SupportResult& result, const SupportPlan& plan);

/// Two-step check (Fu 2014, 4.4, with the mobilised share deciding): each block that misses its target with the bolts
/// through it, the rock behind fixed; then the blocks that bolts stitch together as one body, which must find hold in
/// what lies outside. Both must pass.
[[nodiscard]] SupportResult check_support(const topology::AuditedComplex& complex, const Settings& settings,
                                          const Analysis& analysis, const SupportPlan& plan);

// ---- Patterns of bolts ----------------------------------------------------------------------------------------------

/// Bolts in rings along a straight or bent axis. The outline is the section's, (u, v) in metres, counter-clockwise
/// looking along the axis with u to the right; the bolted arc is where its outward normal lies within `arc` degrees of
/// up (to the right positive).
struct RingPattern {
  std::vector<geometry::Vec3> axis;
  geometry::Vec3 up{0, 0, 1};
  std::vector<std::array<double, 2>> outline;
  std::array<double, 2> arc{-120, 120};
  Length along = metres(1), around = metres(1);
  Length offset_along = {}, offset_around = {};  ///< of the first ring and of the first bolt of a ring
  bool stagger = false;                          ///< every second ring half a spacing further round
  double inclination = 0;                        ///< degrees from the normal towards the axis's end
  Length length = metres(3);
  BoltType type;
  std::uint32_t group = 0, after_stage = 0;
};
/// A ring every `along` m, in each a bolt every `around` m of the arc: (floor((L - o)/along) + 1)
/// (floor((P - o)/around) + 1) bolts. Empty for spacings that are not > 0.
[[nodiscard]] std::vector<Bolt> bolts_of(const RingPattern& pattern);

/// Bolts on a grid in a plane: columns along strike, rows down dip, from `corner`.
struct GridPattern {
  geometry::Vec3 corner;
  geometry::Vec3 across, down;  ///< unit, in the plane
  Length width = {}, height = {};
  Length spacing_across = metres(1), spacing_down = metres(1);
  Length offset_across = {}, offset_down = {};
  bool stagger = false;
  geometry::Vec3 direction;  ///< unit, into the rock
  Length length = metres(3);
  BoltType type;
  std::uint32_t group = 0, after_stage = 0;
};
[[nodiscard]] std::vector<Bolt> bolts_of(const GridPattern& pattern);

/// How many bolts `bolts_of` makes, without making them: a spacing with a slip in it asks for more than memory holds.
/// Along a line no more than 1e9 are counted.
[[nodiscard]] std::uint64_t number_of_bolts(const RingPattern& pattern);
[[nodiscard]] std::uint64_t number_of_bolts(const GridPattern& pattern);

}  // namespace cleave::stability
