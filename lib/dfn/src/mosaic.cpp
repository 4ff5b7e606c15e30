#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <utility>
#include <variant>

#include "models.hpp"
#include "poisson.hpp"

namespace cleave::dfn::detail {

using geometry::Polygon;
using geometry::Vec3;

namespace {

/// A face of a Voronoi cell, towards the cell of seed `neighbour`.
struct CellFace {
  std::size_t neighbour;
  std::vector<Vec3> corners;
};
constexpr std::size_t outside = static_cast<std::size_t>(-1);

std::vector<CellFace> cube(Vec3 centre, double half) {
  std::vector<CellFace> faces;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      const auto corner = [&](double u, double v) {
        std::array<double, 3> p{};
        p[static_cast<std::size_t>(axis)] = sign * half;
        p[static_cast<std::size_t>((axis + 1) % 3)] = u * half;
        p[static_cast<std::size_t>((axis + 2) % 3)] = sign * v * half;
        return centre + Vec3{p[0], p[1], p[2]};
      };
      faces.push_back({outside, {corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)}});
    }
  }
  return faces;
}

double reach_of(const std::vector<CellFace>& faces, Vec3 seed) {
  double reach = 0;
  for (const CellFace& face : faces) {
    for (const Vec3 p : face.corners) reach = std::max(reach, norm(p - seed));
  }
  return reach;
}

/// Keeps the part of a convex cell where dot(n, x) <= offset; the new face leads to `neighbour`. False: nothing
/// changed.
bool clip(std::vector<CellFace>& faces, Vec3 n, double offset, std::size_t neighbour) {
  const auto beyond = [&](Vec3 p) { return dot(n, p) > offset; };
  if (std::ranges::none_of(faces, [&](const CellFace& f) { return std::ranges::any_of(f.corners, beyond); }))
    return false;
  std::vector<CellFace> kept;
  std::vector<Vec3> cut;
  for (const CellFace& face : faces) {
    CellFace rest{face.neighbour, {}};
    for (std::size_t i = 0; i < face.corners.size(); ++i) {
      const Vec3 p = face.corners[i], q = face.corners[(i + 1) % face.corners.size()];
      const double a = dot(n, p) - offset, b = dot(n, q) - offset;
      if (a <= 0) rest.corners.push_back(p);
      if (a == 0) cut.push_back(p);
      if ((a < 0 && b > 0) || (a > 0 && b < 0)) {
        const Vec3 x = p + (a / (a - b)) * (q - p);
        rest.corners.push_back(x);
        cut.push_back(x);
      }
    }
    if (rest.corners.size() >= 3) kept.push_back(std::move(rest));
  }
  if (cut.size() >= 3) {
    Vec3 middle{0, 0, 0};
    for (const Vec3 p : cut) middle += p / static_cast<double>(cut.size());
    const Vec3 some = std::abs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    const Vec3 e1 = normalized(cross(n, some)), e2 = cross(normalized(n), e1);
    const auto angle = [&](Vec3 p) { return std::atan2(dot(p - middle, e2), dot(p - middle, e1)); };
    std::ranges::sort(cut, {}, angle);
    const double near = 1e-9 * norm(cut.front() - middle) + 1e-300;
    std::vector<Vec3> corners;
    for (const Vec3 p : cut) {
      if (corners.empty() || norm(p - corners.back()) > near) corners.push_back(p);
    }
    while (corners.size() > 1 && norm(corners.front() - corners.back()) <= near) corners.pop_back();
    if (corners.size() >= 3) kept.push_back({neighbour, std::move(corners)});
  }
  faces = std::move(kept);
  return true;
}

