#include "field_stress.hpp"

#include <gtest/gtest.h>

#include "shapes.hpp"

namespace cleave::bem {
namespace {

TEST(FieldStress, RadialJointsOfACircularTunnelCarryKirschsHoopStress) {
  // Hydrostatic stress p: hoop stress -p (1 + 1/r^2), so a radial face from r = 1 to 2 carries 1.5 p and no shear.
  const double p = 3e6;
  Region region{.material = testing::material(60e9, 0.25, 2700),
                .loops = {circle({0, 0}, 1, true, 0, 48)},
                .conditions = {free_surface()}};
  Problem problem{.regions = {region}, .extent = Extent::plane};
  problem.in_situ.stress = {-p, 0, -p};
  const Solution s = solve(problem, {}).value();
  const auto at = [](double r, double t) { return r * Vec2{std::cos(t), std::sin(t)}; };
  // Roof block between two radial joints that meet the roof at 80 and 100 degrees; the block on the left of each.
  const double friction = 0.5;
  const std::vector<BlockFace> faces{
      {at(1.0001, 1.4), at(2, 1.4), friction, 0},
      {at(2, std::numbers::pi - 1.4), at(1.0001, std::numbers::pi - 1.4), friction, 1e4}};
  const auto f = forces_on_faces(s, 0, faces);
  for (const FaceForces& face : f) {
    EXPECT_NEAR(face.normal / (1.5 * p), 1, 2e-4);
    EXPECT_NEAR(face.shear / p, 0, 1e-4);
  }
  const double weight = 2e4;
  const ClampedFactors factors = factors_of_safety(faces, f, {0, -weight});
  EXPECT_NEAR(factors.without, std::sin(1.4) * 1e4 * f[1].length / weight, 1e-9);
  const double clamping = std::sin(1.4) * 1.5 * p * (f[0].length + f[1].length) * std::tan(friction) / weight;
  EXPECT_NEAR((factors.with - factors.without) / clamping, 1, 2e-4);
  // In uniaxial horizontal stress the wall is in tension: no clamping there.
  problem.in_situ.stress = {-p, 0, 0};
  const Solution u = solve(problem, {}).value();
  const std::vector<BlockFace> wall{{at(1.0001, 0), at(1.1, 0), friction, 0}};
  const auto pulled = forces_on_faces(u, 0, wall);
  EXPECT_LT(pulled[0].normal, 0);
  EXPECT_EQ(factors_of_safety(wall, pulled, {1, 0}).with, 0);
  EXPECT_TRUE(std::isinf(factors_of_safety(wall, pulled, {}).with));
}

}  // namespace
}  // namespace cleave::bem
