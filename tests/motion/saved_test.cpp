#include <functional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "cleave/core/archive.hpp"
#include "worlds.hpp"

/// Worlds as bytes: what goes on from them is the world that went on.
namespace cleave::motion {
namespace {

using namespace worlds;

constexpr std::string_view kind = "cleave-motion-world";
constexpr std::uint32_t version = 6;

/// A cube that sleeps, and one that comes down on it and wakes it.
World sleeper() {
  return world({floor(), body(box({0, 0, 0}, {1, 1, 1})), body(box({0.3, 0.2, 1.4}, {1.2, 0.9, 1.9}))}, 0.5,
               {.step = 0.01});
}

/// Blocks on a slope, one of which its cement holds and one not, with a block that hits the former.
World cemented(double friction = 0.3) {
  const Turn plane = slope(35, 222.5);
  SceneSpec scene{.bodies = {floor(plane)}, .surfaces = {{friction, 0}}};
  const auto on = [&](double x, double y, double z) { return plane * Vec3{x, y, z}; };
  for (const double x : {-2.0, 2.0}) {
    const auto number = static_cast<std::uint32_t>(scene.bodies.size());
    scene.bodies.push_back(body(moved(block(1, 2, 0.5), on(x, 0, 0.25), plane)));
    Bond bond{.body = number,
              .other = 0,
              .normal = plane * Vec3{0, 0, 1},
              .shares = {},
              .cohesion = x < 0 ? 1.0 : 4.0,
              .tension = 0,
              .friction = friction};
    add_triangle(on(x - 0.5, -1, 0), on(x + 0.5, -1, 0), on(x + 0.5, 1, 0), bond.shares);
    add_triangle(on(x - 0.5, -1, 0), on(x + 0.5, 1, 0), on(x - 0.5, 1, 0), bond.shares);
    scene.bonds.push_back(bond);
  }
  scene.bodies.push_back(body(moved(block(0.5, 0.5, 0.5), on(2, -2, 0.3), plane), 6.0 * on(0, 1, 0)));
  auto made = World::make(std::move(scene), {.step = 0.01});
  if (!made) ADD_FAILURE() << describe(made.error());
  return std::move(*made);
}

/// Icosahedra that fly into one another and rebound.
World cloud() {
  std::vector<BodySpec> bodies;
  for (int k = 0; k < 8; ++k) {
    const Vec3 at{0.7 * (k % 2) - 0.35, 0.7 * (k / 2 % 2) - 0.35, 0.7 * (k / 4) - 0.35};
    bodies.push_back(body(moved(icosahedron(0.3), at, turn_by({0.1 * k, 0.2 * k, 0.3})), -2.0 * at,
                          {0.3 * (k % 4), 0.2 * (k % 5), -0.1 * k}));
  }
  return world(std::move(bodies), 0.4, {.gravity = {}, .step = 0.01}, 0.5);
}

/// Concave bodies of which one is held until later.
World held() {
  const Polyhedron shape = prism({{0, 0}, {0.9, 0}, {0.9, 0.3}, {0.3, 0.3}, {0.3, 0.6}, {0, 0.6}}, 0, 0.3);
  std::vector<BodySpec> bodies{floor(), body(moved(shape, {0, 0, 0.1})), body(moved(shape, {0.1, 0.1, 0.6}))};
  bodies.back().fixed = true;
  return world(std::move(bodies), 0.5, {.step = 0.01});
}

/// A block that floats, beside one that water in a joint presses off its wall until it has drained.
World flooded() {
  SceneSpec scene{.bodies = {{.shape = box({-3, -3, -3}, {0, 3, 3}), .fixed = true},
                             body(box({0, -0.5, 0}, {1, 0.5, 1})),
                             body(box({2, 0, -0.6}, {3, 1, 0.4}))},
                  .surfaces = {{0.4, 0}},
                  .loads = {{.body = 1, .other = 0, .at = {0, 0, 0.4}, .force = {12, 0, 1}, .opens = metres(0.03)},
                            {.body = 2, .at = {2.2, 0, 0}, .force = {0, 1, 0}}},
                  .water = StillWater{.level = metres(0.1), .unit_weight = newtons_per_cubic_metre(15)}};
  auto made = World::make(std::move(scene), {.step = 0.01});
  if (!made) ADD_FAILURE() << describe(made.error());
  return std::move(*made);
}

struct Kind {
  std::string name;
  std::function<World()> make;
  int steps;
  int let_go = -1;  ///< body 2, after so many steps
};

void one_step(World& w, const Kind& kind_of, int at) {
  if (at == kind_of.let_go) w.set_fixed(2, false);
  const auto report = w.step();
  if (!report) ADD_FAILURE() << kind_of.name << ": " << describe(report.error());
}

TEST(Saved, AWorldGoesOnAsIfItHadNotStopped) {
  for (const Kind& of : {Kind{"sleeper", sleeper, 60}, Kind{"cemented", [] { return cemented(); }, 40},
                         Kind{"cloud", cloud, 40}, Kind{"held", held, 40, 20}, Kind{"flooded", flooded, 40}}) {
    World whole = of.make();
    std::vector<std::string> saved;
    for (int k = 0; k < of.steps; ++k) {
      saved.push_back(whole.saved());
      one_step(whole, of, k);
    }
    const std::string end = whole.saved();
    for (const int at : {0, 3, of.steps / 2, of.steps - 1}) {
      World rest = of.make();
      ASSERT_TRUE(rest.restore(saved[static_cast<std::size_t>(at)]).has_value()) << of.name << " " << at;
      EXPECT_TRUE(rest.saved() == saved[static_cast<std::size_t>(at)]) << of.name << " " << at;
      for (int k = at; k < of.steps; ++k) one_step(rest, of, k);
      EXPECT_TRUE(rest.saved() == end) << of.name << " from step " << at;
    }
  }
}

TEST(Saved, TheWorldsHaveWhatTheyAreFor) {
  World w = sleeper();
  bool slept = false, woke = false;
  for (int k = 0; k < 60; ++k) {
    one_step(w, {"sleeper", sleeper, 60}, k);
    woke = woke || (slept && !w.asleep(1));
    slept = slept || w.asleep(1);
  }
  EXPECT_TRUE(slept);
  EXPECT_TRUE(woke);
  World wet = flooded();
  for (int k = 0; k < 5; ++k) one_step(wet, {"flooded", flooded, 40}, k);
  EXPECT_FALSE(wet.load_gone(0));
  for (int k = 5; k < 20; ++k) one_step(wet, {"flooded", flooded, 40}, k);
  EXPECT_TRUE(wet.load_gone(0));
  World c = cemented();
  std::size_t broken = 0;
  for (int k = 0; k < 40; ++k) {
    const auto report = c.step();
    ASSERT_TRUE(report.has_value());
    broken += report->broken;
  }
  EXPECT_GE(broken, 1U);
}

TEST(Saved, WhatIsOfAnotherWorldOrDamagedIsRefused) {
  World w = cemented();
  for (int k = 0; k < 5; ++k) ASSERT_TRUE(w.step().has_value());
  const std::string saved = w.saved();
  const auto refused = [&](World other, const std::string& bytes, SavedFault fault) {
    const std::string before = other.saved();
    const auto got = other.restore(bytes);
    ASSERT_FALSE(got.has_value());
    EXPECT_EQ(got.error(), fault) << describe(got.error());
    EXPECT_TRUE(other.saved() == before);
  };
  refused(cemented(), "", SavedFault::foreign);
  refused(cemented(), "cleave-world 1\n", SavedFault::foreign);
  refused(cemented(), sealed(kind, 99, "x"), SavedFault::other_version);
  refused(cemented(), saved.substr(0, saved.size() - 1), SavedFault::damaged);
  refused(cemented(), saved + " ", SavedFault::damaged);
  refused(cemented(0.31), saved, SavedFault::other_world);
  refused(sleeper(), saved, SavedFault::other_world);
  refused(sleeper(), flooded().saved(), SavedFault::other_world);
  std::string inside{unsealed(kind, version, saved).value()};
  refused(cemented(), sealed(kind, version, inside + "x"), SavedFault::damaged);
  // Behind the name: the time and the last step, then the number of bodies.
  const std::size_t after_name = 8 + 64;
  for (const auto& [at, byte] :
       {std::pair{after_name + 7, '\xff'}, {after_name + 16, '\7'}, {inside.size() - 1, '\2'}}) {
    std::string forged = inside;
    forged[at] = byte;
    refused(cemented(), sealed(kind, version, forged), SavedFault::damaged);
  }
}

}  // namespace
}  // namespace cleave::motion
