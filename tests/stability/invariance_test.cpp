#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "analyse_complex.hpp"
#include "random_complex.hpp"
#include "statics.hpp"

namespace cleave::stability {
namespace {

using geometry::Vec3;
using testing_complex::Description;

using Map = std::function<Vec3(Vec3)>;

/// The 24 turns of the axes by multiples of 90 degrees.
std::vector<Map> turns() {
  const auto roll = [](Vec3 v) { return Vec3{v.y, v.z, v.x}; };
  const auto quarter = [](Vec3 v) { return Vec3{-v.y, v.x, v.z}; };
  const auto over = [](Vec3 v) { return Vec3{v.x, -v.y, -v.z}; };
  std::vector<Map> maps;
  for (int r = 0; r < 3; ++r) {
    for (int q = 0; q < 4; ++q) {
      for (int o = 0; o < 2; ++o) {
        maps.emplace_back([=](Vec3 v) {
          for (int i = 0; i < o; ++i) v = over(v);
          for (int i = 0; i < q; ++i) v = quarter(v);
          for (int i = 0; i < r; ++i) v = roll(v);
          return v;
        });
      }
    }
  }
  return maps;
}

Description turned(Description d, const Map& map) {
  for (auto& contact : d.contacts) contact.inward = map(contact.inward);
  return d;
}

void expect_same(const Analysis& a, const Analysis& b, const Map& map, double volume_ratio, double tolerance) {
  ASSERT_EQ(a.batches.size(), b.batches.size());
  for (std::size_t k = 0; k < a.batches.size(); ++k) EXPECT_EQ(a.batches[k].blocks, b.batches[k].blocks);
  ASSERT_EQ(a.judgements.size(), b.judgements.size());
  for (std::size_t i = 0; i < a.judgements.size(); ++i) {
    const Judgement& p = a.judgements[i];
    const Judgement& q = b.judgements[i];
    EXPECT_EQ(p.block, q.block);
    EXPECT_EQ(p.mode, q.mode);
    EXPECT_EQ(p.batch, q.batch);
    EXPECT_EQ(p.key, q.key);
    EXPECT_EQ(p.cone_dimension, q.cone_dimension);
    EXPECT_LT(geometry::norm(map(p.direction) - q.direction), tolerance);
    EXPECT_NEAR(p.net.si() * volume_ratio, q.net.si(), tolerance * volume_ratio);
    ASSERT_EQ(p.transferred.has_value(), q.transferred.has_value());
    if (p.transferred) {
      EXPECT_EQ(p.transferred->mode, q.transferred->mode);
      EXPECT_NEAR(p.transferred->net.si() * volume_ratio, q.transferred->net.si(), tolerance * volume_ratio);
    }
  }
}

// Decisions are exact, so turning scene and gravity together changes no mode and no batch.
TEST(InvarianceTest, AxesCanBeTurnedByNinetyDegrees) {
  const auto maps = turns();
  ASSERT_EQ(maps.size(), 24U);
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const Description d = testing_complex::random(seed, 40);
    const Settings with = testing_complex::random_settings(seed);
    const Analysis plain = analyse_complex(d.build(), with);
    for (const Map& map : maps) {
      Settings turned_settings = with;
      turned_settings.loads = Loads::make(map({0, 0, -1})).value();
      expect_same(plain, analyse_complex(turned(d, map).build(), turned_settings), map, 1, 1e-9);
    }
  }
}

// Without cohesion weight is the only force there is: all volumes times 1000, same modes, forces times 1000. (A power
// of two would be exact; 1000 is not.)
TEST(InvarianceTest, ForcesScaleWithVolume) {
  for (std::uint64_t seed = 20; seed < 40; ++seed) {
    const Description d = testing_complex::random(seed, 40);
    Description big = d;
    for (double& volume : big.volumes) volume *= 1000;
    const Settings with = statics::settings({statics::strength(10), statics::strength(20), statics::strength(30),
                                             statics::strength(40), statics::strength(50)});
    expect_same(
        analyse_complex(d.build(), with), analyse_complex(big.build(), with), [](Vec3 v) { return v; }, 1000, 1e-9);
  }
}

TEST(InvarianceTest, OrderOfFacesDoesNotMatter) {
  for (std::uint64_t seed = 40; seed < 60; ++seed) {
    const Description d = testing_complex::random(seed, 40);
    Description back = d;
    std::ranges::reverse(back.contacts);
    const Settings with = testing_complex::random_settings(seed);
    expect_same(
        analyse_complex(d.build(), with), analyse_complex(back.build(), with), [](Vec3 v) { return v; }, 1, 1e-9);
  }
}

}  // namespace
}  // namespace cleave::stability
