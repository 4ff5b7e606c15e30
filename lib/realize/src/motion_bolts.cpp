#include "motion_bolts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "cleave/core/text.hpp"

namespace cleave::scene {
namespace {

using geometry::Vec3;
using stability::BoltPull;
using stability::BoltResult;
using topology::BlockComplex;
using topology::BlockId;

/// How all that is let go would begin to move without bolts: what bolts with an angle law ask for.
class Unsupported {
 public:
  Unsupported(const motion::SceneSpec& scene, std::size_t moving, const motion::WorldOptions& options) {
    motion::SceneSpec all = scene;
    all.ties.clear();
    for (std::size_t b = 0; b < moving; ++b) all.bodies[b].fixed = false;
    auto made = motion::World::make(std::move(all), options);
    if (made && made->step()) world_.emplace(*std::move(made));
  }
  /// m/s of a point; nothing where it is not known.
  [[nodiscard]] std::optional<Vec3> velocity(std::size_t body, Vec3 at) const {
    if (!world_) return std::nullopt;
    return world_->velocity(body) + cross(world_->spin(body), at - world_->centroid(body));
  }

 private:
  std::optional<motion::World> world_;
};

class Ties {
 public:
  Ties(const Scene& scene, const Realization& made, const BlockComplex& complex, const motion::WorldOptions& options,
       MotionCast& cast)
      : scene_{scene}, made_{made}, complex_{complex}, options_{options}, cast_{cast} {}

  void add_all() {
    const std::vector<BoltResult>& bolts = made_.support->bolts;
    for (std::uint32_t k = 0; k < bolts.size(); ++k) {
      if (bolts[k].pierced.size() > 1) add(k, bolts[k]);
    }
  }

 private:
  /// Stage after whose excavation a bolt is put in; that of the last one for those placed where all else fails.
  [[nodiscard]] std::uint32_t stage_of(const BoltResult& bolt) const {
    return bolt.spot ? scene_.sequence->stages.back() : bolt.bolt.after_stage;
  }
  /// Whether it has left when the bolt is put in.
  [[nodiscard]] bool leaves_before(BlockId block, const BoltResult& bolt) const {
    if (scene_.motion->release != Release::stage || !scene_.sequence) return false;
    const std::uint32_t body = cast_.body[block.index()];
    return body < cast_.moving.size() && scene_.sequence->stages[cast_.wave[body]] <= stage_of(bolt);
  }

  void add(std::uint32_t number, const BoltResult& whole) {
    BoltResult bolt = whole;
    // Its head is on what is left.
    const auto left =
        std::ranges::find_if_not(bolt.pierced, [&](const auto& p) { return leaves_before(p.block, bolt); });
    bolt.pierced.erase(bolt.pierced.begin(), left);
    const auto owner = [&](BlockId id) -> std::optional<std::optional<std::uint32_t>> {
      if (complex_.blocks()[id].sliver || leaves_before(id, bolt)) return std::nullopt;
      const std::uint32_t body = cast_.body[id.index()];
      return body < cast_.moving.size() ? std::optional{body} : std::nullopt;
    };
    bool acts = false;
    for (const BoltPull& pull : pulls_of(bolt, owner)) acts = add(number, bolt.bolt, pull) || acts;
    const bool late = std::ranges::any_of(whole.pierced, [&](const auto& p) { return leaves_before(p.block, whole); });
    cast_.late_bolts += late ? 1U : 0U;
    cast_.bolts_with_shear += acts && has_shear(bolt.bolt.type) ? 1U : 0U;
  }

  [[nodiscard]] static bool has_shear(const stability::BoltType& type) {
    const auto* bar = std::get_if<stability::GroutedBar>(&type.kind);
    const auto* tube = std::get_if<stability::FrictionTube>(&type.kind);
    return (bar != nullptr && bar->shear > newtons(0)) || (tube != nullptr && tube->shear > newtons(0));
  }

