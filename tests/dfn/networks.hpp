#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "cleave/dfn/joint_set.hpp"
#include "cleave/dfn/sample.hpp"

/// Networks in a box of 12 x 10 x 8 m, and means with their standard errors to compare with exact expectations.
namespace cleave::dfn::networks {

using geometry::Polygon;
using geometry::Vec3;

inline constexpr double pi = std::numbers::pi;
inline constexpr DomainBox box{{0, 0, 0}, {12, 10, 8}};
inline constexpr double volume = 12 * 10 * 8;

inline SizeLaw side(double m) { return SizeLaw::constant(metres(m)); }
inline FisherOrientation iso() { return {Dip::degrees(0), DipDirection::degrees(0), 0}; }
inline FisherOrientation steep() { return {Dip::degrees(40), DipDirection::degrees(70), 15}; }

inline JointSet set_of(Model model, Shape shape, Intensity intensity, OrientationLaw law = iso()) {
  auto set = JointSet::make({std::move(law), std::move(shape), FixedRotation{}, intensity, std::move(model)});
  EXPECT_TRUE(set.has_value()) << describe(set.error());
  return *set;
}

/// Area of a convex polygon within the box.
inline double area_inside(const Polygon& polygon) {
  std::vector<Vec3> c{polygon.corners().begin(), polygon.corners().end()};
  const auto clip = [&](auto&& side_of) {
    std::vector<Vec3> kept;
    for (std::size_t i = 0; i < c.size(); ++i) {
      const Vec3 p = c[i], q = c[(i + 1) % c.size()];
      const double a = side_of(p), b = side_of(q);
      if (a >= 0) kept.push_back(p);
      if ((a > 0 && b < 0) || (a < 0 && b > 0)) kept.push_back(p + (a / (a - b)) * (q - p));
    }
    c = std::move(kept);
  };
  clip([](Vec3 q) { return q.x - box.min.x; });
  clip([](Vec3 q) { return box.max.x - q.x; });
  clip([](Vec3 q) { return q.y - box.min.y; });
  clip([](Vec3 q) { return box.max.y - q.y; });
  clip([](Vec3 q) { return q.z - box.min.z; });
  clip([](Vec3 q) { return box.max.z - q.z; });
  Vec3 sum{0, 0, 0};
  for (std::size_t i = 2; i < c.size(); ++i) sum += 0.5 * cross(c[i - 1] - c[0], c[i] - c[0]);
  return norm(sum);
}
inline double area_inside(const std::vector<SampledJoint>& joints) {
  double area = 0;
  for (const SampledJoint& joint : joints) {
    if (const auto* one = std::get_if<Polygon>(&joint.shape)) area += area_inside(*one);
    if (const auto* several = std::get_if<std::vector<Polygon>>(&joint.shape)) {
      for (const Polygon& p : *several) area += area_inside(p);
    }
  }
  return area;
}

/// By value: what `sample` returns must live as long as the loop over it.
inline std::vector<SampledJoint> draws(const JointSet& set, std::size_t number, std::uint64_t seed,
                                       std::uint64_t realization,
                                       std::span<const std::span<const SampledJoint>> older = {},
                                       const DomainBox& domain = box) {
  auto joints = sample(set, number, domain, seed, realization, older);
  EXPECT_TRUE(joints.has_value());
  return with_polygons(*std::move(joints));
}
inline Mit mit(double share, bool any_shape) {
  Mit model;
  model.share = share;
  if (any_shape) {
    model.min_corners = 3;
    model.min_angle = 0;
    model.max_elongation = 1e6;
  }
  return model;
}

struct Mean {
  double n = 0, mean = 0, squares = 0;
  void add(double x) {
    ++n;
    const double d = x - mean;
    mean += d / n;
    squares += d * (x - mean);
  }
  [[nodiscard]] double variance() const { return squares / (n - 1); }
  [[nodiscard]] double error() const { return std::sqrt(variance() / n); }
};
#define EXPECT_MEAN(sample, exact) EXPECT_NEAR((sample).mean, exact, 4.5 * (sample).error())

inline Mean p32_of(const JointSet& set, std::uint64_t realizations,
                   std::span<const std::span<const SampledJoint>> older = {}) {
  Mean p32;
  for (std::uint64_t k = 0; k < realizations; ++k) {
    p32.add(area_inside(draws(set, 1, 7, k, older)) / volume);
  }
  return p32;
}

}  // namespace cleave::dfn::networks
