#include <fmt/format.h>

#include <utility>

#include "cleave/core/overloaded.hpp"
#include "cleave/geometry/solid.hpp"

namespace cleave::geometry {
namespace {

const char* words(FaceFault fault) {
  switch (fault) {
    case FaceFault::too_few_corners: return "has fewer than three corners";
    case FaceFault::index_out_of_range: return "names a vertex or a tag that does not exist";
    case FaceFault::corner_twice: return "has a corner twice";
    case FaceFault::no_area: return "has no area (its corners lie on one line)";
    case FaceFault::crosses_itself: return "crosses or touches itself";
  }
  std::unreachable();
}

std::string at(Vec3 p) { return fmt::format("({:.9g}, {:.9g}, {:.9g})", p.x, p.y, p.z); }

}  // namespace

std::string describe(const SolidError& error) {
  return std::visit(
      overloaded{
          [](NoFaces) { return std::string{"the surface has no faces; give at least four"}; },
          [](BadVertex e) {
            return fmt::format(
                "vertex {} is not a usable position (not a number, infinite, or beyond 1e12 m); correct its "
                "coordinates",
                e.vertex);
          },
          [](BadFace e) { return fmt::format("face {} {}; correct or remove it", e.face, words(e.fault)); },
          [](OpenEdge e) {
            return fmt::format(
                "the surface is open: the edge from vertex {} {} to vertex {} {} has a face on one side only; close "
                "the hole, or "
                "weld vertices that should be one",
                e.from, at(e.a), e.to, at(e.b));
          },
          [](NonManifoldEdge e) {
            return fmt::format(
                "the surface is not manifold: {} faces use the edge between vertex {} {} and vertex {} {}, allowed are "
                "two; "
                "remove doubled or inner faces",
                e.uses, e.from, at(e.a), e.to, at(e.b));
          },
          [](InconsistentEdge e) {
            return fmt::format(
                "the surface is inconsistently oriented: both faces at the edge from vertex {} {} to vertex {} {} run "
                "along it in "
                "the same sense; reverse the order of the corners of one of them",
                e.from, at(e.a), e.to, at(e.b));
          },
          [](InsideOut e) {
            return e.volume < cubic_metres(0)
                       ? fmt::format(
                             "the surface is inside out (signed volume {:.6g} m3); reverse the order of the corners of "
                             "its faces so that they look outwards",
                             e.volume.si())
                       : fmt::format(
                             "a shell of {:.6g} m3 lies inside another one and looks outwards; reverse its faces to "
                             "make "
                             "it a cavity, or remove it",
                             e.volume.si());
          },
          [](NoVolume e) {
            return e.volume > cubic_metres(0)
                       ? fmt::format(
                             "the body is so flat that its volume ({:.6g} m3) may be rounding alone; make it thicker, "
                             "or "
                             "bring it nearer to the origin",
                             e.volume.si())
                       : std::string{"the body has no volume; its extent must be positive in all three directions"};
          },
          [](FacesCross e) {
            return fmt::format(
                "faces {} and {} cross, overlap or touch where they share no vertex; repair the surface so that it "
                "does not "
                "cross itself",
                e.first, e.second);
          },
          [](FaceNotPlanar e) {
            return fmt::format(
                "face {} is not planar: vertex {} lies {:.3g} m off its best-fit plane, allowed is {:.3g} m; correct "
                "the corners, or set nonplanar = \"triangulate\"",
                e.face, e.vertex, e.distance.si(), e.allowed.si());
          },
          [](NotConvex e) {
            return fmt::format(
                "the body is not convex: vertex {} does not lie behind face {}; check the order of the corners (bits "
                "0, 1, 2 of "
                "the number are the x, y, z side)",
                e.vertex, e.face);
          },
      },
      error);
}

}  // namespace cleave::geometry
