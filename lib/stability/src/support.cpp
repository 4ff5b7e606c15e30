#include "cleave/stability/support.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <utility>
#include <variant>

#include "bolt_grips.hpp"
#include "bolt_paths.hpp"
#include "contacts.hpp"
#include "domain_held.hpp"
#include "face_pressures.hpp"
#include "free_faces.hpp"
#include "supported_body.hpp"
#include "truncated_blocks.hpp"

namespace cleave::stability {
namespace {

using geometry::dot;
using geometry::norm;
using geometry::Vec3;
using topology::BlockId;
using topology::Face;
using topology::FaceId;

constexpr double infinite = std::numeric_limits<double>::infinity();

/// Degrees; 0 where the movement pulls straight at it.
double angle_between(const Bolt& bolt, Vec3 movement) {
  const double along = -dot(bolt.direction, movement);
  return std::atan2(norm(movement + along * bolt.direction), along) * (180 / std::numbers::pi);
}

class Check final {
 public:
  /// `pushing`: what blocks of later batches pass on.
  Check(const topology::BlockComplex& complex, const Settings& settings, const Analysis& analysis,
        const Analysis& pushing, const SupportPlan& plan)
      : complex_{&complex},
        settings_{&settings},
        analysis_{&analysis},
        pushing_{&pushing},
        plan_{&plan},
        model_{complex, settings},
        truncated_blocks_{model_},
        paths_{complex},
        gone_{[this](BlockId id) { return !model_.present(id, 1); }},
        scaled_{std::ranges::any_of(complex.blocks().ids(), gone_)},
        sprayed_{complex, plan.shotcrete.value_or(Shotcrete{}), gone_},
        needy_(complex.blocks().size(), none),
        looked_at_(complex.blocks().size(), std::uint8_t{0}) {}

  SupportResult run() {
    for (const Batch& batch : analysis_->batches) {
      for (const BlockId id : batch.blocks) model_.remove(id, batch.number);
      last_state_ = batch.number + 1;
    }
    find_needy();
    find_turning();
    for (const Bolt& bolt : plan_->bolts) add_bolt(bolt, false);
    for (const Bolt& bolt : plan_->placed) add_bolt(bolt, true);
    result_.spot_bolts = plan_->placed.size();
    if (!result_.undecided.empty()) return std::move(result_);
    for (std::size_t i = 0; i < bodies_.size(); ++i) check_block(i);
    judge_bolts();
    combine();
    return std::move(result_);
  }

 private:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  [[nodiscard]] const Judgement* judgement_of(BlockId id) const {
    const auto it = std::ranges::lower_bound(analysis_->judgements, id, {}, &Judgement::block);
    return it != analysis_->judgements.end() && it->block == id ? &*it : nullptr;
  }

  /// What blocks of later batches pass to a body; forces between its members are its own business.
  [[nodiscard]] ForceSum received(std::span<const BlockId> members) const {
    ForceSum sum;
    for (const Judgement& giver : pushing_->judgements) {
      if (!giver.transferred || giver.transferred->passes.empty()) continue;
      if (std::ranges::binary_search(members, giver.block)) continue;
      for (const Passed& passed : giver.transferred->passes) {
        if (std::ranges::binary_search(members, passed.onto)) sum.add(passed.force, {});
      }
    }
    return sum;
  }

  [[nodiscard]] std::optional<Body> body_of(std::span<const BlockId> members) {
    Body body{.contacts = model_.contacts_of(members, 1), .resultant = {}, .bare = {}};
    if (!body.contacts.exposed) return std::nullopt;
    const std::uint8_t dimension = body.contacts.cone.dimension();
    if (dimension == 0 || (settings_->strict && dimension < 3)) return std::nullopt;
    body.resultant = model_.applied_forces(members.front(), 1);
    for (const BlockId id : members.subspan(1)) {
      const Resultant r = model_.applied_forces(id, 1);
      body.resultant.add(r.newtons(), r.scale());
    }
    const ForceSum from_later = members.size() > 1 ? received(members) : received_by_[members.front()];
    body.resultant.add(from_later.force, from_later.scale);
    body.bare = judge(body.contacts, body.resultant, *settings_);
    body.target = target_of(body.bare.mode, *plan_);
    keep_cohesion_of(body.bare, body.resultant, settings_->parallel_contact, body.contacts);
    return body;
  }

