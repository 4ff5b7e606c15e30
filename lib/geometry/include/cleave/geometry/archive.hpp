#pragma once

#include "cleave/core/archive.hpp"
#include "cleave/geometry/vec3.hpp"

namespace cleave::geometry {

template <class A>
void archive(A& a, Archived<Vec3> auto& v) {
  a(v.x, v.y, v.z);
}

}  // namespace cleave::geometry
