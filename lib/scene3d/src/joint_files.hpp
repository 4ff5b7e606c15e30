#pragma once

#include <expected>
#include <optional>
#include <string>
#include <vector>

#include "cleave/facets/cut_input.hpp"
#include "cleave/geometry/polygon.hpp"
#include "cleave/geometry/vec3.hpp"
#include "context.hpp"

namespace cleave::scene {

/// A joint of one polygon; a bent one becomes triangles when that is wished.
[[nodiscard]] std::expected<topology::Joint, geometry::PolygonError> joint_of(std::vector<geometry::Vec3> corners,
                                                                              bool triangulate);

/// The joints of the file that `joint` names: .obj one a face, .csv one a row, .stl and .ply one surface; .dxf, .ts and
/// .fab what io::Surfaces says, of the set that the layer, object or set of the file is called when `set` is empty.
void parse_joint_file(Context& context, const TableReader& joint, const std::optional<std::string>& set,
                      std::vector<MeasuredJoint>& joints);

}  // namespace cleave::scene
