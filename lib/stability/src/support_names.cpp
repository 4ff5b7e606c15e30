#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "cleave/core/overloaded.hpp"
#include "cleave/stability/support.hpp"

namespace cleave::stability {

std::string_view name(BoltStatus status) noexcept {
  switch (status) {
    case BoltStatus::holds: return "holds";
    case BoltStatus::group: return "group";
    case BoltStatus::redundant: return "redundant";
    case BoltStatus::too_short: return "too short";
    case BoltStatus::compression: return "compression";
    case BoltStatus::no_block: return "no block";
    case BoltStatus::off: return "off the rock";
  }
  std::unreachable();
}

std::string_view name(Held held) noexcept {
  switch (held) {
    case Held::bolts: return "bolts";
    case Held::shotcrete: return "shotcrete";
    case Held::together: return "bolts and shotcrete";
    case Held::not_held: return "not held";
  }
  std::unreachable();
}

std::optional<std::string> problem_of(const SupportPlan& plan) {
  const auto good = [](double v) { return std::isfinite(v) && v >= 0; };
  const auto good_kind = [&](const BoltKind& kind) {
    return std::visit(overloaded{[&](const GroutedBar& k) { return good(k.bond.si()) && good(k.shear.si()); },
                                 [&](const FrictionTube& k) { return good(k.bond.si()) && good(k.shear.si()); },
                                 [&](const Cable& k) { return good(k.bond.si()) && good(k.free_length.si()); },
                                 [&](const MechanicalAnchor& k) { return good(k.capacity.si()); }},
                      kind);
  };
  const auto good_type = [&](const BoltType& t) {
    return good(t.tendon.si()) && good(t.plate.si()) && good(t.anchorage.si()) && good_kind(t.kind);
  };
  for (std::size_t i = 0; i < plan.bolts.size(); ++i) {
    const Bolt& bolt = plan.bolts[i];
    if (!good_type(bolt.type)) return fmt::format("bolt {}: capacities must be finite and >= 0", i + 1);
    if (!(bolt.length > metres(0)) || !std::isfinite(bolt.length.si()))
      return fmt::format("bolt {}: length must be > 0", i + 1);
    if (!geometry::is_finite(bolt.collar) || std::abs(geometry::norm(bolt.direction) - 1) > 1e-9) {
      return fmt::format("bolt {}: collar must be finite and direction a unit vector", i + 1);
    }
  }
  if (!(plan.target_falling > 0) || !(plan.target_sliding > 0)) return "targets must be > 0";
  return std::nullopt;
}

}  // namespace cleave::stability