/// Seeds sorted into boxes of about the mean cell size.
class SeedGrid final {
 public:
  SeedGrid(const std::vector<Vec3>& seeds, const DomainBox& box, double size) : seeds_{seeds}, min_{box.min} {
    const Vec3 s = box.max - box.min;
    size_ = size;
    for (int i = 0; i < 3; ++i) {
      const double length = i == 0 ? s.x : i == 1 ? s.y : s.z;
      counts_[static_cast<std::size_t>(i)] = std::max(1, static_cast<int>(std::ceil(length / size)));
    }
    boxes_.resize(static_cast<std::size_t>(counts_[0]) * static_cast<std::size_t>(counts_[1]) *
                  static_cast<std::size_t>(counts_[2]));
    for (std::size_t i = 0; i < seeds.size(); ++i) boxes_[at(place(seeds[i]))].push_back(i);
  }
  /// Seeds in the shell of boxes at distance `ring` from that of p; all of them lie at least (ring - 1) box sizes away.
  [[nodiscard]] std::vector<std::size_t> ring(Vec3 p, int ring) const {
    std::vector<std::size_t> found;
    const auto c = place(p);
    for (int x = c[0] - ring; x <= c[0] + ring; ++x) {
      for (int y = c[1] - ring; y <= c[1] + ring; ++y) {
        for (int z = c[2] - ring; z <= c[2] + ring; ++z) {
          if (std::max({std::abs(x - c[0]), std::abs(y - c[1]), std::abs(z - c[2])}) != ring) continue;
          if (x < 0 || y < 0 || z < 0 || x >= counts_[0] || y >= counts_[1] || z >= counts_[2]) continue;
          const auto& box = boxes_[at({x, y, z})];
          found.insert(found.end(), box.begin(), box.end());
        }
      }
    }
    std::ranges::sort(found, {}, [&](std::size_t i) { return std::pair{norm(seeds_[i] - p), i}; });
    return found;
  }
  [[nodiscard]] int rings() const { return std::max({counts_[0], counts_[1], counts_[2]}); }
  [[nodiscard]] double size() const { return size_; }

 private:
  [[nodiscard]] std::array<int, 3> place(Vec3 p) const {
    const auto one = [&](double v, int count) {
      return std::clamp(static_cast<int>(std::floor(v / size_)), 0, count - 1);
    };
    return {one(p.x - min_.x, counts_[0]), one(p.y - min_.y, counts_[1]), one(p.z - min_.z, counts_[2])};
  }
  [[nodiscard]] std::size_t at(const std::array<int, 3>& c) const {
    return static_cast<std::size_t>((c[2] * counts_[1] + c[1]) * counts_[0] + c[0]);
  }
  const std::vector<Vec3>& seeds_;
  Vec3 min_;
  double size_ = 1;
  std::array<int, 3> counts_{};
  std::vector<std::vector<std::size_t>> boxes_;
};

std::vector<CellFace> voronoi_cell(const std::vector<Vec3>& seeds, const SeedGrid& grid, std::size_t i) {
  std::vector<CellFace> faces = cube(seeds[i], 8 * grid.size());
  double reach = reach_of(faces, seeds[i]);
  for (int ring = 0; ring <= grid.rings() && (ring - 1) * grid.size() <= 2 * reach; ++ring) {
    for (const std::size_t j : grid.ring(seeds[i], ring)) {
      if (j == i) continue;
      const Vec3 d = seeds[j] - seeds[i];
      if (norm(d) > 2 * reach) break;
      if (clip(faces, d, dot(d, (seeds[i] + seeds[j]) / 2), j)) reach = reach_of(faces, seeds[i]);
    }
  }
  return faces;
}

/// Makes points that are nearly the same the same: the first of them.
class SharedPoints final {
 public:
  explicit SharedPoints(double within) : within_{within} {}
  Vec3 operator()(Vec3 p) {
    const Place at = place(p);
    for (std::int64_t x = at[0] - 1; x <= at[0] + 1; ++x) {
      for (std::int64_t y = at[1] - 1; y <= at[1] + 1; ++y) {
        for (std::int64_t z = at[2] - 1; z <= at[2] + 1; ++z) {
          const auto found = points_.find({x, y, z});
          if (found == points_.end()) continue;
          for (const Vec3 q : found->second) {
            if (norm(q - p) <= within_) return q;
          }
        }
      }
    }
    points_[at].push_back(p);
    return p;
  }

