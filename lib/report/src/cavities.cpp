#include "cavities.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "cleave/geometry/solid.hpp"
#include "cleave/topology/cut.hpp"
#include "polygons.hpp"

namespace cleave::report::detail {
namespace {

using geometry::Vec3;
using topology::Block;
using topology::BlockComplex;
using topology::BlockId;

constexpr std::array<double Vec3::*, 3> axes{&Vec3::x, &Vec3::y, &Vec3::z};

struct Extent {
  Vec3 low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
           std::numeric_limits<double>::infinity()};
  Vec3 high = -low;

  void include(Vec3 p) {
    for (const auto axis : axes) {
      low.*axis = std::min(low.*axis, p.*axis);
      high.*axis = std::max(high.*axis, p.*axis);
    }
  }
};

std::vector<Extent> cavity_extents(const BlockComplex& complex, const Block& block) {
  std::vector<Extent> extents(block.counts.shells - 1);
  for (std::size_t i = 0; i < block.faces.size(); ++i) {
    if (block.shell_of_face[i] == 0) continue;
    for (const topology::VertexId v : complex.faces()[block.faces[i]].loops.front()) {
      extents[block.shell_of_face[i] - 1].include(complex.vertices()[v]);
    }
  }
  return extents;
}

// The fewest positions along an axis that meet every cavity inside (interval stabbing, greedy by upper ends), each in the middle
// of what is common to its cavities.
std::vector<double> stabs(std::vector<Extent> extents, double Vec3::*axis) {
  std::ranges::sort(extents, {}, [&](const Extent& e) { return std::pair{e.high.*axis, e.low.*axis}; });
  std::vector<double> positions;
  for (std::size_t i = 0; i < extents.size();) {
    const double high = extents[i].high.*axis;
    double low = extents[i].low.*axis;
    std::size_t end = i;
    std::vector<Extent> rest;
    for (; end < extents.size(); ++end) {
      if (extents[end].low.*axis < high) {
        low = std::max(low, extents[end].low.*axis);
      } else {
        rest.push_back(extents[end]);
      }
    }
    positions.push_back(low + (high - low) / 2);
    extents = std::move(rest);
    i = 0;
  }
  return positions;
}

std::optional<geometry::Solid> as_solid(const BlockComplex& complex, BlockId block) {
  std::vector<Vec3> points = complex.vertices().items();
  auto polygons = surface_of(complex, block, points, true);
  separate_pinches(polygons, points);
  // Only the block's own points, numbered in order of first use.
  std::vector<std::uint32_t> number(points.size(), std::numeric_limits<std::uint32_t>::max());
  std::vector<Vec3> vertices;
  std::vector<geometry::SolidFace> faces;
  for (const Polygon& polygon : polygons) {
    geometry::SolidFace face;
    for (const std::uint32_t point : polygon.corners) {
      if (number[point] == std::numeric_limits<std::uint32_t>::max()) {
        number[point] = static_cast<std::uint32_t>(vertices.size());
        vertices.push_back(points[point]);
      }
      face.corners.push_back(number[point]);
    }
    faces.push_back(std::move(face));
  }
  auto solid = geometry::Solid::make(std::move(vertices), std::move(faces), {"block"});
  if (!solid) return std::nullopt;
  return *std::move(solid);
}

}  // namespace

std::optional<BlockComplex> cut_through_cavities(const BlockComplex& complex, BlockId block) {
  auto solid = as_solid(complex, block);
  if (!solid) return std::nullopt;
  const auto extents = cavity_extents(complex, complex.blocks()[block]);
  double Vec3::*best = axes.front();
  std::vector<double> positions = stabs(extents, best);
  for (const auto axis : axes) {
    if (auto fewer = stabs(extents, axis); fewer.size() < positions.size()) {
      positions = std::move(fewer);
      best = axis;
    }
  }
  topology::CutInput input{.domain = *std::move(solid), .joints = {}, .excavations = {}, .free_domain_tags = {}};
  for (const double position : positions) {
    topology::PersistentJoint plane;
    plane.through = extents.front().low;
    plane.through.*best = position;
    plane.normal.*best = 1.0;
    input.joints.emplace_back(plane);
  }
  auto pieces = topology::cut(input);
  if (!pieces) return std::nullopt;
  const auto has_cavity = [](const Block& piece) { return piece.counts.shells > 1; };
  if (std::ranges::any_of(pieces->blocks(), has_cavity)) return std::nullopt;
  return *std::move(pieces);
}

}  // namespace cleave::report::detail