  /// `whole` times the least share of the force that holds the body; infinite when none does.
  [[nodiscard]] double least_multiple(const Body& body, Vec3 force, double whole) const {
    const auto least = least_share(body, {.force = force}, *settings_);
    return least ? whole * least->share : infinite;
  }

  void find_needy() {
    received_by_ = IdVector<BlockId, ForceSum>(complex_->blocks().size());
    for (const Judgement& giver : pushing_->judgements) {
      if (!giver.transferred) continue;
      for (const Passed& passed : giver.transferred->passes) received_by_[passed.onto].add(passed.force, {});
    }
    for (const BlockId id : complex_->blocks().ids()) {
      const topology::Block& block = complex_->blocks()[id];
      if (block.fixed || !model_.present(id, 1)) continue;
      // What scaling laid bare needs support too.
      if (!block.free && (!scaled_ || !model_.held(id, 1).exposed)) continue;
      if (block.truncated) {
        if (!truncated_blocks_.stays(id, 1, std::max(1.0, plan_->target_sliding))) result_.undecided.push_back(id);
        continue;
      }
      auto body = body_of({&id, 1});
      if (!body || !moves(body->bare.mode)) continue;
      if (!body->lacks()) continue;
      SupportedBlock entry{.block = id, .mode = body->bare.mode, .target = body->target};
      entry.net_force = body->bare.net;
      entry.factor_of_safety = body->bare.factor_of_safety;
      Vec3 outward;
      for (const FaceId face_id : block.faces) {
        const Face& face = complex_->faces()[face_id];
        if (!is_open(*complex_, face, gone_)) continue;
        entry.free_area += face.area;
        outward += face.area.si() * face.outward;
        if (moves_out_of(face, body->bare.direction)) entry.out_of.push_back(face_id);
      }
      entry.small = entry.free_area < plan_->spot_area;
      if (norm(outward) > 1e-9 * entry.free_area.si()) entry.free_outward = outward / norm(outward);
      const SingleForce least = best_force(*body, *settings_);
      entry.required_direction = least.direction;
      entry.required_force = least.force;
      ask_pressures(entry, *body);
      needy_[id] = static_cast<std::uint32_t>(bodies_.size());
      bodies_.push_back(*std::move(body));
      result_.blocks.push_back(entry);
    }
  }

  /// What leaves later stays where the first batch is held.
  void find_turning() {
    for (const Judgement& j : analysis_->judgements) {
      const bool first = j.batch && (*j.batch == 1 || scaled_);
      if (!first || !j.rotation || !j.rotation->turns || needy_[j.block] != none || !model_.present(j.block, 1))
        continue;
      result_.turning.push_back({.block = j.block});
    }
  }

  void ask_pressures(SupportedBlock& entry, const Body& body) {
    if (!pressures_) pressures_.emplace(*complex_, *settings_, *pushing_, *plan_, gone_);
    entry.required_pressure = pressures_->needed(entry.block, body);
    entry.own_pressure = entry.lining_pressure = entry.required_pressure;
    const ForceSum& received = received_by_[entry.block];
    if (received.force == Vec3{}) return;
    entry.received = norm(received.force);
    entry.own_pressure = pressures_->needed_alone(entry.block);
    const auto too_much = [&](double pressure) { return pascals(pressure) > plan_->most_pressure; };
    entry.passed_on = too_much(entry.required_pressure) && !too_much(entry.own_pressure);
    entry.lining_pressure = pressures_->needed_with_givers(entry.block);
    if (entry.passed_on && too_much(entry.lining_pressure)) entry.lining_pressure = entry.own_pressure;
  }

