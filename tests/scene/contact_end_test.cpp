#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "cleave/scene2d/contact.hpp"

// What is said of a run when it ends, and of numbers and names that were not meant.
namespace cleave::scene::contact_end_test {
namespace {

using bem::Vec2;

ContactScene parsed(const std::string& text) {
  auto scene = parse_contact(text, "s.toml");
  EXPECT_TRUE(scene.has_value()) << (scene ? "" : describe(scene.error().front()));
  return scene ? *std::move(scene) : ContactScene{};
}
std::string problem_of(const std::string& text) {
  const auto scene = parse_contact(text, "s.toml");
  return scene ? "" : describe(scene.error().front());
}

ContactResult ran(const std::string& text) {
  StageTimer timer;
  Progress progress{ProgressStyle::quiet};
  auto result = run(parsed(text), 1, timer, progress);
  EXPECT_TRUE(result.has_value()) << (result ? "" : describe(result.error().front()));
  return result ? *std::move(result) : ContactResult{};
}
std::string verdict(const ContactResult& result) { return std::string{name_of(verdict_of(result))}; }

bool noted(const ContactResult& result, std::string_view words) {
  return std::ranges::any_of(result.notes, [&](const std::string& note) { return note.contains(words); });
}

/// A block of `size` by half of it on a slope of 30 degrees.
std::string slope(double size, double friction, const std::string& contact, const std::string& block = "") {
  const double c = std::sqrt(0.75), far = 10 * size;
  return fmt::format(
      "[rock]\ndensity = 2600\nyoung = 10e9\npoisson = 0.2\n[joints.default]\nfriction = {}\n[contact]\n{}\n[[body]]\n"
      "name = \"plane\"\nfixed = true\noutline = [[0, 0], [{}, 0], [0, {}]]\n[[body]]\nname = \"block\"\nrectangle = "
      "{{ "
      "corner = [{}, {}], width = {}, height = {}, angle = -30 }}\n{}",
      friction, contact, far * c, far / 2, size * c, 4.5 * size, size, size / 2, block);
}
const std::string level =
    "[joints.default]\nfriction = 20\n[[body]]\nname = \"ground\"\nfixed = true\nrectangle = { corner = [-5, -1], "
    "width "
    "= 10, height = 1 }\n[[body]]\nname = \"block\"\nrectangle = { corner = [-0.5, 0], width = 1, height = 1 }\n";

TEST(ContactEnd, WhatGoesOnMovingDoesNotStand) {
  for (const std::string& text : {
           slope(60, 29, "rigid = true\nduration = 2"),                                // it gains speed
           slope(60, 20, "rigid = true\nduration = 2\nmass_damping = 20"),             // it creeps at an even speed
           slope(1, 20, "rigid = true\nduration = 5\nmass_damping = 1000"),            // at 1.8 mm/s
           slope(1000, 20, "rigid = true\nduration = 0.8\nstep = 0.01"),               // few steps
           slope(60, 29, "rigid = true\nduration = 0.1"),                              // by 1 mm so far
           slope(60, 29, "rigid = false\nduration = 0.5\nelement = 30\nstep = 2e-3"),  // and vibrates
       }) {
    const ContactResult r = ran(text);
    EXPECT_EQ(verdict(r), "still moving") << text;
    EXPECT_EQ(verdict_of(r).going_on, 1U);
    EXPECT_TRUE(noted(r, "\"block\" (at ")) << text;
    EXPECT_TRUE(noted(r, "give a longer duration"));
  }
  // Pushed by a force that passes friction at 95 % of the time.
  const double push = 2700 * 9.81 * std::tan(20 * std::numbers::pi / 180) / 0.95;
  const ContactResult late = ran("[contact]\nduration = 1\n" + level +
                                 fmt::format("load = [{{ at = [-0.5, 0.1], force = [{}, 0], time = {{ kind = \"ramp\", "
                                             "duration = 1 }} }}]\n",
                                             push));
  EXPECT_EQ(verdict(late), "still moving");
}

TEST(ContactEnd, WhatRestsSwingsOrStopsStands) {
  const std::string elastic = "[rock]\nyoung = 1e9\npoisson = 0.2\n";
  for (const std::string& text : {
           slope(60, 31, "rigid = true\nduration = 2"),
           slope(60, 40, "rigid = false\nduration = 0.5\nelement = 30\nstep = 2e-3"),
           slope(1, 31, "rigid = true\nduration = 2\nmass_damping = 20"),
           "[contact]\nduration = 1\n" + level,
           // Its vibrations are not damped.
           elastic + "[contact]\nduration = 0.5\nstep = 1e-3\nrigid = false\n" + level,
           // It sinks onto soft springs, and swings on them or creeps down to rest.
           "[contact]\nduration = 2\nstep = 1e-3\nrigid = true\n" + level +
               "[joints.soft]\nnormal_stiffness = 1e7\n"
               "[[body]]\nname = \"soft\"\njoint = \"soft\"\nrectangle = { corner = [2, 0], width = 1, height = 1 }\n",
           "[contact]\nduration = 2\nstep = 1e-3\nrigid = true\nmass_damping = 823\n" + level +
               "[joints.soft]\nnormal_stiffness = 1e7\n"
               "[[body]]\nname = \"soft\"\njoint = \"soft\"\nrectangle = { corner = [2, 0], width = 1, height = 1 }\n",
           // It slides by 1.4 mm and stops, early and in the last tenth of the time.
           "[contact]\nduration = 1\n" + level + "velocity = [0.1, 0]\n",
           "[contact]\nstep = 1e-4\nduration = 0.03\n" + level + "velocity = [0.1, 0]\n",
       }) {
    const ContactResult r = ran(text);
    EXPECT_TRUE(r.converged);
    EXPECT_EQ(verdict(r), "stands") << text << note_of_going_on(r);
    EXPECT_FALSE(noted(r, "went on moving"));
  }
}

// Hit at 0.93 of 1 s it slides for some 20 ms. On a ground that moves it does not fall asleep.
TEST(ContactEnd, WhatGaveWayOnceAndRestsDoesNotGoOn) {
  const ContactResult r =
      ran("[contact]\nduration = 1\nrigid = true\nstep = 1e-3\nground = { acceleration = [1e-3, 0] }\n" + level +
          "[joints.smooth]\nfriction = 0\n[[body]]\nname = \"hits\"\njoint = \"smooth\"\n"
          "velocity = [1, 0]\nrectangle = { corner = [-1.73, 0], width = 0.3, height = 0.3 }\n");
  EXPECT_GT(r.bodies[1].largest, 1e-4);
  EXPECT_FALSE(r.bodies[1].moved_at.has_value());
  EXPECT_FALSE(r.bodies[1].goes_on.has_value());
}

// Seen when it has turned by less than 5 degrees.
TEST(ContactEnd, AColumnThatTipsTopples) {
  const ContactResult r = ran(
      "[joints.default]\nfriction = 60\n[contact]\nduration = 0.6\n[[body]]\nname = \"ground\"\nfixed = "
      "true\nrectangle = { corner = [-10, -1], width = 20, height = 1 }\n[[body]]\nname = \"column\"\noutline = [[0, "
      "0], [0.5, 0], [1.6, 10], [1.1, 10]]\n");
  EXPECT_LT(r.bodies[1].turned, 5 * std::numbers::pi / 180);
  EXPECT_EQ(verdict(r), "topples");
  EXPECT_EQ(verdict(ran(slope(1, 20, "rigid = true\nduration = 2"))), "slides");
}

TEST(ContactEnd, ABoltThatBreaksIsNoted) {
  const auto bolted = [](double capacity) {
    return slope(
        1, 20, "rigid = true\nduration = 0.1",
        fmt::format("[[bolt]]\nname = \"anchor\"\nhead = [1.424, 4.467]\ntoe = [0.431, 4.347]\nspacing = 1\nkind = "
                    "\"mechanical\"\nanchorage = 0.3\ntendon_capacity = {0}\nplate_capacity = "
                    "{0}\nanchor_capacity = {0}\n",
                    capacity));
  };
  const ContactResult weak = ran(bolted(1e3)), strong = ran(bolted(1e6));
  ASSERT_EQ(weak.bolts.size(), 1U);
  EXPECT_EQ(weak.bolts[0].state, BoltState::broken);
  EXPECT_TRUE(noted(weak, "bolt \"anchor\" broke between \"block\" and \"plane\""));
  EXPECT_FALSE(noted(strong, "broke"));
}

TEST(ContactEnd, NumbersInAnotherUnitAreNoted) {
  const auto notes = [](const std::string& text) {
    std::string out;
    for (const Problem& note : parsed(text).notes) out += describe(note) + '\n';
    return out;
  };
  const std::string moving = "[contact]\nduration = 1\n";
  for (const auto& [text, words] : std::vector<std::pair<std::string, std::string>>{
           {"[rock]\ndensity = 26\n" + moving + level, "rock.density: is 26 kg/m3, which is far from usual"},
           {"[rock]\ndensity = 26\n" + moving + level, "write \"26 kN/m3\""},
           {moving + level + "density = 2.6\n", "write \"2.6 t/m3\""},
           {moving + "[joints.soft]\ncohesion = 20\n" + level + "joint = \"soft\"\n", "write \"20 kPa\""},
           {moving + "[joints.soft]\ntension = 5\n" + level + "joint = \"soft\"\n", "write \"5 kPa\""},
           {moving + "[joints.soft]\nwater_pressure = 50\n" + level + "joint = \"soft\"\n", "write \"50 kPa\""},
           {moving + "[joints.soft]\nnormal_stiffness = 1e4\n" + level + "joint = \"soft\"\n", "write \"10000 kPa/m\""},
           {moving + level + "young = 30\npoisson = 0.2\n", "write \"30 MPa\""},
           {moving + level + "load = [{ side = 3, pressure = 100 }]\n", "write \"100 kPa\""},
           {moving + level + "load = [{ side = 3, traction = [0, -100] }]\n", "write \"-100 kPa\""},
           {moving + "ground = { acceleration = [0.2, 0] }\n" + level, "write \"0.2 g\""},
           {moving + "ground = { record = { step = 0.1, x = [0, 0.1, -0.3, 0] } }\n" + level,
            "if it is meant in g, write scale = 9.81"},
       }) {
    EXPECT_TRUE(notes(text).contains(words)) << text << notes(text);
  }
  EXPECT_EQ(
      notes("[rock]\ndensity = 2600\n" + moving +
            "ground = { record = { step = 0.1, x = [0, 0.1, -0.3, 0], scale = 9.81 } }\n[joints.soft]\ncohesion = "
            "2e4\n" +
            level + "joint = \"soft\"\nload = [{ side = 3, pressure = 1e5 }]\n"),
      "");
}

TEST(ContactEnd, TablesOfJointsThatNoSideHasAreRefused) {
  const std::string moving = "[contact]\nduration = 1\n", block = level.substr(level.find("[[body]]"));
  EXPECT_EQ(problem_of(moving + "[joints.Default]\nfriction = 10\n" + block),
            "s.toml:3: joints.Default: no side of a body has this joint; did you mean \"default\"?");
  EXPECT_EQ(problem_of(moving + "[joints.rough]\nfriction = 10\n" + block),
            "s.toml:3: joints.rough: no side of a body has this joint; remove it, or name it in joint of a body");
  EXPECT_EQ(problem_of(moving + "[joints.rough]\nfriction = 10\n" + block + "joint = \"rough\"\n"), "");
  const auto note = [](const std::string& text) {
    const std::vector<Problem> notes = parsed(text).notes;
    return notes.empty() ? "" : describe(notes.front());
  };
  EXPECT_TRUE(note(moving + block).contains("no strength is stated: friction 30 degrees"));
  EXPECT_TRUE(note(moving + "[joints.default]\ncohesion = 1e4\n" + block).contains("states no friction: 30 degrees"));
  EXPECT_EQ(note(moving + "[joints.rough]\nfriction = 10\n" + block + "joint = \"rough\"\n"), "");
}

/// Largest departure of the stress at the nodes of all bodies from a pressure `p` along `up`, over `p`.
double off_even(const ContactResult& r, Vec2 up, double p) {
  double worst = 0;
  std::size_t nodes = 0;
  for (const auto& body : r.frames.back().stress) {
    for (const NodeStress& node : body) {
      const bem::Sym2 s = node.stress;
      const Vec2 t{s.xx * up.x + s.xy * up.y, s.xy * up.x + s.yy * up.y};
      worst = std::max(worst, norm(t + p * up) / p);
      ++nodes;
    }
  }
  EXPECT_GT(nodes, 0U);
  return worst;
}

// A pressure on top goes through a joint with stiffness to a floor as an even one. Equal springs at all nodes gave
// -183, -47, -213 kPa for -100, however fine.
TEST(ContactEnd, AnEvenPressurePassesJointsWithStiffness) {
  for (const double angle : {0.0, 0.7}) {
    for (const auto& [plane, element, count] : std::vector<std::tuple<std::string, double, int>>{
             {"strain", 0.5, 1}, {"strain", 0.25, 1}, {"stress", 0.25, 1}, {"strain", 0.125, 1}, {"strain", 0.25, 2}}) {
      const Vec2 up = rotated(Vec2{0, 1}, angle);
      const auto polygon = [&](std::vector<Vec2> corners) {
        std::string out = "outline = [";
        for (const Vec2 p : corners) out += fmt::format("[{}, {}], ", rotated(p, angle).x, rotated(p, angle).y);
        return out + "]\n";
      };
      std::string text = fmt::format(
          "[rock]\ndensity = 2500\nyoung = 10e9\npoisson = {}\n[joints.default]\nfriction = {}\nnormal_stiffness = "
          "1e9\n[contact]\nstatic = true\nduration = 1000\nrigid = false\ngravity = 0\nplane = \"{}\"\nelement = "
          "{}\n[[body]]\nfixed = true\n",
          count == 1 ? 0.2 : 0.0, count == 1 ? 0 : 30, plane, element);
      text += polygon({{-5, -1}, {6, -1}, {6, 0}, {-5, 0}});
      for (int k = 0; k < count; ++k) {
        const double y = k;
        text += "[[body]]\n" + polygon({{0, y}, {1, y}, {1, y + 1}, {0, y + 1}});
      }
      text += "load = [{ side = 3, pressure = 1e5 }]\n";
      const ContactResult r = ran(text);
      ASSERT_TRUE(r.converged);
      EXPECT_LT(off_even(r, up, 1e5), 1e-5) << angle << ' ' << plane << ' ' << element << ' ' << count;
      // The joint closes by force over stiffness, everywhere.
      const Vec2 foot = r.frames.back().corners[1][0] - r.bodies[1].outline[0];
      EXPECT_NEAR(dot(foot, up) / -1e-4, 1, 1e-4);
    }
  }
}

/// A body that spins at 100 rad/s in nothing for 0.02 s, seen at `steps` frames.
ContactResult spinning(const std::string& body, const std::string& more) {
  return ran(
      "[rock]\ndensity = 2600\nyoung = 20e9\npoisson = 0.25\n[contact]\nduration = 0.02\nstep = 2e-4\nframes "
      "= 4\nrigid = false\ngravity = 0\nplane = \"stress\"\n" +
      more + "[[body]]\nspin = 100\n" + body);
}

// rho w^2 (L^2 / 4 - x^2) / 2 along a thin bar, from the start on, as it turns.
TEST(ContactEnd, ABarThatSpinsIsStretched) {
  const double most = 2600 * 1e4 * 4.0 / 8;
  const ContactResult r = spinning("rectangle = { corner = [5, 3], width = 2, height = 0.1 }\n", "element = 0.1\n");
  ASSERT_TRUE(r.converged);
  for (const ContactFrame& frame : r.frames) {
    const double turn = frame.places[0].rotation;
    std::size_t seen = 0;
    for (std::size_t k = 0; k < r.bodies[0].outline.size(); ++k) {
      const double x = r.bodies[0].outline[k].x - 6;
      if (std::abs(x) > 0.85) continue;
      const bem::Sym2 s = frame.stress[0][k].stress;
      const Vec2 along{std::cos(turn), std::sin(turn)};
      const double pulled = s.xx * along.x * along.x + 2 * s.xy * along.x * along.y + s.yy * along.y * along.y;
      EXPECT_NEAR(pulled / most, 1 - x * x, 0.01) << frame.time << ' ' << x;
      ++seen;
    }
    EXPECT_GT(seen, 20U);
  }
  EXPECT_NEAR(r.frames.back().places[0].rotation, 2, 1e-9);
  EXPECT_LT(std::abs(r.history.back().lost), 1e-6 * r.history.back().kinetic);
}

// The hoop stress at the rim of a disc is rho w^2 R^2 (1 - nu) / 4; a disc of 24 sides of the same area.
TEST(ContactEnd, ADiscThatSpinsIsStretched) {
  std::string outline = "outline = [";
  const double circle = std::sqrt(2 * std::numbers::pi / (24 * std::sin(2 * std::numbers::pi / 24)));
  for (int k = 0; k < 24; ++k) {
    const double a = 2 * std::numbers::pi * k / 24;
    outline += fmt::format("[{:.12f}, {:.12f}], ", circle * std::cos(a), circle * std::sin(a));
  }
  const ContactResult r = spinning(outline + "]\n", "element = 0.14\n");
  ASSERT_TRUE(r.converged);
  const double hoop = 2600 * 1e4 * 0.75 / 4;
  double sum = 0;
  for (const NodeStress& node : r.frames.back().stress[0]) sum += node.stress.xx + node.stress.yy;
  EXPECT_NEAR(sum / static_cast<double>(r.frames.back().stress[0].size()) / hoop, 1, 0.03);
}

/// Two elastic blocks of 1 x 1 m on a floor: mean way down of the top of the upper one, and what the joint between
/// them closes by.
struct Settled {
  bool converged = false;
  double top = 0, joint = 0;
};
Settled settled(double lower, double upper, double kn, double poisson, int friction, std::string_view more,
                bool upper_first = false) {
  const auto block = [](std::string_view name, double y, double young) {
    return fmt::format(
        "[[body]]\nname = \"{}\"\nyoung = {}\nrectangle = {{ corner = [0, {}], width = 1, height = 1 }}\n", name, young,
        y);
  };
  const std::string low = block("low", 0, lower), up = block("up", 1, upper);
  const ContactResult r =
      ran(fmt::format("[rock]\ndensity = 2500\npoisson = {}\nyoung = 1e10\n[joints.default]\nfriction = "
                      "{}\nnormal_stiffness = {}\n[contact]\ngravity = 10\nrigid = false\n{}\n",
                      poisson, friction, kn, more) +
          (upper_first ? up : "") +
          "[[body]]\nname = \"floor\"\nfixed = true\nrectangle = { corner = [-1, -1], width = 3, height = 1 }\n" + low +
          (upper_first ? "" : up));
  const auto way = [&](std::string_view name, double y) {
    double sum = 0, nodes = 0;
    for (std::size_t b = 0; b < r.bodies.size(); ++b) {
      const auto now = corners_at(r, r.frames.size() - 1, b);
      for (std::size_t k = 0; k < now.size() && r.bodies[b].name == name; ++k) {
        if (r.bodies[b].outline[k].y != y) continue;
        sum += now[k].y - y;
        ++nodes;
      }
    }
    return sum / nodes;
  };
  return {r.converged, -way("up", 2), way("low", 1) - way("up", 1)};
}

// Bodies of unequal moduli spread unequally, so nodes that face each other do not stay over one another: what that node
// stood for on the other side of it was lost, and joints closed by up to 63 % too much.
TEST(ContactEnd, JointsBetweenUnequalBodiesCloseByTheirLength) {
  const double weight = 25e3;
  for (const double upper : {1e8, 3e8, 1e9, 1e10}) {
    for (const double kn : {1e8, 1e9, 1e10, 1e11}) {
      for (const auto& [friction, element, upper_first] :
           {std::tuple{30, 0.25, false}, {30, 0.5, true}, {0, 0.25, false}, {30, 0.2, true}}) {
        const Settled s =
            settled(1e10, upper, kn, 0, friction, fmt::format("static = true\nelement = {}", element), upper_first);
        const double top = 3 * weight / kn + 1.5 * weight / 1e10 + 0.5 * weight / upper;
        EXPECT_TRUE(s.converged) << upper << ' ' << kn << ' ' << friction << ' ' << element;
        EXPECT_NEAR(s.top / top, 1, 1e-3) << upper << ' ' << kn << ' ' << friction << ' ' << element;
        EXPECT_NEAR(s.joint / (weight / kn), 1, 2e-3) << upper << ' ' << kn << ' ' << friction << ' ' << element;
      }
    }
  }
}

// The nodes at the ends of the joint lie out of the other body once the softer one has spread: with short steps they
// were not looked at, and the joint lost their share.
TEST(ContactEnd, EndsOfJointsBetweenUnequalBodiesStayClosed) {
  const Settled rest = settled(1e8, 1e9, 1e8, 0.25, 30, "static = true\nelement = 0.5");
  EXPECT_TRUE(rest.converged);
  for (const double step : {2e-3, 5e-4}) {
    const Settled s = settled(1e8, 1e9, 1e8, 0.25, 0,
                              fmt::format("duration = 1.5\nstep = {}\nmass_damping = 15\nelement = 0.5", step));
    const Settled same =
        settled(1e8, 1e9, 1e8, 0.25, 0, "duration = 1.5\nstep = 4e-3\nmass_damping = 15\nelement = 0.5");
    EXPECT_NEAR(s.top / same.top, 1, 1e-4) << step;
    EXPECT_NEAR(s.joint / same.joint, 1, 1e-4) << step;
    EXPECT_NEAR(s.joint / 2.5e-4, 1, 2e-2) << step;
  }
}

// Bonds have the length that an even stress gives them: under pure shear they all hold or all break.
TEST(ContactEnd, CohesionOfAnElasticBodyIsThatOfItsWholeLength) {
  for (const auto& [share, holds] : {std::pair{0.97, true}, {1.03, false}}) {
    const ContactResult r = ran(fmt::format(
        "[rock]\ndensity = 2500\nyoung = 10e9\npoisson = 0.2\n[joints.default]\nfriction = 0\ncohesion = 1e5\ntension "
        "= "
        "1e6\n[contact]\nstatic = true\nduration = 100\nrigid = false\ngravity = 0\n[[body]]\nfixed = true\nrectangle "
        "= {{ corner "
        "= [-5, -1], width = 11, height = 1 }}\n[[body]]\nrectangle = {{ corner = [0, 0], width = 1, height = 1 "
        "}}\nload = [{{ side = 3, traction = [{0}, 0] }}, {{ side = 2, traction = [0, {0}] }}, {{ side = 4, traction = "
        "[0, -{0}] }}]\n",
        share * 1e5));
    EXPECT_EQ(r.converged, holds) << share << ' ' << r.stopped_why;
  }
}

TEST(ContactEnd, AnOverlapOfTheStartIsPartedOrTheRunStops) {
  // Nine micrometres on each side: less than a scene is refused for, more than a step may leave.
  for (const bool room : {true, false}) {
    std::string text =
        "[joints.default]\nfriction = 30\n[contact]\nduration = 0.02\n[[body]]\nfixed = true\nrectangle = { corner = "
        "[-5, -1], width = 10, height = 1 }\n[[body]]\nfixed = true\nrectangle = { corner = [0, 0], width = 1, height "
        "= 1 }\n[[body]]\nrectangle = { corner = [0.999991, 0], width = 1, height = 1 }\n";
    if (!room) {
      text += "[[body]]\nfixed = true\nrectangle = { corner = [1.999982, 0], width = 1, height = 1 }\n";
    }
    const ContactResult r = ran(text);
    EXPECT_EQ(r.converged, room) << r.stopped_why;
    if (room) {
      EXPECT_LE(r.largest_penetration, 1e-6);
      EXPECT_NEAR(r.bodies[2].centroid.x, 1.5, 1e-6);
    }
  }
}

}  // namespace
}  // namespace cleave::scene::contact_end_test
