#include "bolt_paths.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

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

namespace {

/// From a point of its plane to the edges of a face.
double off_edges(const topology::BlockComplex& complex, const Face& face, Vec3 x) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& loop : complex.loops(face)) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec3 a = complex.position(loop[i]), along = complex.position(loop[(i + 1) % loop.size()]) - a;
      const double square = dot(along, along);
      const double share = square > 0 ? std::clamp(dot(x - a, along) / square, 0.0, 1.0) : 0.0;
      least = std::min(least, norm(x - a - share * along));
    }
  }
  return least;
}

/// Whether a bolt runs in a free face of a block that it goes through: half of it is in the air.
bool runs_in_free_face(const topology::BlockComplex& complex, const Bolt& bolt, const BoltPath& path) {
  constexpr double next_to = 1e-6;  // m
  for (const Pierced& p : path.pierced) {
    for (const FaceId id : complex.blocks()[p.block].faces) {
      const Face& face = complex.faces()[id];
      if (face.role != topology::Role::free || std::abs(dot(face.outward, bolt.direction)) > 1e-9) continue;
      const double off = dot(bolt.collar - face.centroid, face.outward);
      if (std::abs(off) > next_to) continue;
      for (const double share : {0.1, 0.3, 0.5, 0.7, 0.9}) {
        const Vec3 x = bolt.collar + std::lerp(p.from, p.to, share) * bolt.direction;
        if (contains(complex, face, x - off * face.outward)) return true;
      }
    }
  }
  return false;
}

}  // namespace

std::optional<FaceId> BoltPaths::collar_face(const Bolt& bolt) const {
  std::optional<FaceId> best;
  double least = reach;
  constexpr double on_edge = 1e-6;  // m
  const Vec3 x = bolt.collar;
  for (const FreeFace& candidate : free_) {
    if (!candidate.box.overlaps({x, x})) continue;
    const Face& face = complex_->faces()[candidate.face];
    if (!(dot(face.outward, bolt.direction) < -1e-9)) continue;  // the bolt must enter the rock
    const double off = dot(x - face.centroid, face.outward);
    if (std::abs(off) > least || (best && std::abs(off) == least)) continue;
    const Vec3 on_face = x - off * face.outward;
    // A collar on an edge, as those at the corners of a section, is of the face by rounding or not.
    if (!contains(*complex_, face, on_face) && off_edges(*complex_, face, on_face) > on_edge) continue;
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

namespace {

/// Two directions at right angles to a bolt, of no plane that a scene would have.
std::array<Vec3, 2> across(Vec3 direction) {
  const Vec3 some{0.3817, -0.7451, 0.5467};
  const Vec3 u = geometry::normalized(cross(direction, some));
  return {u, cross(direction, u)};
}

/// Without blocks that only the way beside the edge clips.
BoltPath without_clipped(BoltPath path, double shortest) {
  std::vector<Pierced> whole;
  double from = 0;
  for (Pierced& p : path.pierced) {
    if (p.to - from < shortest) continue;
    p.from = std::exchange(from, p.to);
    whole.push_back(p);
  }
  path.pierced = std::move(whole);
  return path;
}

}  // namespace

/// Along a line that goes exactly through an edge of a block it is rounding that says which face is met, or that none
/// is: then beside it, as bolts are drilled.
BoltPath BoltPaths::path(const Bolt& bolt) const {
  const auto start = collar_face(bolt);
  if (!start) return {};
  constexpr double beside = 1e-6;  // m
  bool clear = true;
  BoltPath path = along(bolt, *start, clear);
  const auto [u, v] = across(bolt.direction);
  for (int k = 0; k < 8 && !clear; ++k) {
    Bolt moved = bolt;
    const double angle = 0.4 + k * std::numbers::pi / 4;
    moved.collar += beside * (std::cos(angle) * u + std::sin(angle) * v);
    clear = true;
    BoltPath other = along(moved, *start, clear);
    if (clear) path = without_clipped(std::move(other), 8 * beside);
  }
  if (runs_in_free_face(*complex_, bolt, path)) return {};
  return path;
}

/// `clear`: false where it comes next to an edge.
BoltPath BoltPaths::along(const Bolt& bolt, FaceId start, bool& clear) const {
  constexpr double next_to = 1e-8;  // m
  BoltPath path;
  std::vector<Pierced>& pierced = path.pierced;
  BlockId block = complex_->faces()[start].block;
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
      const Vec3 there = bolt.collar + at * bolt.direction;
      if (at > reach && at < bolt.length.si() && off_edges(*complex_, face, there) < next_to) clear = false;
      if (!contains(*complex_, face, there)) continue;
      exit = at;
      through = face;
    }
    if (!through) clear = false;  // beside the block: a line in it comes out somewhere
    if (!through || exit >= bolt.length.si() || through->role == topology::Role::fixed) {
      // Rock beyond a fixed side goes on and never moves.
      pierced.push_back({block, t, bolt.length.si()});
      if (through && exit < bolt.length.si()) path.outside = bolt.length.si() - std::max(exit, t);
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