 private:
  using Place = std::array<std::int64_t, 3>;
  struct Hash {
    std::size_t operator()(const Place& at) const noexcept {
      std::uint64_t h = 0;
      for (const std::int64_t c : at) h = (h ^ static_cast<std::uint64_t>(c)) * 0x9E3779B97F4A7C15U;
      return h ^ (h >> 32U);
    }
  };
  [[nodiscard]] Place place(Vec3 p) const {
    const auto of = [&](double c) { return static_cast<std::int64_t>(std::floor(c / within_)); };
    return {of(p.x), of(p.y), of(p.z)};
  }
  double within_;
  std::unordered_map<Place, std::vector<Vec3>, Hash> points_;
};

/// A face of a cell as one polygon; where corners are too close for one, as triangles.
std::vector<Polygon> pieces_of(const std::vector<Vec3>& corners) {
  std::vector<Polygon> pieces;
  if (auto whole = Polygon::make(corners)) {
    pieces.push_back(*std::move(whole));
    return pieces;
  }
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
    if (auto triangle = Polygon::make({corners[0], corners[k], corners[k + 1]})) {
      pieces.push_back(*std::move(triangle));
    }
  }
  return pieces;
}

/// Where cells lie about: one for each.
struct Seeds {
  std::vector<Vec3> points;
  /// Of a regular grid its numbers of cells, the last axis first in memory.
  std::optional<std::array<std::size_t, 3>> regular;
};

Seeds poisson_seeds(double density, const DomainBox& box, const SetStreams& streams) {
  Seeds seeds;
  const Vec3 extent = box.max - box.min;
  Rng rng = streams.of(Draw::position, 0), number = streams.of(Draw::count, 0);
  const std::uint64_t n = poisson(density * extent.x * extent.y * extent.z, number);
  for (std::uint64_t i = 0; i < n; ++i) {
    Vec3 p;
    p.x = box.min.x + rng.uniform() * extent.x;
    p.y = box.min.y + rng.uniform() * extent.y;
    p.z = box.min.z + rng.uniform() * extent.z;
    seeds.points.push_back(p);
  }
  return seeds;
}

/// Each point of a cubic grid, moved by up to half of jitter cells along each axis.
Seeds grid_seeds(double size, double jitter, const DomainBox& box, const SetStreams& streams) {
  Seeds seeds;
  const Vec3 extent = box.max - box.min;
  Rng rng = streams.of(Draw::position, 0);
  // The grid has a random phase: the same law everywhere.
  Vec3 phase;
  phase.x = rng.uniform();
  phase.y = rng.uniform();
  phase.z = rng.uniform();
  const auto cells = [&](double length) { return static_cast<std::size_t>(length / size) + 1; };
  const std::array<std::size_t, 3> counts{cells(extent.x), cells(extent.y), cells(extent.z)};
  for (std::size_t x = 0; x < counts[0]; ++x) {
    for (std::size_t y = 0; y < counts[1]; ++y) {
      for (std::size_t z = 0; z < counts[2]; ++z) {
        Vec3 p;
        p.x = static_cast<double>(x) + phase.x + jitter * (rng.uniform() - 0.5);
        p.y = static_cast<double>(y) + phase.y + jitter * (rng.uniform() - 0.5);
        p.z = static_cast<double>(z) + phase.z + jitter * (rng.uniform() - 0.5);
        seeds.points.push_back(box.min + size * (p - Vec3{0.5, 0.5, 0.5}));
      }
    }
  }
  if (jitter == 0) seeds.regular = counts;
  return seeds;
}

/// A cell of a regular grid has faces towards its six neighbours alone. The cells across its edges and corners touch it
/// without area: rounding would decide whether a face is seen there.
std::vector<CellFace> cubic_cell(const Seeds& seeds, double size, std::size_t i) {
  const std::array<std::size_t, 3>& counts = *seeds.regular;
  const std::array<std::size_t, 3> strides{counts[1] * counts[2], counts[2], 1};
  std::vector<CellFace> faces = cube(seeds.points[i], size / 2);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t place = i / strides[axis] % counts[axis];
    if (place > 0) faces[2 * axis].neighbour = i - strides[axis];
    if (place + 1 < counts[axis]) faces[2 * axis + 1].neighbour = i + strides[axis];
  }
  return faces;
}

