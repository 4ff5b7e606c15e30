#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "cleave/core/expected.hpp"
#include "cleave/geometry/predicates.hpp"
#include "cleave/geometry/solid.hpp"
#include "outline.hpp"

namespace cleave::geometry {
namespace {

using Quad = std::array<std::uint32_t, 4>;

/// Corners by bits, counter-clockwise from outside, in the order of the tags.
constexpr std::array<Quad, 6> box_faces{
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

std::vector<std::string> box_tags() { return {"west", "east", "south", "north", "bottom", "top"}; }

std::vector<SolidFace> faces_of(bool mirrored) {
  std::vector<SolidFace> faces;
  for (std::uint32_t f = 0; f < 6; ++f) {
    const Quad& q = box_faces[f];
    SolidFace face{.corners = {q.begin(), q.end()}, .tag = f};
    if (mirrored) std::ranges::reverse(face.corners);
    faces.push_back(std::move(face));
  }
  return faces;
}

/// Six times the signed volume, by the six faces seen from corner 0.
double signed_volume(const std::array<Vec3, 8>& corners) {
  double sum = 0;
  for (const Quad& q : box_faces) {
    const Vec3 a = corners[q[0]] - corners[0];
    const Vec3 b = corners[q[1]] - corners[0];
    const Vec3 c = corners[q[2]] - corners[0];
    const Vec3 d = corners[q[3]] - corners[0];
    sum += dot(a, cross(b, c)) + dot(a, cross(c, d));
  }
  return sum / 6;
}

/// One face as a planar quad with all other corners behind it by more than the planarity tolerance.
std::expected<void, SolidError> check_face(const std::array<Vec3, 8>& corners, std::size_t f, bool mirrored) {
  Quad quad = box_faces[f];
  if (mirrored) std::ranges::reverse(quad);
  std::vector<Vec3> ring;
  for (const std::uint32_t v : quad) ring.push_back(corners[v]);
  const auto outline = Outline::measure(ring);
  if (!outline) {
    const bool no_area = std::holds_alternative<ZeroArea>(outline.error());
    return std::unexpected(BadFace{f, no_area ? FaceFault::no_area : FaceFault::crosses_itself});
  }
  if (outline->corners.size() < 4) return std::unexpected(BadFace{f, FaceFault::corner_twice});
  if (outline->distance > outline->allowed) {
    return std::unexpected(
        FaceNotPlanar{f, quad[outline->furthest], metres(outline->distance), metres(outline->allowed)});
  }
  for (std::uint32_t v = 0; v < 8; ++v) {
    if (std::ranges::find(quad, v) != quad.end()) continue;
    if (!(dot(outline->normal, corners[v] - ring.front()) < -outline->allowed)) return std::unexpected(NotConvex{f, v});
  }
  return {};
}

}  // namespace

std::expected<Solid, SolidError> make_hexahedron(const std::array<Vec3, 8>& corners, BentFaces bent) {
  for (std::size_t v = 0; v < corners.size(); ++v) {
    if (!in_range(corners[v])) return std::unexpected(BadVertex{v});
  }
  const double volume = signed_volume(corners);
  if (volume == 0) return std::unexpected(NoVolume{cubic_metres(0)});
  const bool mirrored = volume < 0;
  std::optional<SolidError> first;
  bool any_bent = false;
  for (std::size_t f = 0; f < 6; ++f) {
    const auto sound = check_face(corners, f, mirrored);
    if (sound) continue;
    any_bent = any_bent || std::holds_alternative<FaceNotPlanar>(sound.error());
    if (!first) first = sound.error();
  }
  if (any_bent && bent == BentFaces::triangulate) {
    return Solid::make({corners.begin(), corners.end()}, faces_of(mirrored), box_tags());
  }
  if (first) return std::unexpected(*first);
  CLEAVE_TRY(Solid solid, Solid::make({corners.begin(), corners.end()}, faces_of(mirrored), box_tags()));
  return std::move(solid).with_half_spaces();
}

std::expected<Solid, SolidError> make_box(Vec3 min, Vec3 max) {
  if (!in_range(min)) return std::unexpected(BadVertex{0});
  if (!in_range(max)) return std::unexpected(BadVertex{7});
  const Vec3 extent = max - min;
  if (!(extent.x > 0 && extent.y > 0 && extent.z > 0)) {
    const double product = extent.x * extent.y * extent.z;
    return std::unexpected(NoVolume{cubic_metres(product > 0 ? -product : product)});
  }
  std::vector<Vec3> vertices;
  for (std::uint32_t v = 0; v < 8; ++v) {
    vertices.push_back({(v & 1U) != 0 ? max.x : min.x, (v & 2U) != 0 ? max.y : min.y, (v & 4U) != 0 ? max.z : min.z});
  }
  CLEAVE_TRY(Solid solid, Solid::make(std::move(vertices), faces_of(false), box_tags()));
  return std::move(solid).with_half_spaces();
}

}  // namespace cleave::geometry
