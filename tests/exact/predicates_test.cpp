#include "cleave/exact/predicates.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>

#include "plane_reference.hpp"
#include "random_planes.hpp"

namespace cleave::testing {
namespace {

using exact::line_of;
using exact::meet;
using Real = boost::multiprecision::cpp_bin_float_100;
TEST(Predicates, ExactSignsAreThoseOfTheDeterminants) {
  RandomPlanes random{10};
  for (int i = 0; i < 2000; ++i) {
    const auto [p, q, r, s] = planes_of_kind(random, i % 5);
    EXPECT_EQ(det3_exact(p, q, r), sign(det3(p, q, r)));
    if (det3(p, q, r) == 0) continue;
    EXPECT_EQ(side_exact(p, q, r, s), side_reference(p, q, r, s));
    EXPECT_EQ(side_exact(p, q, r, s), sign(det4(p, q, r, s)) * sign(det3(p, q, r)));
  }
}

// Whatever was asked before: a meet that is kept belongs to its three planes and no others.
TEST(Predicates, ExactSidesDoNotDependOnWhatWasAskedBefore) {
  RandomPlanes random{11};
  for (int i = 0; i < 500; ++i) {
    const auto [a, b, c, d] = planes_of_kind(random, i % 5);
    const std::array planes{a, b, c, d};
    std::array<std::size_t, 4> order{0, 1, 2, 3};
    do {
      const auto &p = planes[order[0]], &q = planes[order[1]], &r = planes[order[2]], &s = planes[order[3]];
      if (det3(p, q, r) == 0) continue;
      EXPECT_EQ(side_exact(p, q, r, s), side_reference(p, q, r, s));
    } while (std::ranges::next_permutation(order).found);
  }
}

/// The approximate determinant less the exact one, in the filter's units; the largest seen.
TEST(Predicates, ErrorBoundsHold) {
  RandomPlanes random{12};
  double largest3 = 0, largest4 = 0, largest_x = 0;
  const auto exponent = [](const Plane& p) {
    double most = 0;
    for (const exact::Int128 n : p.normal()) most = std::max(most, std::abs(static_cast<double>(n)));
    return std::ilogb(most);
  };
  for (int i = 0; i < 5000; ++i) {
    const auto [p, q, r, s] = planes_of_kind(random, i % 5);
    const int e = exponent(p) + exponent(q) + exponent(r);
    const auto point = meet(line_of(p, q), r);
    const auto difference = [](double value, const Integer& exact, int scale) {
      return std::abs((Real{value} - ldexp(Real{exact}, -scale)).convert_to<double>());
    };
    largest3 = std::max(largest3, difference(point.w, det3(p, q, r), e));
    const auto& n = s.approx();
    const double value = (n[0] * point.x[0] + n[1] * point.x[1] + n[2] * point.x[2]) + n[3] * point.w;
    largest4 = std::max(largest4, difference(value, det4(p, q, r, s), e + exponent(s) + 48));
    const auto exact_point = exact_meet(exact_line(p, q), r);
    for (std::size_t k = 0; k < 3; ++k) {
      largest_x = std::max(largest_x, difference(point.x.at(k), Integer{exact_point.x.at(k)}, e + 48));
    }
  }
  EXPECT_LE(largest3, 512 * exact::unit_roundoff);
  EXPECT_LE(largest_x, 912 * exact::unit_roundoff);
  EXPECT_LE(largest4, 10320 * exact::unit_roundoff);
  // The test would be empty if there were no rounding.
  EXPECT_GT(largest3, exact::unit_roundoff / 4);
  EXPECT_GT(largest4, exact::unit_roundoff / 4);
}

TEST(Predicates, Laws) {
  RandomPlanes random{13};
  for (int i = 0; i < 3000; ++i) {
    const auto [p, q, r, s] = planes_of_kind(random, i % 5);
    const Sign o = det3_exact(p, q, r);
    EXPECT_EQ(det3_exact(q, r, p), o);
    EXPECT_EQ(det3_exact(q, p, r), -o);
    EXPECT_EQ(det3_exact(p.flipped(), q, r), -o);
    if (o == Sign::zero) continue;
    const Sign side = side_exact(p, q, r, s);
    EXPECT_EQ(side_exact(q, r, p, s), side);
    EXPECT_EQ(side_exact(q, p, r, s), side);
    EXPECT_EQ(side_exact(p, r.flipped(), q, s), side);
    EXPECT_EQ(side_exact(p, q, r, s.flipped()), -side);
    for (const Plane& own : {p, q, r}) EXPECT_EQ(side_exact(p, q, r, own), Sign::zero);
  }
}

TEST(Predicates, MeetInALatticePointSeesTheSideOfThatPoint) {
  RandomPlanes random{14};
  for (int i = 0; i < 3000; ++i) {
    const LatticePoint a = random.point(whole_lattice / 2);
    const auto through_a = [&] { return random.plane_through(a, i % 2 == 0 ? whole_lattice / 2 : 5); };
    const Plane p = through_a(), q = through_a(), r = through_a();
    if (det3_exact(p, q, r) == Sign::zero) continue;
    const Plane s = random.plane(whole_lattice);
    EXPECT_EQ(side_exact(p, q, r, s), s.side_of(a));
  }
}

TEST(Predicates, SideOfALineParallelToAPlane) {
  RandomPlanes random{15};
  int zero = 0, other = 0;
  for (int i = 0; i < 3000; ++i) {
    // P and Q through the line a + t d; S contains the direction d and some other point.
    const std::int64_t reach = i % 2 == 0 ? whole_lattice / 8 : 3;
    const LatticePoint a = random.point(reach), d = random.point(reach), b = i % 3 == 0 ? a : random.point(reach);
    const auto p = Plane::spanned(a, d, random.point(reach)), q = Plane::spanned(a, d, random.point(reach)),
               s = Plane::spanned(b, d, random.point(reach));
    if (!p || !q || !s || p->parallel_to(*q)) continue;
    ASSERT_EQ(det3_exact(*p, *q, *s), Sign::zero);
    const Sign side = side_of_parallel_line(*p, *q, *s);
    EXPECT_EQ(side, s->side_of(a));
    EXPECT_EQ(side_of_parallel_line(*q, p->flipped(), *s), side);
    EXPECT_EQ(side_of_parallel_line(*p, *q, s->flipped()), -side);
    ++(side == Sign::zero ? zero : other);
  }
  EXPECT_GT(zero, 300);
  EXPECT_GT(other, 300);
}

TEST(Predicates, AnUndecidedFilterIsNotAZero) {
  EXPECT_EQ(exact::sign_filtered(1e-20, 1e-15), std::nullopt);
  EXPECT_EQ(exact::sign_filtered(0, 1e-15), std::nullopt);
  EXPECT_EQ(exact::sign_filtered(1e-15, 1e-15), std::nullopt);
  EXPECT_EQ(exact::sign_filtered(2e-15, 1e-15), Sign::positive);
  EXPECT_EQ(exact::sign_filtered(-2e-15, 1e-15), Sign::negative);
}

}  // namespace
}  // namespace cleave::testing
