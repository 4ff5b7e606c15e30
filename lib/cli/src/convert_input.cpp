#include "convert_input.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/core/overloaded.hpp"
#include "cleave/geometry/polygon.hpp"
#include "cleave/io/bodies.hpp"
#include "cleave/io/file.hpp"
#include "cleave/io/joint_csv.hpp"
#include "cleave/io/mesh.hpp"
#include "cleave/load/load.hpp"
#include "cleave/realize/run.hpp"
#include "commands.hpp"

namespace cleave::cli {
namespace {

using geometry::Vec3;

std::string message_of(const io::ReadError& error) {
  return fmt::format("{}:{}: file: {}; {}", error.file, error.line.value_or(1), error.what, error.remedy);
}

/// Adds a cell from its faces; its volume by the divergence theorem about its first corner.
void add_cell(report::Cells& cells, std::span<const std::int64_t> stream, std::uint32_t block) {
  const std::size_t first = cells.connectivity.size();
  const Vec3 origin = cells.points[static_cast<std::size_t>(stream[2])];
  double six_volumes = 0;
  std::size_t at = 1;
  for (std::int64_t f = 0; f < stream[0]; ++f) {
    const auto count = static_cast<std::size_t>(stream[at]);
    const auto face = stream.subspan(at + 1, count);
    const auto place = [&](std::size_t i) { return cells.points[static_cast<std::size_t>(face[i])] - origin; };
    for (std::size_t i = 1; i + 1 < count; ++i) six_volumes += dot(place(0), cross(place(i), place(i + 1)));
    cells.connectivity.insert(cells.connectivity.end(), face.begin(), face.end());
    at += count + 1;
  }
  cells.face_stream.insert(cells.face_stream.end(), stream.begin(), stream.end());
  cells.face_ends.push_back(static_cast<std::int64_t>(cells.face_stream.size()));
  const auto begin = cells.connectivity.begin() + static_cast<std::ptrdiff_t>(first);
  std::sort(begin, cells.connectivity.end());
  cells.connectivity.erase(std::unique(begin, cells.connectivity.end()), cells.connectivity.end());
  cells.ends.push_back(static_cast<std::int64_t>(cells.connectivity.size()));
  cells.block.push_back(topology::BlockId{block});
  cells.volume.push_back(six_volumes / 6);
}

report::Cells cells_of(const io::Polyhedra& polyhedra) {
  report::Cells cells;
  cells.points = polyhedra.points;
  std::size_t begin = 0;
  for (std::size_t c = 0; c < polyhedra.size(); ++c) {
    const auto end = static_cast<std::size_t>(polyhedra.face_ends[c]);
    add_cell(cells, std::span{polyhedra.face_stream}.subspan(begin, end - begin), polyhedra.block[c]);
    begin = end;
  }
  return cells;
}

/// Both parts of a drawing as one mesh.
io::MeshData joined(io::Surfaces surfaces) {
  io::MeshData mesh = std::move(surfaces.surfaces);
  const io::MeshData& more = surfaces.polygons;
  const auto points = static_cast<std::uint32_t>(mesh.vertices.size());
  const auto groups = static_cast<std::uint32_t>(mesh.groups.size());
  const auto corners = static_cast<std::uint32_t>(mesh.corners.size());
  mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (const std::uint32_t corner : more.corners) mesh.corners.push_back(points + corner);
  for (const std::uint32_t end : more.ends) mesh.ends.push_back(corners + end);
  for (const std::uint32_t group : more.group) mesh.group.push_back(groups + group);
  mesh.groups.insert(mesh.groups.end(), more.groups.begin(), more.groups.end());
  mesh.lines.insert(mesh.lines.end(), more.lines.begin(), more.lines.end());
  mesh.notes = std::move(surfaces.notes);
  return mesh;
}

using Mesh = std::expected<io::MeshData, std::string>;

Mesh mesh_of_table(const std::string& bytes, const std::string& in) {
  const auto table = io::parse_joint_csv(bytes, in);
  if (!table) return std::unexpected(message_of(table.error().front()));
  io::MeshData mesh;
  mesh.notes = table->notes;
  for (const io::JointRow& row : table->rows) {
    const auto fail = [&](const std::string& what) {
      return std::unexpected(fmt::format("{}:{}: row: {}", in, row.line, what));
    };
    using Polygon = std::expected<geometry::Polygon, geometry::ShapeError>;
    const auto polygon = std::visit(
        overloaded{[](const io::Persistent&) -> std::optional<Polygon> { return std::nullopt; },
                   [&](const io::DiscSize& disc) -> std::optional<Polygon> {
                     return geometry::disc(*row.position, row.plane, disc.radius);
                   },
                   [&](const io::RectangleSize& sides) -> std::optional<Polygon> {
                     return geometry::rectangle(*row.position, row.plane, sides.side_a, sides.side_b, sides.rotation);
                   }},
        row.size);
    if (!polygon) return fail("a persistent joint has no outline; give its radius, or side_a and side_b");
    if (!*polygon) return fail(describe(polygon->error()));
    auto group = std::ranges::find(mesh.groups, row.set);
    if (group == mesh.groups.end()) group = mesh.groups.insert(group, row.set);
    for (const Vec3& corner : (*polygon)->corners()) {
      mesh.corners.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
      mesh.vertices.push_back(corner);
    }
    mesh.ends.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
    mesh.group.push_back(static_cast<std::uint32_t>(group - mesh.groups.begin()));
    mesh.lines.push_back(row.line);
  }
  return mesh;
}

template <class Parsed>
Mesh checked(Parsed parsed) {
  if (!parsed) return std::unexpected(message_of(parsed.error()));
  if constexpr (std::is_same_v<typename Parsed::value_type, io::Surfaces>) {
    return joined(std::move(*parsed));
  } else {
    return std::move(*parsed);
  }
}

/// Nothing when the ending is not known.
std::optional<Mesh> mesh_of_file(const std::string& extension, const std::string& bytes, const std::string& in) {
  if (extension == ".obj") return checked(io::parse_obj(bytes, in));
  if (extension == ".stl") return checked(io::parse_stl(bytes, in));
  if (extension == ".ply") return checked(io::parse_ply(bytes, in));
  if (extension == ".dxf") return checked(io::parse_dxf(bytes, in));
  if (extension == ".ts") return checked(io::parse_tsurf(bytes, in));
  if (extension == ".fab") return checked(io::parse_fab(bytes, in));
  if (extension == ".dat") return checked(io::parse_dfnworks_polygons(bytes, in));
  if (extension == ".csv") return mesh_of_table(bytes, in);
  return std::nullopt;
}

/// The faces of one group, with vertices of their own.
io::MeshData part_of(const io::MeshData& mesh, const std::vector<std::size_t>& faces) {
  io::MeshData part;
  part.groups = {mesh.groups[mesh.group[faces.front()]]};
  std::map<std::uint32_t, std::uint32_t> numbers;
  for (const std::size_t f : faces) {
    for (const std::uint32_t corner : mesh.face(f)) {
      const auto [at, is_new] = numbers.try_emplace(corner, static_cast<std::uint32_t>(part.vertices.size()));
      if (is_new) part.vertices.push_back(mesh.vertices[corner]);
      part.corners.push_back(at->second);
    }
    part.ends.push_back(static_cast<std::uint32_t>(part.corners.size()));
    part.group.push_back(0);
    part.lines.push_back(mesh.lines[f]);
  }
  return part;
}

std::vector<std::vector<std::uint32_t>> faces_of(const io::MeshData& part) {
  std::vector<std::vector<std::uint32_t>> faces;
  for (std::size_t f = 0; f < part.faces(); ++f) faces.emplace_back(part.face(f).begin(), part.face(f).end());
  return faces;
}

/// By the numbers of its vertices: every edge is used once in each direction. A block that touches itself along an
/// edge is closed in this sense where the file doubles the vertices of that edge, as ours do.
bool is_closed(const io::MeshData& part) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (std::size_t f = 0; f < part.faces(); ++f) {
    const auto face = part.face(f);
    if (face.size() < 3) return false;
    for (std::size_t i = 0; i < face.size(); ++i) {
      if (!edges.emplace(face[i], face[(i + 1) % face.size()]).second) return false;
    }
  }
  return part.faces() >= 4 &&
         std::ranges::all_of(edges, [&](const auto& edge) { return edges.contains({edge.second, edge.first}); });
}

/// Adds a cell; its volume. A cell without volume is not kept.
double add_block(report::Cells& cells, std::span<const Vec3> points,
                 const std::vector<std::vector<std::uint32_t>>& faces, std::uint32_t block) {
  const auto first = static_cast<std::int64_t>(cells.points.size());
  std::vector<std::int64_t> stream{static_cast<std::int64_t>(faces.size())};
  for (const auto& face : faces) {
    stream.push_back(static_cast<std::int64_t>(face.size()));
    for (const std::uint32_t corner : face) stream.push_back(first + corner);
  }
  cells.points.insert(cells.points.end(), points.begin(), points.end());
  add_cell(cells, stream, block);
  const double volume = cells.volume.back();
  if (volume > 0) return volume;
  cells.points.resize(static_cast<std::size_t>(first));
  cells.face_stream.resize(cells.face_stream.size() - stream.size());
  cells.face_ends.pop_back();
  cells.ends.pop_back();
  cells.connectivity.resize(cells.ends.empty() ? 0 : static_cast<std::size_t>(cells.ends.back()));
  cells.block.pop_back();
  cells.volume.pop_back();
  return volume;
}

/// What of an endless plane lies in a box: the plane's square around the box's centre, cut by its sides.
std::vector<Vec3> plane_in_box(const topology::PersistentJoint& plane, Vec3 low, Vec3 high) {
  const Vec3 middle = 0.5 * (low + high);
  const double reach = norm(high - low);
  const Vec3 n = normalized(plane.normal);
  const Vec3 foot = middle - dot(middle - plane.through, n) * n;
  const Vec3 u = normalized(std::abs(n.z) < 0.9 ? cross(n, {0, 0, 1}) : cross(n, {1, 0, 0})), v = cross(n, u);
  std::vector<Vec3> corners;
  for (const auto& [a, b] : std::array<std::pair<double, double>, 4>{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}}) {
    corners.push_back(foot + (reach * a) * u + (reach * b) * v);
  }
  const auto cut = [&](auto&& inside) {  // >= 0 inside
    std::vector<Vec3> kept;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vec3 p = corners[i], q = corners[(i + 1) % corners.size()];
      const double at_p = inside(p), at_q = inside(q);
      if (at_p >= 0) kept.push_back(p);
      if ((at_p > 0 && at_q < 0) || (at_p < 0 && at_q > 0)) kept.push_back(p + at_p / (at_p - at_q) * (q - p));
    }
    corners = std::move(kept);
  };
  cut([&](Vec3 p) { return p.x - low.x; });
  cut([&](Vec3 p) { return high.x - p.x; });
  cut([&](Vec3 p) { return p.y - low.y; });
  cut([&](Vec3 p) { return high.y - p.y; });
  cut([&](Vec3 p) { return p.z - low.z; });
  cut([&](Vec3 p) { return high.z - p.z; });
  return corners;
}

