#include "face_pressures.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "free_faces.hpp"

namespace cleave::stability {

using geometry::dot;
using geometry::norm;
using geometry::Vec3;
using topology::BlockId;

constexpr double no_pressure_does = std::numeric_limits<double>::infinity();

FacePressures::FacePressures(const topology::BlockComplex& complex, const Settings& settings, const Analysis& pushing,
                             const SupportPlan& plan, std::function<bool(BlockId)> gone)
    : complex_{&complex},
      settings_{&settings},
      pushing_{&pushing},
      plan_{&plan},
      gone_{std::move(gone)},
      model_{complex, settings} {
  for (const Batch& batch : pushing.batches) {
    for (const BlockId id : batch.blocks) model_.remove(id, batch.number);
  }
  for (const Judgement& giver : pushing.judgements) {
    if (!giver.transferred || !giver.batch) continue;
    for (const Passed& passed : giver.transferred->passes) {
      auto& of_receiver = givers_[passed.onto];
      if (of_receiver.empty() || of_receiver.back() != &giver) of_receiver.push_back(&giver);
    }
  }
}

double FacePressures::needed(BlockId block, const Body& body) const {
  if (!moves(body.bare.mode) || !body.lacks()) return 0;
  const Vec3 push = push_of_pressure(*complex_, block, body.bare.direction, gone_);
  const double against = -dot(push, body.bare.direction);
  if (!(against > 0)) return no_pressure_does;
  const double limit = 4 * body.target * body.bare.driving / against;
  const auto least = least_share(body, {.force = limit * push}, *settings_);
  return least ? limit * least->share : no_pressure_does;
}

double FacePressures::needed_alone(BlockId block) { return needed(block, body_of(block, 1, {})); }

Body FacePressures::body_of(BlockId block, std::uint32_t batch, std::span<const Giver> givers) {
  Body body{.contacts = model_.contacts_of({&block, 1}, batch), .resultant = {}, .bare = {}};
  body.resultant = model_.applied_forces(block, batch);
  for (const Giver& giver : givers) body.resultant.add(giver.force, norm(giver.force));
  body.bare = judge(body.contacts, body.resultant, *settings_);
  body.target = target_of(body.bare.mode, *plan_);
  keep_cohesion_of(body.bare, body.resultant, settings_->parallel_contact, body.contacts);
  return body;
}

double FacePressures::with_givers(BlockId block, std::uint32_t batch) {
  std::vector<Giver> givers;
  if (const auto found = givers_.find(block); found != givers_.end()) {
    for (const Judgement* giver : found->second) {
      Vec3 force;
      for (const Passed& passed : giver->transferred->passes) {
        if (passed.onto == block) force += passed.force;
      }
      givers.push_back({giver->block, force, enough_for(*giver)});
    }
  }
  std::ranges::sort(givers, {}, [](const Giver& giver) { return std::pair{giver.enough, giver.block}; });
  double least = needed(block, body_of(block, batch, givers));
  for (std::size_t held = 1; held <= givers.size() && givers[held - 1].enough < least; ++held) {
    const double rest = needed(block, body_of(block, batch, std::span{givers}.subspan(held)));
    least = std::min(least, std::max(givers[held - 1].enough, rest));
  }
  return least;
}

double FacePressures::enough_for(const Judgement& giver) {
  if (const auto known = enough_.find(giver.block); known != enough_.end()) return known->second;
  const bool open = std::ranges::any_of(complex_->blocks()[giver.block].faces, [&](topology::FaceId face) {
    return is_open(*complex_, complex_->faces()[face], gone_);
  });
  const double enough = open ? with_givers(giver.block, *giver.batch) : no_pressure_does;
  enough_.emplace(giver.block, enough);
  return enough;
}

}  // namespace cleave::stability
