#include "detail/fixed_measure.hpp"

#include <algorithm>
#include <cmath>

namespace cleave::topology::detail {
namespace {

using exact::FixedPoint;
using exact::Int128;
using exact::Int512;

/// Both a quotient of large integers, to a few ulp, and their scale.
double ratio(const Int512& a, const Int512& b) { return a.convert_to<double>() / b.convert_to<double>(); }

}  // namespace

void FixedMeasure::add(const FixedPoint& a, const FixedPoint& b, const FixedPoint& c) {
  std::array<FixedPoint, 3> p{a, b, c};
  std::array<std::array<Int512, 3>, 3> w;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      p[i][k] -= apex_[k];
      reach_ = std::max(reach_, p[i][k] < 0 ? -p[i][k] : p[i][k]);
      w[i][k] = p[i][k];
    }
  }
  const Int512 determinant = w[0][0] * (w[1][1] * w[2][2] - w[1][2] * w[2][1]) +
                             w[0][1] * (w[1][2] * w[2][0] - w[1][0] * w[2][2]) +
                             w[0][2] * (w[1][0] * w[2][1] - w[1][1] * w[2][0]);
  six_volumes_ += determinant;
  for (std::size_t k = 0; k < 3; ++k) moment_[k] += determinant * (w[0][k] + w[1][k] + w[2][k]);
  ++triangles_;
}

std::optional<exact::Sign> FixedMeasure::sign() const {
  // A determinant is six products of three numbers of at most `reach`, each less than 2 off: apex and corner.
  const Int512 reach = Int512{reach_} + 2;
  const Int512 bound = Int512{triangles_} * 36 * reach * reach;
  if (six_volumes_ > bound) return exact::Sign::positive;
  if (six_volumes_ < -bound) return exact::Sign::negative;
  return std::nullopt;
}

double FixedMeasure::volume() const { return std::ldexp(six_volumes_.convert_to<double>(), -3 * 112) / 6; }

std::optional<geometry::Vec3> FixedMeasure::centroid() const {
  if (six_volumes_ <= 0) return std::nullopt;
  const auto base = exact::as_position(apex_);
  std::array<double, 3> at{};
  for (std::size_t k = 0; k < 3; ++k) at[k] = base[k] + std::ldexp(ratio(moment_[k], six_volumes_) / 4, -112);
  return geometry::Vec3{at[0], at[1], at[2]};
}

}  // namespace cleave::topology::detail
