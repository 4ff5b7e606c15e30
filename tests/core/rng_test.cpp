#include "cleave/core/rng.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

namespace cleave {
namespace {

TEST(PhiloxTest, GivesThePublishedKnownAnswers) {  // kat_vectors of Random123, philox 4x32 10
  using Words = std::array<std::uint32_t, 4>;
  EXPECT_EQ(detail::philox4x32_10({0, 0, 0, 0}, {0, 0}), (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  constexpr std::uint32_t ones = 0xffffffff;
  EXPECT_EQ(detail::philox4x32_10({ones, ones, ones, ones}, {ones, ones}),
            (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(detail::philox4x32_10({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(RngTest, LaysOutTheKeyAsDocumented) {
  Rng first{1};
  EXPECT_EQ(first.u64(), 0xe3e80670e50a0ebcU);
  EXPECT_EQ(first.u64(), 0x95f222c0b615aa27U);
  // Worked values of an independent implementation; every part of the key differs from every other one.
  Rng all{StreamKey{
      .seed = 0x123456789abcdef0U, .realization = 0xfedcba9876543210U, .purpose = 0x01020304U, .index = 0xdeadbeefU}};
  EXPECT_EQ(all.u64(), 0xf0b30966606d7cccU);
  EXPECT_EQ(all.u64(), 0x02dc8911e0af0d25U);
  EXPECT_EQ(all.u64(), 0xda0fbf947337b300U);
  EXPECT_EQ(all.u64(), 0x653743d34f480fd9U);
  EXPECT_EQ(stream_purpose(2, Draw::size), 515U);
}

TEST(RngTest, UniformIsCentredInTheOpenInterval) {
  Rng a{1};
  EXPECT_EQ(a.uniform(), 0.8902591729757107);
  EXPECT_EQ(a.uniform(), 0.5857259483801359);
  Rng b{StreamKey{.seed = 1, .realization = 7, .purpose = 3, .index = 42}};
  EXPECT_EQ(b.uniform(), 0.899365444836656);
  EXPECT_EQ(b.uniform(), 0.3999338005583176);
}

TEST(RngTest, UniformHasTheMomentsOfTheLaw) {
  constexpr int n = 200'000;
  double sum = 0.0;
  double squares = 0.0;
  double neighbours = 0.0;
  double last = 0.0;
  Rng rng{20260101};
  for (int i = 0; i < n; ++i) {
    const double u = rng.uniform() - 0.5;
    ASSERT_TRUE(u > -0.5 && u < 0.5);
    sum += u;
    squares += u * u;
    neighbours += u * last;
    last = u;
  }
  // Five standard errors each: 1/sqrt(12 n), sqrt(1/180 n), 1/(12 sqrt n).
  EXPECT_NEAR(sum / n, 0.0, 5.0 / std::sqrt(12.0 * n));
  EXPECT_NEAR(squares / n, 1.0 / 12.0, 5.0 / std::sqrt(180.0 * n));
  EXPECT_NEAR(neighbours / n, 0.0, 5.0 / (12.0 * std::sqrt(n)));
}

TEST(RngTest, StreamsOfNeighbouringKeysAreUnrelated) {
  constexpr std::uint32_t n = 50'000;
  const auto first = [](StreamKey key) { return Rng{key}.uniform() - 0.5; };
  double by_index = 0.0;
  double by_purpose = 0.0;
  double by_realization = 0.0;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double u = first({.seed = 5, .realization = 0, .purpose = 0, .index = i});
    by_index += u * first({.seed = 5, .realization = 0, .purpose = 0, .index = i + 1});
    by_purpose += u * first({.seed = 5, .realization = 0, .purpose = 1, .index = i});
    by_realization += u * first({.seed = 5, .realization = 1, .purpose = 0, .index = i});
  }
  const double limit = 5.0 * std::sqrt(n) / 12.0;
  EXPECT_LT(std::abs(by_index), limit);
  EXPECT_LT(std::abs(by_purpose), limit);
  EXPECT_LT(std::abs(by_realization), limit);
}

TEST(RngTest, BetweenReachesBothEndsEquallyOften) {
  constexpr std::size_t sides = 6;
  constexpr int n = 60'000;
  std::array<int, sides> seen{};
  Rng rng{3};
  for (int i = 0; i < n; ++i) {
    const std::int64_t k = rng.between(-2, 3);
    ASSERT_GE(k, -2);
    ASSERT_LE(k, 3);
    ++seen[static_cast<std::size_t>(k + 2)];
  }
  double chi2 = 0.0;
  for (const int s : seen) chi2 += (s - n / 6.0) * (s - n / 6.0) / (n / 6.0);
  EXPECT_LT(chi2, 25.7);  // 5 degrees of freedom, probability 1e-4
}

TEST(RngTest, BetweenHasNoBiasOnWideRanges) {
  // A width of 3/4 of 2^64: plain bits % width would hit the lowest third twice as often as the others.
  constexpr std::int64_t lo = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t hi = std::int64_t{1} << 62;
  Rng rng{4};
  constexpr int n = 30'000;
  int lowest_third = 0;
  for (int i = 0; i < n; ++i) lowest_third += rng.between(lo, hi - 1) < lo / 2 ? 1 : 0;
  EXPECT_NEAR(lowest_third, n / 3.0, 5.0 * std::sqrt(n * 2.0 / 9.0));
}

TEST(RngTest, BetweenTakesTheWholeRangeAndOneValue) {
  Rng rng{5};
  Rng same{5};
  using Limits = std::numeric_limits<std::int64_t>;
  EXPECT_EQ(rng.between(Limits::min(), Limits::max()),
            static_cast<std::int64_t>(same.u64() + (std::uint64_t{1} << 63U)));
  EXPECT_EQ(rng.between(17, 17), 17);
}

TEST(NormalQuantileTest, AgreesWithFortyDigitArithmetic) {
  struct Case {
    double p, x;
  };
  for (const auto& [p, x] : {Case{1e-300, -37.047096299361199237}, Case{1e-12, -7.0344838253011319326},
                             Case{0.01, -2.3263478740408410931}, Case{0.3, -0.52440051270804081597}, Case{0.5, 0.0},
                             Case{0.9, 1.2815515655446005935}, Case{0.999, 3.0902323061678132778}}) {
    EXPECT_NEAR(normal_quantile(p), x, 1e-15 * std::abs(x)) << p;
  }
}

TEST(NormalQuantileTest, InvertsTheDistributionAcrossTheSeamsOfItsThreeParts) {
  const auto distribution = [](double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); };
  double last = -std::numeric_limits<double>::infinity();
  for (int i = 1; i < 4000; ++i) {
    const double p = i / 4000.0;
    const double x = normal_quantile(p);
    EXPECT_GT(x, last);
    last = x;
    EXPECT_NEAR(distribution(x), p, 1e-15) << p;
  }
}

TEST(RngTest, NormalFollowsUniform) {  // common random numbers rest on this
  Rng a{9};
  Rng b{9};
  for (int i = 0; i < 100; ++i) EXPECT_EQ(a.normal(), normal_quantile(b.uniform()));
}

}  // namespace
}  // namespace cleave
