#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "natural_map.hpp"
#include "scenes.hpp"

namespace cleave::dbem::section_test {
namespace {

using namespace scenes;

/// Numbers of a section that the program wrote of a slope in three random joint sets, gravity and step first, then the
/// joints (friction, cohesion, tension, restitution), then the bodies (fixed, velocity, corners with the joint of the
/// edge behind each).
struct Section {
  std::vector<Body> bodies;
  Laws laws;
  WorldOptions options;
};
Section read_section(const std::string& name) {
  std::ifstream in{std::string{CLEAVE_SOURCE_DIR} + "/tests/data/rock_sections/" + name};
  Section section;
  double duration = 0, density = 0;
  std::size_t joints = 0, bodies = 0;
  in >> section.options.gravity.x >> section.options.gravity.y >> section.options.step >> duration >> joints >> bodies;
  in >> density;
  std::vector<JointLaw> law(joints);
  for (JointLaw& joint : law) in >> joint.friction >> joint.cohesion >> joint.tension >> joint.restitution;
  section.laws.otherwise = law.at(0);
  for (std::size_t a = 0; a < joints; ++a) {
    for (std::size_t b = std::max<std::size_t>(a, 1); b < joints; ++b) section.laws.pairs.push_back({a, b, law[b]});
  }
  for (std::size_t k = 0; k < bodies; ++k) {
    int fixed = 0;
    std::size_t corners = 0;
    Body body;
    body.name = fmt::format("{}", k + 1);
    body.density = density;
    in >> fixed >> body.velocity.x >> body.velocity.y >> corners;
    body.outline.resize(corners);
    body.properties.resize(corners);
    for (std::size_t c = 0; c < corners; ++c) in >> body.outline[c].x >> body.outline[c].y >> body.properties[c];
    if (fixed != 0) body.held = {true, true, true};
    section.bodies.push_back(std::move(body));
  }
  EXPECT_TRUE(in.good());
  section.options.overlap_at_start = 2e-5;
  return section;
}

/// 109 loose blocks wedged among fixed ones, 9 to 6e5 kg: far more contact forces than the bodies feel. No step was
/// found for it.
TEST(RockSectionTest, WedgedBlocksTakeTheirSteps) {
  Section section = read_section("slope_136_blocks.txt");
  auto world = World::make(section.bodies, section.laws, section.options);
  ASSERT_TRUE(world.has_value()) << describe(world.error());
  for (int k = 0; k < 8; ++k) {
    const auto report = world->step();
    ASSERT_TRUE(report.has_value()) << "step " << k << ": " << describe(report.error());
    EXPECT_LE(report->residual, 1e-8);
    EXPECT_EQ(report->cuts, 0U) << "step " << k;
  }
}

/// 208 loose blocks, nothing known of their forces at the start, and six contacts more in the second round of the first
/// step: that took 7 x 10^9 operations, the second step 2 x 10^10, and the run was refused at its start.
TEST(RockSectionTest, AStartFromUnknownForcesIsNoDearStep) {
  Section section = read_section("slope_246_blocks.txt");
  auto world = World::make(section.bodies, section.laws, section.options);
  ASSERT_TRUE(world.has_value()) << describe(world.error());
  double work = 0;
  for (int k = 0; k < 6; ++k) {
    const auto report = world->step();
    ASSERT_TRUE(report.has_value()) << "step " << k << ": " << describe(report.error());
    EXPECT_LE(report->residual, 1e-8);
    work += report->work;
    EXPECT_LT(work, k == 0 ? 2e9 : 4.5e9);
  }
}

/// A block pressed between two walls by far more than its weight: that moves nothing and is an answer, though the
/// regularisation would take it away in time.
TEST(RockSectionTest, ForcesThatNoBodyFeelsAreAnAnswer) {
  const std::vector<Body> bodies{fixed("left", rectangle(-1, 0, 1, 1)), block("b", rectangle(0, 0, 1, 1)),
                                 fixed("right", rectangle(1, 0, 1, 1))};
  auto world = World::make(bodies, law(0.5), {});
  ASSERT_TRUE(world.has_value());
  const std::vector<ContactProblem> problems = world->problems(1e-3);
  ASSERT_EQ(problems.size(), 1U);
  ContactProblem problem = problems[0];
  const std::size_t m = problem.contacts();
  const double share = 2600 * g * 1e-3 / static_cast<double>(m);  // of the weight
  std::vector<Vec2> pressed(m);
  problem.start.assign(m, {});
  for (std::size_t k = 0; k < m; ++k) {
    const bem::Mat2& d = problem.w.values[problem.w.diagonal[k]];
    problem.yielding.push_back({1e-10 * d.xx, 1e-10 * d.yy});
    const auto& sides = problem.rigid->sides[k];
    const double up = sides[sides[0].body == RigidForm::ground ? 1 : 0].t[1];
    pressed[k] = {1e4 * share, up * share};
  }
  EXPECT_GT(natural_residual(problem, pressed), 1e-7);
  EXPECT_LT(judge(problem, pressed).residual, 1e-9);
  for (Vec2& p : pressed) p.y *= 0.5;  // half the weight falls
  EXPECT_GT(judge(problem, pressed).residual, 1e-5);
}

TEST(WorldTest, NoTimeAndNoNumbersAreErrors) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  auto world = World::make(stack(2), law(0.5), {});
  ASSERT_TRUE(world.has_value());
  for (const double step : {0.0, -1e-3, none, -std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(world->step(step).has_value()) << step;
  }
  EXPECT_EQ(world->time(), 0);
  EXPECT_TRUE(world->step(1e-3).has_value());
  for (const Vec2 bad : {Vec2{none, 0}, Vec2{0, std::numeric_limits<double>::infinity()}}) {
    std::vector<Body> bodies = stack(1);
    bodies[1].forces.push_back({.at = {0, 0.5}, .force = bad});
    const auto pulled = World::make(bodies, law(0.5), {});
    ASSERT_FALSE(pulled.has_value());
    EXPECT_TRUE(std::holds_alternative<BadForce>(pulled.error()));
    bodies[1].forces = {{.at = bad, .force = {1, 0}}};
    EXPECT_FALSE(World::make(bodies, law(0.5), {}).has_value());
  }
}

}  // namespace
}  // namespace cleave::dbem::section_test
