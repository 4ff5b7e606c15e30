#include "transfer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <ranges>
#include <utility>

#include "nonnegative.hpp"
#include "prefetch.hpp"
#include "verdict.hpp"

namespace cleave::stability {
namespace {

using geometry::dot;
using geometry::norm;
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
  Vec3 into;        ///< unit normal of the face, into the block pushed
  double weight;    ///< area projected on the motion, m2
  double cosine;    ///< of the angle between motion and normal
  double tangent;   ///< tan(friction) of the face
  double cohesion;  ///< N, over the face
  [[nodiscard]] double shear_ratio() const {
    const double shear = std::sqrt(std::max(0.0, 1 - cosine * cosine)) / cosine;
    if (shear < 0x1p-40) return 0;  // straight on
    return tangent > 0 ? shear / tangent : std::numeric_limits<double>::infinity();
  }
};

/// The effective faces E(b): patches to blocks of earlier batches that the motion goes into.
void effective_faces(Model& model, BlockId block, std::uint32_t batch, Vec3 direction, std::vector<Push>& pushed) {
  pushed.clear();
  const Settings& settings = model.settings();
  for (const topology::FaceId id : model.complex().blocks()[block].faces) {
    const topology::Face& face = model.complex().faces()[id];
    if (face.role != topology::Role::joint) continue;
    const Vec3 into = -model.inward(face).unit();
    const double cosine = dot(direction, into);
    if (!(cosine > pushes)) continue;
    for (const topology::Patch& patch : model.complex().patches(face)) {
      if (!patch.neighbour || model.present(*patch.neighbour, batch)) continue;
      const JointStrength& strength = settings.strengths.of(patch.joint);
      pushed.push_back({*patch.neighbour, into, patch.area.si() * cosine, cosine,
                        strength.tan_friction() / settings.partial.friction(),
                        strength.cohesion().si() * patch.area.si() / settings.partial.cohesion()});
    }
  }
}

/// The mode from before, with its formulas, under another resultant. Reactions that would have to pull are none.
Verdict kept_mode(const Contacts& contacts, const Resultant& resultant, const Judgement& before,
                  const Settings& settings) {
  Verdict verdict;
  verdict.mode = before.mode;
  const Vec3 r = resultant.newtons();
  Motion motion;
  motion.kind = MotionKind::free;
  motion.s = r;
  std::vector<std::uint32_t> groups;
  for (const Pressing& p : before.pressing) {
    for (std::uint32_t g = 0; g < contacts.groups.size(); ++g) {
      if (contacts.groups[g].face == p.face) groups.push_back(g);
    }
  }
  if (groups.size() == 1) {
    const Vec3 n = contacts.cone.groups()[groups[0]].unit();
    motion.kind = MotionKind::one_plane;
    motion.s = r - dot(n, r) * n;
    motion.groups = {groups[0], groups[0]};
    motion.reactions = {std::max(0.0, -dot(n, r)), 0};
  } else if (groups.size() == 2) {
    const Direction& a = contacts.cone.groups()[groups[0]];
    const Direction& b = contacts.cone.groups()[groups[1]];
    const Vec3 e = cross(a, b);
    const double q = dot(e, e);
    motion.kind = MotionKind::two_planes;
    motion.s = e * (dot(e, r) / q);
    motion.groups = {groups[0], groups[1]};
    motion.reactions = {std::max(0.0, -dot(cross(r, b.unit()), e) / q), std::max(0.0, dot(cross(r, a.unit()), e) / q)};
  }
  motion.touching = groups;
  verdict.driving = norm(motion.s);
  if (!(verdict.driving > 0)) return verdict;
  verdict.direction = motion.s / verdict.driving;
  verdict.resistance = resistance(contacts, resultant, motion, settings.parallel_contact);
  verdict.net = verdict.driving - verdict.resistance.least;
  verdict.factor_of_safety = verdict.resistance.least / verdict.driving;
  verdict.key = verdict.net > 0x1p-40 * verdict.driving;
  return verdict;
}

class Passing final {
 public:
  Passing(Model& model, Analysis& analysis)
      : model_{&model},
        analysis_{&analysis},
        place_(model.complex().blocks().size()),
        received_(analysis.judgements.size()) {
    for (std::uint32_t i = 0; i < analysis.judgements.size(); ++i) place_[analysis.judgements[i].block] = i;
  }

  void run() {
    for (const Batch& batch : analysis_->batches | std::views::reverse) {
      for (std::size_t i = 0; i < batch.blocks.size(); ++i) {
        if (i + 4 < batch.blocks.size())
          __builtin_prefetch(&analysis_->judgements[place_[batch.blocks[i + 4]]].driving);
        prefetch(model_->complex(), batch.blocks, i);
        judge_and_pass(batch.blocks[i], batch.number);
      }
    }
  }

 private:
  [[nodiscard]] const TransferReadings& readings() const { return model_->settings().transfer; }