  void add_bolt(const Bolt& bolt, bool spot) {
    const BoltPath path = paths_.path(bolt);
    BoltResult entry{.bolt = bolt, .spot = spot, .pierced = path.pierced, .outside = metres(path.outside)};
    // Its head is on what is left after scaling.
    const auto left = std::ranges::find_if_not(entry.pierced, [&](const Pierced& p) { return gone_(p.block); });
    entry.pierced.erase(entry.pierced.begin(), left);
    if (entry.pierced.empty()) {
      entry.status = BoltStatus::off;
      entry.outside = {};
    }
    note_truncated(path);
    for (const Pierced& p : entry.pierced) note_border(p.block, result_.held_by_border);
    const auto number = static_cast<std::uint32_t>(result_.bolts.size());
    for (const Pierced& p : entry.pierced) {
      auto& through = through_[p.block];
      if (through.empty() || through.back() != number) through.push_back(number);
    }
    result_.bolts.push_back(std::move(entry));
  }

  /// Notes a block that only a side of the domain keeps from moving.
  void note_border(BlockId id, std::vector<BlockId>& noted) {
    if (std::ranges::binary_search(noted, id) || !only_border_holds(id)) return;
    noted.insert(std::ranges::lower_bound(noted, id), id);
  }

  [[nodiscard]] bool only_border_holds(BlockId id) {
    constexpr std::uint8_t does = 1, does_not = 2;
    std::uint8_t& known = looked_at_[id];
    if (known == 0) {
      const topology::Block& block = complex_->blocks()[id];
      // In place, or where the blocks that the bolts hold lay it bare.
      const bool loose = block.fixed && !block.truncated && !gone_(id) &&
                         (motion_off_border(model_, id, 1) || motion_off_border(model_, id, last_state_));
      known = loose ? does : does_not;
    }
    return known == does;
  }

  /// What a bolt does depends on the blocks it goes through as a whole: how much of it each grips, and with which
  /// others it is stitched to. Fixed ones hold in any case, if no two parts on the bolt may be one block.
  void note_truncated(const BoltPath& path) {
    std::vector<BlockId> parts;
    bool whole = !path.leaves_window;
    for (const Pierced& p : path.pierced) {
      const topology::Block& block = complex_->blocks()[p.block];
      if (!block.truncated) continue;
      whole = whole && block.fixed && (parts.empty() || parts.back() == p.block);
      parts.push_back(p.block);
    }
    if (!whole) result_.undecided.insert(result_.undecided.end(), parts.begin(), parts.end());
  }

  /// What a bolt can do for a block: nothing (why in `status`), or a force.
  [[nodiscard]] BoltForce action(const BoltResult& bolt, BlockId block, BoltStatus& status) const {
    const BoltType& type = bolt.bolt.type;
    // What comes down by itself anchors nothing, unless it is one body with what hangs on it: then step 2 judges that.
    const Grip grip = grip_of(bolt, block, [&](BlockId behind) {
      return !comes_down(behind) || (can_be_member(behind) && gripped(grip_of(bolt, behind), type));
    });
    const bool plate = grip.collar && type.plate > newtons(0);
    status = BoltStatus::too_short;
    if (!anchors(type, grip.behind)) return {{}, BoltLimit::anchor};
    if (!plate && !holds_head(bolt, grip)) return {{}, BoltLimit::head};
    // A block in front that needs no support itself holds the head.
    double front = 0;
    bool front_plate = false;
    if (const Pierced* before = held_in_front(bolt, grip)) {
      front = gripped_length(type, bolt.bolt.length.si(), before->from, before->to);
      front_plate = true;
    }
    const Capacity c = capacity(type, plate || front_plate, grip.gripped + front, grip.behind);
    const Vec3 motion = bodies_[needy_[block]].bare.direction;
    const BoltForce force = force_against(bolt.bolt, c, anchors(type, grip.gripped), motion);
    const bool helps = force.force != Vec3{} || dot(bolt.bolt.direction, motion) <= 0;
    status = helps ? BoltStatus::holds : BoltStatus::compression;
    return force;
  }

  [[nodiscard]] const Pierced* held_in_front(const BoltResult& bolt, const Grip& grip) const {
    if (grip.collar || bolt.pierced.empty() || needy_[bolt.pierced.front().block] != none) return nullptr;
    return &bolt.pierced.front();
  }

