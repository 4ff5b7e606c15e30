#pragma once

#include "cleave/core/assert.hpp"
#include "cleave/stability/analyse.hpp"

namespace cleave::stability {

/// The settings with friction and cohesion divided by a factor > 0, as well as by their partial factors.
[[nodiscard]] inline Settings with_strengths_over(const Settings& settings, double factor) {
  Settings reduced = settings;
  const auto partial = PartialFactors::make(settings.partial.friction() * factor, settings.partial.cohesion() * factor,
                                            settings.partial.weight());
  CLEAVE_ASSERT(partial.has_value());
  reduced.partial = *partial;
  return reduced;
}

}  // namespace cleave::stability
