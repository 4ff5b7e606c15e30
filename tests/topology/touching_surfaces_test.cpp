#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "cleave/geometry/terrain.hpp"
#include "cleave/geometry/tunnel.hpp"
#include "closed_scenes.hpp"

// Joints drawn to end on the surface of an excavation, or on one another, a rounding short of it or beyond.

namespace cleave::testing {
namespace {

std::vector<double> volumes(const topology::AuditedComplex& audited) {
  std::vector<double> found;
  for (const topology::Block& block : audited.complex().blocks()) found.push_back(block.volume.si());
  std::ranges::sort(found);
  return found;
}

/// A slope's profile somewhere, in any direction, with what slides out on a joint that ends on its toe.
struct Slope {
  topology::CutInput input;
  double slides;  ///< m3
};
Slope slope(const support::Uniform& u, bool along_axes) {
  const double azimuth = along_axes ? 90 * std::floor(4 * u()) : 360 * u();
  const std::array<double, 2> origin = along_axes ? std::array{0.0, 0.0} : std::array{100 * u() - 50, 100 * u() - 50};
  const double height = 3 + 9 * u(), run = height / std::tan((40 + 35 * u()) * degree);
  const double rise = height * (0.2 + 0.4 * u()) / (run + 4), back = 2 + 4 * u(), half = 3 + 5 * u();
  const Vec3 along{std::sin(azimuth * degree), std::cos(azimuth * degree), 0}, strike{along.y, -along.x, 0};
  const auto p = [&](double s, double t, double z) {
    return Vec3{origin[0], origin[1], 0} + s * along + t * strike + Vec3{0, 0, z};
  };
  const double end = -back - 0.5, base = -height + rise * (run + back), base_end = -height + rise * (run - end);
  const Vec3 lo{origin[0] - 60, origin[1] - 60, -40}, hi{origin[0] + 60, origin[1] + 60, 0};
  const geometry::ProfileCut cut{origin, DipDirection::degrees(azimuth), {{0, 0}, {run, -height}}};
  Slope made{scene(box(lo, hi), {}, {geometry::make_profile_cut(cut, {lo, hi}).value()}), 0};
  add(made.input,
      {{p(run, -half - 1, -height), p(run, half + 1, -height), p(end, half + 1, base_end), p(end, -half - 1, base_end)},
       {p(-back, -half - 1, base - 1), p(-back, half + 1, base - 1), p(-back, half + 1, 1), p(-back, -half - 1, 1)},
       {p(end, -half, 1), p(run + 1, -half, 1), p(run + 1, -half, -height - 1), p(end, -half, -height - 1)},
       {p(end, half, 1), p(run + 1, half, 1), p(run + 1, half, -height - 1), p(end, half, -height - 1)}});
  // Above the joint, less what the slope takes.
  const double above = 0.5 * (height + -base) * (run + back), taken = 0.5 * run * height;
  made.slides = 2 * half * (above - taken);
  return made;
}

TEST(TouchingSurfaces, AJointThatEndsOnTheToe) {
  const auto u = uniform(41);
  for (int k = 0; k < 120; ++k) {
    const Slope made = slope(u, k % 4 == 0);
    const auto audited = certified(made.input);
    const auto found = volumes(audited);
    ASSERT_EQ(found.size(), 2U) << k;
    EXPECT_NEAR(found[0], made.slides, 1e-8 * made.slides) << k << ": corners of openings are rounded to 1 nm";
    EXPECT_EQ(audited.complex().report().near_misses.sides, 0U) << k;
    EXPECT_TRUE(audited.complex().report().dangling.empty()) << k;
  }
}

/// The faces of a box, turned.
geometry::Solid turned_box(const Placement& at, Vec3 lo, Vec3 hi) {
  std::vector<Vec3> corners;
  for (unsigned k = 0; k < 8; ++k) {
    corners.push_back(at({(k & 1U) != 0 ? hi.x : lo.x, (k & 2U) != 0 ? hi.y : lo.y, (k & 4U) != 0 ? hi.z : lo.z}));
  }
  const std::vector<std::vector<std::uint32_t>> faces{{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                                      {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  std::vector<geometry::SolidFace> sides;
  for (const auto& face : faces) sides.push_back({face, 0});
  return geometry::Solid::make(std::move(corners), std::move(sides)).value();
}

TEST(TouchingSurfaces, JointsThatEndOnTheWallsOfAnOpening) {
  // A prism over a turned opening: two joints that end on its roof, inside it and on its edge, and one across each end.
  const auto u = uniform(42);
  for (int k = 0; k < 60; ++k) {
    const Placement at{{6 * u(), 6 * u(), 6 * u()}, 1, {30 * u(), 30 * u(), 30 * u()}};
    const double from = k % 2 == 0 ? -1 : -0.3, top = 0.4 + u();
    auto input = scene(box(at.shift - Vec3{20, 20, 20}, at.shift + Vec3{20, 20, 20}), {},
                       {turned_box(at, {-1, -5, -2}, {1, 5, 0})});
    const auto p = [&](double x, double y, double z) { return at({x, y, z}); };
    const auto joint_from = [&](double x) {  // through the ridge and on
      const double to = x + 1.4 * (0.5 - x);
      return Corners{p(x, -3, 0), p(x, 3, 0), p(to, 3, 1.4 * top), p(to, -3, 1.4 * top)};
    };
    add(input, {joint_from(from),
                joint_from(0.9),
                {p(-3, -2, -1), p(3, -2, -1), p(3, -2, 3), p(-3, -2, 3)},
                {p(-3, 2, -1), p(3, 2, -1), p(3, 2, 3), p(-3, 2, 3)}});
    const auto audited = certified(input);
    const auto found = volumes(audited);
    ASSERT_EQ(found.size(), 2U) << k;
    const double prism = 4 * 0.5 * (0.9 - from) * top;
    EXPECT_NEAR(found[0], prism, 1e-8 * prism) << k;
    EXPECT_EQ(audited.complex().report().near_misses.sides, 0U) << k;
  }
}

TEST(TouchingSurfaces, JointsInThePlanesOfTheWalls) {
  // A block over the whole roof of a tunnel: its sides go on where the walls end.
  const auto u = uniform(45);
  for (int k = 0; k < 40; ++k) {
    const double width = 4 + 6 * u(), height = 3 + 3 * u(), azimuth = k % 2 == 0 ? 0 : 360 * u() * degree;
    const Vec3 along{std::sin(azimuth), std::cos(azimuth), 0}, right{along.y, -along.x, 0};
    const Vec3 middle{k % 2 == 0 ? 0 : 50 * u(), k % 2 == 0 ? 0 : -50 * u(), 0};
    auto input = scene(box(middle - Vec3{30, 30, 30}, middle + Vec3{30, 30, 30}), {},
                       {geometry::make_tunnel(geometry::RectangleSection{metres(width), metres(height)},
                                              {middle - 20 * along, middle + 20 * along})
                            .value()});
    const auto p = [&](double x, double y, double z) { return middle + x * right + y * along + Vec3{0, 0, z}; };
    const double w = width / 2, roof = height / 2, top = roof + 2;
    add(input, {{p(-w, -5, roof), p(-w, 5, roof), p(-w, 5, top + 1), p(-w, -5, top + 1)},
                {p(w, -5, roof), p(w, 5, roof), p(w, 5, top + 1), p(w, -5, top + 1)},
                {p(-w - 1, -5, top), p(w + 1, -5, top), p(w + 1, 5, top), p(-w - 1, 5, top)},
                {p(-w - 1, -4, roof - 1), p(w + 1, -4, roof - 1), p(w + 1, -4, top + 1), p(-w - 1, -4, top + 1)},
                {p(-w - 1, 4, roof - 1), p(w + 1, 4, roof - 1), p(w + 1, 4, top + 1), p(-w - 1, 4, top + 1)}});
    const auto found = volumes(certified(input));
    ASSERT_EQ(found.size(), 2U) << k;
    EXPECT_NEAR(found[0], 16 * width, 1e-7 * width) << k;
  }
}

TEST(TouchingSurfaces, ADomainThatIsNotConvex) {
  // A cube that sits in the corner of an L, on its two inner walls: joints end on the edge between them.
  const auto u = uniform(43);
  for (int k = 0; k < 60; ++k) {
    const Placement at{{6 * u(), 6 * u(), 6 * u()}, 1, {30 * u(), 30 * u(), 30 * u()}};
    std::vector<Vec3> corners;
    const std::vector<std::array<double, 2>> outline{{-5, -5}, {5, -5}, {5, 0}, {0, 0}, {0, 5}, {-5, 5}};
    for (const double z : {-5.0, 5.0}) {
      for (const auto& [x, y] : outline) corners.push_back(at({x, y, z}));
    }
    std::vector<geometry::SolidFace> faces{{{5, 4, 3, 2, 1, 0}, 0}, {{6, 7, 8, 9, 10, 11}, 0}};
    for (std::uint32_t i = 0; i < 6; ++i) faces.push_back({{i, (i + 1) % 6, (i + 1) % 6 + 6, i + 6}, 0});
    auto input = scene(geometry::Solid::make(std::move(corners), std::move(faces)).value());
    const auto p = [&](double x, double y, double z) { return at({x, y, z}); };
    // From the inner edge straight on to the outer side.
    const double slant = 2 * u() - 1;
    add(input, {{p(0, 0, -6), p(0, 0, 6), p(-7, -7 + 3 * slant, 6), p(-7, -7 + 3 * slant, -6)}});
    EXPECT_EQ(count_blocks(input), 2U) << k;
  }
}

TEST(TouchingSurfaces, JointsThatGoRoundATunnel) {
  // Two joints in one plane, each round a part of the section: together they part the rock, with `snap` and without.
  const auto u = uniform(46);
  for (int k = 0; k < 90; ++k) {
    const int count = 5 + k % 4, part = 1 + k % (count - 1);
    std::vector<std::array<double, 2>> outline;
    std::array<double, 2> lo{9, 9}, hi{-9, -9};
    for (int i = 0; i < count; ++i) {
      const double angle = 2 * std::numbers::pi * (i + 0.6 * u()) / count, r = 3 + u();
      outline.push_back({r * std::cos(angle), r * std::sin(angle)});
      for (std::size_t v = 0; v < 2; ++v) {
        lo[v] = std::min(lo[v], outline.back()[v]);
        hi[v] = std::max(hi[v], outline.back()[v]);
      }
    }
    const double azimuth = k % 3 == 0 ? 0 : 360 * u() * degree;
    const Vec3 along{std::sin(azimuth), std::cos(azimuth), 0}, right{along.y, -along.x, 0};
    const Vec3 middle{2 * u(), 2 * u(), 2 * u()};
    const auto p = [&](const std::array<double, 2>& at, double beyond) {
      return middle + beyond * (at[0] * right + Vec3{0, 0, at[1]}) -
             0.5 * ((lo[0] + hi[0]) * right + Vec3{0, 0, lo[1] + hi[1]});
    };
    const auto round = [&](int first, int last) {
      Corners corners;
      for (int i = first; i <= last; ++i) corners.push_back(p(outline[static_cast<std::size_t>(i % count)], 1));
      for (int i = last; i >= first; --i) corners.push_back(p(outline[static_cast<std::size_t>(i % count)], 40));
      return corners;
    };
    auto input = scene(
        box({-20, -20, -20}, {20, 20, 20}), {},
        {geometry::make_tunnel(geometry::PolygonSection{outline}, {middle - 40 * along, middle + 40 * along}).value()});
    add(input, {round(0, part), round(part, count)});
    input.snap = metres(std::array{0.0, 1e-9, 1e-6}[static_cast<std::size_t>(k / 3 % 3)]);
    const auto audited = certified(input);
    EXPECT_EQ(audited.complex().blocks().size(), 2U) << k;
    EXPECT_GT(audited.complex().report().excavated.front().inside, cubic_metres(500)) << k;
  }
}

TEST(TouchingSurfaces, ANotchThatEndsOnAnotherJoint) {
  // Its bottom adopts the joint's plane with the side on which the polygon goes on, not the one its arms reach far
  // into.
  for (const double off : {0.0, 3e-7, -3e-7}) {
    auto input = scene(box({-5, -5, -5}, {5, 5, 5}));
    input.joints.emplace_back(topology::PersistentJoint{{0, 0, 0}, {1, 0, 0}});
    add(input,
        {{{-20, -20, 0}, {30, -20, 0}, {30, -2, 0}, {off, -2, 0}, {off, 2, 0}, {30, 2, 0}, {30, 20, 0}, {-20, 20, 0}}});
    input.snap = metres(1e-6);
    const auto audited = certified(input);
    // Where a cut through the polygon goes on in the line of the bottom, the gap stays and is noted.
    const bool noted = off < 0 && audited.complex().report().near_misses.sides > 0;
    EXPECT_EQ(audited.complex().blocks().size(), noted ? 2U : 3U) << off;
  }
}

TEST(TouchingSurfaces, JointsThatEndOnOneAnother) {
  // On a polygon, on two polygons that meet, on a plane without an end; and with a gap of more than roundings.
  const auto u = uniform(44);
  for (int k = 0; k < 200; ++k) {
    const Placement at{{6 * u(), 6 * u(), 6 * u()}, 1, {30 * u(), 30 * u(), 30 * u()}};
    auto input = scene(box(at.shift - Vec3{5, 5, 5}, at.shift + Vec3{5, 5, 5}));
    const auto p = [&](double x, double y, double z) { return at({x, y, z}); };
    const double slant = 6 * u() - 3, gap = k % 8 == 7 ? 1e-9 : 0;
    const Corners ends{p(-20, 0.2, 0.1 + gap), p(20, 0.2, 0.1 + gap), p(20, 0.2 + 2 * slant, 20),
                       p(-20, 0.2 + 2 * slant, 20)};
    const Corners floor{p(-20, -20, 0.1), p(20, -20, 0.1), p(20, 20, 0.1), p(-20, 20, 0.1)};
    if (k % 3 == 0) {
      input.joints.emplace_back(topology::PersistentJoint{p(3, 4, 0.1), geometry::normalized(p(0, 0, 1) - p(0, 0, 0))});
    } else {
      add(input, {floor});
    }
    add(input, {ends});
    if (k % 3 == 1) {  // one that ends on the line in which they meet, from below
      add(input, {{p(-20, 0.2, 0.1), p(20, 0.2, 0.1), p(20, 0.2 + slant, -20), p(-20, 0.2 + slant, -20)}});
    }
    const auto audited = certified(input);
    const std::size_t all = k % 3 == 1 ? 4 : 3;
    EXPECT_EQ(audited.complex().blocks().size(), gap > 0 ? all - 1 : all) << k;
    EXPECT_EQ(audited.complex().report().near_misses.sides > 0, gap > 0) << k;
  }
}

}  // namespace
}  // namespace cleave::testing
