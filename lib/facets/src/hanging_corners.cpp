#include "detail/hanging_corners.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <vector>

#include "cleave/geometry/box_tree.hpp"
#include "detail/as_vec3.hpp"

namespace cleave::topology::detail {
namespace {

using exact::LatticePoint;
using geometry::Vec3;

/// A side of a polygon.
struct Use {
  Side side;
  std::size_t polygon, corner;  ///< it starts at this corner
};

/// A corner on a side, with its place along it.
struct Hanging {
  std::size_t polygon, corner;
  double along;
  LatticePoint site;
};

/// The plane about in which a polygon lies: its normal, turned to one side, and how far from the origin it is.
struct AboutPlane {
  double offset;
  Vec3 normal;
};

AboutPlane about(const JointPolygon& entry) {
  const auto& c = entry.corners;
  const Vec3 a = as_vec3(c[0]), b = as_vec3(c[c.size() / 3]), d = as_vec3(c[2 * c.size() / 3]);
  const Vec3 area = cross(b - a, d - a);
  const double size = geometry::norm(area);
  if (!(size > 0)) return {0, {}};
  const bool turn = area.x < 0 || (area.x == 0 && (area.y < 0 || (area.y == 0 && area.z < 0)));
  const Vec3 normal = (turn ? -1 : 1) / size * area;
  return {dot(normal, a), normal};
}

}  // namespace

bool some_lie_in_one_plane(std::span<const JointPolygon> polygons) {
  std::vector<AboutPlane> planes;
  double farthest = 1;
  for (const JointPolygon& entry : polygons) {
    if (entry.corners.size() < 3) continue;
    planes.push_back(about(entry));
    for (const double v : {planes.back().offset, as_vec3(entry.corners.front()).x, as_vec3(entry.corners.front()).y,
                           as_vec3(entry.corners.front()).z}) {
      farthest = std::max(farthest, std::abs(v));
    }
  }
  std::ranges::sort(planes, {}, &AboutPlane::offset);
  std::size_t looks =
      64 * planes.size();  // where very many pass the origin, one pair more or less is taken to be there
  for (std::size_t i = 0; i < planes.size(); ++i) {
    for (std::size_t j = i + 1; j < planes.size() && planes[j].offset - planes[i].offset <= 1e-6 * farthest; ++j) {
      if (looks-- == 0) return true;
      if (geometry::norm(cross(planes[i].normal, planes[j].normal)) < 1e-5) return true;
    }
  }
  return false;
}

bool take_hanging_corners(std::span<JointPolygon> polygons, const SharedCorners& shared, double within) {
  std::vector<Use> uses;
  for (std::size_t k = 0; k < polygons.size(); ++k) {
    const auto& corners = polygons[k].corners;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const LatticePoint a = corners[i], b = corners[(i + 1) % corners.size()];
      if (a != b && !shared.of_surface(a, b)) uses.push_back({side_of(a, b), k, i});
    }
  }
  std::ranges::sort(uses, {}, [](const Use& use) { return std::tuple{use.side, use.polygon, use.corner}; });
  std::vector<std::span<const Use>> sides;  // all polygons that have one, or none of them, take a corner
  std::vector<geometry::Box> boxes;
  for (std::size_t first = 0, last = 0; first < uses.size(); first = last) {
    while (last < uses.size() && uses[last].side == uses[first].side) ++last;
    sides.push_back(std::span{uses}.subspan(first, last - first));
    boxes.push_back(box_of(std::array{uses[first].side.first, uses[first].side.second}, within + 1));
  }
  const geometry::BoxTree tree{boxes};
  std::vector<Hanging> found;
  // Corners of one polygon alone too: what they are shared with may lie outside the domain and be left out.
  std::vector<LatticePoint> sites;
  for (const JointPolygon& entry : polygons) sites.insert(sites.end(), entry.corners.begin(), entry.corners.end());
  std::ranges::sort(sites);
  const auto again = std::ranges::unique(sites);
  sites.erase(again.begin(), again.end());
  for (const LatticePoint site : sites) {
    tree.overlapping({as_vec3(site), as_vec3(site)}, [&](std::uint32_t number) {
      const auto& [a, b] = sides[number].front().side;
      const Vec3 side = as_vec3(b - a), to = as_vec3(site - a);
      const double length = geometry::norm(side), along = dot(to, side) / length;
      if (along <= within || along >= length - within) return;  // at an end of it
      if (geometry::norm(cross(side, to)) > within * length) return;
      const bool of_needle = std::ranges::any_of(sides[number], [&](const Use& use) {
        const auto& corners = polygons[use.polygon].corners;
        return std::ranges::find(corners, site) != corners.end();
      });
      if (of_needle) return;
      for (const Use& use : sides[number]) {
        const bool forward = polygons[use.polygon].corners[use.corner] == a;
        found.push_back({use.polygon, use.corner, forward ? along : length - along, site});
      }
    });
  }
  std::ranges::sort(found, [](const Hanging& a, const Hanging& b) {
    // The last of each polygon first, so that the places of the others stay.
    return std::tuple{a.polygon, b.corner, b.along, a.site} < std::tuple{b.polygon, a.corner, a.along, b.site};
  });
  for (const Hanging& h : found) {
    auto& corners = polygons[h.polygon].corners;
    corners.insert(corners.begin() + static_cast<std::ptrdiff_t>(h.corner) + 1, h.site);
  }
  return !found.empty();
}

}  // namespace cleave::topology::detail
