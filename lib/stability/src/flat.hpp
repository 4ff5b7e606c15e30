#pragma once

/// Exact integrals over flat polygons given as loops (with holes, not convex), by signed triangles: the indicator of a
/// polygon is the signed sum of those of a fan over its loops, and so is that of an overlap of two.

#include <array>
#include <vector>

#include "cleave/geometry/flat_integrals.hpp"
#include "cleave/geometry/vec3.hpp"
#include "cleave/stability/actions.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::stability {

using geometry::clipped;
using geometry::Convex;
using geometry::integrate;
using geometry::LinearPressure;
using geometry::Moments;

struct SignedTriangle {
  std::array<geometry::Vec3, 3> corners;
  double sign;  ///< +1 or -1
};

/// The face as a signed sum of triangles, corners turning around `face.outward`. Empty for a face without loops.
[[nodiscard]] std::vector<SignedTriangle> fan(const topology::BlockComplex& complex, const topology::Face& face);

/// Whether a point of the face's plane lies in the face: even-odd with half-open edges, so that a point on an edge of
/// two coplanar faces lies in exactly one of them.
[[nodiscard]] bool contains(const topology::BlockComplex& complex, const topology::Face& face, geometry::Vec3 x);

/// The overlap of two triangles of one plane.
[[nodiscard]] Convex overlap(const SignedTriangle& a, const SignedTriangle& b, geometry::Vec3 plane_normal);
[[nodiscard]] Convex within(Convex polygon, const Box& box);

/// Calls visit(part, sign) for the convex parts, which may be empty, of what a face shares with the faces of a
/// neighbour on the same plane: their signed sum is the contact, for a patch carries no outline.
template <class Visit>
void for_each_shared(const topology::BlockComplex& complex, const topology::Face& face, topology::BlockId neighbour,
                     Visit&& visit) {
  const auto own = fan(complex, face);
  for (const topology::FaceId id : complex.blocks()[neighbour].faces) {
    const topology::Face& other = complex.faces()[id];
    if (other.plane != face.plane || other.block_on_positive_side == face.block_on_positive_side) continue;
    for (const SignedTriangle& b : fan(complex, other)) {
      // Seen from this side the neighbour's triangle turns the other way.
      const SignedTriangle turned{{b.corners[0], b.corners[2], b.corners[1]}, b.sign};
      for (const SignedTriangle& a : own) visit(overlap(a, turned, face.outward), a.sign * b.sign);
    }
  }
}

}  // namespace cleave::stability
