#include "cleave/stability/analyse.hpp"

#include <utility>

#include "analyse_complex.hpp"
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

Analysis analyse(const topology::AuditedComplex& complex, const Settings& settings) {
  return analyse_complex(complex.complex(), settings);
}

}  // namespace cleave::stability
