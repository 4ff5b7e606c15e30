#include "parallel_planes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace cleave::stability {
namespace {

using geometry::Vec3;
using topology::PlaneId;

constexpr double largest_turn = 1e-8;  // rad: whatever the roundings, more is meant

/// Where a direction lies on a grid, up to its sign.
struct Cell {
  std::int64_t x, y, z;
  friend bool operator==(const Cell&, const Cell&) = default;
};
struct CellHash {
  std::size_t operator()(const Cell& c) const noexcept {
    std::uint64_t h = 0x9E3779B97F4A7C15U;
    for (const std::int64_t v : {c.x, c.y, c.z}) {
      h = (h ^ static_cast<std::uint64_t>(v)) * 0xFF51AFD7ED558CCDU;
      h ^= h >> 32U;
    }
    return h;
  }
};

/// A plane with the angle by which roundings may have turned it, rad.
struct Tilted {
  PlaneId plane;
  Vec3 normal;
  double by;
};

/// Planes by cell; each is in one, and looked for in all that it may have been turned from.
class Grid final {
 public:
  /// `most`: no plane was turned by more.
  explicit Grid(double most) : cell_size_{4 * most} {}
  /// The first plane put in that is parallel but for roundings.
  [[nodiscard]] const Tilted* like(const Tilted& plane) const {
    for (const double sense : {1.0, -1.0}) {
      const Vec3 n = sense * plane.normal;
      for (unsigned corner = 0; corner < 8; ++corner) {
        const auto shifted = [&](double v, unsigned bit) {
          return v + ((corner & bit) != 0 ? 0.5 : -0.5) * cell_size_;
        };
        const auto found = planes_.find(cell_of({shifted(n.x, 1), shifted(n.y, 2), shifted(n.z, 4)}));
        if (found == planes_.end()) continue;
        for (const Tilted& other : found->second) {
          if (geometry::norm(n - other.normal) <= plane.by + other.by) return &other;
        }
      }
    }
    return nullptr;
  }
  void put(const Tilted& plane) { planes_[cell_of(plane.normal)].push_back(plane); }

 private:
  [[nodiscard]] Cell cell_of(Vec3 n) const {
    const auto at = [&](double v) { return static_cast<std::int64_t>(std::floor(v / cell_size_)); };
    return {at(n.x), at(n.y), at(n.z)};
  }
  double cell_size_;
  std::unordered_map<Cell, std::vector<Tilted>, CellHash> planes_;
};

Tilted tilted(const topology::BlockComplex& complex, PlaneId id, double by) {
  const auto n = complex.planes()[id].unit_normal();
  return {id, {n[0], n[1], n[2]}, by};
}

/// Whether any two are about parallel and not exactly so.
bool any_about_parallel(const topology::BlockComplex& complex, double most) {
  Grid grid{most};
  for (std::uint32_t p = 0; p < complex.planes().size(); ++p) {
    const Tilted plane = tilted(complex, PlaneId{p}, most);
    const Tilted* other = grid.like(plane);
    if (other == nullptr) {
      grid.put(plane);
    } else if (!(plane.normal == other->normal) && !(plane.normal == -other->normal)) {
      return true;
    }
  }
  return false;
}

}  // namespace

Length rounding_of_corners(const topology::BlockComplex& complex) {
  constexpr double roundings = 16;
  double farthest = 0;
  for (const topology::Block& block : complex.blocks()) farthest = std::max(farthest, geometry::norm(block.centroid));
  const topology::CutReport& report = complex.report();
  // Moves of two corners, to one side and to the other, at both ends.
  return metres(std::max(roundings * (report.lattice_pitch_m + farthest * 0x1p-52), 4 * report.largest_snap_m));
}

double turn_by(Length rounding, Area face) {
  return face.si() > 0 ? std::min(largest_turn, rounding.si() / std::sqrt(face.si())) : largest_turn;
}

IdVector<PlaneId, PlaneId> parallel_planes(const topology::BlockComplex& complex, double taper) {
  const double most = std::max(largest_turn, taper / 2);  // of each of two
  IdVector<PlaneId, PlaneId> like(complex.planes().size(), PlaneId{0U});
  for (std::uint32_t p = 0; p < like.size(); ++p) like[PlaneId{p}] = PlaneId{p};
  if (!any_about_parallel(complex, most)) return like;
  IdVector<PlaneId, Area> widest(complex.planes().size(), Area{});
  for (std::size_t f = 0; f < complex.faces().size(); ++f) {
    const topology::Face& face = complex.faces()[topology::FaceId{f}];
    if (face.role == topology::Role::free) continue;
    Area& area = widest[face.plane];
    area = std::max(area, face.area);
  }
  const Length rounding = rounding_of_corners(complex);
  std::vector<Tilted> planes;
  for (std::uint32_t p = 0; p < like.size(); ++p) {
    const Area area = widest[PlaneId{p}];
    if (area > Area{}) planes.push_back(tilted(complex, PlaneId{p}, std::max(turn_by(rounding, area), taper / 2)));
  }
  // The largest stand for the others.
  std::ranges::stable_sort(planes, {}, &Tilted::by);
  Grid grid{most};
  for (const Tilted& plane : planes) {
    if (const Tilted* other = grid.like(plane)) {
      like[plane.plane] = other->plane;
    } else {
      grid.put(plane);
    }
  }
  return like;
}

}  // namespace cleave::stability