  /// Without a plate on the block itself: by its grip there, or, free up to its anchor, by the plate in front.
  [[nodiscard]] bool holds_head(const BoltResult& bolt, const Grip& grip) const {
    const BoltType& type = bolt.bolt.type;
    if (anchors(type, grip.gripped)) return true;
    return std::holds_alternative<MechanicalAnchor>(type.kind) && type.plate > newtons(0) &&
           held_in_front(bolt, grip) != nullptr;
  }

  [[nodiscard]] Vec3 bolt_force(BlockId block, std::uint32_t& count, std::uint32_t without = none) const {
    Vec3 sum;
    count = 0;
    const auto it = through_.find(block);
    if (it == through_.end()) return sum;
    for (const std::uint32_t number : it->second) {
      if (number == without) continue;
      BoltStatus status{};
      const BoltForce f = action(result_.bolts[number], block, status);
      if (f.force == Vec3{}) continue;
      sum += f.force;
      ++count;
    }
    return sum;
  }

  void check_block(std::size_t i) {
    const Body& body = bodies_[i];
    const double layer = plan_->shotcrete ? shotcrete(result_.blocks[i]) : 0;
    layers_.push_back(layer);
    Help help;
    const auto look = [&] {
      SupportedBlock& entry = result_.blocks[i];
      help = {bolt_force(entry.block, entry.bolts), layer};
      entry.factor_with_bolts =
          entry.bolts > 0 ? fixed_mode_factor(body, help.force, plan_->active) : entry.factor_of_safety;
      const auto bolts = least_share(body, {help.force, 0}, *settings_);
      const auto both = bolts || layer == 0 ? bolts : least_share(body, help, *settings_);
      entry.mobilised = both.transform([](const Share& s) { return s.share; });
      entry.mode_held = both ? both->mode : entry.mode;
      entry.held = bolts ? Held::bolts : !both ? Held::not_held : both->share > 0 ? Held::together : Held::shotcrete;
      // Beyond everything in full, along the best direction.
      entry.missing_force = 0;
      if (both) return;
      const double most = 2 * body.target * (body.bare.driving + norm(help.force));
      Body helped = body;
      helped.resultant.add(help.force / body.target, norm(help.force) / body.target);
      const auto more = least_share(helped, {most * entry.required_direction, layer}, *settings_);
      entry.missing_force = more ? most * more->share : infinite;
    };
    look();
    if (result_.blocks[i].held == Held::not_held && plan_->spot && result_.blocks[i].free_area >= plan_->spot_area)
      place_spot_bolts(result_.blocks[i], look);
    if (plan_->factors) result_.blocks[i].factor_with_support = factor_with(body, help, *settings_);
  }

  /// What the layer can carry round the block, N.
  double shotcrete(SupportedBlock& entry) {
    const Shotcrete& layer = *plan_->shotcrete;
    const Body& body = bodies_[needy_[entry.block]];
    const double perimeter = keyed_perimeter(
        *complex_, entry.block, body.bare.direction, sprayed_,
        [&](BlockId other) {
          note_border(other, result_.sprayed_at_border);
          return needy_[other] != none;
        },
        gone_);
    const double hold = perimeter * held_per_metre(layer);
    const double rock = body.bare.resistance.least;
    entry.factor_with_shotcrete = (rock + hold) / body.bare.driving;
    const double lack = body.target * body.bare.driving - rock;
    const bool bonds = !layer.adhesion || perimeter * layer.bond_width.si() * layer.adhesion->si() >= lack;
    if (perimeter > 0 && bonds) entry.needed_thickness = lack / (perimeter * layer.shear_strength.si());
    return hold;
  }

  template <class Look>
  void place_spot_bolts(SupportedBlock& entry, Look look) {
    const Body& body = bodies_[needy_[entry.block]];
    const Vec3 motion = body.bare.direction;
    const std::array<Vec3, 2> wanted{spot_direction(body), -motion};
    std::uint32_t placed = 0;
    for (const Bolt& bolt : spot_places(*complex_, entry.block, wanted, motion, *plan_->spot)) {
      if (placed == plan_->spot->most || entry.held != Held::not_held) break;
      const BoltResult trial{.bolt = bolt, .spot = true, .pierced = paths_.path(bolt).pierced};
      BoltStatus status{};
      if (trial.pierced.empty() || action(trial, entry.block, status).force == Vec3{}) continue;
      add_bolt(bolt, true);
      ++result_.spot_bolts;
      ++placed;
      look();
    }
  }

