#include "bolt_paths.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "flat.hpp"

namespace cleave::stability {

using geometry::dot;
using geometry::Vec3;
using topology::BlockId;
using topology::Face;
using topology::FaceId;

BoltPaths::BoltPaths(const topology::BlockComplex& complex) : complex_{&complex} {
  for (const FaceId id : complex.faces().ids()) {
    const Face& face = complex.faces()[id];
    if (face.role != topology::Role::free) continue;
    geometry::Box box;
    for (const auto& loop : complex.loops(face)) {
      for (const topology::VertexId v : loop) box.add(complex.position(v));
    }
    free_.push_back({id, box.grown(reach)});
  }
}

std::optional<FaceId> BoltPaths::collar_face(const Bolt& bolt) const {
  std::optional<FaceId> best;
  double least = reach;
  const Vec3 x = bolt.collar;
  for (const FreeFace& candidate : free_) {
    if (!candidate.box.overlaps({x, x})) continue;
    const Face& face = complex_->faces()[candidate.face];
    if (!(dot(face.outward, bolt.direction) < -1e-9)) continue;  // the bolt must enter the rock
    const double off = dot(x - face.centroid, face.outward);
    if (std::abs(off) > least || (best && std::abs(off) == least)) continue;
    if (!contains(*complex_, face, x - off * face.outward)) continue;
    best = candidate.face;
    least = std::abs(off);
  }
  return best;
}

std::optional<BlockId> BoltPaths::behind(const Face& face, Vec3 x) const {
  std::optional<BlockId> any;
  for (const topology::Patch& patch : complex_->patches(face)) {
    if (!patch.neighbour) continue;
    if (any == patch.neighbour) continue;
    if (!any) any = patch.neighbour;
    for (const FaceId id : complex_->blocks()[*patch.neighbour].faces) {
      const Face& other = complex_->faces()[id];
      if (other.plane != face.plane || other.block_on_positive_side == face.block_on_positive_side) continue;
      if (contains(*complex_, other, x)) return patch.neighbour;
    }
  }
  return any;  // on an edge, to rounding
}

BoltPath BoltPaths::path(const Bolt& bolt) const {
  BoltPath path;
  std::vector<Pierced>& pierced = path.pierced;
  const auto start = collar_face(bolt);
  if (!start) return path;
  BlockId block = complex_->faces()[*start].block;
  double t = 0;
  constexpr std::size_t most = 100'000;
  while (pierced.size() < most) {
    double exit = std::numeric_limits<double>::infinity();
    std::optional<Face> through;
    for (const FaceId id : complex_->blocks()[block].faces) {
      const Face& face = complex_->faces()[id];
      const double rate = dot(face.outward, bolt.direction);
      if (!(rate > 1e-12)) continue;
      const double at = dot(face.centroid - bolt.collar, face.outward) / rate;
      if (at < t - 1e-9 || at >= exit) continue;
      if (!contains(*complex_, face, bolt.collar + at * bolt.direction)) continue;
      exit = at;
      through = face;
    }
    if (!through || exit >= bolt.length.si() || through->role == topology::Role::fixed) {
      // Rock beyond a fixed side goes on and never moves.
      pierced.push_back({block, t, bolt.length.si()});
      break;
    }
    if (through->role == topology::Role::window) {
      path.leaves_window = true;
      pierced.push_back({block, t, bolt.length.si()});
      break;
    }
    exit = std::max(exit, t);
    pierced.push_back({block, t, exit});
    if (through->role == topology::Role::free) break;
    const auto next = behind(*through, bolt.collar + exit * bolt.direction);
    if (!next) break;
    block = *next;
    t = exit;
  }
  return path;
}

}  // namespace cleave::stability
