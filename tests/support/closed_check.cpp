#include "closed_check.hpp"

#include <fmt/format.h>

#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"

namespace cleave::support {

std::optional<std::string> fault_of(const ClosedTrial& trial) {
  using geometry::Vec3;
  const double h = trial.half * trial.at.scale;
  const Vec3 middle = trial.at.shift;
  auto domain = geometry::make_box(middle - Vec3{h, h, h}, middle + Vec3{h, h, h});
  if (!domain) return std::nullopt;
  topology::CutInput input{.domain = *std::move(domain)};
  input.snap = metres(trial.snap);
  for (const auto& corners : trial.polygons) {
    auto polygon = geometry::Polygon::make(corners);
    if (!polygon) return std::nullopt;
    input.joints.emplace_back(topology::Joint{{*std::move(polygon)}});
  }
  auto complex = topology::cut(input);
  if (!complex) return describe(complex.error());
  const std::size_t blocks = complex->blocks().size();
  std::size_t round = 0;
  for (const topology::Block& block : complex->blocks()) round += block.convex ? 1 : 0;
  const std::uint64_t missed = complex->report().near_misses.sides;
  const auto audited = topology::audit(*std::move(complex));
  if (!audited) return "certificate: " + describe(audited.error());
  if (blocks != trial.expected || (trial.convex && round + 1 < trial.expected)) {
    return fmt::format("{} blocks, {} convex, {} expected", blocks, round, trial.expected);
  }
  if (missed > 0) return fmt::format("{} sides are said to miss others", missed);
  return "";
}

}  // namespace cleave::support
