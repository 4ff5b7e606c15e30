#include "transfer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <ranges>

#include "verdict.hpp"

namespace cleave::stability {
namespace {

using geometry::Vec3;
using topology::BlockId;

/// A face is pushed when the motion goes into it by more than rounding: a block that slides along a face does not lean
/// on it.
constexpr double pushes = 0x1p-40;

struct Received {
  Vec3 force;        ///< N
  double scale = 0;  ///< N, sum of the magnitudes they were computed from
};

struct Push {
  BlockId onto;
  double weight;  ///< area projected on the motion, m2
  double shear_ratio;
};

double shear_ratio(double cosine, const JointStrength& strength, const Settings& settings) {
  const double tangent = std::sqrt(std::max(0.0, 1 - cosine * cosine)) / cosine;
  const double friction = strength.tan_friction() / settings.partial.friction();
  if (tangent < 0x1p-40) return 0;  // straight on
  return friction > 0 ? tangent / friction : std::numeric_limits<double>::infinity();
}

/// The effective faces E(b): patches to blocks of earlier batches that the motion goes into.
std::vector<Push> effective_faces(Model& model, BlockId block, std::uint32_t batch, Vec3 direction) {
  std::vector<Push> pushed;
  for (const topology::FaceId id : model.complex().blocks()[block].faces) {
    const topology::Face& face = model.complex().faces()[id];
    if (face.role != topology::Role::joint) continue;
    const double cosine = -geometry::dot(direction, model.inward(face).unit());
    if (!(cosine > pushes)) continue;
    for (const topology::Patch& patch : model.complex().patches(face)) {
      if (!patch.neighbour || model.present(*patch.neighbour, batch)) continue;
      const double ratio = shear_ratio(cosine, model.settings().strengths.of(patch.joint), model.settings());
      pushed.push_back({*patch.neighbour, patch.area.si() * cosine, ratio});
    }
  }
  return pushed;
}

}  // namespace

void transfer_forces(Model& model, Analysis& analysis) {
  analysis.force_transfer = true;
  IdVector<BlockId, Received> received(model.complex().blocks().size());
  const auto judgement_of = [&](BlockId id) -> Judgement& {
    return *std::ranges::lower_bound(analysis.judgements, id, {}, &Judgement::block);
  };
  for (const Batch& batch : analysis.batches | std::views::reverse) {
    for (const BlockId id : batch.blocks) {
      const Received incoming = received[id];
      Resultant resultant = model.applied_forces(id, batch.number);
      resultant.add(incoming.force, incoming.scale);
      const Verdict verdict = judge(model.contacts(id, batch.number), resultant, model.settings());
      analysis.equilibrium_residual = std::max(analysis.equilibrium_residual, verdict.residual);

      Transferred result{.mode = verdict.mode, .key = verdict.key, .direction = verdict.direction};
      result.driving = newtons(verdict.driving);
      result.resistance = newtons(verdict.resistance.least);
      result.net = newtons(verdict.net);
      result.factor_of_safety = verdict.factor_of_safety;
      result.received = incoming.force;
      result.tie = verdict.tie;
      if (verdict.key && batch.number > 1) {
        const auto pushed = effective_faces(model, id, batch.number, verdict.direction);
        double total = 0;
        for (const Push& push : pushed) total += push.weight;
        result.self_held = !(total > 0);
        if (total > 0) {
          result.passed = newtons(verdict.net);
          for (const Push& push : pushed) {
            const double share = push.weight / total;
            received[push.onto].force += verdict.net * share * verdict.direction;
            received[push.onto].scale += share * resultant.scale();
            result.passes.push_back({push.onto, verdict.net * share * verdict.direction});
            result.shear_ratio = std::max(result.shear_ratio, push.shear_ratio);
          }
        }
      }
      judgement_of(id).transferred = result;
    }
  }
}

}  // namespace cleave::stability
