#include "cleave/stability/analyse.hpp"

#include <utility>

#include "analyse_complex.hpp"
#include "cleave/core/assert.hpp"
#include "cleave/core/fields.hpp"

namespace cleave::stability {

std::string_view name(Mode mode) noexcept { return enum_name(mode); }

bool moves(Mode mode) noexcept {
  switch (mode) {
    case Mode::falling:
    case Mode::lifting:
    case Mode::sliding:
    case Mode::wedge: return true;
    case Mode::stable:
    case Mode::tapered: return false;
  }
  std::unreachable();
}

Settings with_strengths_over(const Settings& settings, double factor) {
  Settings reduced = settings;
  const auto partial = PartialFactors::make(settings.partial.friction() * factor, settings.partial.cohesion() * factor,
                                            settings.partial.weight());
  CLEAVE_ASSERT(partial.has_value());
  reduced.partial = *partial;
  return reduced;
}

Analysis analyse(const topology::AuditedComplex& complex, const Settings& settings) {
  return analyse_complex(complex.complex(), settings);
}

}  // namespace cleave::stability
