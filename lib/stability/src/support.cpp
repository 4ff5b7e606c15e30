#include "cleave/stability/support.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "bolt_grips.hpp"
#include "bolt_paths.hpp"
#include "contacts.hpp"
#include "free_faces.hpp"
#include "known_parts.hpp"
#include "supported_body.hpp"

namespace cleave::stability {
namespace {

using geometry::dot;
using geometry::norm;
using geometry::Vec3;
using topology::BlockId;
using topology::Face;
using topology::FaceId;

constexpr double infinite = std::numeric_limits<double>::infinity();

class Check final {
 public:
  Check(const topology::BlockComplex& complex, const Settings& settings, const Analysis& analysis,
        const SupportPlan& plan)
      : complex_{&complex},
        settings_{&settings},
        analysis_{&analysis},
        plan_{&plan},
        model_{complex, settings},
        known_parts_{model_},
        paths_{complex},
        needy_(complex.blocks().size(), none) {}

  SupportResult run() {
    find_needy();
    for (const Bolt& bolt : plan_->bolts) add_bolt(bolt, false);
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
    for (const Judgement& giver : analysis_->judgements) {
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
    return body;
  }

  void find_needy() {
    received_by_ = IdVector<BlockId, ForceSum>(complex_->blocks().size());
    for (const Judgement& giver : analysis_->judgements) {
      if (!giver.transferred) continue;
      for (const Passed& passed : giver.transferred->passes) received_by_[passed.onto].add(passed.force, {});
    }
    for (const BlockId id : complex_->blocks().ids()) {
      const topology::Block& block = complex_->blocks()[id];
      if (!block.free || block.fixed || !model_.present(id, 1)) continue;
      if (block.truncated) {
        if (!known_parts_.stays(id, 1, std::max(1.0, plan_->target_sliding))) result_.undecided.push_back(id);
        continue;
      }
      auto body = body_of({&id, 1});
      if (!body || !moves(body->bare.mode)) continue;
      if (!body->lacks()) continue;
      SupportedBlock entry{.block = id, .mode = body->bare.mode, .target = body->target};
      entry.net_force = body->bare.net;
      entry.factor_of_safety = body->bare.factor_of_safety;
      Vec3 push;  // of 1 Pa on the free faces
      for (const FaceId face_id : block.faces) {
        const Face& face = complex_->faces()[face_id];
        if (face.role != topology::Role::free) continue;
        entry.free_area += face.area.si();
        push -= face.area.si() * face.outward;
      }
      entry.required_direction = best_direction(*body);
      const double most = 1.05 * body->target * body->bare.driving;
      entry.required_force = most * least_share(*body, most * entry.required_direction, *settings_, 1).share;
      entry.required_pressure = infinite;
      if (const double against = -dot(push, body->bare.direction); against > 1e-9 * norm(push)) {
        const double limit = 4 * body->target * body->bare.driving / against;
        entry.required_pressure = limit * least_share(*body, limit * push, *settings_, 1).share;
      }
      needy_[id] = static_cast<std::uint32_t>(bodies_.size());
      bodies_.push_back(*std::move(body));
      result_.blocks.push_back(entry);
    }
  }

  void add_bolt(const Bolt& bolt, bool spot) {
    const BoltPath path = paths_.path(bolt);
    BoltResult entry{.bolt = bolt, .spot = spot, .pierced = path.pierced};
    if (entry.pierced.empty()) entry.status = BoltStatus::off;
    note_truncated(path);
    const auto number = static_cast<std::uint32_t>(result_.bolts.size());
    for (const Pierced& p : entry.pierced) {
      auto& through = through_[p.block];
      if (through.empty() || through.back() != number) through.push_back(number);
    }
    result_.bolts.push_back(std::move(entry));
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

  /// What a bolt can do for a block: nothing (why in `status`), or a force along it.
  [[nodiscard]] Capacity action(const BoltResult& bolt, BlockId block, BoltStatus& status) const {
    const Grip grip = grip_of(bolt.pierced, block);
    const BoltType& type = bolt.bolt.type;
    const bool plate = grip.collar && type.plate > 0;
    status = BoltStatus::too_short;
    if (grip.behind < type.anchorage || !(grip.behind > 0)) return {0, BoltLimit::anchor};
    if (!plate && (grip.gripped < type.anchorage || !(grip.gripped > 0))) return {0, BoltLimit::head};
    // A block in front that needs no support itself holds the head.
    double front = 0;
    bool front_plate = false;
    if (!grip.collar && !bolt.pierced.empty() && needy_[bolt.pierced.front().block] == none) {
      front = bolt.pierced.front().to - bolt.pierced.front().from;
      front_plate = true;
    }
    const Capacity c = capacity(type, plate || front_plate, grip.gripped + front, grip.behind);
    const Vec3 motion = bodies_[needy_[block]].bare.direction;
    status = dot(bolt.bolt.direction, motion) > 0 ? BoltStatus::compression : BoltStatus::holds;
    return status == BoltStatus::holds ? c : Capacity{0, c.limit};
  }

  [[nodiscard]] Vec3 bolt_force(BlockId block, std::uint32_t& count, std::uint32_t without = none) const {
    Vec3 sum;
    count = 0;
    const auto it = through_.find(block);
    if (it == through_.end()) return sum;
    for (const std::uint32_t number : it->second) {
      if (number == without) continue;
      BoltStatus status{};
      const Capacity c = action(result_.bolts[number], block, status);
      if (!(c.force > 0)) continue;
      sum += c.force * result_.bolts[number].bolt.direction;
      ++count;
    }
    return sum;
  }

  void check_block(std::size_t i) {
    SupportedBlock& entry = result_.blocks[i];
    const Body& body = bodies_[i];
    const auto look = [&] {
      const Vec3 force = bolt_force(entry.block, entry.bolts);
      entry.factor_with_bolts =
          entry.bolts > 0 ? fixed_mode_factor(body, force, plan_->active) : entry.factor_of_safety;
      const Least least = entry.bolts > 0 ? least_share(body, force, *settings_, 1) : Least{};
      entry.mobilised = std::isfinite(least.share) ? least.share : 2;
      entry.mode_held = std::isfinite(least.share) ? least.mode : entry.mode;
      if (std::isfinite(least.share)) entry.held = Held::bolts;
      entry.missing_force = 0;
      if (entry.held != Held::bolts) {
        // Beyond the bolts in full, along the best direction.
        const double most = 2 * body.target * (body.bare.driving + norm(force));
        Body bolted = body;
        bolted.resultant.add(force / body.target, norm(force) / body.target);
        const Least more = least_share(bolted, most * entry.required_direction, *settings_, 1);
        entry.missing_force = std::isfinite(more.share) ? most * more.share : infinite;
      }
    };
    look();
    if (plan_->shotcrete) shotcrete(entry);
    if (entry.held == Held::not_held && plan_->spot && entry.free_area >= plan_->spot_area)
      place_spot_bolts(entry, look);
    if (entry.held == Held::not_held && entry.factor_with_shotcrete >= entry.target &&
        entry.free_area < plan_->spot_area) {
      entry.held = Held::shotcrete;
      entry.missing_force = 0;
    }
  }

  void shotcrete(SupportedBlock& entry) {
    const Shotcrete& layer = *plan_->shotcrete;
    const double perimeter =
        keyed_perimeter(*complex_, entry.block, [&](BlockId other) { return needy_[other] != none; });
    double hold = perimeter * layer.thickness * layer.shear_strength;
    if (layer.adhesion > 0) hold = std::min(hold, perimeter * layer.bond_width * layer.adhesion);
    // A block between 1 and its target has no net force: what it lacks is the resistance up to the target.
    const Body& body = bodies_[needy_[entry.block]];
    const double lack = body.target * body.bare.driving - body.bare.resistance.least;
    const double net = std::max(entry.net_force, lack / body.target);
    entry.factor_with_shotcrete = net > 0 ? hold / net : infinite;
    entry.needed_thickness = perimeter > 0 ? entry.target * net / (perimeter * layer.shear_strength) : infinite;
  }

  template <class Look>
  void place_spot_bolts(SupportedBlock& entry, Look look) {
    const Vec3 motion = bodies_[needy_[entry.block]].bare.direction;
    const std::array<Vec3, 2> wanted{entry.required_direction, -motion};
    std::uint32_t placed = 0;
    for (const Bolt& bolt : spot_places(*complex_, entry.block, wanted, motion, *plan_->spot)) {
      if (placed == plan_->spot->most || entry.held != Held::not_held) break;
      const BoltResult trial{.bolt = bolt, .spot = true, .pierced = paths_.path(bolt).pierced};
      BoltStatus status{};
      if (trial.pierced.empty() || !(action(trial, entry.block, status).force > 0)) continue;
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
        const Capacity c = action(bolt, p.block, status);
        const SupportedBlock& entry = result_.blocks[needy_[p.block]];
        const double used = c.force * std::min(1.0, entry.mobilised);
        if (!holds || c.force > 0) {
          if (used > most) {
            most = used;
            bolt.serves = p.block;
            bolt.capacity = c.force;
            bolt.limit = c.limit;
            bolt.used = used;
          }
          if (!holds) bolt.status = status;
        }
        if (!(c.force > 0)) continue;
        holds = true;
        if (entry.held != Held::bolts) {
          needed = true;
          continue;
        }
        std::uint32_t left = 0;
        const Vec3 rest = bolt_force(p.block, left, number);
        needed = needed || !std::isfinite(least_share(bodies_[needy_[p.block]], rest, *settings_, 1).share);
      }
      if (holds) bolt.status = needed ? BoltStatus::holds : BoltStatus::redundant;
    }
  }

  /// Step 2: blocks gripped by one bolt are one body.
  void combine() {
    const auto counts = [&](BlockId id) { return !plan_->key_only || needy_[id] != none; };
    for (auto& members : stitched(*complex_, result_.bolts, counts)) {
      CombinedBlock body{.members = members};
      for (const BlockId id : members) {
        body.immovable = body.immovable || complex_->blocks()[id].fixed;
        body.volume += complex_->blocks()[id].volume.si();
      }
      body.factor_of_safety = infinite;
      if (!body.immovable) {
        if (const auto found = body_of(members)) {
          body.removable = true;
          body.mode = found->bare.mode;
          body.target = found->target;
          body.net_force = found->bare.net;
          body.factor_of_safety = found->bare.factor_of_safety;
          body.passes = !moves(body.mode) || !found->lacks();
          if (!body.passes) {
            const double most = 1.05 * found->target * found->bare.driving;
            body.missing_force = most * least_share(*found, most * best_direction(*found), *settings_, 1).share;
          }
        } else {
          body.mode = Mode::tapered;
        }
      }
      result_.combined.push_back(std::move(body));
    }
  }

  const topology::BlockComplex* complex_;
  const Settings* settings_;
  const Analysis* analysis_;
  const SupportPlan* plan_;
  Model model_;
  KnownParts known_parts_;
  BoltPaths paths_;
  IdVector<BlockId, std::uint32_t> needy_;  ///< index into bodies_ and result_.blocks
  IdVector<BlockId, ForceSum> received_by_;
  std::vector<Body> bodies_;
  std::map<BlockId, std::vector<std::uint32_t>> through_;
  SupportResult result_;
};

}  // namespace

Capacity capacity(const BoltType& type, bool plate_on_block, double before, double behind) {
  const double head = (plate_on_block ? type.plate : 0) + type.bond * before;
  const double anchor = type.bond * behind;
  Capacity least{head, BoltLimit::head};
  if (type.tendon < least.force) least = {type.tendon, BoltLimit::tendon};
  if (anchor < least.force) least = {anchor, BoltLimit::anchor};
  return least;
}

bool SupportResult::passes() const noexcept {
  return std::ranges::all_of(blocks, [](const SupportedBlock& b) { return b.held != Held::not_held; }) &&
         std::ranges::all_of(combined, [](const CombinedBlock& b) { return b.passes; });
}

SupportResult check_support(const topology::AuditedComplex& complex, const Settings& settings, const Analysis& analysis,
                            const SupportPlan& plan) {
  return Check{complex.complex(), settings, analysis, plan}.run();
}

}  // namespace cleave::stability
