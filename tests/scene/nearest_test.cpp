#include "cleave/core/nearest.hpp"

#include <gtest/gtest.h>

#include <array>

namespace cleave::scene {
namespace {

constexpr std::array<std::string_view, 5> keys{"seed", "snap", "gravity", "dip_direction", "min"};

TEST(NearestTest, FindsSlips) {
  EXPECT_EQ(nearest("sead", keys), "seed");
  EXPECT_EQ(nearest("Seed", keys), "seed");
  EXPECT_EQ(nearest("gavrity", keys), "gravity");
  EXPECT_EQ(nearest("dipdirection", keys), "dip_direction");
  EXPECT_EQ(nearest("mni", keys), "min");
}

TEST(NearestTest, GuessesNothingForStrangers) {
  EXPECT_FALSE(nearest("water", keys).has_value());
  EXPECT_FALSE(nearest("", keys).has_value());
  EXPECT_FALSE(nearest(std::string(1'000'000, 's'), keys).has_value());
  EXPECT_FALSE(nearest("x", keys).has_value());
}

}  // namespace
}  // namespace cleave::scene