  bool add(std::uint32_t number, const stability::Bolt& bolt, const BoltPull& pull) {
    // Any wall stands for the rock that stays: all of it is where it was.
    const auto wall = static_cast<std::uint32_t>(cast_.moving.size());
    if ((!pull.body || !pull.other) && cast_.walls == 0) return false;
    const auto at = [&](double along) { return bolt.collar + along * bolt.direction - complex_.origin(); };
    const double share = share_of(bolt, pull, at(pull.leaves));
    if (!(share * pull.force > newtons(0))) {
      ++cast_.unsure_pulls;
      return false;
    }
    cast_.scene.ties.push_back({.body = pull.body.value_or(wall),
                                .other = pull.other.value_or(wall),
                                .end = at(pull.held),
                                .other_end = at(pull.anchored),
                                .capacity = share * pull.force,
                                .ductility = bolt.type.ductility});
    cast_.ties.push_back({.bolt = number, .leaves = pull.leaves, .anchored = pull.anchored});
    return true;
  }

  /// Of its tension, by its angle law: none where the movement that it would hold against is not known.
  double share_of(const stability::Bolt& bolt, const BoltPull& pull, Vec3 at) {
    if (bolt.type.angle == stability::AngleLaw::full) return 1;
    if (!unsupported_) unsupported_.emplace(cast_.scene, cast_.moving.size(), options_);
    const auto velocity = [&](std::optional<std::uint32_t> body) {
      return body ? unsupported_->velocity(*body, at) : Vec3{};
    };
    const std::optional<Vec3> near = velocity(pull.body), deep = velocity(pull.other);
    if (!near || !deep) return 0;
    const Vec3 apart = *near - *deep;
    // Less than that is rounding.
    if (!(norm(apart) > 1e-4 * options_.step * norm(options_.gravity))) return 0;
    return share_at_angle(bolt, apart).value_or(0);
  }

  const Scene& scene_;
  const Realization& made_;
  const BlockComplex& complex_;
  const motion::WorldOptions& options_;
  MotionCast& cast_;
  std::optional<Unsupported> unsupported_;
};

}  // namespace

void add_ties(const Scene& scene, const Realization& made, const BlockComplex& complex,
              const motion::WorldOptions& options, MotionCast& cast) {
  if (!scene.motion->support || !made.support || cast.moving.empty()) return;
  cast.supported = true;
  Ties{scene, made, complex, options, cast}.add_all();
}

void add_support_notes(const Scene& scene, const Realization& made, const MotionCast& cast, const MotionResult& result,
                       std::vector<std::string>& notes) {
  if (!scene.support || result.blocks.empty()) return;
  if (!cast.supported) {
    notes.emplace_back(scene.motion->support ? "motion: blocks move without their support, which was not judged"
                                             : "motion: blocks move without their support, as motion.support says");
    return;
  }
  if (!result.bolts.empty()) {
    std::string note =
        fmt::format("motion: {} of {} {} blocks that are let go, along the bolts; ", result.bolts.size(),
                    counted(made.support->bolts.size(), "bolt", "bolts"), result.bolts.size() == 1 ? "ties" : "tie");
    notes.push_back(note + fmt::format("{} broke, the largest force is {:.4g} kN", result.bolts_broken(),
                                       result.largest_bolt_force().si() / 1000));
  } else if (!made.support->bolts.empty()) {
    notes.emplace_back("motion: no bolt ties a block that is let go to other rock");
  }
  if (cast.late_bolts > 0) {
    notes.push_back("motion: " + counted(cast.late_bolts, "bolt goes", "bolts go") +
                    " through blocks that leave before it is put in, and holds none of those");
  }
  if (cast.unsure_pulls > 0) {
    notes.push_back("motion: " + counted(cast.unsure_pulls, "pull of a bolt", "pulls of bolts") +
                    " with an angle law left out: what they join does not begin to move so that they get longer");
  }
  if (cast.bolts_with_shear > 0) {
    notes.emplace_back("motion: bolts pull along their axes alone; their shear_capacity is left out");
  }
  if (scene.support->plan.shotcrete) notes.emplace_back("motion: blocks move without the shotcrete");
}

}  // namespace cleave::scene
