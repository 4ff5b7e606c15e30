#pragma once

#include "cleave/geometry/archive.hpp"
#include "cleave/motion/world.hpp"

namespace cleave::motion {

template <class A>
void archive(A& a, Archived<Turn> auto& t) {
  a(t.w, t.x, t.y, t.z);
}

}  // namespace cleave::motion
