#include "cleave/stability/support.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "bolt_paths.hpp"
#include "contacts.hpp"
#include "flat.hpp"
#include "verdict.hpp"

namespace cleave::stability {
namespace {

using geometry::dot;
using geometry::norm;
using geometry::Vec3;
using topology::BlockId;
using topology::Face;
using topology::FaceId;

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double rounding = 0x1p-40;

double target_of(Mode mode, const SupportPlan& plan) {
  return mode == Mode::falling || mode == Mode::lifting ? plan.target_falling : plan.target_sliding;
}

/// A body under its loads, before any support.
struct Body {
  Contacts contacts;
  Resultant resultant;
  Verdict bare;
  double target = 1;
};

struct AtShare {
  double lack;  ///< T - R / target, N; <= 0: held
  double driving;
  Mode mode;
};

/// The body with an extra force, strength and force both reduced by the target.
AtShare with_force(const Body& body, Vec3 force, const Settings& settings) {
  Resultant r = body.resultant;
  r.add(force / body.target, norm(force) / body.target);
  const Verdict v = judge(body.contacts, r, settings);
  return {v.driving - v.resistance.least / body.target, v.driving, v.mode};
}

struct Least {
  double share = infinite;  ///< infinite: not found up to the limit
  Mode mode = Mode::stable;
};

/// Smallest share of `force` in [0, limit] that holds the body: 32 steps, then bisection in the first that does. (The
/// lack of hold is continuous but where cohesion is lost with a wall, so a scan comes first.)
Least least_share(const Body& body, Vec3 force, const Settings& settings, double limit) {
  const auto holds = [&](double share, Mode& mode) {
    const AtShare at = with_force(body, share * force, settings);
    mode = at.mode;
    return at.lack <= rounding * body.bare.driving;
  };
  Mode mode = Mode::stable;
  double below = 0;
  if (holds(0, mode)) return {0, mode};
  constexpr int steps = 32;
  for (int i = 1; i <= steps; ++i) {
    double above = limit * i / steps;
    if (!holds(above, mode)) {
      below = above;
      continue;
    }
    for (int k = 0; k < 60 && above - below > 1e-13 * limit; ++k) {
      const double middle = 0.5 * (below + above);
      Mode there = Mode::stable;
      if (holds(middle, there)) {
        above = middle;
        mode = there;
      } else {
        below = middle;
      }
    }
    return {above, mode};
  }
  return {};
}

/// Factor of safety in the mode without bolts (Fu 2014, 4.8 to 4.10) under the sum of the bolts' forces.
double fixed_mode_factor(const Body& body, Vec3 bolts, bool active) {
  const Verdict& v = body.bare;
  if (!moves(v.mode)) return infinite;
  const double along = -dot(bolts, v.direction);
  double resistance = v.resistance.least;
  const auto& pressing = v.resistance.pressing;
  const auto swap_friction = [&](std::size_t k, double reaction) {
    const Contact& group = body.contacts.groups[pressing[k].first];
    const double old = pressing[k].second;
    resistance += reaction * group.tan_at(reaction) - old * group.tan_at(old);
  };
  if (pressing.size() == 1) {
    const Vec3 n = body.contacts.cone.groups()[pressing[0].first].unit();
    swap_friction(0, std::max(0.0, pressing[0].second - dot(bolts, n)));
  } else if (pressing.size() == 2) {
    Resultant r = body.resultant;
    r.add(bolts, norm(bolts));
    if (const auto both = reactions(body.contacts.cone, r, pressing[0].first, pressing[1].first)) {
      swap_friction(0, both->first);
      swap_friction(1, both->second);
    }
  }
  if (!active) return (resistance + along) / v.driving;
  return v.driving > along ? resistance / (v.driving - along) : infinite;
}

/// Direction of the best single force: at the friction angle to a plane, else straight against the motion.
Vec3 best_direction(const Body& body) {
  const Verdict& v = body.bare;
  if (v.mode != Mode::sliding || v.resistance.pressing.size() != 1) return -v.direction;
  const auto [group, reaction] = v.resistance.pressing[0];
  const double b = std::atan(body.contacts.groups[group].tan_at(reaction));
  return geometry::normalized(-std::cos(b) * v.direction - std::sin(b) * body.contacts.cone.groups()[group].unit());
}

struct Grip {
  double gripped = 0;          ///< m in the block
  double first = 0, last = 0;  ///< m from the collar: where the bolt enters it first and leaves it last
  bool collar = false;
  double behind = 0;  ///< m in rock beyond it
};

Grip grip_of(const std::vector<Pierced>& path, BlockId block) {
  Grip grip;
  bool found = false;
  for (const Pierced& p : path) {
    if (p.block == block) {
      if (!found) grip.first = p.from;
      found = true;
      grip.gripped += p.to - p.from;
      grip.last = p.to;
      grip.behind = 0;
    } else if (found) {
      grip.behind += p.to - p.from;
    }
  }
  grip.collar = !path.empty() && path.front().block == block;
  return grip;
}

class Check final {
 public:
  Check(const topology::BlockComplex& complex, const Settings& settings, const Analysis& analysis,
        const SupportPlan& plan)
      : complex_{&complex},
        settings_{&settings},
        analysis_{&analysis},
        plan_{&plan},
        model_{complex, settings},
        paths_{complex},
        needy_(complex.blocks().size(), none) {}

