#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "attitude_keys.hpp"
#include "cleave/core/overloaded.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/geometry/polygon.hpp"
#include "cleave/geometry/polygon_holes.hpp"
#include "cleave/scene3d/key_tables.hpp"
#include "context.hpp"
#include "joint_files.hpp"

namespace cleave::scene {
namespace {

using std::string_view;

const KeyTable& disc_keys() {
  static const KeyTable keys = [] {
    KeyTable table{.name = "joint.disc", .keys = {{"centre", key::vector(rule::coordinate), required, "m"}}};
    for (Key& key : attitude_keys(true)) table.keys.push_back(std::move(key));
    table.keys.push_back({"radius", key::number(rule::length), required, "m"});
    table.keys.push_back({"sides", key::whole(3, 1024), "32", "of the regular polygon of the disc's area"});
    return table;
  }();
  return keys;
}

using Geometry = std::variant<topology::Joint, topology::PersistentJoint>;

std::optional<Geometry> parse_plane(const Context& context, const TableReader& joint) {
  const auto table = joint.sub("plane");
  if (!table) return std::nullopt;
  const auto through = table->need_vec3("through");
  const auto attitude = parse_attitude(context, *table);
  if (!through || !attitude) return std::nullopt;
  return topology::PersistentJoint{*through, geometry::upward_normal(*attitude)};
}

std::optional<Geometry> parse_disc(const Context& context, const TableReader& joint) {
  const auto table = joint.sub("disc");
  if (!table) return std::nullopt;
  const auto centre = table->need_vec3("centre");
  const auto attitude = parse_attitude(context, *table);
  const auto radius = table->need_number("radius");
  const std::int64_t sides = table->count("sides");
  if (!centre || !attitude || !radius) return std::nullopt;
  auto polygon = geometry::disc(*centre, *attitude, metres(*radius), static_cast<std::uint32_t>(sides));
  if (!polygon) {
    joint.error("disc", describe(polygon.error()), "");
    return std::nullopt;
  }
  topology::Joint result;
  result.polygons.push_back(std::move(*polygon));
  return result;
}

/// holes = [[[x, y, z], ...], ...] of a polygon.
bool parse_holes(const TableReader& joint, topology::Joint& shape) {
  const TomlEntry* entry = joint.find("holes");
  if (entry == nullptr) return true;
  const auto bad = [&](std::string what, std::string remedy) {
    joint.error("holes", std::move(what), std::move(remedy));
    return false;
  };
  const auto* list = std::get_if<TomlArray>(&entry->node.value);
  if (list == nullptr) {
    return bad("is not a list of outlines", "write holes = [[[x, y, z], [x, y, z], ...], ...]");
  }
  if (shape.polygons.size() != 1) return bad("has a meaning for flat polygons only", "give the surface as triangles");
  std::vector<geometry::Polygon> holes;
  for (std::size_t h = 0; h < list->items.size(); ++h) {
    const auto* outline = std::get_if<TomlArray>(&list->items[h].value);
    std::vector<geometry::Vec3> corners;
    for (std::size_t i = 0; outline != nullptr && i < outline->items.size(); ++i) {
      const auto corner = joint.vec3_of(
          outline->items[i], fmt::format("{}[{}][{}]", joint.path_of("holes"), h + 1, i + 1), rule::coordinate);
      if (!corner) return false;
      corners.push_back(*corner);
    }
    auto polygon = geometry::Polygon::make(std::move(corners));
    if (!polygon) return bad(fmt::format("hole {}: {}", h + 1, describe(polygon.error())), "");
    holes.push_back(std::move(*polygon));
  }
  if (const auto fault = geometry::check_holes(shape.polygons.front(), holes)) return bad(describe(*fault), "");
  shape.holes.push_back(std::move(holes));
  return true;
}

std::optional<Geometry> parse_polygon(const Context& context, const TableReader& joint) {
  auto corners = joint.points("polygon");
  if (!corners) return std::nullopt;
  auto shape = joint_of(std::move(*corners), context.triangulate);
  if (!shape) {
    joint.error("polygon", describe(shape.error()), "");
    return std::nullopt;
  }
  if (!parse_holes(joint, *shape)) return std::nullopt;
  return std::move(*shape);
}

/// terminates_at of all joints, once all names are known.
void resolve_terminations(Context& context, const std::vector<MeasuredJoint>& joints) {
  for (std::size_t j = 0; j < joints.size(); ++j) {
    for (const std::string& name : joints[j].ends_on) {
      const auto at = std::ranges::find(joints, name, &MeasuredJoint::name);
      const auto problem = [&](std::string what, std::string remedy) {
        context.problems.error_in(joints[j].file, joints[j].line, "joint.terminates_at", std::move(what),
                                  std::move(remedy));
      };
      if (at == joints.end()) {
        problem(fmt::format("no joint has the name \"{}\"", name.substr(0, 60)),
                "give a joint that name, or remove it");
        continue;
      }
      const auto* surface = std::get_if<topology::Joint>(&at->geometry);
      if (surface != nullptr && surface->polygons.size() != 1) {
        problem(
            fmt::format("joint \"{}\" is not flat", name.substr(0, 60)),
            "end it on a plane, a disc or a polygon; what passes a curved joint and bounds no block is dropped anyway");
        continue;
      }
      const auto index = static_cast<std::size_t>(at - joints.begin());
      if (index == j) {
        problem("names the joint itself", "remove it");
        continue;
      }
      context.terminations.push_back({topology::JointId{j}, topology::JointId{index}});
    }
  }
}

/// Strength of this joint alone. A file's rows state theirs in columns.
OwnStrength parse_own_strength(const TableReader& joint, bool is_file) {
  OwnStrength own;
  for (const string_view key : {"friction", "cohesion", "tension"}) {
    if (is_file && joint.has(key)) {
      joint.error(key, "belongs to a single joint, not to a file",
                  "write it under [joints.NAME], or as a column of the file");
      return own;
    }
  }
  if (const auto friction = joint.number("friction")) own.friction = FrictionAngle::degrees(*friction);
  if (const auto cohesion = joint.number("cohesion")) own.cohesion = pascals(*cohesion);
  if (const auto tension = joint.number("tension")) own.tension = pascals(*tension);
  return own;
}

}  // namespace

const KeyTable& plane_keys() {
  static const KeyTable keys = [] {
    KeyTable table{.name = "plane",
                   .keys = {{"through", key::vector(rule::coordinate), required, "m, a point of the plane"}}};
    for (Key& key : attitude_keys(true)) table.keys.push_back(std::move(key));
    return table;
  }();
  return keys;
}

const KeyTable& joint_keys() {
  static const KeyTable keys{
      .name = "joint",
      .keys =
          {{"file", key::text(), "",
            "`.obj`: each face one joint; `.csv`: each row one joint (below); `.stl`, `.ply`: the whole surface "
            "one joint; `.dxf`, `.ts`, `.fab`, `.dat`: polygons and surfaces ([formats](formats.md))"},
           {"plane", key::table(&plane_keys), "",
            "`{ through, dip, dip_direction }` (or `trend`, `plunge` of the pole): persistent: cuts the whole domain"},
           {"disc", key::table(&disc_keys), "",
            "`{ centre, dip, dip_direction, radius, sides = 32 }` (or `trend`, `plunge`): regular polygon of the "
            "disc's area"},
           {"polygon", key::points(), "", "`[[x, y, z], ...]`: simple, planar, convex or not"},
           {"holes", key::array(key::points()), "",
            "beside `polygon`: outlines of holes in its plane, strictly inside it and apart from each other"},
           {"set", key::text(), "\"default\"",
            "name of its set; for `.dxf`, `.ts` and `.fab` the layer, object or set that the file names"},
           {"name", key::text(), "", "of a single joint"},
           {"terminates_at", key::texts(), "[]", "names of flat joints: it ends on their planes, below", "ends_on"},
           {"surface", key::flag(), "true of `.stl`, `.ply`",
            "of mesh files: true makes the whole mesh one joint, false each face a joint of its own"},
           {"wrap", key::flag(), "false", "of CSV files: accept dips and directions outside 0..90 and 0..360"},
           declination_key(),
           {"friction", key::number(rule::friction), "that of its set",
            "degrees, of this joint alone (not of files: there it is a column)"},
           {"cohesion", key::number(rule::strength), "that of its set", "Pa, of this joint alone"},
           {"tension", key::number(rule::strength), "that of its set", "Pa, of this joint alone"}},
      .one_of = {{"file", "plane", "disc", "polygon"}}};
  return keys;
}

std::expected<topology::Joint, geometry::PolygonError> joint_of(std::vector<geometry::Vec3> corners, bool triangulate) {
  topology::Joint joint;
  auto polygon = geometry::Polygon::make(corners);
  if (polygon) {
    joint.polygons.push_back(std::move(*polygon));
    return joint;
  }
  if (triangulate && std::holds_alternative<geometry::NotPlanar>(polygon.error())) {
    auto triangles = geometry::Polygon::triangulated(std::move(corners));
    if (triangles) {
      joint.polygons = std::move(*triangles);
      return joint;
    }
    return std::unexpected(triangles.error());
  }
  return std::unexpected(polygon.error());
}

void parse_joints(Context& context, const TableReader& root, std::vector<MeasuredJoint>& joints) {
  for (const TableReader& joint : root.each("joint")) {
    const auto set = joint.text("set");
    const auto name = joint.text("name");
    const auto ends_on = joint.texts("terminates_at").value_or(std::vector<std::string>{});
    const TomlEntry* kind = joint.one_of();
    if (kind == nullptr) continue;
    for (const string_view key : {"wrap", "declination", "surface"}) {
      if (joint.has(key) && kind->key != "file") joint.error(key, "has a meaning for files only", "remove it");
    }
    if (joint.has("holes") && kind->key != "polygon") {
      joint.error("holes", "has a meaning for polygons only", "remove it");
    }
    if (name && kind->key == "file") joint.error("name", "has a meaning for a single joint only", "remove it");
    if (name && std::ranges::find(joints, *name, &MeasuredJoint::name) != joints.end()) {
      joint.error("name", fmt::format("\"{}\" is the name of another joint", name->substr(0, 60)), "choose another");
    }
    const std::size_t before = joints.size();
    const OwnStrength own = parse_own_strength(joint, kind->key == "file");
    if (kind->key == "file") {
      parse_joint_file(context, joint, set, joints);
    } else {
      auto geometry = kind->key == "plane"  ? parse_plane(context, joint)
                      : kind->key == "disc" ? parse_disc(context, joint)
                                            : parse_polygon(context, joint);
      if (!geometry) continue;
      joints.push_back({.geometry = std::move(*geometry),
                        .set = context.set_named(set.value_or("default")),
                        .own = own,
                        .file = context.problems.file(),
                        .line = kind->line,
                        .name = name.value_or(std::string{}),
                        .ends_on = {}});
    }
    for (std::size_t j = before; j < joints.size(); ++j) joints[j].ends_on = ends_on;
  }
  resolve_terminations(context, joints);
}

}  // namespace cleave::scene