  void judge_and_pass(BlockId id, std::uint32_t batch) {
    const std::uint32_t place = place_[id];
    Judgement& judgement = analysis_->judgements[place];
    const Received incoming = received_[place];
    if (incoming.force == Vec3{}) {
      // Nothing was passed to it: what was found of it holds, and need not be found again.
      Transferred& result = judgement.transferred.emplace();
      result.mode = judgement.mode;
      result.key = judgement.key;
      result.direction = judgement.direction;
      result.driving = judgement.driving;
      result.resistance = judgement.resistance;
      result.net = judgement.net;
      result.factor_of_safety = judgement.factor_of_safety;
      result.tie = judgement.tie;
      result.pressing = judgement.pressing;
      const bool slides = judgement.key && !(judgement.rotation && judgement.rotation->turns);
      if (slides && batch > 1) pass(id, batch, model_->applied_forces(id, batch).scale(), result);
      return;
    }
    Resultant resultant = model_->applied_forces(id, batch);
    resultant.add(incoming.force, incoming.scale);
    const Contacts contacts = model_->contacts(id, batch);
    const bool keeps = readings().receiver == TransferReadings::Receiver::keeps_mode && moves(judgement.mode) &&
                       incoming.force != Vec3{};
    const Verdict verdict = keeps ? kept_mode(contacts, resultant, judgement, model_->settings())
                                  : judge(contacts, resultant, model_->settings());
    analysis_->equilibrium_residual = std::max(analysis_->equilibrium_residual, verdict.residual);

    Transferred result{.mode = verdict.mode, .key = verdict.key, .direction = verdict.direction};
    result.driving = newtons(verdict.driving);
    result.resistance = newtons(verdict.resistance.least);
    result.net = newtons(verdict.net);
    result.factor_of_safety = verdict.factor_of_safety;
    result.received = incoming.force;
    result.tie = verdict.tie;
    result.pressing = pressing_of(contacts, verdict);
    // A block that leaves because it turns passes nothing on: only translation gives a force to pass.
    if (judgement.rotation && judgement.rotation->turns && judgement.key) result.key = true;
    if (verdict.key && batch > 1) pass(id, batch, resultant.scale(), result);
    judgement.transferred = std::move(result);
  }

  /// `scale` of the forces that `result` was found from.
  void pass(BlockId id, std::uint32_t batch, double scale, Transferred& result) {
    effective_faces(*model_, id, batch, result.direction, pushed_);
    const std::vector<Push>& pushed = pushed_;
    double total = 0;
    for (const Push& push : pushed) total += push.weight;
    result.self_held = !(total > 0);
    if (!(total > 0)) return;
    const double force = readings().force == TransferReadings::Force::driving ? result.driving.si() : result.net.si();
    result.passed = newtons(force);
    for (const Push& push : pushed) result.shear_ratio = std::max(result.shear_ratio, push.shear_ratio());
    const std::vector<Vec3> forces = readings().along == TransferReadings::Along::normals
                                         ? along_normals(pushed, force, result)
                                         : in_line(pushed, total, force, result);
    result.passes.reserve(pushed.size());
    for (std::size_t i = 0; i < pushed.size(); ++i) {
      if (forces[i] == Vec3{}) continue;
      const std::uint32_t theirs = model_->removed_in(pushed[i].onto);  // 0: left out from the start, holds nothing
      if (theirs == 0 || (readings().reach == TransferReadings::Reach::adjacent && theirs + 1 != batch)) {
        result.lost += norm(forces[i]);
        continue;
      }
      Received& receiver = received_[place_[pushed[i].onto]];
      receiver.force += forces[i];
      receiver.scale += scale * norm(forces[i]) / force;
      result.passes.push_back({pushed[i].onto, forces[i]});
    }
  }

  [[nodiscard]] std::vector<Vec3> in_line(const std::vector<Push>& pushed, double total, double force,
                                          Transferred& result) const {
    std::vector<Vec3> forces;
    forces.reserve(pushed.size());
    for (const Push& push : pushed) {
      const double share = force * (push.weight / total);
      Vec3 f = share * result.direction;
      if (readings().interface == TransferReadings::Interface::strength) {
        const double normal = share * push.cosine;
        const Vec3 shear = f - normal * push.into;
        const double most = normal * push.tangent + push.cohesion, size = norm(shear);
        if (size > most) {
          f = normal * push.into + (most / size) * shear;
          result.lost += size - most;
        }
      }
      forces.push_back(f);
    }
    return forces;
  }

  /// F s^ = sum lam m - sum dN n, both >= 0, least squares and shortest.
  [[nodiscard]] std::vector<Vec3> along_normals(const std::vector<Push>& pushed, double force, Transferred& result) {
    Columns columns;
    for (const Push& push : pushed) columns.push_back({push.into.x, push.into.y, push.into.z});
    for (const Pressing& pressing : result.pressing) {
      const Vec3 n = model_->inward(model_->complex().faces()[pressing.face]).unit();
      columns.push_back({-n.x, -n.y, -n.z});
    }
    const Vec3 s = result.direction;
    const NonNegative found = shortest_nonnegative(columns, {s.x, s.y, s.z});
    std::vector<Vec3> forces;
    for (std::size_t i = 0; i < pushed.size(); ++i) forces.push_back(force * found.x[i] * pushed[i].into);
    for (std::size_t i = pushed.size(); i < columns.size(); ++i) {
      if (found.x[i] > 0)
        result.added.push_back({result.pressing[i - pushed.size()].face, newtons(force * found.x[i])});
    }
    const double left = norm({found.residual[0], found.residual[1], found.residual[2]});
    if (left > 1e-12) result.lost += force * left;
    return forces;
  }

  Model* model_;
  Analysis* analysis_;
  IdVector<BlockId, std::uint32_t> place_;  ///< of a block's judgement; of any block of a batch there is one
  std::vector<Received> received_;          ///< parallel to the judgements
  std::vector<Push> pushed_;
};

}  // namespace

void transfer_forces(Model& model, Analysis& analysis) {
  analysis.force_transfer = true;
  Passing{model, analysis}.run();
}

}  // namespace cleave::stability
