#include "cleave/flow/flow.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "discretisation.hpp"

namespace cleave::flow {
namespace {

using Fault = std::optional<BadNetwork>;

Fault bad(const char* kind, std::size_t number, const char* what) {
  return BadNetwork{kind + (' ' + std::to_string(number)), what};
}

Fault fault_of_triangle(const NetworkSpec& spec, std::size_t t) {
  const auto& corners = spec.mesh.triangles[t];
  for (const std::uint32_t c : corners) {
    if (c >= spec.mesh.points.size()) return bad("triangle", t, "names a point that is not there");
  }
  if (spec.mesh.part[t] >= spec.transmissivity.size()) return bad("triangle", t, "is of a part that is not there");
  const auto [a, b, c] = corners;
  const auto& at = spec.mesh.points;
  const auto apart = [&](std::uint32_t p, std::uint32_t q) { return p != q && at[p] != at[q]; };
  if (!apart(a, b) || !apart(b, c) || !apart(c, a)) return bad("triangle", t, "has a side without length");
  return std::nullopt;
}

Fault fault_of_borders(const NetworkSpec& spec) {
  const Sides sides{spec.mesh};
  std::vector<std::uint8_t> seen(sides.count(), 0);
  for (std::size_t b = 0; b < spec.mesh.borders.size(); ++b) {
    const Border& border = spec.mesh.borders[b];
    if (border.surface >= spec.surfaces.size()) return bad("border", b, "is on a surface that is not there");
    const auto side = sides.find(border.ends[0], border.ends[1]);
    if (!side) return bad("border", b, "is no side of a triangle");
    if (std::exchange(seen[*side], std::uint8_t{1}) != 0) return bad("border", b, "is there already");
  }
  return std::nullopt;
}

Fault fault_of(const NetworkSpec& spec) {
  const Mesh& mesh = spec.mesh;
  if (mesh.triangles.size() >= UINT32_MAX / 8) return BadNetwork{"mesh", "has too many triangles"};
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    if (!geometry::is_finite(mesh.points[p])) return bad("point", p, "is not finite");
  }
  for (std::size_t p = 0; p < spec.transmissivity.size(); ++p) {
    const double t = spec.transmissivity[p].si();
    if (!(t > 0) || !std::isfinite(t)) return bad("part", p, "has a transmissivity that is not above 0");
  }
  for (std::size_t s = 0; s < spec.surfaces.size(); ++s) {
    const auto* standing = std::get_if<Standing>(&spec.surfaces[s]);
    if (standing != nullptr && !std::isfinite(standing->level.si())) return bad("surface", s, "has no finite level");
  }
  if (mesh.part.size() != mesh.triangles.size()) return BadNetwork{"mesh", "does not name a part for each triangle"};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (Fault fault = fault_of_triangle(spec, t)) return fault;
  }
  return fault_of_borders(spec);
}

}  // namespace

std::expected<Network, BadNetwork> Network::make(NetworkSpec spec) {
  if (Fault fault = fault_of(spec)) return std::unexpected(*std::move(fault));
  return Network{std::move(spec)};
}

std::string describe(const BadNetwork& error) { return error.which + ' ' + error.what; }

}  // namespace cleave::flow
