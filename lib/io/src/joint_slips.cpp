#include "joint_slips.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <variant>

#include "cleave/core/overloaded.hpp"

namespace cleave::io {
namespace {

/// Plane, place and size to the last digit.
std::string joint_of(const JointRow& row) {
  const std::string size =
      std::visit(overloaded{[](Persistent) { return std::string{}; },
                            [](const DiscSize& disc) { return fmt::format("{}", disc.radius.si()); },
                            [](const RectangleSize& r) {
                              return fmt::format("{} {} {}", r.side_a.si(), r.side_b.si(), r.rotation.degrees());
                            }},
                 row.size);
  return fmt::format("{} {} {} {} {} {}", row.plane.dip.degrees(), row.plane.direction.degrees(), row.position->x,
                     row.position->y, row.position->z, size);
}

}  // namespace

std::optional<std::string> note_on_endless(std::span<const JointRow> rows) {
  std::size_t endless = 0;
  const JointRow* first = nullptr;
  for (const JointRow& row : rows) {
    if (!std::holds_alternative<Persistent>(row.size)) continue;
    if (endless++ == 0) first = &row;
  }
  if (endless == 0) return std::nullopt;
  return fmt::format("{} of {} joints {} no size (the first in line {}): {} through the whole domain", endless,
                     rows.size(), endless == 1 ? "has" : "have", first->line, endless == 1 ? "it goes" : "they go");
}

std::optional<std::string> note_on_repeated(std::span<const JointRow> rows) {
  std::map<std::string, std::uint32_t> seen;
  std::size_t repeated = 0;
  std::array<std::uint32_t, 2> first{};
  for (const JointRow& row : rows) {
    if (!row.position) continue;
    const auto [at, added] = seen.try_emplace(joint_of(row), row.line);
    if (added) continue;
    if (repeated++ == 0) first = {row.line, at->second};
  }
  if (repeated == 0) return std::nullopt;
  return fmt::format("{} {} the joint of an earlier one (line {} that of line {}): check them", repeated,
                     repeated == 1 ? "row repeats" : "rows repeat", first[0], first[1]);
}

}  // namespace cleave::io
