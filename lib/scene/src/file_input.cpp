#include "cleave/scene/file_input.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "cleave/core/text.hpp"

namespace cleave::scene {

std::string extension_of(std::string_view name) {
  const std::size_t dot = name.find_last_of('.');
  if (dot == std::string_view::npos || name.find('/', dot) != std::string_view::npos) return {};
  return lower(name.substr(dot + 1));
}

void report_read_error(Problems& problems, const io::ReadError& error) {
  const std::string key = error.column ? fmt::format("column {}", *error.column) : "file";
  problems.error_in(error.file, error.line.value_or(1), key, error.what, error.remedy);
}

namespace {

using Surfaces = std::expected<io::Surfaces, io::ReadError>;
using Mesh = std::expected<io::MeshData, io::ReadError>;

std::optional<Surfaces> parse_surfaces(const LoadedFile& loaded) {
  const std::string extension = extension_of(loaded.shown);
  if (extension == "dxf") return io::parse_dxf(loaded.bytes, loaded.shown);
  if (extension == "ts") return io::parse_tsurf(loaded.bytes, loaded.shown);
  if (extension == "fab") return io::parse_fab(loaded.bytes, loaded.shown);
  if (extension == "dat") return io::parse_dfnworks_polygons(loaded.bytes, loaded.shown);
  return std::nullopt;
}

std::optional<Mesh> parse_faces(const LoadedFile& loaded) {
  const std::string extension = extension_of(loaded.shown);
  if (extension == "obj") return io::parse_obj(loaded.bytes, loaded.shown);
  if (extension == "stl") return io::parse_stl(loaded.bytes, loaded.shown);
  if (extension == "ply") return io::parse_ply(loaded.bytes, loaded.shown);
  if (extension != "dxf" && extension != "ts") return std::nullopt;
  auto surfaces = parse_surfaces(loaded);
  if (!surfaces) return std::nullopt;
  if (!*surfaces) return Mesh{std::unexpect, std::move(*surfaces).error()};
  io::MeshData mesh = std::move((*surfaces)->surfaces);
  mesh.notes = std::move((*surfaces)->notes);
  if ((*surfaces)->polygons.faces() > 0) {
    mesh.notes.push_back(
        fmt::format("{} closed polylines are no part of a surface: not used", (*surfaces)->polygons.faces()));
  }
  return mesh;
}

bool is_near(InputContext& context, const io::MeshData& mesh, const std::string& shown) {
  const bool far = std::ranges::any_of(mesh.vertices, [](geometry::Vec3 v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}) > rule::coordinate.high;
  });
  if (far) {
    context.problems.error_in(shown, 1, "v", "a vertex lies further than 1e9 m from the origin", "check its numbers");
  }
  return !far;
}

void add_notes(InputContext& context, const std::vector<std::string>& notes, const std::string& shown) {
  for (const std::string& note : notes) context.problems.note_in(shown, 1, "file", note, "");
}

}  // namespace

bool is_surfaces(std::string_view extension) {
  return extension == "dxf" || extension == "ts" || extension == "fab" || extension == "dat";
}

std::optional<io::Surfaces> surfaces_of(InputContext& context, const LoadedFile& loaded) {
  auto parsed = parse_surfaces(loaded);
  if (!parsed) return std::nullopt;
  if (!*parsed) {
    report_read_error(context.problems, parsed->error());
    return std::nullopt;
  }
  io::Surfaces& surfaces = **parsed;
  add_notes(context, surfaces.notes, loaded.shown);
  if (!is_near(context, surfaces.polygons, loaded.shown) || !is_near(context, surfaces.surfaces, loaded.shown)) {
    return std::nullopt;
  }
  return std::move(surfaces);
}

std::optional<io::MeshData> mesh_of(InputContext& context, const TableReader& owner, std::string_view key,
                                    const LoadedFile& loaded) {
  auto parsed = parse_faces(loaded);
  if (!parsed) {
    const bool tables = key == "file" && owner.path().starts_with("joint");
    const std::string extension = extension_of(loaded.shown);
    const bool workbook = extension == "xlsx" || extension == "xls" || extension == "xlsm" || extension == "ods";
    owner.error(key, fmt::format("the ending of \"{}\" is not known", loaded.shown),
                tables && workbook ? "export the sheet as CSV, and name that file"
                : tables           ? "give a file that ends in .obj, .csv, .dxf, .ts, .fab, .dat, .stl or .ply"
                                   : "give a file that ends in .stl, .obj, .ply, .dxf or .ts");
    return std::nullopt;
  }
  if (!*parsed) {
    report_read_error(context.problems, parsed->error());
    return std::nullopt;
  }
  const io::MeshData& mesh = **parsed;
  add_notes(context, mesh.notes, loaded.shown);
  if (!is_near(context, mesh, loaded.shown)) return std::nullopt;
  if (mesh.faces() == 0) {
    context.problems.error_in(loaded.shown, 1, "file", "holds no faces", "check that it is the right file");
    return std::nullopt;
  }
  return std::move(**parsed);
}

}  // namespace cleave::scene