  void judge_bolts() {
    for (std::uint32_t number = 0; number < result_.bolts.size(); ++number) {
      BoltResult& bolt = result_.bolts[number];
      if (bolt.status == BoltStatus::off) continue;
      double most = -1;
      bool needed = false, holds = false;
      for (const Pierced& p : bolt.pierced) {
        if (needy_[p.block] == none) continue;
        BoltStatus status{};
        const BoltForce force = action(bolt, p.block, status);
        const double most_force = norm(force.force);
        const SupportedBlock& entry = result_.blocks[needy_[p.block]];
        const double used = most_force * entry.mobilised.value_or(1);
        if (!holds || most_force > 0) {
          if (used > most) {
            most = used;
            bolt.serves = p.block;
            bolt.capacity = most_force;
            bolt.limit = force.limit;
            bolt.used = used;
            bolt.angle = angle_between(bolt.bolt, bodies_[needy_[p.block]].bare.direction);
          }
          if (!holds) bolt.status = status;
        }
        if (!(most_force > 0)) continue;
        holds = true;
        if (entry.held == Held::not_held) {
          needed = true;
          continue;
        }
        std::uint32_t left = 0;
        const std::uint32_t place = needy_[p.block];
        const Help rest{bolt_force(p.block, left, number), layers_[place]};
        needed = needed || !least_share(bodies_[place], rest, *settings_);
      }
      if (holds) bolt.status = needed ? BoltStatus::holds : BoltStatus::redundant;
    }
  }

  /// A key block of any batch, or one that lacks something of its target.
  [[nodiscard]] bool comes_down(BlockId id) const {
    if (needy_[id] != none) return true;
    const Judgement* judged = judgement_of(id);
    return judged != nullptr && judged->key;
  }

  /// A block of step 2 that may move: fixed ones stay whatever they are bolted to.
  [[nodiscard]] bool can_be_member(BlockId id) const {
    return !complex_->blocks()[id].fixed && (!plan_->key_only || needy_[id] != none);
  }

  /// A bolt that leaves a body, and what it does for it there, N.
  struct Leaving {
    std::uint32_t bolt;
    Vec3 force;
  };

  /// What bolts that leave a body can do for it: each its capacity where it leaves.
  [[nodiscard]] Help bolts_leaving(std::span<const BlockId> members, Vec3 motion, CombinedBlock& entry,
                                   std::vector<Leaving>& leaving) const {
    Help help;
    for (std::uint32_t number = 0; number < result_.bolts.size(); ++number) {
      const BoltResult& bolt = result_.bolts[number];
      const BoltType& type = bolt.bolt.type;
      const BodyGrip grip = grip_of(bolt, members, [&](BlockId id) { return !can_be_member(id) && !comes_down(id); });
      if (!grip.gripped || !anchors(type, grip.anchored)) continue;
      const Capacity tension = capacity(type, grip.collar && type.plate > newtons(0), grip.inside, grip.anchored);
      const BoltForce held = force_against(bolt.bolt, tension, anchors(type, grip.inside), motion);
      if (held.force == Vec3{}) continue;  // its motion would shorten it
      help.force += held.force;
      entry.bolt_force += norm(held.force);
      leaving.push_back({number, held.force});
      ++entry.bolts;
    }
    return help;
  }

