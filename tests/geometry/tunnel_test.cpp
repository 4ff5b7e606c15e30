#include "cleave/geometry/tunnel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <string>

namespace cleave::geometry::tunnel_test {
namespace {

constexpr double pi = std::numbers::pi;
const std::vector<Vec3> north{{40, 0, 30}, {40, 80, 30}};

/// Area under a circular arc drawn with n chords: n equal isosceles triangles less the triangle of the chord.
double arc_area(double width, double rise, double n) {
  const double r = (width * width / 4 + rise * rise) / (2 * rise);
  const double half = rise == width / 2 ? pi / 2 : std::atan2(width / 2, r - rise);
  return n * r * r / 2 * std::sin(2 * half / n) - (r - rise) * width / 2;
}

struct Case {
  const char* name;
  Section section;
  double area;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> all{
      {"circle", CircleSection{metres(8)}, pi * 16},
      {"ellipse", EllipseSection{metres(8), metres(6)}, pi * 12},
      {"rectangle", RectangleSection{metres(5), metres(4)}, 20},
      {"d", DShapeSection{metres(10), metres(3)}, 30 + arc_area(10, 5, 16)},
      {"half disc", DShapeSection{metres(10), metres(0)}, arc_area(10, 5, 16)},
      {"horseshoe", HorseshoeSection{metres(10), metres(10)}, 50 + arc_area(10, 5, 16)},
      {"low horseshoe", HorseshoeSection{metres(10), metres(5)}, arc_area(10, 5, 16)},
      {"trapezoid", TrapezoidSection{metres(6), metres(4), metres(3)}, 15},
      // half angle 2 atan(rise / (width / 2)) = 90 for rise = 3; atan2(3, 0) with width 6: a half circle
      {"arch of a half circle", ArchSection{metres(6), metres(4), metres(3)}, 24 + arc_area(6, 3, 16)},
      {"flat arch", ArchSection{metres(6), metres(4), metres(1)}, 24 + arc_area(6, 1, 7)},
      {"polygon", PolygonSection{{{0, 0}, {4, 0}, {4, 3}, {2, 1}, {0, 3}}}, 8},
      {"clockwise polygon", PolygonSection{{{0, 3}, {2, 1}, {4, 3}, {4, 0}, {0, 0}}}, 8},
  };
  return all;
}

template <class Error>
bool refused_as(const Section& section, const std::vector<Vec3>& axis, const TunnelOptions& options = {}) {
  const auto tunnel = make_tunnel(section, axis, options);
  if (tunnel) return false;
  EXPECT_NE(describe(tunnel.error()).find("; "), std::string::npos) << describe(tunnel.error());
  return std::holds_alternative<Error>(tunnel.error());
}

TEST(TunnelTest, EverySectionHasItsAreaInEveryDirection) {
  const std::vector<std::vector<Vec3>> axes{north,
                                            {{0, 0, 0}, {30, 0, 0}},
                                            {{5, 5, 5}, {-7, 12, 3}},
                                            {{5e5, 4e6, 100}, {500020, 4000030, 95}},
                                            {{1, 2, 3}, {4, 6, 50}}};
  for (const Case& c : cases()) {
    for (const auto& axis : axes) {
      SCOPED_TRACE(c.name);
      const auto tunnel = make_tunnel(c.section, axis);
      ASSERT_TRUE(tunnel.has_value()) << describe(tunnel.error());
      const double length = norm(axis[1] - axis[0]);
      EXPECT_NEAR(tunnel->volume().si() / (c.area * length), 1, 2e-9);
    }
  }
}

TEST(TunnelTest, CurvedSectionsConvergeToTheirCurves) {
  const auto area = [](const Section& section, std::uint32_t segments) {
    return make_tunnel(section, {{0, 0, 0}, {0, 1, 0}}, {.segments = segments, .up = {}}).value().volume().si();
  };
  const Section horseshoe = HorseshoeSection{metres(10), metres(10)};
  const double exact = 50 + pi * 12.5;
  const double coarse = exact - area(horseshoe, 16);
  const double fine = exact - area(horseshoe, 64);
  EXPECT_GT(fine, 0);
  EXPECT_NEAR(coarse / fine, 16, 0.1);  // second order
}

TEST(TunnelTest, FacesCarryTheirNames) {
  const auto tunnel = make_tunnel(HorseshoeSection{metres(10), metres(10)}, north).value();
  const std::vector<std::string> names{"wall", "floor", "crown", "start", "end"};
  EXPECT_TRUE(std::ranges::equal(tunnel.tags(), names));
  std::vector<int> count(5);
  for (const SolidFace& f : tunnel.faces()) {
    ++count[f.tag];
    const auto v = tunnel.vertices();
    const auto all = [&](auto&& holds) { return std::ranges::all_of(f.corners, [&](auto c) { return holds(v[c]); }); };
    if (f.tag == 1) {
      EXPECT_TRUE(all([](Vec3 p) { return p.z == 25; }));
    }
    if (f.tag == 0) {
      EXPECT_TRUE(all([](Vec3 p) { return p.x == 35; }) || all([](Vec3 p) { return p.x == 45; }));
    }
    if (f.tag == 2) {
      EXPECT_TRUE(all([](Vec3 p) { return p.z >= 30; }));
    }
    if (f.tag == 3) {
      EXPECT_TRUE(all([](Vec3 p) { return p.y == 0; }));
    }
    if (f.tag == 4) {
      EXPECT_TRUE(all([](Vec3 p) { return p.y == 80; }));
    }
  }
  EXPECT_EQ(count, (std::vector<int>{2, 1, 16, 1, 1}));
  const auto rectangle = make_tunnel(RectangleSection{metres(2), metres(2)}, north).value();
  EXPECT_EQ(rectangle.faces()[2].tag, 2U);  // its roof is the crown
  std::set<std::uint32_t> round;
  for (const SolidFace& f : make_tunnel(CircleSection{metres(8)}, north).value().faces()) round.insert(f.tag);
  EXPECT_EQ(round, (std::set<std::uint32_t>{0, 1, 2, 3, 4}));
}

// On any lattice whose pitch divides a nanometre's power of two the sides stay parallelograms: checked in integers of
// 2^-30 m.
TEST(TunnelTest, SidesAreExactParallelogramsWhateverTheDirection) {
  for (const Case& c : cases()) {
    const auto tunnel = make_tunnel(c.section, {{500000.1, 4000000.7, 99.3}, {500020.123, 4000030.456, 95.77}}).value();
    const auto v = tunnel.vertices();
    for (const SolidFace& f : tunnel.faces()) {
      for (const std::uint32_t i : f.corners) {
        for (const double x : {v[i].x, v[i].y, v[i].z}) EXPECT_EQ(std::ldexp(x, 30), std::nearbyint(std::ldexp(x, 30)));
      }
      if (f.tag > 2) continue;
      ASSERT_EQ(f.corners.size(), 4U);
      EXPECT_EQ(v[f.corners[2]] - v[f.corners[1]], v[f.corners[3]] - v[f.corners[0]]);
    }
  }
}

TEST(TunnelTest, TheAxisRunsThroughTheCentreOfTheBoundingBox) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const auto tunnel = make_tunnel(c.section, north).value();
    Vec3 lo = tunnel.vertices()[0], hi = lo;
    for (const Vec3 p : tunnel.vertices()) {
      lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
      hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
    }
    EXPECT_NEAR((lo.x + hi.x) / 2, 40, 1e-9);
    // the flat arch has an odd number of chords, so its apex is cut off by the middle one
    EXPECT_NEAR((lo.z + hi.z) / 2, 30, std::string{c.name} == "flat arch" ? 0.02 : 1e-9);
    EXPECT_EQ(lo.y, 0);
    EXPECT_EQ(hi.y, 80);
  }
}

