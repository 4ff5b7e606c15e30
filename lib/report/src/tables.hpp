#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/core/fields.hpp"
#include "cleave/realize/places.hpp"
#include "cleave/realize/run_result.hpp"

/// Rows of the tables a run of blocks writes, each column once.
namespace cleave::report {

/// What the tables have by the analysis of a run.
struct TableParts {
  bool force_transfer = false, rotation = false, support = false, field_stress = false;
};
inline constexpr TableParts all_parts{.force_transfer = true, .rotation = true, .support = true, .field_stress = true};
/// `result` has an analysis.
[[nodiscard]] inline TableParts parts_of(const scene::RunResult& result) {
  return {.force_transfer = result.analysis->force_transfer,
          .rotation = result.analysis->rotation != stability::RotationCheck::off,
          .support = result.support.has_value(),
          .field_stress = result.field_stress.has_value()};
}

struct KeyBlockRow {
  const stability::Judgement& j;
  double volume_m3 = 0;
  std::size_t faces = 0;
  std::vector<topology::JointId> joints = {};
  TableParts parts = {};
  const stability::SupportedBlock* supported = nullptr;
  std::optional<std::string_view> group_supported = {};  ///< "held", ...: of its group below the target
  const scene::ClampedBlock* clamped = nullptr;
  scene::BlockPlace place = {};
  std::vector<std::string> sets = {};
};

/// `result` has an analysis.
[[nodiscard]] KeyBlockRow key_block_row(const topology::BlockComplex& complex, const scene::RunResult& result,
                                        const stability::Judgement& j);

template <class V>
void direction_fields(V& v, const geometry::Vec3& d, std::string_view x, std::string_view y, std::string_view z) {
  v(x, d.x);
  v(y, d.y);
  v(z, d.z);
}

/// The block with the forces that later batches pass to it; one that nothing was passed to keeps its values.
template <class V>
void transferred_fields(V& v, const stability::Judgement& j) {
  const stability::Transferred t =
      j.transferred.value_or(stability::Transferred{.mode = j.mode,
                                                    .key = j.key,
                                                    .direction = j.direction,
                                                    .driving = j.driving,
                                                    .resistance = j.resistance,
                                                    .net = j.net,
                                                    .factor_of_safety = j.factor_of_safety});
  v("key_transferred", t.key,
    "the same block with the forces that later batches pass to it; one that nothing is passed to repeats its values");
  v("mode_transferred", name(t.mode));
  direction_fields(v, t.direction, "direction_x_transferred", "direction_y_transferred", "direction_z_transferred");
  v("net_force_n_transferred", t.net);
  v("factor_of_safety_transferred", t.factor_of_safety);
  v("passed_n_transferred", t.passed, "what the block passes on");
  v("untransferred_n", t.lost, "what of it the scene's reading of the transfer loses");
  v("lost_n_transferred", t.lost, "old name of `untransferred_n`; goes with the next version");
}

/// What support leaves of a group: the worst verdict on its blocks with it; empty: none moves.
[[nodiscard]] constexpr std::string_view held_word(std::optional<assembly::Verdict> left) {
  return !left ? "held" : *left == assembly::Verdict::in_doubt ? "in_doubt" : "not_held";
}

template <class V>
void supported_fields(V& v, const stability::Judgement& j, const stability::SupportedBlock* b,
                      std::optional<std::string_view> group) {
  // Of a later batch: it stays when the first one is held. Otherwise it needs nothing by itself.
  const bool turns = b == nullptr && !group && j.batch && *j.batch == 1 && j.rotation && j.rotation->turns;
  const std::string_view held = b != nullptr              ? name(b->held)
                                : group                   ? "see its group"
                                : turns                   ? "not judged"
                                : j.batch && *j.batch > 1 ? "held by earlier batches"
                                                          : "none needed";
  const std::optional<double> factor = b == nullptr ? std::optional{j.factor_of_safety} : b->factor_with_support;
  const stability::SupportedBlock none{.block = topology::BlockId{0U}};
  const stability::SupportedBlock& s = b != nullptr ? *b : none;
  v("held_by_supported", held,
    "`[support]`: what holds the block by itself; `not judged`: a key block that only turns, of which translation says "
    "nothing");
  v("group_supported", group,
    "its group of blocks, where that is below its target: `held`, `not_held` or `in_doubt`; empty: in none, or groups "
    "were not judged");
  v("bolts_supported", s.bolts, "how many bolts");
  v("mobilised_share_supported", s.mobilised, "share of their capacity that the target takes; empty where none does");
  v("factor_of_safety_supported", when(b != nullptr || (!group && !turns), factor),
    "with all support: at the target exactly where the block is held");
  v("missing_force_n_supported", s.missing_force, "what the block lacks to its target");
  v("required_force_n_supported", s.required_force, "least single force that gives the target");
  v("required_pressure_pa_supported", s.required_pressure, "the same as a pressure on its free faces");
}

template <class V>
void clamped_fields(V& v, const scene::ClampedBlock* clamped) {
  using C = scene::ClampedBlock;
  const auto of = [&](auto figure) { return clamped != nullptr ? std::optional{clamped->*figure} : std::nullopt; };
  const auto factor = of(&C::factor_of_safety);
  v("key_clamped", factor ? std::optional{*factor < 1} : std::nullopt,
    "`[field_stress]`: the same motion with the stress of the rock across the block's joints; empty for blocks that "
    "are "
    "not at the tunnel");
  v("factor_of_safety_clamped", factor);
  v("compression_n_clamped", of(&C::compression), "sum over planes");
  v("tension_n_clamped", of(&C::tension), "sum over planes; counted as no stress");
}

/// "10:30": to half an hour.
[[nodiscard]] std::string clock_text(double hours);

template <class V>
void place_fields(V& v, const scene::BlockPlace& place, const std::vector<std::string>& sets) {
  v("x_m", place.centroid.x, "centroid of the block");
  v("y_m", place.centroid.y);
  v("z_m", place.centroid.z);
  v("location", place.location,
    "`roof`, `floor`, `left wall`, `right wall` of a tunnel (looking along its axis); `north wall`, `east wall`, "
    "`south wall`, `west wall` of a shaft (an axis that plunges 70 degrees or more). Elsewhere `slope`, `bench`: of an "
    "excavation of that kind; `crest`: of a block with level ground above such a face; `floor`: level ground that is "
    "cut, `ground`: that is a side of the domain (dips below 10 degrees); `roof`: it overhangs by more than 45 "
    "degrees; `face`: a tunnel's heading and any other free face");
  v("chainage_m", place.chainage, "along the tunnel's axis; empty where there is no tunnel");
  v("free_area_m2", place.free_area, "of the block's free faces");
  v("sets", sets, "joint sets that bound the block, joined by `;`");
  v("clock", place.clock ? std::optional{clock_text(*place.clock)} : std::nullopt,
    "on the face of a clock to half an hour, looking along the tunnel's axis: `12:00` at the crown, `3:00` on the "
    "right");
  v("depth_m", place.depth,
    "how far it reaches into the rock: of the points at which it meets other rock the one farthest from its free faces "
    "(to 0.1 %); empty without a free face");
  v("extent_m", place.extent, "between the two corners that are farthest apart");
}

template <class V>
void fields(V& v, const KeyBlockRow& x) {
  v("block", x.j.block, "number from 0, as in `blocks.vtu`");
  v("batch", x.j.batch, "when it leaves, from 1; empty for a block that stays");
  v("key", x.j.key, "1 when unstable");
  v("mode", name(x.j.mode),
    "`falling`, `lifting`, `sliding`, `wedge`; `stable`, `tapered`: not by itself, but with its group, or it topples");
  v("volume_m3", x.volume_m3);
  v("weight_n", x.j.weight);
  v("direction_x", x.j.direction.x, "unit vector of first motion");
  v("direction_y", x.j.direction.y);
  v("direction_z", x.j.direction.z);
  v("net_force_n", x.j.net,
    "driving force less resistance: positive when unstable; of a block that moves only in its group what is out of "
    "balance, mass times acceleration");
  v("factor_of_safety", x.j.factor_of_safety,
    "`inf` when nothing drives the block; of a block that moves only in its group that of the group, 1 where it is too "
    "large for factors");
  v("faces", x.faces, "how many faces the block has");
  v("joints", x.joints, "numbers of the joints it touches, joined by `;`");
  if (x.parts.force_transfer) transferred_fields(v, x.j);
  if (x.parts.rotation) {
    const std::optional<bool> topples = x.j.rotation ? std::optional{x.j.rotation->turns} : std::nullopt;
    v("topples", topples,
      "rotational check: 1 when no forces at its contacts hold the block against turning, and with rotation = "
      "\"decide\" when a search finds that it turns from rest though some would; else 0; empty for a block that "
      "translation moves");
    v("turns", topples, "old name of `topples`; goes with the next version");
  }
  if (x.parts.support) supported_fields(v, x.j, x.supported, x.group_supported);
  if (x.parts.field_stress) clamped_fields(v, x.clamped);
  place_fields(v, x.place, x.sets);
}

struct LoadCaseRow {
  std::string_view load;
  const stability::Judgement& j;
  double volume_m3 = 0;
  scene::BlockPlace place = {};
  std::vector<std::string> sets = {};
};
template <class V>
void fields(V& v, const LoadCaseRow& x) {
  v("case", x.load, "name of the [[load]]; `base` without one");
  v("block", x.j.block);
  v("batch", x.j.batch);
  v("key", x.j.key);
  v("mode", name(x.j.mode));
  v("volume_m3", x.volume_m3);
  direction_fields(v, x.j.direction, "direction_x", "direction_y", "direction_z");
  v("net_force_n", x.j.net);
  v("factor_of_safety", x.j.factor_of_safety);
  place_fields(v, x.place, x.sets);
}

/// A block that only a side of the domain holds.
struct BorderBlockRow {
  std::string_view load;
  topology::BlockId block;
  const stability::DomainHeld::Alone* alone = nullptr;  ///< none: it moves only together with others
  double volume_m3 = 0;
  scene::BlockPlace place = {};
  std::vector<std::string> sets = {};
};
template <class V>
void fields(V& v, const BorderBlockRow& x) {
  const stability::DomainHeld::Alone none{.block = x.block};
  const stability::DomainHeld::Alone& a = x.alone != nullptr ? *x.alone : none;
  const bool alone = x.alone != nullptr;
  v("case", x.load, "name of the [[load]]; `base` without one");
  v("block", x.block, "number from 0, as in `blocks.vtu`");
  v("alone", alone, "1: it moves by itself, were the sides of the domain smooth joints; 0: only together with others");
  v("mode", when(alone, name(a.mode)), "as in key_blocks.csv, as are the columns that follow; empty: not by itself");
  v("volume_m3", x.volume_m3);
  v("direction_x", when(alone, a.direction.x));
  v("direction_y", when(alone, a.direction.y));
  v("direction_z", when(alone, a.direction.z));
  v("net_force_n", when(alone, a.net));
  v("factor_of_safety", when(alone, a.factor_of_safety),
    "with strength on joints alone: on a side of the domain there is none");
  place_fields(v, x.place, x.sets);
}

struct BoltRow {
  std::size_t number = 0;
  std::string pattern;
  const stability::BoltResult& b;
  std::vector<std::string> blocks = {};
  const scene::MotionBolt* motion = nullptr;  ///< where it acts there
};
template <class V>
void fields(V& v, const BoltRow& x) {
  v("bolt", x.number, "from 0");
  v("pattern", x.pattern, "name of its pattern, or `spot`");
  v("after_stage", when(x.b.bolt.after_stage > 0, x.b.bolt.after_stage), "put in then; empty: from the start");
  v("x", x.b.bolt.collar.x, "of its collar, m");
  v("y", x.b.bolt.collar.y);
  v("z", x.b.bolt.collar.z);
  direction_fields(v, x.b.bolt.direction, "direction_x", "direction_y", "direction_z");
  v("length_m", x.b.bolt.length.si());
  v("status", name(x.b.status),
    "`holds` a block or stitched body that needs it; `group`: of these none does, but it pulls at a group of blocks "
    "that needs support; `redundant`, `too short`, `compression`, `no block`, `off the rock`");
  v("limit", when(x.b.capacity > 0, name(x.b.limit)), "what its capacity is limited by");
  v("serves", x.b.serves, "the block that takes most of it");
  v("capacity_n", x.b.capacity, "at the joint behind that block, tension and shear");
  v("used_n", x.b.used, "of it; of a bolt of a group all: its share was not asked");
  v("blocks", x.blocks,
    "blocks it goes through, with the metres from the collar at which it enters and leaves each (`12:0-1.5;7:1.5-3`)");
  v("kind", stability::bolt_kind_names.at(x.b.bolt.type.kind.index()));
  v("angle_deg", when(x.b.capacity > 0, x.b.angle), "to the movement of the block it serves; 0: pure tension");
  v("body", x.b.body, "the combined body (`combined_blocks.csv`) that it holds to the rock outside; empty: none");
  v("body_used_n", when(x.b.body.has_value(), x.b.body_used), "of its capacity where it leaves that body");
  const scene::MotionBolt none{};
  const scene::MotionBolt& moved = x.motion != nullptr ? *x.motion : none;
  v("motion_force_n", when(x.motion != nullptr, moved.largest),
    "largest in `[motion]`, in any step; empty where it ties nothing that is let go to other rock");
  v("motion_lengthened_m", when(x.motion != nullptr, moved.lengthened), "there, for good");
  v("motion_broken_s", moved.broken_at, "when it broke there");
  v("outside_m", x.b.outside.si(),
    "of its length beyond a side of the domain that is not free; rock is taken to go on there, and to grip it");
}

struct SupportBlockRow {
  std::string_view load;
  const stability::SupportedBlock& b;
};
template <class V>
void fields(V& v, const SupportBlockRow& x) {
  v("case", x.load, "name of the [[load]]; `base` without one");
  v("block", x.b.block);
  v("mode", name(x.b.mode));
  v("target", x.b.target, "required factor of safety");
  v("net_force_n", x.b.net_force);
  v("factor_of_safety", x.b.factor_of_safety, "without support");
  v("held_by", name(x.b.held));
  v("bolts", x.b.bolts);
  v("factor_with_bolts", x.b.factor_with_bolts, "bolts alone, a partial sum");
  v("factor_with_shotcrete", x.b.factor_with_shotcrete, "shotcrete alone, a partial sum; empty without");
  v("factor_with_support", x.b.factor_with_support, "with everything: at least the target exactly where it is held");
  v("mobilised_share", x.b.mobilised, "of the bolts; empty where no share holds");
  v("missing_force_n", x.b.missing_force);
  v("required_force_n", x.b.required_force);
  v("required_pressure_pa", x.b.required_pressure);
  v("free_area_m2", x.b.free_area.si());
  v("shotcrete_thickness_m", x.b.needed_thickness,
    "that would hold the block alone; empty without shotcrete and where none would, as its bond gives way first");
  v("received_n", x.b.received, "what blocks of later batches pass to it");
  v("own_pressure_pa", x.b.own_pressure, "required_pressure_pa without that");
  v("lining_pressure_pa", x.b.lining_pressure,
    "required_pressure_pa with the same pressure on the blocks that pass to it: at what these need themselves they "
    "pass "
    "nothing on");
  v("passed_on", x.b.passed_on,
    "its free faces cannot take what it received (`most_pressure`): hold the blocks behind");
}

struct CombinedBlockRow {
  std::string_view load;
  std::size_t number = 0;
  const stability::CombinedBlock& b;
};
template <class V>
void fields(V& v, const CombinedBlockRow& x) {
  v("case", x.load, "name of the [[load]]; `base` without one");
  v("body", x.number, "from 0");
  v("members", x.b.members, "blocks, joined by `;`");
  v("volume_m3", x.b.volume);
  v("removable", x.b.removable);
  v("mode", when(x.b.removable, name(x.b.mode)));
  v("target", x.b.target);
  v("net_force_n", x.b.net_force);
  v("factor_of_safety", x.b.factor_of_safety, "without bolts");
  v("bolts_leaving", x.b.bolts, "that hold it to rock outside");
  v("bolt_force_n", x.b.bolt_force, "what they can carry there, sum");
  v("factor_with_support", x.b.factor_with_support, "with them");
  v("mobilised_share", x.b.mobilised, "of them; empty where no share holds");
  v("passes", x.b.passes);
  v("missing_force_n", x.b.missing_force);
}

/// What both tables of groups say of one.
template <class V>
void blocks_fields(V& v, const stability::KeyGroup& g) {
  std::string blocks;
  for (const topology::BlockId id : g.blocks) blocks += (blocks.empty() ? "" : " ") + std::to_string(id.value());
  v("blocks", blocks, "numbers, joined by blanks");
  v("volume_m3", g.volume);
}
template <class V>
void motion_fields(V& v, const stability::KeyGroup& g) {
  direction_fields(v, g.direction, "direction_x", "direction_y", "direction_z");
  v("moments", g.moments, "1 when blocks turn: translation alone does not move them");
}

template <class V>
void centroid_fields(V& v, const std::optional<scene::GroupPlace>& place, std::string_view meaning) {
  v("x_m", place ? std::optional{place->centroid.x} : std::nullopt, meaning);
  v("y_m", place ? std::optional{place->centroid.y} : std::nullopt);
  v("z_m", place ? std::optional{place->centroid.z} : std::nullopt);
}
template <class V>
void spot_fields(V& v, const std::optional<scene::GroupPlace>& place) {
  v("location", place ? place->location : std::string_view{},
    "of its block with most free area, as in key_blocks.csv; so are chainage and clock; empty: no block has a free "
    "face");
  v("chainage_m", place ? place->chainage : std::nullopt);
  v("clock", place && place->clock ? std::optional{clock_text(*place->clock)} : std::nullopt);
}

/// Why a group is in doubt; empty for others.
[[nodiscard]] constexpr std::string_view doubt_of(const stability::KeyGroup& group) noexcept {
  if (group.verdict != assembly::Verdict::in_doubt) return {};
  return group.weaker ? "weaker" : "undecided";
}

struct KeyGroupRow {
  const stability::KeyGroup& g;
  std::size_t number = 0;
  std::string_view load_case = {};
  std::optional<std::uint32_t> stage = {};
  std::optional<scene::LetGo> let_go = {};
  std::optional<scene::GroupPlace> place = {};  ///< of a group in the last stage
  std::vector<std::string> sets = {};
};
template <class V>
void fields(V& v, const KeyGroupRow& x) {
  v("group", x.number, "from 1");
  v("batch", x.g.batch, "in whose state it was found, from 1");
  v("verdict", assembly::name(x.g.verdict), "`certain`, `unsafe` or `in_doubt`");
  blocks_fields(v, x.g);
  v("factor_up", when(x.g.factors, x.g.factor_up), "above it motion is certain; `inf`: there is no such factor");
  v("factor_move", when(x.g.factors, x.g.factor_move),
    "of motion from rest: the factor of safety of the group; empty for a group too large for factors");
  motion_fields(v, x.g);
  v("load_case", x.load_case, "name of the `[[load]]` it moves in; empty: the base case");
  v("stage", x.stage,
    "after which stage it moves, with the block numbers of `blocks_stage_N.vtu`; empty: after the last, which is "
    "listed as a stage only where blocks fell before");
  v("let_go", x.let_go ? scene::name_of(*x.let_go) : std::string_view{},
    "of a group in doubt in the base case: what rigid blocks in motion do that start from rest, in 0.2 s: "
    "`stayed`, `moved`, `stopped` (the contact law could not be solved) or `not_tried`");
  const auto of = [&](auto member) { return x.place ? std::optional{std::invoke(member, *x.place)} : std::nullopt; };
  centroid_fields(v, x.place,
                  "centroid of the group, as the columns that follow empty for groups of stages before the last");
  spot_fields(v, x.place);
  v("free_area_m2", of(&scene::GroupPlace::free_area), "sum");
  v("sets", x.sets, "joint sets that bound its blocks, joined by `;`");
  v("factor_with_moments", x.g.factors ? x.g.factor_turning : std::nullopt,
    "`factor_move` with moments, of a group that translation alone moves: the lesser of both counts");
  v("factor_of_largest", x.g.factors ? x.g.factor_of_largest : std::nullopt,
    "at which the largest of several blocks starts to move: a crumb beside it may move at less, and gives the group "
    "its factor");
  v("doubt", doubt_of(x.g),
    "of a group in doubt: `weaker`: at rest, but it would move with 5 % less strength and half of the cohesion, which "
    "breaks bit by bit; `undecided`: the search did not settle");
  v("net_force_n", x.g.net, "what is out of balance: mass times acceleration, sum over its blocks; empty: in doubt");
}

/// A group of blocks below its target, and what the support leaves of it.
struct SupportedGroupRow {
  const stability::KeyGroup& g;
  std::size_t number = 0;
  std::optional<assembly::Verdict> left = {};
  std::string_view load_case = {};  ///< empty: the base case
  std::optional<Force> net = {};
  std::optional<scene::GroupPlace> place = {};
};
template <class V>
void fields(V& v, const SupportedGroupRow& x) {
  v("group", x.number, "from 1; not the numbers of key_groups.csv");
  v("batch", x.g.batch, "in whose state without support it was found, from 1");
  v("without", assembly::name(x.g.verdict),
    "verdict at strengths over the target without support: `certain`, `unsafe`, `in_doubt` or `no_motion_found`");
  v("with", held_word(x.left), "`held`, `not_held` or `in_doubt`, with the support at the target");
  blocks_fields(v, x.g);
  motion_fields(v, x.g);
  v("load_case", x.load_case, "name of the `[[load]]` it misses its target in; empty: the base case");
  v("net_force_n", x.net,
    "what the support leaves out of balance, strengths and support over the target: mass times acceleration of the "
    "blocks that still move. Further support takes part over the target too; empty: held, or in doubt");
  centroid_fields(v, x.place, "centroid of the group");
  spot_fields(v, x.place);
}

}  // namespace cleave::report

