#include "cleave/exact/plane.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "plane_reference.hpp"
#include "random_planes.hpp"

namespace cleave::testing {
namespace {

TEST(Plane, GoesThroughItsPointsAndIsReduced) {
  RandomPlanes random{1};
  for (int i = 0; i < 2000; ++i) {
    const std::int64_t reach = i % 2 == 0 ? whole_lattice : 6;
    const LatticePoint a = random.point(reach), b = random.point(reach), c = random.point(reach);
    const auto plane = Plane::through(a, b, c);
    if (!plane) continue;
    for (const LatticePoint p : {a, b, c}) EXPECT_EQ(plane->side_of(p), Sign::zero);
    const auto n = coefficients(*plane);
    EXPECT_EQ(gcd(gcd(n[0], n[1]), n[2]), 1);
    // The positive side is the one from which a, b, c turn counter-clockwise.
    const LatticePoint d = random.point(reach);
    const auto row = [&](LatticePoint p) {
      return std::array<Integer, 3>{Integer{p.x - a.x}, Integer{p.y - a.y}, Integer{p.z - a.z}};
    };
    EXPECT_EQ(plane->side_of(d), sign(determinant<3>({row(b), row(c), row(d)})));
  }
}

TEST(Plane, IsTheSameThroughAnyOfItsPoints) {
  const LatticePoint a{0, 0, 0}, b{6, 0, 3}, c{0, 4, 2};
  const auto p = Plane::through(a, b, c).value();
  EXPECT_EQ(p, Plane::through(b, c, a).value());
  EXPECT_EQ(p, Plane::through({12, -4, 4}, {12, 0, 6}, {6, 0, 3}).value()) << "other points";
  EXPECT_EQ(p.flipped(), Plane::through(a, c, b).value());
  EXPECT_EQ(p.flipped().flipped(), p);
  EXPECT_TRUE(p.coincides_with(p.flipped()));
  EXPECT_FALSE(p == p.flipped());
  EXPECT_TRUE(p.parallel_to(
      Plane::through(a + LatticePoint{0, 0, 1}, b + LatticePoint{0, 0, 1}, c + LatticePoint{0, 0, 1}).value()));
  EXPECT_FALSE(p.coincides_with(
      Plane::through(a + LatticePoint{0, 0, 1}, b + LatticePoint{0, 0, 1}, c + LatticePoint{0, 0, 1}).value()));
}

TEST(Plane, DoesNotExistThroughPointsOnALine) {
  EXPECT_FALSE(Plane::through({0, 0, 0}, {1, 2, 3}, {2, 4, 6}));
  EXPECT_FALSE(Plane::through({5, 5, 5}, {5, 5, 5}, {1, 2, 3}));
  constexpr std::int64_t big = whole_lattice / 2;
  EXPECT_FALSE(Plane::through({-big, -big, -big}, {0, 0, 0}, {big, big, big}));
  EXPECT_TRUE(Plane::through({-big, -big, -big}, {0, 0, 0}, {big, big, big - 1})) << "one site off in 2^46";
}

TEST(Plane, ApproximationIsAsGoodAsItSays) {
  RandomPlanes random{2};
  for (int i = 0; i < 20000; ++i) {
    const Plane p = random.plane(i % 3 == 0 ? 10 : i % 3 == 1 ? std::int64_t{1} << 30 : whole_lattice);
    const auto& approx = p.approx();
    const double largest = std::max({std::abs(approx[0]), std::abs(approx[1]), std::abs(approx[2])});
    EXPECT_GE(largest, 1);
    EXPECT_LT(largest, 2 + 0x1p-50);
    EXPECT_LE(std::abs(approx[3]), 3);
    const auto exact = coefficients(p);
    std::size_t k = 0;
    while (std::abs(approx.at(k)) != largest) ++k;
    const long double scale = static_cast<long double>(approx.at(k)) / exact.at(k).convert_to<long double>();
    for (std::size_t j = 0; j < 4; ++j) {
      const long double value = exact.at(j).convert_to<long double>() * scale * (j == 3 ? 0x1p-48L : 1.0L);
      EXPECT_LE(std::abs(static_cast<long double>(approx.at(j)) - value), 0x1p-51L * std::abs(value) * 1.01L);
    }
    const auto u = p.unit_normal();
    EXPECT_NEAR(u[0] * u[0] + u[1] * u[1] + u[2] * u[2], 1, 1e-15);
  }
}

TEST(Plane, SideOfPointsOneSiteOff) {
  RandomPlanes random{3};
  for (int i = 0; i < 5000; ++i) {
    const LatticePoint a = random.point(whole_lattice / 2);
    const Plane p = random.plane_through(a, whole_lattice / 2);
    EXPECT_EQ(p.side_of(a), Sign::zero);
    EXPECT_EQ(p.side_of(a + LatticePoint{1, 0, 0}), exact::sign_of(p.normal()[0]));
    EXPECT_EQ(p.side_of(a + LatticePoint{0, -1, 0}), -exact::sign_of(p.normal()[1]));
    EXPECT_EQ(p.side_of(a + LatticePoint{0, 0, 1}), exact::sign_of(p.normal()[2]));
  }
}

}  // namespace
}  // namespace cleave::testing
