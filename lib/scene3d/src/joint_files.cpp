#include "joint_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>
#include <utility>
#include <variant>

#include "cleave/core/overloaded.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/geometry/polygon.hpp"
#include "cleave/io/joint_csv.hpp"
#include "cleave/io/mesh.hpp"
#include "cleave/scene/file_input.hpp"

namespace cleave::scene {
namespace {

using std::string_view;

/// The faces of a mesh as polygons. What is wrong with one is reported, but for those without area: they separate
/// nothing, and programs that cut faces into triangles write them (ours, too, where a corner lies on a side). They are
/// left out, and that is said.
class FaceReader final {
 public:
  FaceReader(Context& context, const io::MeshData& mesh, const std::string& shown)
      : context_{&context}, mesh_{&mesh}, shown_{&shown} {}

  std::optional<topology::Joint> operator()(std::size_t f) {
    auto shape = joint_of(mesh_->corners_of(f), context_->triangulate);
    if (shape) return std::move(*shape);
    if (std::holds_alternative<geometry::ZeroArea>(shape.error())) {
      if (flat_++ == 0) first_flat_ = f;
    } else {
      report(f, shape.error());
    }
    return std::nullopt;
  }

  void end() const {
    if (flat_ == 0) return;
    if (flat_ == mesh_->faces()) return report(first_flat_, geometry::ZeroArea{});
    context_->problems.note_in(
        *shown_, line_of(first_flat_), key_of(first_flat_),
        fmt::format("{} of {} faces have no area and are left out, this is the first", flat_, mesh_->faces()), "");
  }

 private:
  void report(std::size_t f, const geometry::PolygonError& error) const {
    context_->problems.error_in(*shown_, line_of(f), key_of(f), describe(error), "");
  }
  [[nodiscard]] std::uint32_t line_of(std::size_t f) const { return std::max(1U, mesh_->lines[f]); }
  [[nodiscard]] std::string key_of(std::size_t f) const {
    const bool obj = extension_of(*shown_) == "obj";
    return obj ? fmt::format("f (face {})", f + 1) : fmt::format("face {}", f + 1);
  }

  Context* context_;
  const io::MeshData* mesh_;
  const std::string* shown_;
  std::size_t flat_ = 0, first_flat_ = 0;
};

/// Each face one joint, of the set that `set_of` gives for its group.
template <class SetOf>
void add_faces(Context& context, const io::MeshData& mesh, const std::string& shown, SetOf&& set_of,
               std::vector<MeasuredJoint>& joints) {
  FaceReader read{context, mesh, shown};
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    auto shape = read(f);
    if (!shape) continue;
    joints.push_back({.geometry = std::move(*shape),
                      .set = set_of(mesh.group[f]),
                      .own = {},
                      .file = shown,
                      .line = std::max(1U, mesh.lines[f])});
  }
  read.end();
}

/// The faces of each group one joint: a triangulated fault.
template <class SetOf>
void add_surfaces(Context& context, const io::MeshData& mesh, const std::string& shown, SetOf&& set_of,
                  std::vector<MeasuredJoint>& joints) {
  std::vector<topology::Joint> surfaces(mesh.groups.size());
  std::vector<std::uint32_t> lines(mesh.groups.size(), 0);
  FaceReader read{context, mesh, shown};
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    auto shape = read(f);
    if (!shape) continue;
    const std::uint32_t g = mesh.group[f];
    if (surfaces[g].polygons.empty()) lines[g] = std::max(1U, mesh.lines[f]);
    std::ranges::move(shape->polygons, std::back_inserter(surfaces[g].polygons));
  }
  read.end();
  for (std::uint32_t g = 0; g < surfaces.size(); ++g) {
    if (surfaces[g].polygons.empty()) continue;
    joints.push_back(
        {.geometry = std::move(surfaces[g]), .set = set_of(g), .own = {}, .file = shown, .line = lines[g]});
  }
}

/// All faces in one group.
io::MeshData ungrouped(io::MeshData mesh) {
  std::ranges::fill(mesh.group, 0U);
  mesh.groups = {""};
  return mesh;
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

/// `declination`: degrees.
void add_rows(Context& context, const io::JointTable& table, const std::string& shown,
              const std::optional<std::string>& set, double declination, std::vector<MeasuredJoint>& joints) {
  const auto other = [&](const io::JointRow& row) { return set && !row.set.empty() && row.set != *set; };
  if (const auto row = std::ranges::find_if(table.rows, other); row != table.rows.end()) {
    context.problems.note_in(
        shown, row->line, "set",
        fmt::format("names {0}, but the joint has set = \"{1}\": all rows are of {1}", row->set, *set),
        "remove set from the joint to take the sets of the rows");
  }
  for (const io::JointRow& row : table.rows) {
    const geometry::Attitude attitude{row.plane.dip, context.turned(row.plane.direction.degrees() + declination)};
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
                      .own = {.friction = row.friction, .cohesion = row.cohesion, .tension = row.tension},
                      .file = shown,
                      .line = row.line});
  }
}

