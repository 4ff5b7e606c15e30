/// Any bytes as OBJ, STL, PLY and as a table of joints: no crash; what is read is written and read back the same; each
/// face is a polygon or has a reason not to be; a closed surface is closed when looked at again.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <ranges>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cleave/core/assert.hpp"
#include "cleave/geometry/polygon.hpp"
#include "cleave/geometry/solid.hpp"
#include "cleave/geometry/triangulate.hpp"
#include "cleave/io/joint_csv.hpp"
#include "cleave/io/mesh.hpp"
#include "fuzz_target.hpp"

namespace {

using namespace cleave;
using geometry::Vec3;
using io::MeshData;

void check_round_trips(const MeshData& mesh) {
  MeshData plain = mesh;
  plain.lines.clear();
  plain.notes.clear();

  auto obj = io::parse_obj(io::write_obj(mesh), "again");
  const bool has_empty_face = std::ranges::any_of(std::views::iota(std::size_t{0}, mesh.faces()),
                                                  [&](std::size_t f) { return mesh.face(f).empty(); });
  CLEAVE_ASSERT(obj.has_value() || has_empty_face);  // PLY may hold faces without corners
  if (obj) {
    CLEAVE_ASSERT(obj->vertices == plain.vertices);
    CLEAVE_ASSERT(obj->corners == plain.corners && obj->ends == plain.ends);
    CLEAVE_ASSERT(obj->group.size() == plain.group.size());
  }
  const auto ply = io::parse_ply(io::write_ply(mesh), "again");
  CLEAVE_ASSERT(ply.has_value());
  CLEAVE_ASSERT(ply->vertices == plain.vertices && ply->corners == plain.corners && ply->ends == plain.ends);
}

void check_polygons(const MeshData& mesh) {
  const std::size_t most = std::min<std::size_t>(mesh.faces(), 200);
  for (std::size_t f = 0; f < most; ++f) {
    if (mesh.face(f).size() > 200) continue;
    const std::vector<Vec3> corners = mesh.corners_of(f);
    const auto polygon = geometry::Polygon::make(corners);
    if (!polygon) CLEAVE_ASSERT(!describe(polygon.error()).empty());
    const bool bent = !polygon && std::holds_alternative<geometry::NotPlanar>(polygon.error());
    const auto pieces = geometry::Polygon::triangulated(corners);
    CLEAVE_ASSERT(pieces.has_value() == (polygon.has_value() || bent));
    if (polygon) {
      const std::span<const Vec3> ring = polygon->corners();
      CLEAVE_ASSERT(pieces->size() == ring.size() - 2);
      // the same polygon from another corner and in the other sense
      std::vector<Vec3> turned{ring.begin(), ring.end()};
      std::ranges::rotate(turned, turned.begin() + 1);
      std::ranges::reverse(turned);
      const auto again = geometry::Polygon::make(turned);
      // planarity alone may differ by rounding at its limit
      CLEAVE_ASSERT(again.has_value() ? again->convex() == polygon->convex()
                                      : std::holds_alternative<geometry::NotPlanar>(again.error()));
    }
  }
}

void check_solid(const MeshData& mesh) {
  if (mesh.faces() > 400 || mesh.corners.size() > 2000) return;
  const auto solid = io::solid_of(mesh);
  if (!solid) {
    CLEAVE_ASSERT(!describe(solid.error()).empty());
    return;
  }
  CLEAVE_ASSERT(solid->volume() > cubic_metres(0));
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  for (const geometry::SolidFace& face : solid->faces()) {
    for (std::size_t i = 0; i < face.corners.size(); ++i) {
      ++uses[{face.corners[i], face.corners[(i + 1) % face.corners.size()]}];
    }
  }
  for (const auto& [edge, count] : uses) {
    CLEAVE_ASSERT(count == 1);
    CLEAVE_ASSERT(uses.contains({edge.second, edge.first}));
  }
  // turned inside out it is refused, and for that reason
  std::vector<geometry::SolidFace> faces{solid->faces().begin(), solid->faces().end()};
  for (geometry::SolidFace& face : faces) std::ranges::reverse(face.corners);
  const auto inside_out = geometry::Solid::make({solid->vertices().begin(), solid->vertices().end()}, std::move(faces),
                                                {solid->tags().begin(), solid->tags().end()});
  CLEAVE_ASSERT(!inside_out.has_value());
  // (A solid whose volume is within rounding of zero may as well have none when its faces are summed the other way
  // round.)
  CLEAVE_ASSERT(std::holds_alternative<geometry::InsideOut>(inside_out.error()) ||
                std::holds_alternative<geometry::NoVolume>(inside_out.error()));
}

void check_mesh(const std::expected<MeshData, io::ReadError>& mesh) {
  if (!mesh) {
    CLEAVE_ASSERT(!mesh.error().what.empty() && !mesh.error().remedy.empty());
    return;
  }
  CLEAVE_ASSERT(mesh->faces() > 0 && mesh->group.size() == mesh->faces() && mesh->ends.back() == mesh->corners.size());
  for (const std::uint32_t corner : mesh->corners) CLEAVE_ASSERT(corner < mesh->vertices.size());
  for (const std::uint32_t group : mesh->group) CLEAVE_ASSERT(group < mesh->groups.size());
  check_round_trips(*mesh);
  check_polygons(*mesh);
  check_solid(*mesh);
}

void check_table(std::string_view text, bool wrap, bool need_position) {
  auto table = io::parse_joint_csv(text, "fuzz.csv", {.wrap = wrap, .need_position = need_position});
  if (!table) {
    CLEAVE_ASSERT(!table.error().empty() && table.error().size() <= 20);
    return;
  }
  auto again =
      io::parse_joint_csv(io::write_joint_csv(*table), "again", {.wrap = false, .need_position = need_position});
  CLEAVE_ASSERT(again.has_value());
  CLEAVE_ASSERT(again->rows.size() == table->rows.size());
  for (std::size_t i = 0; i < table->rows.size(); ++i) {
    table->rows[i].line = again->rows[i].line;
    CLEAVE_ASSERT(table->rows[i] == again->rows[i]);
  }
}

}  // namespace

CLEAVE_FUZZ_TARGET(bytes) {
  const std::string text(bytes.begin(), bytes.end());
  check_mesh(io::parse_obj(text, "fuzz.obj"));
  check_mesh(io::parse_stl(text, "fuzz.stl"));
  check_mesh(io::parse_ply(text, "fuzz.ply"));
  check_table(text, false, true);
  check_table(text, true, false);
}
