#pragma once

#include "cleave/core/id.hpp"

namespace cleave::topology {

using PlaneId = Id<struct PlaneTag>;  ///< one a distinct plane; coplanar joints share it
using JointId = Id<struct JointTag>;  ///< a joint of the scene, in scene order
using VertexId = Id<struct VertexTag>;
using FaceId = Id<struct FaceTag>;  ///< a face of one block (not shared)
using BlockId = Id<struct BlockTag>;

}  // namespace cleave::topology