TEST(TunnelTest, ShaftsNeedAnUpDirection) {
  const std::vector<Vec3> down{{0, 0, 0}, {0, 0, -20}};
  EXPECT_TRUE(refused_as<UpAlongAxis>(RectangleSection{metres(2), metres(4)}, down));
  EXPECT_TRUE(refused_as<UpAlongAxis>(RectangleSection{metres(2), metres(4)}, down, {.up = Vec3{0, 0, 0}}));
  EXPECT_TRUE(refused_as<UpAlongAxis>(RectangleSection{metres(2), metres(4)}, down, {.up = Vec3{0, std::nan(""), 0}}));
  const auto shaft = make_tunnel(RectangleSection{metres(2), metres(4)}, down, {.up = Vec3{0, 1, 0.5}});
  ASSERT_TRUE(shaft.has_value());
  EXPECT_EQ(shaft->volume().si(), 160);
  double reach = 0;
  for (const Vec3 p : shaft->vertices()) reach = std::max(reach, p.y);
  EXPECT_EQ(reach, 2);  // the height lies along north
}

TEST(TunnelTest, BendsAreMitred) {
  // An L of two arms of 10 m: the mitre takes from one arm what it gives to the other, volume = area x length of the
  // axis.
  const std::vector<Vec3> bent{{0, 0, 0}, {10, 0, 0}, {10, 10, 0}};
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const auto tunnel = make_tunnel(c.section, bent);
    ASSERT_TRUE(tunnel.has_value()) << describe(tunnel.error());
    if (std::string{c.name} != "polygon" && std::string{c.name} != "clockwise polygon") {
      EXPECT_NEAR(tunnel->volume().si() / (c.area * 20), 1, 1e-9);  // sections symmetric about the axis
    }
  }
  // floors stay level round bends in plan, and a tunnel in steps of a curve keeps its volume
  std::vector<Vec3> curve;
  for (int i = 0; i <= 20; ++i) curve.push_back({50 * std::sin(i * pi / 40), 50 * std::cos(i * pi / 40), 7});
  const auto curved = make_tunnel(HorseshoeSection{metres(6), metres(6)}, curve).value();
  for (const SolidFace& f : curved.faces()) {
    if (f.tag != 1) continue;
    for (const std::uint32_t v : f.corners) EXPECT_EQ(curved.vertices()[v].z, 4);
  }
  const double chord = 2 * 50 * std::sin(pi / 80);
  EXPECT_NEAR(curved.volume().si(), (18 + arc_area(6, 3, 16)) * 20 * chord, 1e-6);
}

