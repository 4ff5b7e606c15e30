#include "cleave/core/quantity.hpp"

#include <gtest/gtest.h>

#include <type_traits>

namespace cleave {
namespace {

TEST(QuantityTest, DimensionsFollowTheProducts) {
  static_assert(std::is_same_v<decltype(metres(2) * square_metres(3)), Volume>);
  static_assert(std::is_same_v<decltype(newtons(2) / square_metres(3)), Stress>);
  static_assert(std::is_same_v<decltype(metres(2) / metres(3)), double>);
  const Force weight = kilograms_per_cubic_metre(2700) * cubic_metres(2) * metres_per_second_squared(10);
  EXPECT_EQ(weight.si(), 54'000.0);
  EXPECT_EQ(metres(6) / metres(3), 2.0);
  EXPECT_LT(metres(2), metres(3) - metres(0.5));
}

TEST(AngleTest, DegreesAreKeptAndRadiansComputed) {
  EXPECT_EQ(Dip::degrees(30).degrees(), 30.0);
  EXPECT_DOUBLE_EQ(Dip::degrees(180).radians(), std::numbers::pi);
  EXPECT_DOUBLE_EQ(Dip::radians(std::numbers::pi / 6).degrees(), 30.0);
}

}  // namespace
}  // namespace cleave