namespace cleave::scene {
template <class V>
void fields(V& v, const MotionBlock& x) {
  v("block", x.block);
  v("moved", x.moved, "1 when its centroid moved by more than a millimetre");
  v("first_motion_s", x.first_motion, "when it had moved so far");
  v("fall_m", x.fall, "of the centroid, downwards");
  v("runout_m", x.runout, "of the centroid, level");
  v("front_runout_m", x.front,
    "farthest level way of a corner of it from where that was, at any time: says whether a road is reached");
  v("speed_m_s", x.fastest, "largest speed of the centroid");
  v("x_m", x.centroid.x, "centroid at the end");
  v("y_m", x.centroid.y);
  v("z_m", x.centroid.z);
  v("left", x.left, "1 when it left the domain and was followed no further");
  v("leaving_speed_m_s", when(x.left, x.leaving_speed), "of the centroid, as it left; empty: it did not");
  v("bolts", x.bolts, "that tied it to other rock");
  v("bolts_broken", x.bolts_broken, "of these");
  v("locked", x.locked, "1 when it stands at the end and only forces locked between blocks are known to hold it");
}

template <class V>
void fields(V& v, const MaximumRow& x) {
  const stability::MaximumKeyBlock& b = x.block;
  std::string below;
  for (std::size_t i = 0; i < 3; ++i) below += ((b.block.code >> i) & 1U) != 0 ? '1' : '0';
  v("set_1", x.sets[0], "joint sets");
  v("set_2", x.sets[1]);
  v("set_3", x.sets[2]);
  v("below", below, "one digit a set, 1 when the block lies below its plane");
  v("where", x.where);
  v("apex_right_m", b.block.apex[0], "from the tunnel's centre, looking along its axis");
  v("apex_up_m", b.block.apex[1]);
  v("volume_m3", b.block.volume);
  v("weight_n", b.weight);
  v("height_m", b.block.height);
  v("face_area_m2", b.block.face_area);
  v("joint_area_1_m2", b.areas[0]);
  v("joint_area_2_m2", b.areas[1]);
  v("joint_area_3_m2", b.areas[2]);
  v("mode", name(b.mode));
  v("direction_x", b.direction.x);
  v("direction_y", b.direction.y);
  v("direction_z", b.direction.z);
  v("driving_n", b.driving);
  v("resistance_n", b.resistance);
  v("net_force_n", b.net);
  v("factor_of_safety", b.factor_of_safety);
  v("target", b.target, "required factor of safety");
  v("required_pressure_pa", b.required_pressure, "on the free face, for that target");
  v("position", x.position,
    "as UnWedge names wedges at the perimeter: `roof`, `upper right`, ...; at a shaft `north`, `northeast`, ...");
  v("scale", b.scale,
    "of its lengths, that no joint be longer than `trace` and `size` of the scene allow; 1: the largest");
  v("trace_m", b.longest_trace(), "longest trace of its joints on the wall");
  v("joint_size_m", b.largest_extent(), "largest extent of its joint faces");
}
}  // namespace cleave::scene
