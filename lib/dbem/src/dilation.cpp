#include <algorithm>
#include <cmath>

#include "world_impl.hpp"

/// Rough faces: closed at the start they fit; slipped, they ride on one another's slopes (Patton 1966). A contact is
/// then one with a slope, inclined by the dilation angle against its edge, so that nothing is gained or lost but by
/// friction.
namespace cleave::dbem {

void World::Impl::add_mated(Mated side) {
  if (std::ranges::find(mated, side) != mated.end()) return;
  mated.push_back(side);
  // The side goes on past corners that carry nothing.
  const auto n = static_cast<std::uint32_t>(corner_count(side.body));
  const auto& sharp = shapes[side.body].sharp;
  for (const bool forwards : {true, false}) {
    Mated next = side;
    for (std::uint32_t k = 1; k < n; ++k) {
      const std::uint32_t corner = forwards ? (next.edge + 1) % n : next.edge;
      if (sharp[corner] != 0) break;
      next.edge = forwards ? corner : (next.edge + n - 1) % n;
      if (std::ranges::find(mated, next) == mated.end()) mated.push_back(next);
    }
  }
}

void World::Impl::make_mated() {
  for (const ContactCandidate& t : touches) {
    const JointLaw& law = law_of(t);
    const double feature = std::min(shapes[t.i].feature, shapes[t.j].feature);
    if (!(law.dilation > 0) || t.gap > 1e-6 * feature) continue;
    if (rides.empty()) rides.assign(size(), 0.0);
    for (const std::uint32_t b : {t.i, t.j}) rides[b] = std::max(rides[b], law.dilation * law.dilation_slip.si());
    add_mated({t.j, t.edge, t.i});
    // The side of the corner that lies along the edge.
    const auto n = static_cast<std::uint32_t>(corner_count(t.i));
    const auto corner_at = corners_of(corners, t.i);
    for (const std::uint32_t side : {t.vertex, (t.vertex + n - 1) % n}) {
      const Vec2 along = corner_at[(side + 1) % n] - corner_at[side];
      if (std::abs(dot(along, t.normal)) <= 1e-3 * norm(along)) add_mated({t.i, side, t.j});
    }
  }
  std::ranges::sort(mated);
  if (!mated.empty()) fat.clear();  // pairs reach as far as they can ride
}

void JointState::ride(ContactCandidate& touch, const State& at) const {
  if (mated.empty() || !std::ranges::binary_search(mated, Mated{touch.j, touch.edge, touch.i})) return;
  const JointLaw& law = law_of(touch);
  if (!(law.dilation > 0)) return;
  // Slip since the start, in the axes of the edge's body.
  const std::vector<Vec2>& edge_of = shapes[touch.j].corners;
  const Vec2 from = edge_of[touch.edge], to = edge_of[(touch.edge + 1) % edge_of.size()];
  const Vec2 along = (to - from) / norm(to - from);
  const Vec2 start = start_x[touch.i] - start_x[touch.j] + shapes[touch.i].corners[touch.vertex];
  const double slip = dot(rotated(touch.point - at.x[touch.j], -at.angle[touch.j]) - start, along);
  const double feature = std::min(shapes[touch.i].feature, shapes[touch.j].feature);
  if (std::abs(slip) <= contact_depth * feature) return;  // they fit
  if (std::abs(slip) >= law.dilation_slip.si()) {
    touch.gap -= law.dilation * law.dilation_slip.si();
    return;
  }
  const double angle = std::atan(law.dilation);
  touch.gap = std::cos(angle) * (touch.gap - law.dilation * std::abs(slip));
  touch.tilt = slip > 0 ? -angle : angle;
  touch.normal = rotated(touch.normal, touch.tilt);
}

double JointState::friction_of(const ContactCandidate& t, const Bond* bond) const {
  const JointLaw& law = law_of(t);
  const double whole = bond == nullptr ? law.residual_friction.value_or(law.friction) : law.friction;
  if (t.tilt == 0) return whole;
  return std::max(0.0, (whole - law.dilation) / (1 + whole * law.dilation));
}

}  // namespace cleave::dbem
