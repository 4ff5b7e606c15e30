// Rebuilding, estimates of the error and stress inside of moving bodies, as scenes ask for them.

#include <gtest/gtest.h>

#include <cmath>

#include "cleave/scene2d/bodies.hpp"
#include "plane_runs.hpp"

namespace cleave::scene {
namespace {

using plane_runs::ran;

std::string plan_of(const std::string& text) {
  std::string all;
  for (const PlannedStep& planned : make_plan(*parse_bodies(text, "s.toml")).steps) all += planned.why + "\n";
  return all;
}

/// Stretched slowly by a pressure that stays on its ends.
std::string stretched(double megapascals, const std::string& time) {
  return "[rock]\nyoung = 1e6\npoisson = 0\ndensity = 1000\n[elastic]\nstress = false\npoints = [{ name = \"in\", at = "
         "[0.3, 0.1], stress = true }, { name = \"end\", at = [1, 0] }]\n"
         "time = { end = 10, step = 0.02, frames = 4, modes = 1000, damping = { share = 1 }" +
         time +
         " }\n[[body]]\noutline = [[-1, -0.5], [1, -0.5], [1, 0.5], [-1, 0.5]]\n"
         "load = [{ sides = [2, 4], pressure = " +
         std::to_string(-megapascals * 1e6) + ", time = { kind = \"ramp\", duration = 5, follows = true } }]\n";
}

TEST(Rebuilding, LargeStrainRebuildsAndSmallStrainDoesNot) {
  const BodiesResult small = ran(stretched(0.005, ""));
  EXPECT_EQ(small.bodies[0].rebuilds, 0U);
  EXPECT_NEAR(small.bodies[0].strain_since_build, 0.005, 1e-4);
  EXPECT_NEAR(small.points[1].displacement.back().x, 0.005, 2e-5);
  const BodiesResult large = ran(stretched(0.2, ""));
  EXPECT_GE(large.bodies[0].rebuilds, 8U);
  EXPECT_NEAR(large.points[1].displacement.back().x, std::exp(0.2) - 1, 2e-3);
  // A point inside goes with it, and carries the pull.
  EXPECT_NEAR(large.points[0].displacement.back().x, 0.3 * (std::exp(0.2) - 1), 1e-3);
  EXPECT_NEAR(large.points[0].stress.back().xx, 0.2e6, 5e3);
  EXPECT_NEAR(large.points[0].stress.back().yy, 0, 2e3);
  const BodiesResult never = ran(stretched(0.2, ", rebuild = 0"));
  EXPECT_EQ(never.bodies[0].rebuilds, 0U);
  EXPECT_NEAR(never.points[1].displacement.back().x, 0.2, 1e-3);
  EXPECT_FALSE(never.notes.empty());  // at its limit
  EXPECT_TRUE(large.notes.empty());
}

TEST(Rebuilding, ABodyThatIsTooDeformedStopsWithItsReason) {
  // A hundred times its modulus, tension: no shape is left to go on with.
  const BodiesResult r = ran(stretched(100, ""));
  EXPECT_FALSE(r.converged);
  EXPECT_TRUE(r.stopped_why.find("too deformed") != std::string::npos ||
              r.stopped_why.find("did not converge") != std::string::npos)
      << r.stopped_why;
  for (const std::string bad : {", rebuild = -1", ", rebuild = 2", ", estimate = 1", ", rebild = 0.1"}) {
    const auto scene = parse_bodies(stretched(0.1, bad), "s.toml");
    ASSERT_FALSE(scene.has_value()) << bad;
    EXPECT_NE(describe(scene.error().front()).find("elastic.time"), std::string::npos)
        << describe(scene.error().front());
  }
}

TEST(Rebuilding, PlanSaysWhatIsLeftOut) {
  const std::string asked = plan_of(stretched(0.1, ""));
  EXPECT_EQ(asked.find("no stress inside"), std::string::npos);
  EXPECT_EQ(asked.find("no estimate"), std::string::npos);
  const std::string off = plan_of(stretched(0.1, ", rebuild = 0, estimate = false"));
  EXPECT_NE(off.find("no estimate of the error: switched off"), std::string::npos);
  EXPECT_NE(off.find("no rebuilding: switched off"), std::string::npos);
  std::string bare = stretched(0.1, "");
  const std::string key = ", stress = true }";
  bare.replace(bare.find(key), key.size(), " }");
  EXPECT_NE(plan_of(bare).find("no stress inside: no point asks for it"), std::string::npos);
  EXPECT_TRUE(ran(bare).points[0].stress.empty());
}

/// Column of Fu (2014) under a sudden pull, nu = 0.
std::string column(double step, int elements) {
  return "[rock]\nyoung = 1e5\npoisson = 0\ndensity = 1\n[elastic]\nstress = false\nelement = " +
         std::to_string(4.0 / elements) + "\ntime = { end = 0.1, step = " + std::to_string(step) +
         ", frames = 100 }\npoints = [{ at = [0, 4] }]\n[[body]]\noutline = [[-1, 0], [1, 0], [1, 4], [-1, 4]]\n"
         "support = [{ side = 1, kind = \"fixed\" }]\nload = [{ side = 3, traction = [0, 1] }]\n";
}

TEST(ErrorEstimate, BoundsTheErrorOfTheSuddenlyLoadedBar) {
  const double c = std::sqrt(1e5);
  std::size_t given = 0;
  for (const auto& [step, elements] : {std::pair{2e-3, 2}, std::pair{1e-3, 4}, std::pair{2e-4, 8}}) {
    const BodiesResult r = ran(column(step, elements));
    double worst = 0, most = 0;
    for (std::size_t f = 0; f < r.times.size(); ++f) {
      const double phase = std::fmod(r.times[f], 16 / c);
      const double exact = 1e-5 * (phase <= 8 / c ? phase : 16 / c - phase) * c;
      worst = std::max(worst, std::abs(r.points[0].displacement[f].y - exact));
      most = std::max(most, exact);
    }
    // An upper figure, and not a wild one, or none.
    given += r.bodies[0].error ? 1U : 0U;
    EXPECT_NE(r.bodies[0].error.has_value(), !r.bodies[0].no_estimate.empty());
    if (!r.bodies[0].error) continue;
    EXPECT_GT(*r.bodies[0].error, worst / most);
    EXPECT_LT(*r.bodies[0].error, 10 * worst / most);
  }
  EXPECT_GE(given, 1U);
}

/// Largest error over the largest displacement of the end of a bar of 10 x 0.5 m, pushed suddenly.
double error_of_shock(const BodiesResult& r) {
  const double c = 2000, period = 40 / c;
  double worst = 0, most = 0;
  for (std::size_t f = 0; f < r.times.size(); ++f) {
    const double phase = std::fmod(r.times[f], period);
    const double exact = -1e-4 * c * (phase <= period / 2 ? phase : period - phase);
    worst = std::max(worst, std::abs(r.points[0].displacement[f].x - exact));
    most = std::max(most, std::abs(exact));
  }
  return worst / most;
}

TEST(ErrorEstimate, OfAShockedBarCoversOrIsNone) {
  for (const auto& [element, step] : {std::pair{2.5, 1e-4}, std::pair{0.6, 5e-5}}) {
    const BodiesResult r =
        ran("[rock]\nyoung = 10e9\npoisson = 0\ndensity = 2500\n[elastic]\nstress = false\nelement = " +
            std::to_string(element) + "\ntime = { end = 0.01, step = " + std::to_string(step) +
            ", frames = 100 }\npoints = [{ at = [10, 0.25] }]\n[[body]]\noutline = [[0, 0], [10, 0], [10, 0.5], [0, "
            "0.5]]\ngrading = 1\nsupport = [{ side = 4, kind = \"fixed\" }]\nload = [{ side = 2, traction = [-1e6, 0] "
            "}]\n");
    const BodyResult& body = r.bodies[0];
    EXPECT_LT(error_of_shock(r), 0.05) << element;
    if (body.error) {
      EXPECT_GT(*body.error, error_of_shock(r) / 1.5) << element;
    } else {
      EXPECT_FALSE(body.no_estimate.empty());
    }
  }
}

TEST(ErrorEstimate, OfAFreeFallIsRounding) {
  const BodiesResult r = ran(
      "[rock]\nyoung = 1e9\npoisson = 0.25\n[elastic]\ngravity = 10\nstress = false\ntime = { end = 1, step = 0.01 }\n"
      "[[body]]\noutline = [[0, 0], [1, 0], [1, 1], [0, 1]]\n");
  ASSERT_TRUE(r.bodies[0].error.has_value());
  EXPECT_LT(*r.bodies[0].error, 1e-10);
  EXPECT_NEAR(r.bodies[0].largest, 5, 1e-9);
}

TEST(InnerStress, StaticLimitOfAHeldBlockInTimeIsTheStaticScene) {
  const std::string rest =
      "[[body]]\noutline = [[0, 0], [3, 0], [3, 1], [0, 1.5]]\nelements = 6\nsupport = [{ side = 4, kind = \"fixed\" "
      "}]\nload = [{ side = 3, pressure = 1e3 }]\n";
  const std::string head =
      "[rock]\nyoung = 1e7\npoisson = 0.25\ndensity = 10\n[elastic]\nstress = false\npoints = [{ at = [1.5, 0.6], "
      "stress = true }, { at = [2, 0], stress = true }]\n";
  const BodiesResult fixed = ran(head + rest);
  const BodiesResult slow =
      ran(head + "time = { end = 400, step = 1, scheme = \"backward_euler\", frames = 1, estimate = false }\n" + rest);
  for (std::size_t p = 0; p < 2; ++p) {
    const bem::Sym2 a = fixed.points[p].stress[0], b = slow.points[p].stress.back();
    const double size = std::abs(a.xx) + std::abs(a.yy) + std::abs(a.xy);
    EXPECT_NEAR(a.xx, b.xx, 0.03 * size) << p;
    EXPECT_NEAR(a.yy, b.yy, 0.03 * size) << p;
    EXPECT_NEAR(a.xy, b.xy, 0.03 * size) << p;
    EXPECT_GT(size, 1e3);
  }
}

TEST(SizesApart, AMillimetreBesideAKilometreInOneScene) {
  // A cube of 1 mm beside one of 1 km, stretched alike: the same strain, at rest and in motion.
  const auto body = [](const std::string& at, const std::string& to, const std::string& top) {
    return "[[body]]\noutline = [[" + at + ", 0], [" + to + ", 0], [" + to + ", " + top + "], [" + at + ", " + top +
           "]]\nelements = 2\nsupport = [{ side = 1, kind = \"roller\" }, { side = 4, kind = \"roller\" }]\nload = [{ "
           "side = 3, traction = [0, 1e3] }]\n";
  };
  const std::string bodies = body("0", "0.001", "0.001") + body("1", "1001", "1000");
  const std::string head = "[rock]\nyoung = 1e9\npoisson = 0.25\n[elastic]\nstress = false\n";
  const BodiesResult still = ran(head + bodies);
  EXPECT_NEAR(still.bodies[0].largest / 1e-3 / (still.bodies[1].largest / 1e3), 1, 1e-9);
  const BodiesResult slow =
      ran(head + "time = { end = 1e4, step = 100, scheme = \"backward_euler\", frames = 1 }\n" + bodies);
  EXPECT_NEAR(slow.bodies[0].largest / still.bodies[0].largest, 1, 1e-4);
  EXPECT_NEAR(slow.bodies[1].largest / still.bodies[1].largest, 1, 1e-4);
}

TEST(PlaneRock, AWrongConstantOfTheRockIsReportedOnce) {
  for (const std::string line : {"young = -1\npoisson = 0.2\n", "young = 1e9\npoisson = 0.7\n"}) {
    const auto scene =
        parse_bodies("[rock]\n" + line + "[[body]]\noutline = [[0, 0], [1, 0], [1, 1], [0, 1]]\n", "s.toml");
    ASSERT_FALSE(scene.has_value());
    EXPECT_EQ(scene.error().size(), 1U) << describe(scene.error().back());
  }
}

}  // namespace
}  // namespace cleave::scene
