#include "cleave/assembly/groups.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "cases.hpp"

namespace cleave::assembly {
namespace {

using namespace test;

void expect_factors(const Builder& b, double up, double moving, double tolerance = 1e-6) {
  const Assembly assembly = b.made();
  const StaticFactor s = static_factor(assembly);
  const MovingFactor m = moving_factor(assembly, s.factor);
  const auto near = [&](double got, double want, const char* what) {
    if (want == infinite || want == 0) {
      EXPECT_EQ(got, want) << what;
    } else {
      EXPECT_NEAR(got, want, tolerance * want) << what;
    }
  };
  near(s.factor, up, "static");
  near(m.factor, moving, "moving");
}

const double m30 = tan_deg(30), m35 = tan_deg(35);

TEST(SingleBlocks, PlaneS1) { expect_factors(single({{plane(35, 90), m30}}), m30 / m35, m30 / m35); }
TEST(SingleBlocks, WedgeS2) {
  expect_factors(single({{plane(40, 130), m30}, {plane(60, 220), m30}}), 0.958055, m30 / tan_deg(33.357221));
}
TEST(SingleBlocks, HoekBrayS3) {
  const Builder b = single({{plane(45, 105), tan_deg(20), 500 * 5565.008}, {plane(70, 235), m30, 1000 * 6428.125}},
                           {0, 0, -28272195});
  expect_factors(b, 1.824059, 1.735577);
}
TEST(SingleBlocks, RoofWedgeS4) {
  const double c = cos_deg(20), s = sin_deg(20);
  expect_factors(single({{{c, 0, -s}, m30}, {{-c, 0, -s}, m30}}), m30 / tan_deg(20), 0);
}
TEST(SingleBlocks, SlotS5) {
  expect_factors(single({{{1, 0, 0}, tan_deg(10)}, {{-1, 0, 0}, tan_deg(10)}}), infinite, 0);
}
TEST(SingleBlocks, RoofPyramidS6) {
  expect_factors(single({{-plane(60, 0), m35}, {-plane(60, 120), m35}, {-plane(60, 240), m35}}), m35 / m30, 0);
}
TEST(SingleBlocks, FloorPyramidS7) {
  expect_factors(single({{plane(60, 0), 0}, {plane(60, 120), 0}, {plane(60, 240), 0}}), infinite, infinite);
}
TEST(SingleBlocks, UnequalPlanesS8) {
  expect_factors(single({{plane(50, 0), tan_deg(51)}, {plane(50, 90), tan_deg(5)}}), 1.050977, 60.149144 / 64.440048);
}
TEST(SingleBlocks, CubeInWallS9) {
  const Builder b =
      single({{{0, 0, 1}, m35}, {{0, 0, -1}, m35}, {{0, 1, 0}, m35}, {{0, -1, 0}, m35}, {{1, 0, 0}, m35}}, {.3, 0, -1});
  expect_factors(b, infinite, m35 / .3);
}

TEST(Pairs, SlabBehindToeP1) { expect_factors(toe(false), 0.942790, 0.942790); }
TEST(Pairs, SlabBehindToeBetweenRoughSidesP1) { expect_factors(toe(true), infinite, 0.942790); }
TEST(Pairs, SlabBehindToeInSectionP2) { expect_factors(toe_section(), 0.917061, 0.894759); }
TEST(Pairs, ActivePassiveP3) { expect_factors(active_passive(), 0.933277, 0.933277); }
TEST(Pairs, InterlockedP4) { expect_factors(interlocked(), tan_deg(5) / tan_deg(10), 0, 5e-6); }
TEST(Pairs, DrawerP5) {
  expect_factors(drawer(true), 2.208553, 2.208553);
  expect_factors(drawer(false), 0.736184, 0.736184);
}
TEST(Pairs, LeaningP6) {
  expect_factors(leaning(2), 2.156068, 2.156068);
  expect_factors(leaning(1), infinite, infinite);
}

// Digits of corners in the sources: six.
TEST(Ploughing, E1) { expect_factors(ploughing(e1), 1.2148040661, 1.2148040661, 1e-8); }
TEST(Ploughing, E2) { expect_factors(ploughing(e2), 2.032358063, 2.032358063); }
TEST(Ploughing, E3) { expect_factors(ploughing(e3), 0.9988044584, 0.9988044584, 1e-8); }
TEST(Ploughing, E4) {
  expect_factors(ploughing(e4), 1.268596703, 1.224683404, 4e-6);
  EXPECT_NEAR(static_factor(ploughing(e4, Freedom::section_translation).made()).factor, 1.440276577, 4e-6);
}

}  // namespace
}  // namespace cleave::assembly
