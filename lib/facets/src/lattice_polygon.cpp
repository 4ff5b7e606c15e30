#include "detail/lattice_polygon.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "cleave/exact/predicates.hpp"
#include "cleave/geometry/ear_ring.hpp"

namespace cleave::topology::detail {
namespace {

using exact::Int128;
using exact::LatticePoint;
using exact::Sign;

std::array<double, 3> as_double(LatticePoint p) {
  return {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
}
double squared_length(LatticePoint p) {
  const auto d = as_double(p);
  return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}
double squared_area(LatticePoint u, LatticePoint v) {
  const auto a = as_double(u);
  const auto b = as_double(v);
  const double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
  return x * x + y * y + z * z;
}
std::array<Int128, 3> cross(LatticePoint u, LatticePoint v) {
  const auto product = [](std::int64_t p, std::int64_t q) { return static_cast<Int128>(p) * q; };
  return {product(u.y, v.z) - product(u.z, v.y), product(u.z, v.x) - product(u.x, v.z),
          product(u.x, v.y) - product(u.y, v.x)};
}

/// Three corners that fix a plane, with the square of twice their area.
struct Three {
  std::size_t first, second, third;
  double squared_area;
};

/// The first corner in `order`, the farthest from it among the next ones, and the farthest from the line of these two.
Three spread(std::span<const LatticePoint> corners, std::span<const std::size_t> order, std::size_t second_pool,
             std::size_t third_pool) {
  const auto pick = [&](std::size_t count, auto&& measure) {
    std::size_t best = order[0];
    double most = 0;
    for (std::size_t k = 0; k < count; ++k) {
      if (const double m = measure(corners[order[k]]); m > most) {
        most = m;
        best = order[k];
      }
    }
    return best;
  };
  const LatticePoint first = corners[order[0]];
  const std::size_t second = pick(second_pool, [&](LatticePoint c) { return squared_length(c - first); });
  const auto span = corners[second] - first;
  const std::size_t third = pick(third_pool, [&](LatticePoint c) { return squared_area(span, c - first); });
  return {order[0], second, third, squared_area(span, corners[third] - first)};
}

/// The corners in their plane. A ring that holes were joined to passes some places twice.
class Lattice final {
 public:
  explicit Lattice(const LatticePolygon& polygon) : polygon_{polygon} {}
  [[nodiscard]] Sign turn(std::size_t i, std::size_t j, std::size_t k) const {
    const auto& p = polygon_.corners;
    return orient2d(p[i], p[j], p[k], polygon_.along);
  }
  [[nodiscard]] auto ignored(std::size_t a, std::size_t b, std::size_t c) const {
    return [&p = polygon_.corners, a, b, c](std::size_t i) { return p[i] == p[a] || p[i] == p[b] || p[i] == p[c]; };
  }

 private:
  const LatticePolygon& polygon_;
};

}  // namespace

std::optional<exact::Plane> plane_of(std::span<const LatticePoint> corners, std::span<const std::size_t> preferred) {
  constexpr double least_share = 0x1p-12;  // of the squared area that any corners have
  std::vector<std::size_t> order(corners.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const std::size_t all = corners.size(), named = preferred.size();
  Three three = spread(corners, order, all, all);
  if (named > 0) {
    std::ranges::stable_partition(order,
                                  [&](std::size_t i) { return std::ranges::find(preferred, i) != preferred.end(); });
    const double enough = least_share * three.squared_area;
    for (const auto& [seconds, thirds] : {std::pair{named, named}, std::pair{named, all}, std::pair{all, all}}) {
      const Three next = spread(corners, order, seconds, thirds);
      if (!(next.squared_area > enough)) continue;
      three = next;
      break;
    }
  }
  return exact::Plane::through(corners[three.first], corners[three.second], corners[three.third]);
}

LatticePoint direction_along(const exact::Plane& plane) {
  const auto& n = plane.normal();
  constexpr Int128 limit = Int128{1} << 46;
  if (std::ranges::all_of(n, [](Int128 c) { return -limit <= c && c <= limit; })) {
    return {static_cast<std::int64_t>(n[0]), static_cast<std::int64_t>(n[1]), static_cast<std::int64_t>(n[2])};
  }
  const auto unit = plane.unit_normal();
  const auto scaled = [](double c) { return static_cast<std::int64_t>(std::nearbyint(std::ldexp(c, 46))); };
  return {scaled(unit[0]), scaled(unit[1]), scaled(unit[2])};
}

Sign orient2d(LatticePoint a, LatticePoint b, LatticePoint c, LatticePoint along) noexcept {
  const LatticePoint u = b - a;
  const LatticePoint v = c - a;
  const auto p = as_double(u);
  const auto q = as_double(v);
  const auto w = as_double(along);
  const std::array<double, 6> terms{p[1] * q[2] * w[0],  -p[2] * q[1] * w[0], p[2] * q[0] * w[1],
                                    -p[0] * q[2] * w[1], p[0] * q[1] * w[2],  -p[1] * q[0] * w[2]};
  double sum = 0, magnitude = 0;
  for (const double t : terms) {
    sum += t;
    magnitude += std::abs(t);
  }
  // Differences and `along` are exact; each term has two roundings, the sum at most six more.
  if (const auto sign = exact::sign_filtered(sum, 16 * exact::unit_roundoff * magnitude)) return *sign;
  const auto n = cross(u, v);
  return exact::dot_sign(n, along);
}

std::optional<LatticePolygon> make_lattice_polygon(std::vector<LatticePoint> corners,
                                                   std::span<const std::size_t> preferred) {
  // Twice the vector area, exactly: it decides which way round the corners go and whether any area is left.
  const auto vector_area = [&] {
    std::array<Int128, 3> sum{};
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
      const auto part = cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
      for (std::size_t k = 0; k < 3; ++k) sum[k] += part[k];
    }
    return sum;
  };
  if (corners.size() < 3) return std::nullopt;

  const auto plane = plane_of(corners, preferred);
  if (!plane) return std::nullopt;

  const auto area = vector_area();
  const Sign sense = exact::dot_sign(plane->normal(), area);
  if (sense == Sign::zero) return std::nullopt;
  LatticePolygon polygon{sense == Sign::positive ? *plane : plane->flipped(), {}, {}, true, true};
  polygon.along = direction_along(polygon.plane);
  polygon.exactly_planar =
      std::ranges::all_of(corners, [&](LatticePoint c) { return polygon.plane.side_of(c) == Sign::zero; });

  // Drop repeated corners and corners inside a straight side (spikes, too, fall away this way).
  bool changed = true;
  while (changed && corners.size() >= 3) {
    changed = false;
    for (std::size_t i = 0; i < corners.size() && corners.size() >= 3; ++i) {
      const std::size_t count = corners.size();
      if (orient2d(corners[(i + count - 1) % count], corners[i], corners[(i + 1) % count], polygon.along) ==
          Sign::zero) {
        corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(i));
        changed = true;
        --i;
      }
    }
  }
  if (corners.size() < 3) return std::nullopt;
  const std::size_t count = corners.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (orient2d(corners[i], corners[(i + 1) % count], corners[(i + 2) % count], polygon.along) != Sign::positive) {
      polygon.convex = false;
    }
  }
  polygon.corners = std::move(corners);
  return polygon;
}

