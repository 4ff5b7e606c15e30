#include <gtest/gtest.h>

#include <array>

#include "cleave/exact/predicates.hpp"
#include "random_planes.hpp"

namespace cleave::testing {
namespace {

using exact::line_of;
using exact::meet;

TEST(Predicates, FilterAgreesWithTheIntegers) {
  RandomPlanes random{11};
  std::array<int, 5> decided{}, zeros{};
  for (int i = 0; i < 100'000; ++i) {
    const int kind = i % 5;
    const auto [p, q, r, s] = planes_of_kind(random, kind);
    const auto point = meet(line_of(p, q), r);
    const Sign det3_sign = det3_exact(p, q, r);
    if (const auto filtered = det3_filtered(point)) {
      ASSERT_EQ(*filtered, det3_sign);
    }
    EXPECT_EQ(orientation(p, q, r), det3_sign);
    if (det3_sign == Sign::zero) continue;
    const Sign side = side_exact(p, q, r, s);
    if (side == Sign::zero) ++zeros.at(static_cast<std::size_t>(kind));
    if (const auto filtered = side_filtered(point, s)) {
      ASSERT_EQ(*filtered, side);
      ++decided.at(static_cast<std::size_t>(kind));
    }
  }
  EXPECT_GT(decided[0], 19'800) << "of 20,000 general ones";
  EXPECT_GT(zeros[1], 1000);
  EXPECT_EQ(decided[2], 0) << "zero is never decided by rounding";
  EXPECT_GT(zeros[2], 19'000);
  EXPECT_LT(decided[3], 200) << "one site off is beyond doubles";
  EXPECT_LT(zeros[3], 10'000);
}

}  // namespace
}  // namespace cleave::testing
