#include "cleave/stability/actions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "cleave/core/assert.hpp"

namespace cleave::stability {

namespace {

/// Of water that flows.
std::optional<std::string> wrong_with(const ActionSpec& spec) {
  const FlowWater& flow = *spec.flow;
  if (spec.water || !spec.joint_pressure.empty())
    return "that of the flow stands beside a table or pressures; give one";
  if (!std::isfinite(flow.unit_weight.si()) || flow.unit_weight < UnitWeight{}) {
    return fmt::format("unit weight {} N/m3 is not >= 0; water has 9810", flow.unit_weight.si());
  }
  for (const FlowWater::Contact& contact : flow.contacts) {
    if (!geometry::is_finite(contact.heads) || !geometry::is_finite(contact.at)) {
      return fmt::format("what flows against block {} is not finite", contact.block.index());
    }
  }
  for (const FlowWater::Standing& side : flow.standing) {
    if (!std::isfinite(side.level)) return "a level of standing water is not finite; give metres";
  }
  if (!std::ranges::is_sorted(flow.contacts, {}, &FlowWater::Contact::block)) {
    return "contacts are not in the order of their blocks; sort them";
  }
  return std::nullopt;
}

}  // namespace

std::string describe(const BadAction& error) { return fmt::format("{}: {}", error.which, error.what); }

std::expected<Actions, BadAction> Actions::make(ActionSpec spec) {
  const auto bad = [](std::string which, std::string what) {
    return std::unexpected(BadAction{std::move(which), std::move(what)});
  };
  if (spec.water) {
    if (!std::isfinite(spec.water->level)) return bad("water", "the table's level is not finite; give metres");
    if (!std::isfinite(spec.water->unit_weight.si()) || spec.water->unit_weight < UnitWeight{}) {
      return bad("water", fmt::format("unit weight {} N/m3 is not >= 0; water has 9810", spec.water->unit_weight.si()));
    }
  }
  for (const auto& pressure : spec.joint_pressure) {
    if (pressure && (!std::isfinite(*pressure) || *pressure < 0)) {
      return bad("water", fmt::format("pressure {} Pa is not >= 0; suction does not hold rock", *pressure));
    }
  }
  if (spec.flow) {
    if (auto wrong = wrong_with(spec)) return bad("water", *std::move(wrong));
  }
  for (std::size_t i = 0; i < spec.surcharges.size(); ++i) {
    const Surcharge& s = spec.surcharges[i];
    const std::string which = fmt::format("surcharge {}", i + 1);
    if (!geometry::is_finite(s.traction) || !std::isfinite(s.pressure.si()))
      return bad(which, "is not finite; give Pa");
    if (!s.within) continue;
    if (!geometry::is_finite(s.within->min) || !geometry::is_finite(s.within->max) ||
        !(s.within->min.x < s.within->max.x && s.within->min.y < s.within->max.y &&
          s.within->min.z < s.within->max.z)) {
      return bad(which, "its box is empty; min must be below max on each axis");
    }
  }
  for (std::size_t i = 0; i < spec.points.size(); ++i) {
    if (!geometry::is_finite(spec.points[i].at) || !geometry::is_finite(spec.points[i].force)) {
      return bad(fmt::format("point force {}", i + 1), "is not finite; give m and N");
    }
  }
  for (std::size_t i = 0; i < spec.lines.size(); ++i) {
    const LineForce& line = spec.lines[i];
    const std::string which = fmt::format("line force {}", i + 1);
    if (!geometry::is_finite(line.from) || !geometry::is_finite(line.to) || !geometry::is_finite(line.per_metre)) {
      return bad(which, "is not finite; give m and N/m");
    }
    if (line.from == line.to) return bad(which, "has no length; use a point force");
  }
  Actions actions;
  actions.spec_ = std::move(spec);
  return actions;
}

Actions Actions::with_water_level(double level) const {
  Actions other = *this;
  if (other.spec_.water) other.spec_.water->level = level;
  return other;
}

Actions Actions::with_flow(FlowWater water) const {
  Actions other = *this;
  other.spec_.flow = std::move(water);
  CLEAVE_ASSERT(!wrong_with(other.spec_));
  return other;
}

Actions Actions::with_pressures_of(std::span<const std::size_t> from) const {
  Actions other = *this;
  other.spec_.joint_pressure.clear();
  other.spec_.or_table.clear();
  for (const std::size_t k : from) {
    other.spec_.joint_pressure.push_back(k < spec_.joint_pressure.size() ? spec_.joint_pressure[k] : std::nullopt);
    other.spec_.or_table.push_back(k < spec_.or_table.size() ? spec_.or_table[k] : std::uint8_t{0});
  }
  return other;
}

}  // namespace cleave::stability