/// The joints of one realization; a joint of several polygons is as many faces.
std::expected<ConvertInput, std::string> network_of_scene(const std::string& in, std::uint64_t realization) {
  const auto first = [](const std::vector<scene::Problem>& problems) { return describe(problems.front()); };
  const auto scene = scene::load_blocks(in);
  if (!scene) return std::unexpected(first(scene.error()));
  const auto drawn = scene::sample(*scene, realization);
  if (!drawn) return std::unexpected(first(drawn.error()));
  ConvertInput input{io::MeshData{}, {}};
  auto& mesh = std::get<io::MeshData>(input.content);
  for (const scene::SetInfo& set : drawn->sets) mesh.groups.push_back(set.name);
  const auto add = [&](std::span<const Vec3> corners, scene::SetId set) {
    for (const Vec3& corner : corners) {
      mesh.corners.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
      mesh.vertices.push_back(corner);
    }
    mesh.ends.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
    mesh.group.push_back(static_cast<std::uint32_t>(set.index()));
    mesh.lines.push_back(0);
  };
  // A little beyond the domain, so that the end of a plane cuts nothing.
  const auto [low, high] = geometry::box_of(scene->domain.vertices());
  const Vec3 margin = 0.01 * (high - low);
  std::size_t planes = 0, outside = 0, several = 0;
  for (const topology::JointId id : drawn->joints.ids()) {
    const scene::SetId set = drawn->joints[id].set;
    std::visit(overloaded{[&](const topology::Joint& joint) {
                            several += joint.polygons.size() > 1 ? 1U : 0U;
                            for (const auto& polygon : joint.polygons) add(polygon.corners(), set);
                          },
                          [&](const topology::PersistentJoint& plane) {
                            ++planes;
                            const auto corners = plane_in_box(plane, low - margin, high + margin);
                            if (corners.size() >= 3) {
                              add(corners, set);
                            } else {
                              ++outside;
                            }
                          }},
               drawn->input.joints[id.index()]);
  }
  if (planes > 0) {
    input.notes.push_back(fmt::format("{} endless planes are written up to 1 % beyond the domain's box{}", planes,
                                      outside > 0 ? fmt::format("; {} of them miss it", outside) : std::string{}));
  }
  if (several > 0) input.notes.push_back(fmt::format("{} joints of several polygons are a face each polygon", several));
  if (mesh.faces() == 0)
    return std::unexpected(in + ":1: joint_set: the scene has no joints; add [[joint]] or [[joint_set]]");
  return input;
}

