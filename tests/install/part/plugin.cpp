#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"

/// A plug-in of somebody else: the archives must go into a shared object.
extern "C" int blocks_of_a_cut_cube() {
  using namespace cleave;
  const geometry::Vec3 m{1, 1, 1}, x{1.5, 0, 0}, y{0, 1.5, 0};
  const topology::CutInput scene{
      .domain = geometry::make_box({0, 0, 0}, {2, 2, 2}).value(),
      .joints = {topology::Joint{{geometry::Polygon::make({m - x - y, m + x - y, m + x + y, m - x + y}).value()}}}};
  const auto blocks = topology::cut(scene);
  if (!blocks || !topology::audit(*blocks)) return -1;
  return blocks->blocks()[topology::BlockId{0}].fixed ? static_cast<int>(blocks->blocks().size()) : -2;
}
