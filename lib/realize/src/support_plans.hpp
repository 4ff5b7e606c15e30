#pragma once

#include <algorithm>
#include <iterator>
#include <utility>

#include "judge.hpp"

namespace cleave::scene {

inline stability::SupportPlan with_targets(stability::SupportPlan plan, const Targets& target) {
  plan.target_falling = target.falling;
  plan.target_sliding = target.sliding;
  return plan;
}

/// Spot bolts where one load after the other asks for them beside what stands by then: under every load all of them
/// stand. `checks`: of a plan under each load.
void place_spot_bolts(stability::SupportPlan& plan, auto& checks) {
  const bool factors = std::exchange(plan.factors, false);
  for (auto& check : checks) std::ranges::copy(newly_placed(check(plan), plan), std::back_inserter(plan.placed));
  plan.factors = factors;
  plan.spot.reset();
}
/// One load alone places them as it is checked.
stability::SupportPlan with_spot_bolts(stability::SupportPlan plan, auto& checks) {
  if (plan.spot && checks.size() > 1) place_spot_bolts(plan, checks);
  return plan;
}

}  // namespace cleave::scene
