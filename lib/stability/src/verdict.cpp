#include "verdict.hpp"

#include <algorithm>
#include <utility>

namespace cleave::stability {
namespace {

using geometry::Vec3;

Mode mode_of(const Motion& motion, Vec3 gravity) {
  switch (motion.kind) {
    case MotionKind::none:
    case MotionKind::held: return Mode::stable;
    case MotionKind::free: return geometry::dot(motion.s, gravity) >= 0 ? Mode::falling : Mode::lifting;
    case MotionKind::one_plane: return Mode::sliding;
    case MotionKind::two_planes: return Mode::wedge;
  }
  std::unreachable();
}

double residual(const Contacts& contacts, const Resultant& resultant, const Motion& motion, const Resistance& held) {
  Vec3 sum = resultant.newtons() - motion.s;
  for (const auto& [group, reaction] : held.pressing) sum += reaction * contacts.cone.groups()[group].unit();
  return geometry::norm(sum) / resultant.scale();
}

}  // namespace

Verdict judge(const Contacts& contacts, const Resultant& resultant, const Settings& settings) {
  Verdict verdict;
  const Motion motion = project(contacts.cone, resultant);
  verdict.mode = mode_of(motion, settings.loads.gravity());
  verdict.tie = motion.tie;
  if (!moves(verdict.mode)) return verdict;
  verdict.driving = geometry::norm(motion.s);
  verdict.direction = motion.s / verdict.driving;
  verdict.resistance = resistance(contacts, resultant, motion, settings.parallel_contact);
  verdict.residual = residual(contacts, resultant, motion, verdict.resistance);
  verdict.net = verdict.driving - verdict.resistance.least;
  verdict.factor_of_safety = verdict.resistance.least / verdict.driving;
  // At the limit (FoS = 1 to the rounding of normals and of tan) the sign of T - R is noise: such a block holds.
  verdict.key = verdict.net > 0x1p-40 * verdict.driving;
  return verdict;
}

std::vector<Pressing> pressing_of(const Contacts& contacts, const Verdict& verdict) {
  const Resistance& held = verdict.resistance;
  const double mobilised = 1 / std::max(1.0, verdict.factor_of_safety);
  std::vector<Pressing> out;
  out.reserve(held.pressing.size());
  for (std::size_t k = 0; k < held.pressing.size(); ++k) {
    const auto& [group, reaction] = held.pressing[k];
    out.push_back({contacts.groups[group].face, newtons(reaction), newtons(mobilised * held.strength[k])});
  }
  return out;
}

}  // namespace cleave::stability
