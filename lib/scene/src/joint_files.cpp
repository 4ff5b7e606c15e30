#include "joint_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>
#include <utility>

#include "cleave/core/overloaded.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/geometry/shapes.hpp"
#include "cleave/io/joint_csv.hpp"
#include "cleave/io/mesh.hpp"
#include "file_input.hpp"

namespace cleave::scene {
namespace {

using std::string_view;

/// Each face one joint.
void add_faces(Context& context, const io::MeshData& mesh, const std::string& shown, SetId set,
               std::vector<MeasuredJoint>& joints) {
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    const std::uint32_t line = std::max(1U, mesh.lines[f]);
    auto shape = joint_of(mesh.corners_of(f), context.triangulate);
    if (!shape) {
      context.problems.error_in(shown, line, fmt::format("f (face {})", f + 1), shape.error().what,
                                shape.error().remedy);
      continue;
    }
    joints.push_back({.geometry = std::move(*shape), .set = set, .own = {}, .file = shown, .line = line});
  }
}

/// All faces one joint: a triangulated fault.
void add_surface(Context& context, const io::MeshData& mesh, const std::string& shown, SetId set,
                 std::vector<MeasuredJoint>& joints) {
  topology::Joint surface;
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    auto shape = joint_of(mesh.corners_of(f), context.triangulate);
    if (!shape) {
      context.problems.error_in(shown, std::max(1U, mesh.lines[f]), fmt::format("face {}", f + 1), shape.error().what,
                                shape.error().remedy);
      continue;
    }
    std::ranges::move(shape->polygons, std::back_inserter(surface.polygons));
  }
  if (surface.polygons.empty()) return;
  joints.push_back({.geometry = std::move(surface), .set = set, .own = {}, .file = shown, .line = 1});
}

using Geometry = std::variant<topology::Joint, topology::PersistentJoint>;

std::expected<Geometry, std::string> geometry_of(const io::JointRow& row, const geometry::Attitude& attitude) {
  const geometry::Vec3 at = *row.position;  // parse_joint_csv was asked for it
  const auto single =
      [](std::expected<geometry::Polygon, geometry::ShapeError> polygon) -> std::expected<Geometry, std::string> {
    if (!polygon) return std::unexpected(describe(polygon.error()));
    topology::Joint joint;
    joint.polygons.push_back(std::move(*polygon));
    return joint;
  };
  return std::visit(
      overloaded{[&](const io::Persistent&) -> std::expected<Geometry, std::string> {
                   return topology::PersistentJoint{at, geometry::upward_normal(attitude)};
                 },
                 [&](const io::DiscSize& disc) { return single(geometry::disc(at, attitude, disc.radius)); },
                 [&](const io::RectangleSize& sides) {
                   return single(geometry::rectangle(at, attitude, sides.side_a, sides.side_b, sides.rotation));
                 }},
      row.size);
}

void add_rows(Context& context, const io::JointTable& table, const std::string& shown,
              const std::optional<std::string>& set, std::vector<MeasuredJoint>& joints) {
  for (const io::JointRow& row : table.rows) {
    const geometry::Attitude attitude{row.plane.dip, context.turned(row.plane.direction.degrees())};
    const geometry::Vec3 at = *row.position;
    const bool near = std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)}) <= rule::coordinate.high;
    auto shape = near ? geometry_of(row, attitude)
                      : std::expected<Geometry, std::string>{
                            std::unexpect, "lies further than 1e9 m from the origin; check its numbers"};
    if (!shape) {
      context.problems.error_in(shown, row.line, "row", shape.error(), "");
      continue;
    }
    const std::string name = set ? *set : row.set.empty() ? std::string{"default"} : row.set;
    joints.push_back({.geometry = std::move(*shape),
                      .set = context.set_named(name),
                      .own = {.friction = row.friction, .cohesion = row.cohesion},
                      .file = shown,
                      .line = row.line});
  }
}

}  // namespace

void parse_joint_file(Context& context, const TableReader& joint, const std::optional<std::string>& set,
                      std::vector<MeasuredJoint>& joints) {
  const bool wrap = joint.boolean("wrap").value_or(false);
  const auto loaded = context.file(joint, "file");
  if (!loaded) return;
  const std::string ending = ending_of(loaded->shown);
  if (ending == "csv") {
    const auto table = io::parse_joint_csv(loaded->bytes, loaded->shown, {.wrap = wrap, .need_position = true});
    if (!table) {
      for (const io::ReadError& error : table.error()) report_read_error(context.problems, error);
      return;
    }
    for (const std::string& note : table->notes) context.problems.note_in(loaded->shown, 1, "header", note, "");
    if (joint.has("surface")) joint.error("surface", "has a meaning for meshes only", "remove it");
    add_rows(context, *table, loaded->shown, set, joints);
    return;
  }
  if (wrap) joint.error("wrap", "has a meaning for CSV files only", "remove it");
  const auto mesh = mesh_of(context, joint, "file", *loaded);
  if (!mesh) return;
  const SetId id = context.set_named(set.value_or("default"));
  const bool surface = joint.boolean("surface").value_or(ending != "obj");
  if (!surface) {
    add_faces(context, *mesh, loaded->shown, id, joints);
  } else {
    add_surface(context, *mesh, loaded->shown, id, joints);
  }
}

}  // namespace cleave::scene