/// Face area per volume of the cells of one seed per volume.
double face_area(Mosaic::Seeds seeds) {
  switch (seeds) {
    case Mosaic::Seeds::poisson: return 2.910436;  // Miles 1972; Moller 1989
    case Mosaic::Seeds::grid:
      return 3;  // cubes
    // Half the mean surface of 3,000,000 cells: the inner 32^3 of 92 grids of 40^3 seeds of grid_seeds, cut out by
    // voronoi_cell as here. Standard error 0.0001.
    case Mosaic::Seeds::jittered: return 2.8891;
  }
  return 3;
}

}  // namespace

std::vector<SampledJoint> mosaic(const JointSet& set, const DomainBox& domain, const SetStreams& streams) {
  const auto& model = std::get<Mosaic>(set.spec().model);
  const Vec3 s = domain.max - domain.min;
  const double volume = s.x * s.y * s.z;
  // With g seeds per volume faces have g^(1/3) times the area of one.
  const auto* count = std::get_if<Count>(&set.spec().intensity);
  const double density = count != nullptr
                             ? static_cast<double>(count->joints) / volume
                             : std::pow(set.expected_p32(volume) / model.share / face_area(model.seeds), 3);
  if (!(density > 0)) return {};
  const double size = std::cbrt(1 / density);
  const Vec3 margin{4 * size, 4 * size, 4 * size};
  const DomainBox box{domain.min - margin, domain.max + margin};
  const double jitter = model.seeds == Mosaic::Seeds::jittered ? 1 : 0;
  const Seeds all = model.seeds == Mosaic::Seeds::poisson ? poisson_seeds(density, box, streams)
                                                          : grid_seeds(size, jitter, box, streams);
  const std::vector<Vec3>& seeds = all.points;
  const SeedGrid grid{seeds, box, size};
  // Corners that cells share are computed once in each of them, and are the same to rounding.
  const double farthest = std::max({norm(box.min), norm(box.max), size});
  SharedPoints shared{std::max(1e-9 * size, 0x1p-44 * farthest)};
  std::vector<SampledJoint> joints;
  Rng marks = streams.of(Draw::termination, 0);
  // A cell that reaches into the domain has its seed within three sizes of it (an empty ball of that radius: e^-113).
  const auto far = [&](Vec3 p) {
    const double by = 3 * size;
    return p.x < domain.min.x - by || p.y < domain.min.y - by || p.z < domain.min.z - by || p.x > domain.max.x + by ||
           p.y > domain.max.y + by || p.z > domain.max.z + by;
  };
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    if (far(seeds[i])) continue;
    for (const CellFace& face : all.regular ? cubic_cell(all, size, i) : voronoi_cell(seeds, grid, i)) {
      if (face.neighbour == outside || face.neighbour < i) continue;
      const bool joint = marks.uniform() < model.share;
      if (!joint) continue;
      geometry::Box box_of_face;
      Vec3 middle{0, 0, 0};
      std::vector<Vec3> corners;
      for (const Vec3 corner : face.corners) {
        const Vec3 q = shared(corner);
        box_of_face.add(q);
        middle += q / static_cast<double>(face.corners.size());
        if (corners.empty() || norm(q - corners.back()) > 0) corners.push_back(q);
      }
      while (corners.size() > 1 && norm(corners.front() - corners.back()) == 0) corners.pop_back();
      if (!domain.overlaps(box_of_face)) continue;
      std::vector<Polygon> pieces = pieces_of(corners);
      if (pieces.empty()) continue;
      Vec3 normal = normalized(seeds[face.neighbour] - seeds[i]);
      if (normal.z < 0) normal = -normal;
      joints.push_back({std::move(pieces), middle, normal, static_cast<std::uint32_t>(joints.size())});
    }
  }
  return joints;
}

}  // namespace cleave::dfn::detail
