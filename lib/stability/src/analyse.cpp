#include "cleave/stability/analyse.hpp"

#include <utility>

#include "analyse_complex.hpp"

namespace cleave::stability {

std::string_view name(Mode mode) noexcept {
  switch (mode) {
    case Mode::falling: return "falling";
    case Mode::lifting: return "lifting";
    case Mode::sliding: return "sliding";
    case Mode::wedge: return "wedge";
    case Mode::stable: return "stable";
    case Mode::tapered: return "tapered";
  }
  std::unreachable();
}

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
