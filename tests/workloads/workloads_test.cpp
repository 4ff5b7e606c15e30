/// Small scenes whose block counts are known.

#include "workload_check.hpp"

namespace cleave::support {
namespace {

TEST(WorkloadsTest, Grids) {
  expect_known_count(grid(4));
  expect_known_count(grid(6));
}
TEST(WorkloadsTest, RotatedGrids) {
  expect_known_count(rotated_grid(4));
  expect_known_count(rotated_grid(6));
}
TEST(WorkloadsTest, Rectangles) { expect_known_count(rectangles(13)); }
TEST(WorkloadsTest, RectanglesAThousandAndTenThousandKilometresAway) {
  expect_known_count(far_rectangles(1e6, 1e6));
  expect_known_count(far_rectangles(1e7, 1e7));
}
TEST(WorkloadsTest, CoplanarSquares) {
  expect_known_count(coplanar_squares());
  expect_known_count(rotated_coplanar_squares(), metres(1e-9));
}
TEST(WorkloadsTest, Fan) {
  expect_known_count(fan());
  expect_known_count(rotated_fan(), metres(1e-9));
  expect_known_count(rotated_fan());
}
TEST(WorkloadsTest, ManyPlanesThroughOnePoint) {
  expect_known_count(common_vertex(8));
  expect_known_count(common_vertex(20));
}
TEST(WorkloadsTest, Slivers) {
  expect_known_count(slivers(10, 1e-6));
  expect_known_count(slivers(10, 1e-9));
}
TEST(WorkloadsTest, ContactsAtEdgesAndVertices) { expect_known_count(touching()); }
TEST(WorkloadsTest, Cavities) { expect_known_count(cavities()); }
TEST(WorkloadsTest, Ring) { expect_known_count(ring()); }

}  // namespace
}  // namespace cleave::support
