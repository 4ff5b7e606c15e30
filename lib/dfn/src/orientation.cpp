#include "orientation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "bingham.hpp"
#include "cleave/core/overloaded.hpp"
#include "cleave/core/rng.hpp"

namespace cleave::dfn::detail {

using geometry::Vec3;

namespace {

constexpr double radians(double degrees) { return degrees * (std::numbers::pi / 180); }

Frame bingham(const BinghamOrientation& law, double u, double v) {
  const Frame mean = frame_of(law.dip.degrees(), law.dip_direction.degrees());
  const Vec3 up_dip = cross(mean.normal, mean.strike);
  const double c = std::cos(law.axis.radians()), s = std::sin(law.axis.radians());
  const BinghamDraw drawn = draw_bingham(law, u, v);
  const double sine = std::sqrt(drawn.versine * (2 - drawn.versine));
  const double first = sine * std::cos(drawn.azimuth), second = sine * std::sin(drawn.azimuth);
  const Vec3 across = (first * c - second * s) * mean.strike + (first * s + second * c) * up_dip;
  return frame_of_normal(normalized((1 - drawn.versine) * mean.normal + across), mean.strike);
}

Frame about(const Frame& mean, double kappa, double u, double v) {
  // 1 - cos t, so that small angles keep their digits.
  const double versine = kappa > 0 ? -std::log1p(u * std::expm1(-2 * kappa)) / kappa : 2 * u;
  const double sine = std::sqrt(versine * (2 - versine));
  const double azimuth = 2 * std::numbers::pi * v;
  const Vec3 across = std::cos(azimuth) * mean.strike + std::sin(azimuth) * cross(mean.normal, mean.strike);
  return frame_of_normal(normalized((1 - versine) * mean.normal + sine * across), mean.strike);
}

Frame fisher(const FisherOrientation& law, double u, double v) {
  return about(frame_of(law.dip.degrees(), law.dip_direction.degrees()), law.kappa, u, v);
}

/// u chooses the normal; what is left of it within its step turns it, with v.
Frame bootstrap(const BootstrapOrientation& law, double u, double v) {
  const auto at = static_cast<std::size_t>(std::ranges::upper_bound(law.cumulative, u) - law.cumulative.begin());
  const std::size_t i = std::min(at, law.normals.size() - 1);
  const double from = i > 0 ? law.cumulative[i - 1] : 0;
  const Frame mean = frame_of_normal(law.normals[i], {-1, 0, 0});
  if (!law.jitter) return mean;
  return about(mean, *law.jitter, std::clamp((u - from) / (law.cumulative[i] - from), 0x1p-53, 1 - 0x1p-53), v);
}

}  // namespace

Frame frame_of_normal(Vec3 normal, Vec3 strike_if_flat) noexcept {
  if (normal.z < 0) normal = -normal;
  const double steepness = std::hypot(normal.x, normal.y);
  if (steepness < 1e-12) return {normal, strike_if_flat};
  return {normal, Vec3{-normal.y, normal.x, 0} / steepness};
}

Frame turned_by_fisher(geometry::Vec3 normal, double kappa, double u, double v) noexcept {
  return about(frame_of_normal(normal, {-1, 0, 0}), kappa, u, v);
}

Frame frame_of(double dip, double dip_direction) noexcept {
  dip = std::remainder(dip, 360);  // [-180, 180]
  if (dip < 0) {
    dip = -dip;
    dip_direction += 180;
  }
  if (dip > 90) {
    dip = 180 - dip;
    dip_direction += 180;
  }
  const double d = radians(dip), a = radians(dip_direction);
  const double ca = std::cos(a), sa = std::sin(a), sd = std::sin(d);
  return {{sd * sa, sd * ca, std::cos(d)}, {-ca, sa, 0}};
}

Frame mean_frame(const OrientationLaw& law) noexcept {
  return std::visit([](const auto& l) { return frame_of(l.dip.degrees(), l.dip_direction.degrees()); }, law);
}

Frame draw(const OrientationLaw& law, double u, double v) noexcept {
  return std::visit(overloaded{
                        [&](const UniformOrientation& l) {
                          return frame_of(l.dip.degrees() + (2 * u - 1) * l.dip_range.degrees(),
                                          l.dip_direction.degrees() + (2 * v - 1) * l.dip_direction_range.degrees());
                        },
                        [&](const FisherOrientation& l) { return fisher(l, u, v); },
                        [&](const BootstrapOrientation& l) { return bootstrap(l, u, v); },
                        [&](const BinghamOrientation& l) { return bingham(l, u, v); },
                        [&](const NormalOrientation& l) {
                          const double first = normal_quantile(u), r = l.correlation;
                          const double second = r * first + std::sqrt(1 - r * r) * normal_quantile(v);
                          return frame_of(l.dip.degrees() + first * l.dip_std.degrees(),
                                          l.dip_direction.degrees() + second * l.dip_direction_std.degrees());
                        },
                    },
                    law);
}

Frame draw(const OrientationLaw& law, const Frame& mean, double u, double v) noexcept {
  if (const auto* l = std::get_if<FisherOrientation>(&law)) return about(mean, l->kappa, u, v);
  return draw(law, u, v);
}

}  // namespace cleave::dfn::detail
