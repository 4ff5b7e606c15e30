/// Larger scenes whose block counts several exact programs agree on.

#include "workload_check.hpp"

namespace cleave::support {
namespace {

TEST(LargeWorkloadsTest, Grids) {
  expect_known_count(grid(10));
  expect_known_count(grid(20));
  expect_known_count(rotated_grid(10));
  expect_known_count(rotated_grid(20));
}
TEST(LargeWorkloadsTest, PersistentPlanes) {
  expect_known_count(persistent(13));
  expect_known_count(persistent(26));
}
TEST(LargeWorkloadsTest, Rectangles) { expect_known_count(rectangles(50)); }
TEST(LargeWorkloadsTest, Discs) { expect_known_count(discs(1000)); }

}  // namespace
}  // namespace cleave::support
