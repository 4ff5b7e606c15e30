#include "shape.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cleave/core/overloaded.hpp"

namespace cleave::dfn::detail {
namespace {

constexpr double pi = std::numbers::pi;

/// E[first * second].
double mean_product(const SizeLaw& first, const SecondSize& second) {
  return std::visit(overloaded{
                        [&](IndependentSize) { return first.moment(1) * first.moment(1); },
                        [&](AspectRatio r) { return first.moment(2) / r.ratio; },
                        [&](const SizeLaw& law) { return first.moment(1) * law.moment(1); },
                    },
                    second);
}

double largest_second(const SizeLaw& first, const SecondSize& second) {
  return std::visit(overloaded{
                        [&](IndependentSize) { return first.largest().si(); },
                        [&](AspectRatio r) { return first.largest().si() / r.ratio; },
                        [](const SizeLaw& law) { return law.largest().si(); },
                    },
                    second);
}

double second_size(const SizeLaw& law, const SecondSize& second, double first, double v) {
  return std::visit(overloaded{
                        [&](IndependentSize) { return law.quantile(v).si(); },
                        [&](AspectRatio r) { return first / r.ratio; },
                        [&](const SizeLaw& own) { return own.quantile(v).si(); },
                    },
                    second);
}

/// Area of the regular polygon of circumradius 1.
double unit_area(std::uint32_t sides) { return sides * std::sin(2 * pi / sides) / 2; }
/// Circumradius of the polygon with the area of a circle of radius 1.
double same_area(std::uint32_t sides) { return std::sqrt(pi / unit_area(sides)); }

}  // namespace

double mean_area(const Shape& shape) noexcept {
  return std::visit(overloaded{
                        [](const Rectangle& s) { return mean_product(s.size, s.second); },
                        [](const Square& s) { return s.size.moment(2); },
                        [](const Disc& s) { return pi / 4 * s.size.moment(2); },
                        [](const Ellipse& s) { return pi / 4 * mean_product(s.size, s.second); },
                        [](const RegularPolygon& s) { return unit_area(s.sides) / 4 * s.size.moment(2); },
                        [](Persistent) { return 0.0; },
                    },
                    shape);
}

double reach(const Shape& shape) noexcept {
  return std::visit(
      overloaded{
          [](const Rectangle& s) { return std::hypot(s.size.largest().si(), largest_second(s.size, s.second)) / 2; },
          [](const Square& s) { return s.size.largest().si() / std::numbers::sqrt2; },
          [](const Disc& s) { return s.size.largest().si() / 2 * same_area(s.sides); },
          [](const Ellipse& s) {
            return std::max(s.size.largest().si(), largest_second(s.size, s.second)) / 2 * same_area(s.sides);
          },
          [](const RegularPolygon& s) { return s.size.largest().si() / 2; },
          [](Persistent) { return 0.0; },
      },
      shape);
}

SizeDrawer::SizeDrawer(const Shape& shape) : shape_{&shape} {
  const auto round = [&](std::uint32_t sides) {
    sides_ = sides;
    stretch_ = same_area(sides);
  };
  if (const auto* disc = std::get_if<Disc>(shape_)) round(disc->sides);
  if (const auto* ellipse = std::get_if<Ellipse>(shape_)) round(ellipse->sides);
  if (const auto* polygon = std::get_if<RegularPolygon>(shape_)) sides_ = polygon->sides;
}

bool SizeDrawer::two_draws() const noexcept {
  const auto own = [](const SecondSize& second) { return !std::holds_alternative<AspectRatio>(second); };
  if (const auto* rectangle = std::get_if<Rectangle>(shape_)) return own(rectangle->second);
  if (const auto* ellipse = std::get_if<Ellipse>(shape_)) return own(ellipse->second);
  return false;
}

HalfAxes SizeDrawer::draw(double u, double v) const {
  const auto equal = [&](const SizeLaw& size) {
    const double half = size.quantile(u).si() / 2 * stretch_;
    return HalfAxes{half, half};
  };
  const auto two = [&](const SizeLaw& size, const SecondSize& second) {
    const double first = size.quantile(u).si();
    return HalfAxes{first / 2 * stretch_, second_size(size, second, first, v) / 2 * stretch_};
  };
  return std::visit(overloaded{
                        [&](const Rectangle& s) { return two(s.size, s.second); },
                        [&](const Square& s) { return equal(s.size); },
                        [&](const Disc& s) { return equal(s.size); },
                        [&](const Ellipse& s) { return two(s.size, s.second); },
                        [&](const RegularPolygon& s) { return equal(s.size); },
                        [](Persistent) { return HalfAxes{0, 0}; },
                    },
                    *shape_);
}

double draw_rotation(const RotationLaw& law, Rng rng) noexcept {
  return std::visit(overloaded{
                        [](const FixedRotation& r) { return r.angle.radians(); },
                        [&](const UniformRotation& r) {
                          return r.from.radians() + rng.uniform() * (r.to.radians() - r.from.radians());
                        },
                        [&](const NormalRotation& r) { return r.mean.radians() + rng.normal() * r.std.radians(); },
                    },
                    law);
}

}  // namespace cleave::dfn::detail