  void judge_combined(CombinedBlock& entry) {
    entry.factor_of_safety = infinite;
    const auto body = body_of(entry.members);
    entry.removable = body.has_value();
    entry.mode = body ? body->bare.mode : Mode::tapered;
    if (plan_->factors) entry.factor_with_support = infinite;
    if (!body || !moves(entry.mode)) return;
    entry.target = body->target;
    entry.net_force = body->bare.net;
    entry.factor_of_safety = body->bare.factor_of_safety;
    std::vector<Leaving> leaving;
    const Help help = bolts_leaving(entry.members, body->bare.direction, entry, leaving);
    const auto least = least_share(*body, help, *settings_);
    entry.mobilised = least.transform([](const Share& s) { return s.share; });
    entry.passes = least.has_value();
    for (const Leaving& held : leaving) {
      BoltResult& bolt = result_.bolts[held.bolt];
      if (bolt.status != BoltStatus::holds &&
          (!entry.passes || !least_share(*body, {.force = help.force - held.force}, *settings_))) {
        bolt.status = BoltStatus::holds;
      }
      const double used = norm(held.force) * entry.mobilised.value_or(1);
      if (bolt.body && bolt.body_used >= used) continue;
      bolt.body = result_.combined.size();
      bolt.body_used = used;
    }
    if (plan_->factors) entry.factor_with_support = factor_with(*body, help, *settings_);
    if (entry.passes) return;
    Body helped = *body;
    helped.resultant.add(help.force / body->target, norm(help.force) / body->target);
    const double most = 2 * body->target * (body->bare.driving + norm(help.force));
    entry.missing_force = least_multiple(helped, most * best_force(*body, *settings_).direction, most);
  }

  /// Step 2: blocks gripped by one bolt are one body.
  void combine() {
    for (auto& members : stitched(*complex_, result_.bolts, [&](BlockId id) { return can_be_member(id); })) {
      CombinedBlock entry{.members = std::move(members)};
      for (const BlockId id : entry.members) entry.volume += complex_->blocks()[id].volume.si();
      judge_combined(entry);
      result_.combined.push_back(std::move(entry));
    }
  }

  const topology::BlockComplex* complex_;
  const Settings* settings_;
  const Analysis* analysis_;
  const Analysis* pushing_;
  const SupportPlan* plan_;
  Model model_;  ///< in state 1 all blocks are there
  std::uint32_t last_state_ = 1;
  TruncatedBlocks truncated_blocks_;
  BoltPaths paths_;
  std::function<bool(BlockId)> gone_;  ///< scaled off before the support
  bool scaled_;                        ///< some block is
  Sprayed sprayed_;
  std::optional<FacePressures> pressures_;     ///< once a block needs support
  IdVector<BlockId, std::uint32_t> needy_;     ///< index into bodies_ and result_.blocks
  IdVector<BlockId, std::uint8_t> looked_at_;  ///< by `only_border_holds`
  IdVector<BlockId, ForceSum> received_by_;
  std::vector<Body> bodies_;
  std::vector<double> layers_;  ///< N, parallel to bodies_: what shotcrete can carry
  std::map<BlockId, std::vector<std::uint32_t>> through_;
  SupportResult result_;
};

}  // namespace

bool SupportResult::passes() const noexcept {
  return std::ranges::all_of(blocks, [](const SupportedBlock& b) { return b.held != Held::not_held; }) &&
         std::ranges::all_of(combined, [](const CombinedBlock& b) { return b.passes; });
}

bool SupportResult::holds_what_turns() const noexcept { return std::ranges::all_of(turning, &OnlyTurns::held); }

std::vector<Bolt> newly_placed(const SupportResult& result, const SupportPlan& plan) {
  std::vector<Bolt> out;
  for (std::size_t k = plan.bolts.size() + plan.placed.size(); k < result.bolts.size(); ++k) {
    out.push_back(result.bolts[k].bolt);
  }
  return out;
}

SupportResult check_support(const topology::AuditedComplex& complex, const Settings& settings, const Analysis& analysis,
                            const SupportPlan& plan) {
  const bool reduces = settings.force_transfer && settings.transfer.strengths == TransferReadings::Strengths::target &&
                       plan.target_sliding > 1;
  if (!reduces) return Check{complex.complex(), settings, analysis, analysis, plan}.run();
  const Analysis pushing = analyse(complex, with_strengths_over(settings, plan.target_sliding));
  SupportResult result = Check{complex.complex(), settings, analysis, pushing, plan}.run();
  result.undecided.insert(result.undecided.end(), pushing.undecided.begin(), pushing.undecided.end());
  return result;
}

}  // namespace cleave::stability