  SupportResult run() {
    find_needy();
    for (const Bolt& bolt : plan_->bolts) add_bolt(bolt, false);
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
      auto body = body_of({&id, 1});
      if (!body || !moves(body->bare.mode)) continue;
      if (!(body->bare.driving - body->bare.resistance.least / body->target > rounding * body->bare.driving)) continue;
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
    BoltResult entry{.bolt = bolt, .spot = spot, .pierced = paths_.path(bolt)};
    if (entry.pierced.empty()) entry.status = BoltStatus::off;
    const auto number = static_cast<std::uint32_t>(result_.bolts.size());
    for (const Pierced& p : entry.pierced) {
      auto& through = through_[p.block];
      if (through.empty() || through.back() != number) through.push_back(number);
    }
    result_.bolts.push_back(std::move(entry));
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

  /// Perimeter of the free faces along which sprayed concrete is keyed to rock that stays: the block's own joint face
  /// beyond the edge must not lead to another loose block.
  [[nodiscard]] double keyed_perimeter(BlockId id) const {
    std::map<std::pair<std::uint32_t, std::uint32_t>, const Face*> beyond;
    const auto key = [](topology::VertexId a, topology::VertexId b) {
      return std::pair{std::min(a.value(), b.value()), std::max(a.value(), b.value())};
    };
    const auto edges = [&](const Face& face, auto&& use) {
      for (const auto& loop : complex_->loops(face)) {
        for (std::size_t i = 0; i < loop.size(); ++i) use(loop[i], loop[(i + 1) % loop.size()]);
      }
    };
    for (const FaceId face_id : complex_->blocks()[id].faces) {
      const Face& face = complex_->faces()[face_id];
      if (face.role != topology::Role::joint) continue;
      edges(face, [&](auto a, auto b) { beyond[key(a, b)] = &face; });
    }
    double perimeter = 0;
    for (const FaceId face_id : complex_->blocks()[id].faces) {
      const Face& face = complex_->faces()[face_id];
      if (face.role != topology::Role::free) continue;
      edges(face, [&](auto a, auto b) {
        const auto it = beyond.find(key(a, b));
        if (it == beyond.end()) return;
        for (const topology::Patch& patch : complex_->patches(*it->second)) {
          if (patch.neighbour && needy_[*patch.neighbour] != none) return;
        }
        perimeter += norm(complex_->position(b) - complex_->position(a));
      });
    }
    return perimeter;
  }

  void shotcrete(SupportedBlock& entry) {
    const Shotcrete& layer = *plan_->shotcrete;
    const double perimeter = keyed_perimeter(entry.block);
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
    const Body& body = bodies_[needy_[entry.block]];
    const Face* largest = nullptr;
    for (const FaceId face_id : complex_->blocks()[entry.block].faces) {
      const Face& face = complex_->faces()[face_id];
      if (face.role != topology::Role::free) continue;
      if (largest == nullptr || face.area > largest->area) largest = &face;
    }
    if (largest == nullptr) return;
    Vec3 direction = -largest->outward;
    for (const Vec3 wanted : {entry.required_direction, -body.bare.direction}) {
      if (dot(wanted, largest->outward) < -0.3) {
        direction = wanted;
        break;
      }
    }
    if (dot(direction, body.bare.direction) >= 0) return;
    const Vec3 u = geometry::normalized(std::abs(largest->outward.z) < 0.9 ? cross(largest->outward, {0, 0, 1})
                                                                           : cross(largest->outward, {1, 0, 0}));
    const Vec3 v = cross(largest->outward, u);
    double u0 = infinite, u1 = -infinite, v0 = infinite, v1 = -infinite;
    for (const auto& loop : complex_->loops(*largest)) {
      for (const topology::VertexId vertex : loop) {
        const Vec3 x = complex_->position(vertex) - largest->centroid;
        u0 = std::min(u0, dot(x, u));
        u1 = std::max(u1, dot(x, u));
        v0 = std::min(v0, dot(x, v));
        v1 = std::max(v1, dot(x, v));
      }
    }
    const auto halton = [](std::uint32_t i, std::uint32_t base) {
      double f = 1, r = 0;
      for (; i > 0; i /= base) {
        f /= base;
        r += f * (i % base);
      }
      return r;
    };
    std::uint32_t placed = 0;
    for (std::uint32_t i = 0; i < 400 && placed < plan_->spot->most && entry.held == Held::not_held; ++i) {
      const Vec3 x =
          i == 0 ? largest->centroid
                 : largest->centroid + (u0 + halton(i, 2) * (u1 - u0)) * u + (v0 + halton(i, 3) * (v1 - v0)) * v;
      if (!contains(*complex_, *largest, x)) continue;
      const Bolt bolt{.collar = x, .direction = direction, .length = plan_->spot->length, .type = plan_->spot->type};
      BoltResult trial{.bolt = bolt, .spot = true, .pierced = paths_.path(bolt)};
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
    std::vector<std::uint32_t> parent(complex_->blocks().size());
    std::iota(parent.begin(), parent.end(), 0U);
    const auto root = [&](std::uint32_t i) {
      while (parent[i] != i) i = parent[i] = parent[parent[i]];
      return i;
    };
    for (const BoltResult& bolt : result_.bolts) {
      std::optional<std::uint32_t> first;
      std::vector<BlockId> seen;
      for (const Pierced& p : bolt.pierced) {
        if (std::ranges::find(seen, p.block) != seen.end()) continue;
        seen.push_back(p.block);
        if (plan_->key_only && needy_[p.block] == none) continue;
        const Grip grip = grip_of(bolt.pierced, p.block);
        const bool plate = grip.collar && bolt.bolt.type.plate > 0;
        if (!plate && (grip.gripped < bolt.bolt.type.anchorage || !(grip.gripped > 0))) continue;
        const std::uint32_t here = root(p.block.value());
        if (!first) {
          first = here;
          continue;
        }
        const std::uint32_t there = root(*first);
        parent[std::max(here, there)] = std::min(here, there);
      }
    }
    std::map<std::uint32_t, std::vector<BlockId>> groups;
    for (const BlockId id : complex_->blocks().ids()) groups[root(id.value())].push_back(id);
    for (auto& [lowest, members] : groups) {
      if (members.size() < 2) continue;
      static_cast<void>(lowest);
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
          const double lack = found->bare.driving - found->bare.resistance.least / found->target;
          body.passes = !moves(body.mode) || !(lack > rounding * found->bare.driving);
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
