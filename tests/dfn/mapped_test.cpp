#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "cleave/dfn/sample.hpp"
#include "networks.hpp"
#include "sanitized.hpp"

// What is drawn for a trace is compared with integrals of the laws over all joints that leave it, at 4.5 standard
// errors; what a joint shows on a face with closed forms and with points along the trace. Seeds are fixed.

namespace cleave::dfn {
namespace {

using geometry::normalized;
using geometry::Polygon;
using geometry::Vec3;
using networks::Mean;
using networks::pi;

/// Draws of a mean; the bounds follow from how many there are.
constexpr std::uint64_t many = support::sanitized ? 250 : 2000;

Polygon polygon(std::vector<Vec3> corners) { return Polygon::make(std::move(corners)).value(); }
/// A square face of this half side in the plane z = height.
MappedFace floor_face(double half, double height = 0) {
  return {polygon({{-half, -half, height}, {half, -half, height}, {half, half, height}, {-half, half, height}})};
}
SampledJoint joint_of_corners(std::vector<Vec3> corners) {
  const Polygon shape = polygon(std::move(corners));
  const auto c = shape.corners();
  Vec3 normal = normalized(cross(c[1] - c[0], c[2] - c[0]));
  if (normal.z < 0) normal = -normal;
  return {shape, (c[0] + c[2]) / 2, normal, 0};
}
JointSet discs(const SizeSpec& size, double kappa = 0, double dip = 60) {
  return JointSet::make({.orientation = FisherOrientation{Dip::degrees(dip), DipDirection::degrees(90), kappa},
                         .shape = Disc{SizeLaw::make(size).value(), 64},
                         .intensity = P32{0.5}})
      .value();
}
SizeSpec even(double from, double to) {
  SizeSpec size;
  size.distribution = SizeDistribution::uniform;
  size.min = metres(from);
  size.max = metres(to);
  return size;
}
std::vector<HonouredJoint> drawn(const JointSet& set, const Mapping& mapping, std::uint64_t realization) {
  const std::array<const JointSet*, 1> sets{&set};
  return honour(sets, mapping, 5, realization).value();
}
double size_of(const SampledJoint& joint) { return std::get<JointOutline>(joint.shape).first * 2; }

// ---- what a joint shows ---------------------------------------------------------------------------------------------

TEST(MappedTest, ASquareJointShowsItsChordOnAFace) {
  Mapping mapping{.faces = {floor_face(10)}};
  // Vertical, x = 1, from y = -2 to 3 and z = -1 to 4.
  const SampledJoint joint = joint_of_corners({{1, -2, -1}, {1, 3, -1}, {1, 3, 4}, {1, -2, 4}});
  const auto traces = traces_on(joint, mapping, 0);
  ASSERT_EQ(traces.size(), 1U);
  EXPECT_NEAR(norm(traces[0].ends[1] - traces[0].ends[0]), 5, 1e-12);
  EXPECT_NEAR(std::abs(traces[0].ends[0].y - traces[0].ends[1].y), 5, 1e-12);
  EXPECT_EQ(traces[0].goes_on, (std::array{false, false}));
}

TEST(MappedTest, ATraceGoesOnWhereTheFaceEnds) {
  Mapping mapping{.faces = {floor_face(2)}};
  const SampledJoint joint = joint_of_corners({{1, -1, -1}, {1, 3, -1}, {1, 3, 4}, {1, -1, 4}});
  const auto traces = traces_on(joint, mapping, 0);
  ASSERT_EQ(traces.size(), 1U);
  const std::size_t beyond = traces[0].ends[0].y > traces[0].ends[1].y ? 0 : 1;
  EXPECT_NEAR(traces[0].ends[beyond].y, 2, 1e-12);
  EXPECT_NEAR(traces[0].ends[1 - beyond].y, -1, 1e-12);
  EXPECT_TRUE(traces[0].goes_on[beyond]);
  EXPECT_FALSE(traces[0].goes_on[1 - beyond]);
  mapping.shortest = metres(3);
  EXPECT_TRUE(traces_on(joint, mapping, 0).empty());
  mapping.shortest = metres(2.999);
  EXPECT_EQ(traces_on(joint, mapping, 0).size(), 1U);
}

TEST(MappedTest, AJointAcrossANotchShowsTwoTraces) {
  // A U of width 6: arms from y = 0 to 4, notch 2 wide from y = 1.
  Mapping mapping{.faces = {{polygon(
                      {{-3, 0, 0}, {3, 0, 0}, {3, 4, 0}, {1, 4, 0}, {1, 1, 0}, {-1, 1, 0}, {-1, 4, 0}, {-3, 4, 0}})}}};
  const SampledJoint joint = joint_of_corners({{-2, 2, -1}, {5, 2, -1}, {5, 2, 1}, {-2, 2, 1}});
  auto traces = traces_on(joint, mapping, 0);
  ASSERT_EQ(traces.size(), 2U);
  std::ranges::sort(traces, {}, [](const MappedTrace& t) { return t.ends[0].x + t.ends[1].x; });
  EXPECT_NEAR(norm(traces[0].ends[1] - traces[0].ends[0]), 1, 1e-12);
  EXPECT_NEAR(norm(traces[1].ends[1] - traces[1].ends[0]), 2, 1e-12);
  EXPECT_EQ(traces[0].goes_on[0] + traces[0].goes_on[1], 1);
  EXPECT_EQ(traces[1].goes_on[0] + traces[1].goes_on[1], 2);
}

TEST(MappedTest, APlaneWithoutEndCrossesTheWholeFace) {
  Mapping mapping{.faces = {floor_face(2, 7)}, .holes = {{{0, 0, 0}, {0, 0, 10}}}};
  const SampledJoint plane{
      InfinitePlane{{0.5, 100, 3}, normalized(Vec3{1, 0, 1})}, {0.5, 100, 3}, normalized(Vec3{1, 0, 1}), 0};
  EXPECT_TRUE(traces_on(plane, mapping, 0).empty());  // x = -3.5 at z = 7
  mapping.faces = {floor_face(2, 4)};
  const auto traces = traces_on(plane, mapping, 0);
  ASSERT_EQ(traces.size(), 1U);
  EXPECT_NEAR(traces[0].ends[0].x, -0.5, 1e-12);
  EXPECT_NEAR(std::abs(traces[0].ends[0].y - traces[0].ends[1].y), 4, 1e-12);
  EXPECT_EQ(traces[0].goes_on, (std::array{true, true}));
  EXPECT_NEAR(pick_in(plane, mapping, 0)->at.z, 3.5, 1e-12);
}

TEST(MappedTest, AHolePicksTheJointsItGoesThrough) {
  const Mapping mapping{.holes = {{{0, 0, -5}, {0, 0, 5}}, {{2.5, 0, -5}, {2.5, 0, 5}}, {{0, 0, 1}, {0, 0, 5}}}};
  const SampledJoint joint = joint_of_corners({{-2, -2, -2}, {2, -2, 2}, {2, 2, 2}, {-2, 2, -2}});
  ASSERT_TRUE(pick_in(joint, mapping, 0));
  EXPECT_NEAR(norm(pick_in(joint, mapping, 0)->at), 0, 1e-12);
  EXPECT_FALSE(pick_in(joint, mapping, 1));
  EXPECT_FALSE(pick_in(joint, mapping, 2));
}

/// A tunnel's walls, its face and a hole ahead.
Mapping tunnel() {
  return {.faces = {{polygon({{0, 3, 0}, {8, 3, 0}, {8, 3, 5}, {0, 3, 5}})},
                    {polygon({{0, 7, 0}, {8, 7, 0}, {8, 7, 5}, {0, 7, 5}})},
                    {polygon({{0, 3, 5}, {8, 3, 5}, {8, 7, 5}, {0, 7, 5}})},
                    {polygon({{8, 3, 0}, {8, 7, 0}, {8, 7, 5}, {8, 3, 5}})}},
          .holes = {{{8, 5, 2}, {12, 5, 3}}}};
}
JointSet tunnel_set() {
  SizeSpec size;
  size.distribution = SizeDistribution::exponential;
  size.mean = metres(3);
  size.max = metres(12);
  return networks::set_of(Baecher{}, Disc{SizeLaw::make(size).value()}, P32{0.6}, networks::steep());
}

TEST(MappedTest, SeenAndUnseenAreTheWholeNetwork) {
  const JointSet set = tunnel_set();
  const auto joints = networks::draws(set, 0, 3, 0);
  Mapping seen = tunnel();
  map(joints, 0, seen);
  ASSERT_GT(seen.joints.size(), 20U);
  const auto rest = unseen(joints, tunnel());
  EXPECT_EQ(rest.size() + seen.joints.size(), joints.size());
  Mapping nothing = tunnel();
  map(rest, 0, nothing);
  EXPECT_TRUE(nothing.joints.empty());
  // Points along each trace lie within the joint's plane and the face.
  for (const MappedJoint& joint : seen.joints) {
    EXPECT_TRUE(joint.set == 0U);
    EXPECT_FALSE(joint.traces.empty() && joint.picks.empty());
  }
  // Joints too short to be mapped are not seen.
  Mapping coarse = tunnel();
  coarse.shortest = metres(1);
  EXPECT_GT(unseen(joints, coarse).size(), rest.size());
}

// ---- joints that honour ---------------------------------------------------------------------------------------------

TEST(MappedTest, EveryJointDrawnShowsWhatWasSeenAndNoMore) {
  const JointSet set = tunnel_set();
  std::size_t seen = 0, honoured = 0;
  for (std::uint64_t truth = 0; truth < 10; ++truth) {
    Mapping mapping = tunnel();
    map(networks::draws(set, 0, 3, truth), 0, mapping);
    const auto joints = drawn(set, mapping, truth);
    ASSERT_EQ(joints.size(), mapping.joints.size());
    for (std::size_t i = 0; i < joints.size(); ++i) {
      ++seen;
      EXPECT_EQ(joints[i].mapped, i);
      EXPECT_EQ(joints[i].joint.index, 0x80000000U + i);
      if (!joints[i].honours) continue;
      ++honoured;
      // Mapped again, it gives the same traces and picks.
      Mapping again = tunnel();
      map(std::span{&joints[i].joint, 1}, 0, again);
      ASSERT_EQ(again.joints.size(), 1U);
      std::size_t longer = 0;
      for (const MappedTrace& trace : again.joints[0].traces) {
        const double length = norm(trace.ends[1] - trace.ends[0]);
        longer += length > 0.1 ? 1 : 0;
        double nearest = length;
        for (const MappedTrace& was : mapping.joints[i].traces) {
          if (was.face != trace.face) continue;
          const double same = std::max(norm(was.ends[0] - trace.ends[0]), norm(was.ends[1] - trace.ends[1]));
          const double turned = std::max(norm(was.ends[1] - trace.ends[0]), norm(was.ends[0] - trace.ends[1]));
          nearest = std::min({nearest, same, turned});
        }
        EXPECT_LE(nearest, 0.1 + 1e-9);
      }
      std::size_t were = 0;
      for (const MappedTrace& was : mapping.joints[i].traces) were += norm(was.ends[1] - was.ends[0]) > 0.2 ? 1U : 0U;
      EXPECT_GE(longer, were);
      ASSERT_EQ(again.joints[0].picks.size(), mapping.joints[i].picks.size());
      if (!again.joints[0].picks.empty()) {
        EXPECT_LE(norm(again.joints[0].picks[0].at - mapping.joints[i].picks[0].at), 0.1 + 1e-9);
      }
    }
  }
  EXPECT_GT(seen, 200U);
  EXPECT_GE(static_cast<double>(honoured), 0.97 * static_cast<double>(seen));
}

/// The mean diameter of discs that leave this trace, by its weight as a function of the diameter.
double mean_diameter(double from, double to, const std::function<double(double)>& weight) {
  double sum = 0, all = 0;
  constexpr int steps = 200'000;
  for (int i = 0; i < steps; ++i) {
    const double d = from + (i + 0.5) / steps * (to - from), w = weight(d);
    sum += w * d;
    all += w;
  }
  return sum / all;
}
Mapping one_trace(double length, bool first_goes_on, bool last_goes_on) {
  Mapping mapping{.faces = {floor_face(20)}, .error = metres(0.02)};
  mapping.joints.push_back(
      {.set = 0U, .traces = {{0, {Vec3{-length / 2, 0, 0}, Vec3{length / 2, 0, 0}}, {first_goes_on, last_goes_on}}}});
  return mapping;
}
Mean drawn_diameters(const JointSet& set, const Mapping& mapping) {
  Mean mean;
  for (std::uint64_t k = 0; k < many; ++k) mean.add(size_of(drawn(set, mapping, k).front().joint));
  return mean;
}

TEST(MappedTest, SizesFollowTheLawGivenATraceWithBothEnds) {
  // Offset s from the centre even, length 2 sqrt(R^2 - s^2): density of the length L/(4 s).
  const Mean mean = drawn_diameters(discs(even(2, 8)), one_trace(4, false, false));
  EXPECT_MEAN(mean, mean_diameter(4, 8, [](double d) { return 1 / std::sqrt(d * d - 16); }));
}

TEST(MappedTest, SizesFollowTheLawGivenATraceWithOneEnd) {
  // The trace at the border of the face, so that it may go on.
  Mapping mapping = one_trace(4, false, true);
  mapping.faces = {{polygon({{-20, -20, 0}, {2, -20, 0}, {2, 20, 0}, {-20, 20, 0}})}};
  const Mean mean = drawn_diameters(discs(even(2, 8)), mapping);
  EXPECT_MEAN(mean, mean_diameter(4, 8, [](double d) { return std::sqrt(d * d - 16); }));
}

TEST(MappedTest, SizesFollowTheLawGivenATraceWithoutEnds) {
  Mapping mapping = one_trace(4, true, true);
  mapping.faces = {{polygon({{-2, -20, 0}, {2, -20, 0}, {2, 20, 0}, {-2, 20, 0}})}};
  const Mean mean = drawn_diameters(discs(even(2, 8)), mapping);
  EXPECT_MEAN(mean, mean_diameter(4, 8, [](double d) {
                // Integral of 2 sqrt(R^2 - s^2) - L over the offsets with longer chords.
                const double r = d / 2, s = std::sqrt(r * r - 4);
                return 2 * (s * 2 + r * r * std::asin(s / r)) - 8 * s;
              }));
}

TEST(MappedTest, SizesFollowTheLawGivenAPick) {
  Mapping mapping{.holes = {{{0, 0, -1}, {0, 0, 1}}}};
  mapping.joints.push_back({.set = 0U, .picks = {{0, {0, 0, 0.25}}}});
  const JointSet set = discs(even(2, 8));
  const Mean mean = drawn_diameters(set, mapping);
  EXPECT_MEAN(mean, mean_diameter(2, 8, [](double d) { return d * d; }));
  // The hole shows joints by the cosine of the angle between it and their normals: E cos = 2/3 for all directions.
  Mean cosine;
  for (std::uint64_t k = 0; k < many; ++k) cosine.add(std::abs(drawn(set, mapping, k).front().joint.normal.z));
  EXPECT_MEAN(cosine, 2.0 / 3);
  // Even over the disc: mean square of the distance from its centre half that of its rim.
  Mean distance;
  for (std::uint64_t k = 0; k < many; ++k) {
    const SampledJoint joint = drawn(set, mapping, k).front().joint;
    const Vec3 off = joint.centre - Vec3{0, 0, 0.25};
    EXPECT_NEAR(dot(off, joint.normal), 0, 1e-9);
    const double radius = size_of(joint) / 2;
    distance.add(dot(off, off) / (radius * radius));
  }
  EXPECT_MEAN(distance, 0.5);
}

TEST(MappedTest, OrientationsFollowTheLawGivenATrace) {
  // All directions alike: the angle p between face and joint has density sin^2 p, so that E cos^2 = 1/4 (1/3 where the
  // face did not show steep joints more often, 1/2 on the circle across the trace).
  const JointSet set = discs(even(4.5, 8));
  const Mapping mapping = one_trace(4, false, false);
  Mean square;
  for (std::uint64_t k = 0; k < many; ++k) {
    const Vec3 normal = drawn(set, mapping, k).front().joint.normal;
    EXPECT_NEAR(normal.x, 0, 1e-12);  // it holds the trace
    square.add(normal.z * normal.z);
  }
  EXPECT_MEAN(square, 0.25);
}

TEST(MappedTest, TheJointLiesWhereTheTraceIs) {
  const Mapping mapping = one_trace(4, false, false);
  Mean left;
  for (std::uint64_t k = 0; k < many; ++k) {
    const SampledJoint joint = drawn(discs(even(2, 8)), mapping, k).front().joint;
    EXPECT_NEAR(dot(joint.centre, joint.normal), 0, 1e-9);
    EXPECT_NEAR(joint.centre.x, 0, 0.011);
    left.add(joint.centre.z > 0 ? 1 : 0);
  }
  EXPECT_MEAN(left, 0.5);  // above and below alike
}

TEST(MappedTest, AMeasuredDirectionIsKept) {
  const Vec3 normal = normalized(Vec3{1, 2, 3});
  Mapping mapping{.holes = {{{0, 0, -1}, {0, 0, 1}}}};
  mapping.joints.push_back({.set = 0U, .picks = {{0, {0, 0, 0.25}, normal}}});
  EXPECT_NEAR(norm(drawn(discs(even(2, 8), 50), mapping, 1).front().joint.normal - normal), 0, 1e-12);
}

TEST(MappedTest, ADirectionMeasuredOnATraceIsTurnedToHoldIt) {
  Mapping mapping = one_trace(4, false, false);
  mapping.joints.front().traces.front().normal = normalized(Vec3{0.05, 1, 1});
  const Vec3 normal = drawn(discs(even(2, 8)), mapping, 1).front().joint.normal;
  EXPECT_NEAR(norm(normal - normalized(Vec3{0, 1, 1})), 0, 1e-12);
  // Measured in a hole, it counts for the trace as well.
  mapping.joints.front().traces.front().normal.reset();
  mapping.holes.push_back({{0, 1, -3}, {0, 1, 3}});
  mapping.joints.front().picks.push_back({0, {0, 1, -0.5}, normalized(Vec3{0, 1, 2})});
  mapping.turn = Rotation::degrees(1);  // so that the points do not decide
  mapping.error = metres(0.3);
  EXPECT_NEAR(norm(drawn(discs(even(6, 8)), mapping, 1).front().joint.normal - normalized(Vec3{0, 1, 2})), 0, 1e-12);
}

TEST(MappedTest, APlaneSeenOnTwoFacesIsFitted) {
  // x = 1 on floor and on a wall y = 5.
  Mapping mapping{.faces = {floor_face(5), {polygon({{-5, 5, 0}, {5, 5, 0}, {5, 5, 5}, {-5, 5, 5}})}}};
  mapping.joints.push_back({.set = 0U,
                            .traces = {{0, {Vec3{1, 2, 0}, Vec3{1, 5, 0}}, {false, true}},
                                       {1, {Vec3{1, 5, 0}, Vec3{1, 5, 2}}, {true, false}}}});
  const JointSet set = discs(even(2, 12), 5, 70);
  std::size_t honoured = 0;
  for (std::uint64_t k = 0; k < 20; ++k) {
    const HonouredJoint joint = drawn(set, mapping, k).front();
    honoured += joint.honours ? 1 : 0;
    EXPECT_NEAR(std::abs(joint.joint.normal.x), 1, 1e-9);
  }
  EXPECT_EQ(honoured, 20U);
}

TEST(MappedTest, AnUnknownSetIsDrawnByHowManyOfItsJointsWouldShow) {
  const SizeSpec size = even(2, 8);
  const auto with = [&](double p32, double dip) {
    return JointSet::make({.orientation = FisherOrientation{Dip::degrees(dip), DipDirection::degrees(0), 30},
                           .shape = Disc{SizeLaw::make(size).value(), 16},
                           .intensity = P32{p32}})
        .value();
  };
  Mapping mapping = one_trace(4, false, false);
  mapping.joints.front().set.reset();
  // Strike along the trace, dips that the face shows alike; the second has three times as many joints.
  const JointSet first = with(0.2, 60), second = with(0.6, 60), flat = with(0.6, 20);
  const auto share = [&](const JointSet& other) {
    Mean mean;
    const std::array<const JointSet*, 3> sets{&first, nullptr, &other};
    for (std::uint64_t k = 0; k < 3000; ++k) {
      const std::size_t set = honour(sets, mapping, 5, k)->front().set;
      EXPECT_TRUE(set == 0 || set == 2);
      mean.add(set == 2 ? 1 : 0);
    }
    return mean;
  };
  const Mean same = share(second);
  EXPECT_MEAN(same, 0.75);
  // Flat joints show less, and their strikes are spread more widely.
  const Mean less = share(flat);
  EXPECT_LT(less.mean, 0.75 - 4.5 * less.error());
}

TEST(MappedTest, WhatTheLawDoesNotShowIsThereAllTheSame) {
  // A trace longer than any joint, and one across the strike of a set without spread.
  const JointSet small = discs(even(1, 2));
  const auto longer = drawn(small, one_trace(4, false, false), 0).front();
  EXPECT_FALSE(longer.honours);
  EXPECT_NEAR(longer.misfit.si(), 1, 0.51);
  EXPECT_NEAR(dot(longer.joint.centre, longer.joint.normal), 0, 1e-9);
  const JointSet fixed = discs(even(5, 6), 1e9, 60);  // strikes along y
  const auto turned = drawn(fixed, one_trace(4, false, false), 0).front();
  EXPECT_FALSE(turned.honours);
  EXPECT_NEAR(turned.joint.normal.x, 0, 1e-9);
}

TEST(MappedTest, JointsThatAreNoPolygonsThereAreRefused) {
  // Joints of a micrometre, 1e10 m away.
  const JointSet small = discs(even(1e-7, 1e-6));
  Mapping mapping{.holes = {{{1e10, 0, -1}, {1e10, 0, 1}}}};
  mapping.joints.push_back({.set = 0U, .picks = {{0, {1e10, 0, 0}}}});
  const std::array<const JointSet*, 1> sets{&small};
  const auto refused = honour(sets, mapping, 5, 0);
  ASSERT_FALSE(refused.has_value());
  EXPECT_TRUE(std::holds_alternative<JointTooSmall>(refused.error()));
  // A set without spread whose normal is the trace's direction still gives one.
  const JointSet square = discs(even(5, 6), 1e9, 90);  // normal along x
  EXPECT_FALSE(drawn(square, one_trace(4, false, false), 0).front().honours);
}

TEST(MappedTest, AJointDependsOnNoOtherJoint) {
  const JointSet set = tunnel_set();
  Mapping mapping = tunnel();
  map(networks::draws(set, 0, 3, 4), 0, mapping);
  const auto all = drawn(set, mapping, 9);
  mapping.joints.resize(5);
  const auto few = drawn(set, mapping, 9);
  for (std::size_t i = 0; i < few.size(); ++i) EXPECT_EQ(few[i].joint.centre, all[i].joint.centre);
  EXPECT_NE(drawn(set, mapping, 10).front().joint.centre, all.front().joint.centre);
}

TEST(MappedTest, RanksOfTheTruthAreEvenAmongDraws) {
  // What a next face will show, from what the tunnel has shown: the truth ranks evenly among conditioned networks.
  const JointSet set = tunnel_set();
  const Mapping ahead{.faces = {{polygon({{9, 3, 0}, {9, 7, 0}, {9, 7, 5}, {9, 3, 5}})}}};
  const auto shown = [&](std::span<const SampledJoint> joints) {
    Mapping seen = ahead;
    map(joints, 0, seen);
    double sum = 0;
    for (const MappedJoint& joint : seen.joints) {
      for (const MappedTrace& t : joint.traces) sum += norm(t.ends[1] - t.ends[0]);
    }
    return sum;
  };
  constexpr std::uint64_t truths = 80, draws = 9;
  std::array<double, draws + 1> ranks{};
  double spread_given = 0, spread = 0;
  for (std::uint64_t truth = 0; truth < truths; ++truth) {
    const auto joints = networks::draws(set, 0, 11, truth);
    Mapping mapping = tunnel();
    map(joints, 0, mapping);
    const double exact = shown(joints);
    std::size_t rank = 0;
    for (std::uint64_t k = 0; k < draws; ++k) {
      auto other = networks::draws(set, 0, 12, truth * draws + k);
      spread += std::pow(shown(other) - exact, 2);
      other = unseen(std::move(other), mapping);
      for (HonouredJoint& joint : drawn(set, mapping, truth * draws + k)) other.push_back(std::move(joint.joint));
      const double value = shown(other);
      spread_given += std::pow(value - exact, 2);
      rank += value < exact ? 1 : 0;
    }
    ++ranks.at(rank);
  }
  double chi_square = 0;
  for (const double count : ranks) chi_square += std::pow(count - 8, 2) / 8;
  EXPECT_LT(chi_square, 27.9);            // 9 degrees of freedom, 0.1 %
  EXPECT_LT(spread_given, 0.5 * spread);  // and it is worth knowing
}

// ---- joining, refusing ----------------------------------------------------------------------------------------------

TEST(MappedTest, TracesThatMeetAtACornerAreOfOneJoint) {
  Mapping mapping{.faces = {floor_face(5), {polygon({{-5, 5, 0}, {5, 5, 0}, {5, 5, 5}, {-5, 5, 5}})}}};
  const auto add = [&](std::optional<std::size_t> set, MappedTrace trace) {
    mapping.joints.push_back({.set = set, .traces = {trace}});
  };
  add(0U, {0, {Vec3{1, 2, 0}, Vec3{1, 5, 0}}, {false, true}});
  add(1U, {1, {Vec3{1, 5, 0}, Vec3{1, 5, 2}}, {true, false}});     // another set
  add({}, {1, {Vec3{1.05, 5, 0}, Vec3{1, 5, 3}}, {true, false}});  // not known: of the first
  add(0U, {1, {Vec3{1.2, 5, 0}, Vec3{1, 5, 4}}, {true, false}});   // too far
  add(0U, {1, {Vec3{1.01, 5, 0}, Vec3{1, 5, 4}}, {false, true}});  // ends there
  EXPECT_EQ(join_round_corners(mapping), (std::vector<std::size_t>{0, 1, 0, 2, 3}));
  ASSERT_EQ(mapping.joints.size(), 4U);
  EXPECT_EQ(mapping.joints[0].traces.size(), 2U);
  EXPECT_TRUE(mapping.joints[0].set == 0U);
}

TEST(MappedTest, SetsThatCannotHonourAreRefusedWithTheReason) {
  const auto reason = [](const JointSet& set) {
    const auto why = cannot_honour(set);
    return why ? why->key : "";
  };
  const SizeLaw size = networks::side(2);
  EXPECT_EQ(reason(tunnel_set()), "");
  EXPECT_EQ(reason(networks::set_of(Baecher{}, Square{size}, Count{20})), "intensity");
  EXPECT_EQ(reason(networks::set_of(Baecher{}, Persistent{}, P10{1})), "shape");
  EXPECT_EQ(reason(networks::set_of(EnhancedBaecher{{0}, 1}, Square{size}, P32{1})), "model");
  EXPECT_NEAR(longest_trace(networks::set_of(Baecher{}, Square{size}, P32{1})).si(), 2 * std::numbers::sqrt2, 1e-12);
}

}  // namespace
}  // namespace cleave::dfn