std::vector<std::array<std::size_t, 3>> triangulate(const LatticePolygon& polygon) {
  const Lattice lattice{polygon};
  std::vector<std::size_t> corners_left(polygon.corners.size());
  std::iota(corners_left.begin(), corners_left.end(), std::size_t{0});
  geometry::EarRing<Lattice> ring{std::move(corners_left), lattice};
  std::vector<std::array<std::size_t, 3>> triangles;
  // On from the corner after the last ear, round and round: each round takes every other corner of a convex ring, and
  // no corner gets many triangles. What nearly coincident planes cost grows with the cube of those that meet in a
  // corner.
  std::size_t from = 0;
  while (ring.size() > 3) {
    auto k = ring.find(from, [&](std::size_t place) { return ring.is_ear(place); });
    if (k) {
      triangles.push_back(ring.cut(*k));
    } else {
      // No ear: flat remainders are dropped corner by corner, anything else crosses itself.
      k = ring.find(0, [&](std::size_t place) { return ring.turn(place) == Sign::zero; });
      if (!k) return {};
      ring.cut(*k);
    }
    from = *k + 1;
  }
  if (ring.size() == 3 && ring.turn(1) == Sign::positive) triangles.push_back(ring.triangle(1));
  return triangles;
}

}  // namespace cleave::topology::detail
