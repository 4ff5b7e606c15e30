#include <algorithm>

#include "world_impl.hpp"

namespace cleave::dbem {

bool ContactSolve::bounces(const Island& island, const ContactCandidate& touch, double closing, double step) const {
  return island.impact && closing < -1e-6 && touch.gap + step * closing <= 0 && law_of(touch).restitution > 0;
}

/// Two impacts one after the other in one step: the second would give nothing back, for at the start of the step its
/// bodies did not yet close. The share of the step that ends with the first one; 1 where there is no second. A group in
/// which nothing seems to hit at the start gives nothing back either, though a body that turns or falls faster may hit
/// before the end, and so may what is seen to hit by the geometry in the middle of the step alone: then the share that
/// ends just before it does.
double ContactSolve::until_first_bounce(const std::vector<ContactCandidate>& list, const Island& island,
                                        const Rows& rows, const ContactSolution& found, double step) const {
  if (step <= 1e-3 * options.step) return 1;
  double first = step, soonest = step;
  bool second = false;
  for (std::size_t k = 0; k < island.touches.size(); ++k) {
    const ContactCandidate& touch = list[island.touches[k]];
    if (law_of(touch).restitution <= 0) continue;
    const double closing = velocity_of(rows, k, state).x;
    if (bounces(island, touch, closing, step)) {
      first = std::min(first, std::max(touch.gap, 0.0) / -closing);
    } else {
      const double feature = std::min(shapes[touch.i].feature, shapes[touch.j].feature);
      if (found.impulse[k].x <= 0 || touch.gap <= 2 * contact_depth * feature) continue;
      if (!island.impact && closing > -norm(options.gravity) * step - 1e-6) continue;  // it is laid down, not thrown
      second = true;
      if (closing < 0) soonest = std::min(soonest, touch.gap / -closing);
    }
  }
  if (!second) return 1;
  return island.impact ? std::clamp(1.0001 * first / step, 0.02, 0.5) : std::clamp(0.98 * soonest / step, 0.02, 0.9);
}

}  // namespace cleave::dbem
