#include "flat.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "cleave/stability/analyse.hpp"

namespace cleave::stability {
namespace {

using geometry::Vec3;

/// The plane's two axes that see the face largest, so that "inside" is asked in two dimensions.
struct Flattened {
  bool drop_x, drop_y;
  explicit Flattened(Vec3 n)
      : drop_x{std::abs(n.x) >= std::abs(n.y) && std::abs(n.x) >= std::abs(n.z)},
        drop_y{!drop_x && std::abs(n.y) >= std::abs(n.z)} {}
  [[nodiscard]] double u(Vec3 x) const { return drop_x ? x.y : x.x; }
  [[nodiscard]] double v(Vec3 x) const { return drop_x || drop_y ? x.z : x.y; }
};

}  // namespace

bool contains(const topology::BlockComplex& complex, const topology::Face& face, Vec3 x) {
  const Flattened flat{face.outward};
  const double pu = flat.u(x), pv = flat.v(x);
  bool odd = false;
  for (const auto& loop : complex.loops(face)) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      Vec3 a = complex.position(loop[i]), b = complex.position(loop[(i + 1) % loop.size()]);
      if ((flat.v(a) > pv) == (flat.v(b) > pv)) continue;
      if (flat.v(a) > flat.v(b)) std::swap(a, b);  // same arithmetic from both sides of the edge
      const double at = flat.u(a) + (pv - flat.v(a)) / (flat.v(b) - flat.v(a)) * (flat.u(b) - flat.u(a));
      if (pu < at) odd = !odd;
    }
  }
  return odd;
}

std::vector<SignedTriangle> fan(const topology::BlockComplex& complex, const topology::Face& face) {
  std::vector<SignedTriangle> triangles;
  for (const auto& loop : complex.loops(face)) {
    for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
      const Vec3 a = complex.position(loop[0]), b = complex.position(loop[i]), c = complex.position(loop[i + 1]);
      const double turn = geometry::dot(geometry::cross(b - a, c - a), face.outward);
      if (turn > 0) triangles.push_back({{a, b, c}, 1});
      if (turn < 0) triangles.push_back({{a, c, b}, -1});
    }
  }
  return triangles;
}

Convex overlap(const SignedTriangle& a, const SignedTriangle& b, Vec3 plane_normal) {
  Convex part{a.corners.begin(), a.corners.end()};
  for (std::size_t i = 0; i < 3 && part.size() > 2; ++i) {
    const Vec3 from = b.corners[i], to = b.corners[(i + 1) % 3];
    const Vec3 out = geometry::cross(to - from, plane_normal);
    part = clipped(part, out, geometry::dot(out, from));
  }
  return part;
}

Convex within(Convex polygon, const Box& box) {
  const std::array<std::pair<Vec3, double>, 6> sides{{{{1, 0, 0}, box.max.x},
                                                      {{0, 1, 0}, box.max.y},
                                                      {{0, 0, 1}, box.max.z},
                                                      {{-1, 0, 0}, -box.min.x},
                                                      {{0, -1, 0}, -box.min.y},
                                                      {{0, 0, -1}, -box.min.z}}};
  for (const auto& [normal, offset] : sides) polygon = clipped(polygon, normal, offset);
  return polygon;
}

std::vector<Vec3> shared_corners(const topology::BlockComplex& complex, const topology::Face& face,
                                 topology::BlockId neighbour) {
  std::vector<Vec3> corners;
  for_each_shared(complex, face, neighbour, [&](const Convex& part, double) {
    if (part.size() > 2) corners.insert(corners.end(), part.begin(), part.end());
  });
  return corners;
}

std::optional<std::array<Vec3, 4>> spread_of(const topology::BlockComplex& complex, const topology::Face& face,
                                             topology::BlockId neighbour) {
  const Vec3 n = face.outward;
  const Vec3 u = geometry::normalized(cross(n, std::abs(n.z) < 0.9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0})), w = cross(n, u);
  const Vec3 from = face.centroid;
  double area = 0, su = 0, sw = 0, uu = 0, uw = 0, ww = 0;
  for_each_shared(complex, face, neighbour, [&](const Convex& part, double sign) {
    for (std::size_t i = 1; i + 1 < part.size(); ++i) {
      const Vec3 a = part[0] - from, b = part[i] - from, c = part[i + 1] - from;
      const double third = sign * geometry::norm(geometry::cross(b - a, c - a)) / 6;
      for (const Vec3 x : {0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)}) {
        const double xu = dot(x, u), xw = dot(x, w);
        area += third;
        su += third * xu;
        sw += third * xw;
        uu += third * xu * xu;
        uw += third * xu * xw;
        ww += third * xw * xw;
      }
    }
  });
  if (!(area > 0)) return std::nullopt;
  const double mu = su / area, mw = sw / area;
  uu = std::max(0.0, uu / area - mu * mu);
  ww = std::max(0.0, ww / area - mw * mw);
  uw = uw / area - mu * mw;
  // Principal axes of the 2 x 2 matrix of variances.
  const double mean = 0.5 * (uu + ww), half = 0.5 * (uu - ww), off = std::sqrt(half * half + uw * uw);
  double eu = half >= 0 ? half + off : uw, ew = half >= 0 ? uw : off - half;
  const double length = std::sqrt(eu * eu + ew * ew);
  eu = length > 0 ? eu / length : 1;
  ew = length > 0 ? ew / length : 0;
  constexpr double share = 1.2;
  const double wide = share * std::sqrt(std::max(0.0, mean + off)),
               narrow = share * std::sqrt(std::max(0.0, mean - off));
  const Vec3 middle = from + mu * u + mw * w;
  const Vec3 along = wide * (eu * u + ew * w), across = narrow * (-ew * u + eu * w);
  return std::array{middle + along, middle - along, middle + across, middle - across};
}

}  // namespace cleave::stability