/// One note for a column of numbers that are none of the usual ones, at the first of them. `stated`: the header names
/// their unit.
template <class ValueOf>
void note_unusual(Problems& problems, const io::JointTable& table, const std::string& shown, string_view column,
                  bool stated, const NumberRule& rule, ValueOf&& value_of) {
  std::size_t count = 0;
  std::uint32_t line = 0;
  double first = 0;
  for (const io::JointRow& row : table.rows) {
    const std::optional<double> value = value_of(row);
    if (!value || rule.is_usual(*value)) continue;
    if (count++ > 0) continue;
    line = row.line;
    first = *value;
  }
  if (count == 0) return;
  const auto unit = likely_unit(first, rule);
  problems.note_in(
      shown, line, std::string{column},
      fmt::format("is {}{}, which is far from usual ({:g} to {:g}){}", first, rule.unit, rule.usual->low,
                  rule.usual->high, count > 1 ? fmt::format(", and so are {} rows in all", count) : std::string{}),
      stated ? std::string{"check the unit that the header states"}
      : unit ? fmt::format("if it is meant in {0}, name the column \"{1} ({0})\"", *unit, column)
             : std::string{"it is taken as it stands: check it"});
}

void note_unusual_strengths(Problems& problems, const io::JointTable& table, const std::string& shown) {
  note_unusual(problems, table, shown, "friction", table.friction_unit, rule::friction, [](const io::JointRow& row) {
    return row.friction ? std::optional{row.friction->degrees()} : std::nullopt;
  });
  const auto stress = [](const std::optional<Stress>& of) { return of ? std::optional{of->si()} : std::nullopt; };
  note_unusual(problems, table, shown, "cohesion", table.cohesion_unit, rule::strength,
               [&](const io::JointRow& row) { return stress(row.cohesion); });
  note_unusual(problems, table, shown, "tension", table.tension_unit, rule::strength,
               [&](const io::JointRow& row) { return stress(row.tension); });
}

}  // namespace

void parse_joint_file(Context& context, const TableReader& joint, const std::optional<std::string>& set,
                      std::vector<MeasuredJoint>& joints) {
  const bool wrap = joint.boolean("wrap").value_or(false);
  const auto loaded = context.file(joint, "file");
  if (!loaded) return;
  const std::string extension = extension_of(loaded->shown);
  if (extension == "csv") {
    const auto table = io::parse_joint_csv(loaded->bytes, loaded->shown, {.wrap = wrap, .need_position = true});
    if (!table) {
      for (const io::ReadError& error : table.error()) report_read_error(context.problems, error);
      return;
    }
    for (const std::string& note : table->notes) context.problems.note_in(loaded->shown, 1, "header", note, "");
    note_unusual_strengths(context.problems, *table, loaded->shown);
    if (joint.has("surface")) joint.error("surface", "has a meaning for meshes only", "remove it");
    add_rows(context, *table, loaded->shown, set, joint.value("declination"), joints);
    return;
  }
  if (wrap) joint.error("wrap", "has a meaning for CSV files only", "remove it");
  if (joint.has("declination")) joint.error("declination", "has a meaning for CSV files only", "remove it");
  if (is_surfaces(extension)) {
    const auto surfaces = surfaces_of(context, *loaded);
    if (!surfaces) return;
    const auto set_among = [&](const std::vector<std::string>& groups) {
      return [&context, &set, &groups](std::uint32_t group) {
        const std::string& own = groups[group];
        // "0" is the layer of what nobody put on a layer
        return context.set_named(set ? *set : own.empty() || own == "0" ? std::string{"default"} : own);
      };
    };
    add_faces(context, surfaces->polygons, loaded->shown, set_among(surfaces->polygons.groups), joints);
    add_surfaces(context, surfaces->surfaces, loaded->shown, set_among(surfaces->surfaces.groups), joints);
    return;
  }
  auto mesh = mesh_of(context, joint, "file", *loaded);
  if (!mesh) return;
  const std::size_t all = mesh->faces();
  *mesh = io::without_faces_between_parts(*std::move(mesh));
  if (const std::size_t left_out = all - mesh->faces(); left_out > 0) {
    context.problems.note_in(
        loaded->shown, 1, "g",
        fmt::format("{} of {} faces lie between the parts of a block with cavities (block_N and block_N_part_2): they "
                    "are no joints and are left out",
                    left_out, all),
        "");
  }
  const SetId id = context.set_named(set.value_or("default"));
  const bool surface = joint.boolean("surface").value_or(extension != "obj");
  const auto one_set = [id](std::uint32_t) { return id; };
  if (!surface) {
    add_faces(context, *mesh, loaded->shown, one_set, joints);
  } else {
    add_surfaces(context, ungrouped(*mesh), loaded->shown, one_set, joints);
  }
}

}  // namespace cleave::scene
