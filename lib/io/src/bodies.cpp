#include "cleave/io/bodies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <variant>

#include "cleave/core/disjoint_sets.hpp"
#include "cleave/geometry/polygon.hpp"
#include "cleave/geometry/triangulate.hpp"
#include "surface_measure.hpp"

namespace cleave::io {
namespace {

using geometry::Vec3;

/// Takes faces apart and counts.
class Unbender final {
 public:
  /// Triangles of a bent face, by the places of its corners; empty for all others.
  std::vector<std::array<std::uint32_t, 3>> triangles_of(const std::vector<Vec3>& corners) {
    if (corners.size() < 4) return {};
    const auto polygon = geometry::Polygon::make(corners);
    const auto* bent = polygon ? nullptr : std::get_if<geometry::NotPlanar>(&polygon.error());
    if (bent == nullptr || touches_itself(corners)) return {};
    auto triangles = geometry::triangulate(corners);
    if (!triangles) return {};
    ++faces_;
    furthest_ = std::max(furthest_, bent->distance.si());
    return std::move(*triangles);
  }

  [[nodiscard]] std::optional<std::string> note() const {
    if (faces_ == 0) return std::nullopt;
    return fmt::format(
        "{} faces of bodies are bent, with corners up to {:.3g} m off their plane: each is cut into "
        "triangles, along its shortest diagonals",
        faces_, furthest_);
  }

 private:
  /// Its triangles would not close the cell any more.
  static bool touches_itself(std::vector<Vec3> corners) {
    std::ranges::sort(corners, {}, [](const Vec3& p) { return std::array{p.x, p.y, p.z}; });
    return std::ranges::adjacent_find(corners) != corners.end();
  }

  std::uint64_t faces_ = 0;
  double furthest_ = 0;
};

/// Thinner than what rounded coordinates can show.
bool is_thin(const MeshData& mesh) {
  const SurfaceMeasure found =
      measure_surface(mesh.faces(), [&](std::size_t f) { return mesh.face(f); }, mesh.vertices);
  return std::abs(found.volume) <= found.noise(1e-12);
}

}  // namespace

Unbent without_bent_faces(MeshData mesh) {
  Unbender unbender;
  MeshData flat{.vertices = {}, .corners = {}, .ends = {}, .group = {}, .groups = {}, .lines = {}, .notes = {}};
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    const auto face = mesh.face(f);
    const auto add = [&](std::span<const std::uint32_t> corners) {
      flat.corners.insert(flat.corners.end(), corners.begin(), corners.end());
      flat.ends.push_back(static_cast<std::uint32_t>(flat.corners.size()));
      flat.group.push_back(mesh.group[f]);
      flat.lines.push_back(mesh.lines[f]);
    };
    const auto triangles = unbender.triangles_of(mesh.corners_of(f));
    for (const auto& [a, b, c] : triangles) add(std::array{face[a], face[b], face[c]});
    if (triangles.empty()) add(face);
  }
  flat.vertices = std::move(mesh.vertices);
  flat.groups = std::move(mesh.groups);
  flat.notes = std::move(mesh.notes);
  return {std::move(flat), unbender.note()};
}

UnbentCells without_bent_faces(const Polyhedra& cells) {
  Unbender unbender;
  Polyhedra flat{.points = cells.points, .face_stream = {}, .face_ends = {}, .block = cells.block};
  std::size_t at = 0;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const std::size_t head = flat.face_stream.size();
    std::int64_t faces = 0;
    const auto add = [&](std::span<const std::int64_t> points) {
      ++faces;
      flat.face_stream.push_back(static_cast<std::int64_t>(points.size()));
      flat.face_stream.insert(flat.face_stream.end(), points.begin(), points.end());
    };
    flat.face_stream.push_back(0);
    for (std::int64_t f = cells.face_stream[at++]; f > 0; --f) {
      const auto count = static_cast<std::size_t>(cells.face_stream[at++]);
      const auto face = std::span{cells.face_stream}.subspan(at, count);
      at += count;
      std::vector<Vec3> corners;
      for (const std::int64_t p : face) corners.push_back(cells.points[static_cast<std::size_t>(p)]);
      const auto triangles = unbender.triangles_of(corners);
      for (const auto& [i, j, k] : triangles) add(std::array{face[i], face[j], face[k]});
      if (triangles.empty()) add(face);
    }
    flat.face_stream[head] = faces;
    flat.face_ends.push_back(static_cast<std::int64_t>(flat.face_stream.size()));
  }
  return {std::move(flat), unbender.note()};
}

std::optional<geometry::SolidError> overlap_of(const MeshData& closed) {
  if (closed.faces() == 0 || is_thin(closed)) return std::nullopt;
  std::vector<geometry::SolidFace> faces;
  for (std::size_t f = 0; f < closed.faces(); ++f) {
    const auto corners = closed.face(f);
    faces.push_back({{corners.begin(), corners.end()}, 0});
  }
  DisjointSets<std::uint32_t> surfaces{closed.vertices.size()};
  for (const geometry::SolidFace& face : faces) {
    for (const std::uint32_t corner : face.corners) surfaces.join(face.corners[0], corner);
  }
  const auto surface_of = [&](std::size_t f) { return surfaces.find(closed.face(f)[0]); };
  bool several = false;
  for (std::size_t f = 0; f < closed.faces(); ++f) several = several || surface_of(f) != surface_of(0);
  if (!several) return std::nullopt;
  auto solid = geometry::Solid::make(closed.vertices, std::move(faces));
  if (solid) return std::nullopt;
  const auto* cross = std::get_if<geometry::FacesCross>(&solid.error());
  const bool told = cross != nullptr ? surface_of(cross->first) != surface_of(cross->second)
                                     : std::holds_alternative<geometry::InsideOut>(solid.error());
  return told ? std::optional{std::move(solid).error()} : std::nullopt;
}

}  // namespace cleave::io