TEST(TunnelTest, ADeclineThatWindsKeepsItsFloorLevelAcross) {
  // One turn of a helix at 8 degrees, in 36 chords. Carried along from bend to bend the section would roll by
  // 36 times the turn at a bend, about 2 pi sin 8 degrees = 50 degrees.
  std::vector<Vec3> helix;
  for (int i = 0; i <= 36; ++i) {
    const double t = i * pi / 18;
    helix.push_back({20 * std::cos(t), 20 * std::sin(t), -20 * t * std::tan(8 * pi / 180)});
  }
  const auto ramp = make_tunnel(RectangleSection{metres(5), metres(4)}, helix);
  ASSERT_TRUE(ramp.has_value()) << describe(ramp.error());
  const double chord = norm(helix[1] - helix[0]);
  EXPECT_NEAR(ramp->volume().si() / (20 * 36 * chord), 1, 1e-3);
  std::size_t straight = 0, beside_bends = 0;
  for (const SolidFace& f : ramp->faces()) {
    if (f.tag > 2) continue;
    const bool quad = f.corners.size() == 4;  // of the true section; triangles take up the turn beside the bends
    ++(quad ? straight : beside_bends);
    const Vec3 a = ramp->vertices()[f.corners[0]], b = ramp->vertices()[f.corners[1]],
               c = ramp->vertices()[f.corners[2]];
    const Vec3 out = normalized(cross(b - a, c - a));
    const double upright =
        f.tag == 0 ? 0 : (f.tag == 1 ? -1 : 1) * std::sqrt(1 - std::pow((helix[0] - helix[1]).z / chord, 2));
    EXPECT_NEAR(out.z, upright, quad ? 1e-7 : 0.06);
  }
  EXPECT_EQ(straight, 36U * 4);
  EXPECT_EQ(beside_bends, 35U * 2 * 4 * 2);
  // a level bend turns nothing
  const auto plan = make_tunnel(RectangleSection{metres(5), metres(4)}, {{0, 0, 0}, {9, 0, 0}, {9, 9, 0}});
  ASSERT_TRUE(plan.has_value());
  EXPECT_EQ(plan->faces().size(), 10U);
}

// Quads that are twisted are parted along a diagonal: which one must not tell left from right.
TEST(TunnelTest, TheMirrorImageOfATunnelIsTheTunnelOfTheMirrorImage) {
  const std::vector<Vec3> axis{{0, 0, 0}, {2, 9, 0}, {0, 20, 2}, {-9, 30, 1}};
  std::vector<Vec3> mirrored = axis;
  for (Vec3& p : mirrored) p.x = -p.x;
  for (const Section& section : {Section{HorseshoeSection{metres(5), metres(5)}}, Section{CircleSection{metres(3)}}}) {
    const auto one = make_tunnel(section, axis), other = make_tunnel(section, mirrored);
    ASSERT_TRUE(one.has_value() && other.has_value());
    ASSERT_EQ(one->faces().size(), other->faces().size());
    std::size_t triangles = 0;
    const auto centroid = [](const Solid& solid, const SolidFace& face) {
      Vec3 sum{};
      for (const std::uint32_t v : face.corners) sum += solid.vertices()[v];
      return sum / static_cast<double>(face.corners.size());
    };
    for (const SolidFace& f : one->faces()) {
      triangles += f.corners.size() == 3 ? 1U : 0U;
      Vec3 c = centroid(*one, f);
      c.x = -c.x;
      EXPECT_TRUE(std::ranges::any_of(other->faces(), [&](const SolidFace& g) {
        return g.corners.size() == f.corners.size() && norm(centroid(*other, g) - c) < 1e-8;
      }));
    }
    EXPECT_GT(triangles, 40U);
  }
}