constexpr const char* known_endings =
    "give a result folder, a scene (.toml), .vtu, .obj, .stl, .ply, .dxf, .ts, .fab, .dat or .csv";

}  // namespace

std::expected<ConvertInput, std::string> read_convert_input(const std::string& in, std::uint64_t realization) {
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(in, ignored);
  const std::string file = is_folder ? (std::filesystem::path{in} / "blocks.vtu").generic_string() : in;
  const std::string extension = extension_of(file);
  constexpr std::string_view endings = " .vtu .obj .stl .ply .dxf .ts .fab .dat .csv .toml ";
  if (extension.empty() || endings.find(" " + extension + " ") == std::string_view::npos) {
    return std::unexpected(fmt::format("{}:1: IN: the ending is not known; {}", in, known_endings));
  }
  if (extension == ".toml") return network_of_scene(in, realization);
  const auto bytes = io::read_file(file);
  if (!bytes) return std::unexpected(message_of(bytes.error()));
  if (extension == ".vtu") {
    const auto polyhedra = io::parse_vtu(*bytes, file);
    if (!polyhedra) return std::unexpected(message_of(polyhedra.error()));
    const io::UnbentCells unbent = io::without_bent_faces(*polyhedra);
    ConvertInput input{cells_of(unbent.cells), {}};
    if (unbent.note) input.notes.push_back(*unbent.note);
    return input;
  }
  auto mesh = mesh_of_file(extension, *bytes, file);
  if (!mesh || !*mesh) return std::unexpected(mesh ? mesh->error() : std::string{known_endings});
  std::vector<std::string> notes = std::exchange((*mesh)->notes, {});
  return ConvertInput{std::move(**mesh), std::move(notes)};
}

