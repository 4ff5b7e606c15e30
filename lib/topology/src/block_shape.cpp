#include "cleave/topology/block_shape.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cleave::topology {
namespace {

using geometry::Vec3;

/// Integral of x x^T over a block about its centroid, over its volume: by signed tetrahedra from the centroid.
std::array<double, 6> covariance(const BlockComplex& complex, const Block& block) {
  std::array<double, 6> sum{};
  const Vec3 to_centre = block.centroid - complex.origin();
  for (const FaceId id : block.faces) {
    for (const auto& loop : complex.loops(complex.faces()[id])) {
      const Vec3 a = complex.vertices()[loop[0]] - to_centre;
      for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
        const Vec3 b = complex.vertices()[loop[i]] - to_centre, c = complex.vertices()[loop[i + 1]] - to_centre;
        const double six = dot(a, cross(b, c));
        const Vec3 s = a + b + c;
        const auto part = [&](double Vec3::* p, double Vec3::* q) {
          return six / 120 * (a.*p * a.*q + b.*p * b.*q + c.*p * c.*q + s.*p * s.*q);
        };
        sum[0] += part(&Vec3::x, &Vec3::x);
        sum[1] += part(&Vec3::y, &Vec3::y);
        sum[2] += part(&Vec3::z, &Vec3::z);
        sum[3] += part(&Vec3::x, &Vec3::y);
        sum[4] += part(&Vec3::y, &Vec3::z);
        sum[5] += part(&Vec3::z, &Vec3::x);
      }
    }
  }
  const double volume = block.volume.si();
  for (double& value : sum) value = volume > 0 ? value / volume : 0;
  return sum;
}

/// Eigenvalues of a symmetric matrix, largest first (Smith 1961).
std::array<double, 3> eigenvalues(const std::array<double, 6>& m) {
  const auto [xx, yy, zz, xy, yz, zx] = m;
  const double mean = (xx + yy + zz) / 3, off = xy * xy + yz * yz + zx * zx;
  const double a = xx - mean, b = yy - mean, c = zz - mean;
  const double p = std::sqrt((a * a + b * b + c * c + 2 * off) / 6);
  if (!(p > 0)) return {mean, mean, mean};
  const double det = (a * (b * c - yz * yz) - xy * (xy * c - yz * zx) + zx * (xy * yz - b * zx)) / (p * p * p);
  const double angle = std::acos(std::clamp(det / 2, -1.0, 1.0)) / 3;
  const double first = mean + 2 * p * std::cos(angle), last = mean + 2 * p * std::cos(angle + 2 * std::numbers::pi / 3);
  return {first, 3 * mean - first - last, last};
}

}  // namespace

std::array<double, 3> inertia(const BlockComplex& complex, const Block& block) {
  return eigenvalues(covariance(complex, block));
}

geometry::Box extents(const BlockComplex& complex, const Block& block) {
  geometry::Box box;
  for (const FaceId id : block.faces) {
    for (const auto& loop : complex.loops(complex.faces()[id])) {
      for (const VertexId vertex : loop) box.add(complex.vertices()[vertex]);
    }
  }
  return box;
}

}  // namespace cleave::topology