TEST(TunnelTest, SegmentsAlongUpKeepTheSectionOfTheOneBefore) {
  const auto frames = section_frames({{0, 0, 0}, {0, 9, 0}, {0, 9, 9}, {0, 18, 9}, {0, 27, 18}}, {0, 0, 2});
  ASSERT_EQ(frames.size(), 4U);
  for (const SectionFrame& f : frames) {
    EXPECT_NEAR(norm(f.right - Vec3{1, 0, 0}), 0, 1e-15);
    EXPECT_NEAR(norm(f.up - cross(f.right, f.along)), 0, 1e-15);
  }
  EXPECT_NEAR(norm(frames[1].up - Vec3{0, -1, 0}), 0, 1e-15);
  const Section square = RectangleSection{metres(4), metres(4)};
  const auto drop = make_tunnel(square, {{0, 0, 0}, {0, 9, 0}, {0, 9, 9}, {0, 18, 9}});
  ASSERT_TRUE(drop.has_value()) << describe(drop.error());
  EXPECT_NEAR(drop->volume().si(), 16 * 27, 1e-6);
  // out of a shaft to the side the section would turn by a right angle
  EXPECT_TRUE(refused_as<SectionTurns>(square, {{0, 0, 0}, {0, 9, 0}, {0, 9, 9}, {9, 9, 9}}));
}

TEST(TunnelTest, PointsOnAStraightAxisAddNothing) {
  const auto plain = make_tunnel(CircleSection{metres(4)}, north).value();
  const auto dotted =
      make_tunnel(CircleSection{metres(4)}, {{40, 0, 30}, {40, 10, 30}, {40, 33, 30}, {40, 80, 30}}).value();
  EXPECT_TRUE(std::ranges::equal(plain.vertices(), dotted.vertices()));
  EXPECT_EQ(plain.faces().size(), dotted.faces().size());
}

TEST(TunnelTest, BadInputIsRefusedWithTheReason) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Section good = CircleSection{metres(4)};
  for (const double bad : {0.0, -2.0, nan, std::numeric_limits<double>::infinity()}) {
    EXPECT_TRUE(refused_as<NonPositiveDimension>(CircleSection{metres(bad)}, north));
    EXPECT_TRUE(refused_as<NonPositiveDimension>(EllipseSection{metres(1), metres(bad)}, north));
    EXPECT_TRUE(refused_as<NonPositiveDimension>(RectangleSection{metres(bad), metres(1)}, north));
    EXPECT_TRUE(refused_as<NonPositiveDimension>(DShapeSection{metres(bad), metres(1)}, north));
    EXPECT_TRUE(refused_as<NonPositiveDimension>(HorseshoeSection{metres(1), metres(bad)}, north));
    EXPECT_TRUE(refused_as<NonPositiveDimension>(TrapezoidSection{metres(1), metres(bad), metres(1)}, north));
    EXPECT_TRUE(refused_as<NonPositiveDimension>(ArchSection{metres(1), metres(1), metres(bad)}, north));
  }
  EXPECT_TRUE(refused_as<NonPositiveDimension>(DShapeSection{metres(1), metres(-1)}, north));
  EXPECT_TRUE(refused_as<HorseshoeTooLow>(HorseshoeSection{metres(10), metres(4.9)}, north));
  EXPECT_TRUE(refused_as<ArchTooHigh>(ArchSection{metres(10), metres(1), metres(5.1)}, north));
  EXPECT_TRUE(refused_as<BadSegments>(good, north, {.segments = 1, .up = {}}));
  EXPECT_TRUE(refused_as<BadSegments>(good, north, {.segments = 100000, .up = {}}));
  EXPECT_TRUE(refused_as<BadSection>(PolygonSection{{{0, 0}, {1, 1}, {1, 0}, {0, 1}}}, north));
  EXPECT_TRUE(refused_as<BadSection>(PolygonSection{{{0, 0}, {1, nan}, {1, 0}}}, north));
  EXPECT_TRUE(refused_as<BadSection>(PolygonSection{}, north));
  EXPECT_TRUE(refused_as<AxisTooShort>(good, {{0, 0, 0}}));
  EXPECT_TRUE(refused_as<BadAxisPoint>(good, {{0, 0, 0}, {0, nan, 0}}));
  EXPECT_TRUE(refused_as<BadAxisPoint>(good, {{0, 0, 0}, {0, 1e300, 0}}));
  EXPECT_TRUE(refused_as<ZeroLengthAxis>(good, {{0, 0, 0}, {0, 9, 0}, {0, 9, 0}}));
  EXPECT_TRUE(refused_as<BendTooSharp>(good, {{0, 0, 0}, {0, 9, 0}, {0, 0, 0}}));
  EXPECT_TRUE(refused_as<BendTooSharp>(good, {{0, 0, 0}, {1, 0, 0}, {1, 9, 0}}));
  // back into itself
  EXPECT_TRUE(refused_as<TunnelNotSolid>(good, {{0, 0, 0}, {50, 0, 0}, {50, 50, 0}, {20, 50, 0}, {20, -50, 0}}));
}

}  // namespace
}  // namespace cleave::geometry::tunnel_test