std::expected<ConvertedBlocks, std::string> blocks_of(const io::MeshData& given, const std::string& in) {
  const io::Unbent unbent = io::without_bent_faces(given);
  const io::MeshData& mesh = unbent.mesh;
  std::vector<std::vector<std::size_t>> faces_of_group(mesh.groups.size());
  for (std::size_t f = 0; f < mesh.faces(); ++f) faces_of_group[mesh.group[f]].push_back(f);
  ConvertedBlocks result;
  report::Cells& cells = result.cells;
  if (unbent.note) result.notes.push_back(*unbent.note);
  for (std::uint32_t group = 0; group < mesh.groups.size(); ++group) {
    if (faces_of_group[group].empty()) continue;
    const io::MeshData part = part_of(mesh, faces_of_group[group]);
    const auto no_block = [&](const geometry::SolidError& error) {
      return std::unexpected(fmt::format("{}:{}: group \"{}\": is no block: {}", in, std::max(1U, part.lines[0]),
                                         mesh.groups[group], describe(error)));
    };
    if (is_closed(part)) {
      if (const auto overlap = io::overlap_of(part)) return no_block(*overlap);
      if (add_block(cells, part.vertices, faces_of(part), group) > 0) continue;
    }
    const auto solid = io::solid_of(part);  // welds corners at one place, and says what is wrong
    if (!solid) return no_block(solid.error());
    std::vector<std::vector<std::uint32_t>> faces;
    for (const geometry::SolidFace& face : solid->faces()) faces.push_back(face.corners);
    add_block(cells, solid->vertices(), faces, group);
  }
  return result;
}

}  // namespace cleave::cli
