#include "surface_loads.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cleave/core/overloaded.hpp"
#include "flat.hpp"

namespace cleave::stability {
namespace {

using geometry::cross;
using geometry::dot;
using geometry::norm;
using geometry::Vec3;
using topology::BlockComplex;
using topology::BlockId;
using topology::Face;
using topology::FaceId;

double distance_to_segment(Vec3 x, Vec3 a, Vec3 b) {
  const Vec3 along = b - a;
  const double length = dot(along, along);
  const double t = length > 0 ? std::clamp(dot(x - a, along) / length, 0.0, 1.0) : 0.0;
  return norm(x - (a + t * along));
}

double distance(const BlockComplex& complex, const Face& face, Vec3 x) {
  if (face.corner_count == 0) return std::numeric_limits<double>::infinity();
  const double off = dot(x - face.centroid, face.outward);
  if (contains(complex, face, x - off * face.outward)) return std::abs(off);
  double least = std::numeric_limits<double>::infinity();
  for (const auto& loop : complex.loops(face)) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      least = std::min(
          least, distance_to_segment(x, complex.position(loop[i]), complex.position(loop[(i + 1) % loop.size()])));
    }
  }
  return least;
}

struct Nearest {
  std::optional<FaceId> face;
  double distance = std::numeric_limits<double>::infinity();
};

Nearest nearest_free_face(const BlockComplex& complex, Vec3 x) {
  Nearest best;
  for (const FaceId id : complex.faces().ids()) {
    const Face& face = complex.faces()[id];
    if (face.role != topology::Role::free) continue;
    // Ties between neighbours that share an edge: the face that holds the point, then the lower number.
    const double d = distance(complex, face, x);
    if (d < best.distance) best = {id, d};
  }
  return best;
}

struct Piece {
  FaceId face;
  double from, to;  ///< share of the line
};

/// The line cut into pieces, each on one free face (none twice).
std::vector<Piece> pieces_of(const BlockComplex& complex, const LineForce& line) {
  struct Candidate {
    FaceId face;
    double off;
  };
  std::vector<Candidate> candidates;
  std::vector<double> breaks{0, 1};
  const Vec3 along = line.to - line.from;
  for (const FaceId id : complex.faces().ids()) {
    const Face& face = complex.faces()[id];
    if (face.role != topology::Role::free || face.corner_count == 0) continue;
    const double a = dot(line.from - face.centroid, face.outward), b = dot(line.to - face.centroid, face.outward);
    if (std::min(std::abs(a), std::abs(b)) > reach && (a > 0) == (b > 0)) continue;
    candidates.push_back({id, std::max(std::abs(a), std::abs(b))});
    // Where the line comes within reach of the plane, and where it crosses the face's edges.
    if (a != b) {
      for (const double side : {-reach, reach}) breaks.push_back((side - a) / (b - a));
    }
    const Vec3 across = cross(face.outward, along);
    for (const auto& loop : complex.loops(face)) {
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const Vec3 p = complex.position(loop[i]), q = complex.position(loop[(i + 1) % loop.size()]);
        const double dp = dot(across, p - line.from), dq = dot(across, q - line.from);
        if ((dp > 0) == (dq > 0)) continue;
        const Vec3 hit = p + (dp / (dp - dq)) * (q - p);
        breaks.push_back(dot(hit - line.from, along) / dot(along, along));
      }
    }
  }
  std::erase_if(breaks, [](double t) { return !(t >= 0 && t <= 1); });
  std::ranges::sort(breaks);
  std::vector<Piece> pieces;
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    if (!(breaks[i + 1] - breaks[i] > 1e-12)) continue;
    const Vec3 middle = line.from + 0.5 * (breaks[i] + breaks[i + 1]) * along;
    std::optional<FaceId> best;
    double least = reach;
    for (const Candidate& candidate : candidates) {
      const Face& face = complex.faces()[candidate.face];
      const double off = dot(middle - face.centroid, face.outward);
      if (std::abs(off) > least || (best && std::abs(off) == least)) continue;
      if (!contains(complex, face, middle - off * face.outward)) continue;
      best = candidate.face;
      least = std::abs(off);
    }
    if (best) pieces.push_back({*best, breaks[i], breaks[i + 1]});
  }
  return pieces;
}

/// The part of a face that a surcharge acts on.
Moments loaded(const BlockComplex& complex, const Face& face, const Surcharge& load) {
  if (!lies_on(face, load.on)) return {};
  if (!load.within) return {face.area.si(), face.area.si() * face.centroid};
  Moments area;
  for (const SignedTriangle& t : fan(complex, face)) {
    area += t.sign * integrate(within({t.corners.begin(), t.corners.end()}, *load.within));
  }
  return area;
}

}  // namespace

bool lies_on(const Face& face, const FreeSurface& surface) {
  if (face.role != topology::Role::free) return false;
  return std::visit(overloaded{[](AnyFreeFace) { return true; },
                               [&](DomainSide side) { return !face.excavation && face.tag == side.tag; },
                               [&](ExcavationWall wall) { return face.excavation == wall.excavation; }},
                    surface);
}

void for_each_surface_load(const BlockComplex& complex, const Actions& actions,
                           const std::function<void(BlockId, Vec3 force, Vec3 at)>& visit) {
  const ActionSpec& spec = actions.spec();
  for (const Surcharge& load : spec.surcharges) {
    for (const Face& face : complex.faces()) {
      const Moments area = loaded(complex, face, load);
      if (!(area.total > 0)) continue;
      const Vec3 centre = area.first / area.total;
      const Vec3 traction = load.traction - load.pressure.si() * face.outward;
      visit(face.block, area.total * traction, centre);
    }
  }
  for (const PointForce& load : spec.points) {
    const Nearest nearest = nearest_free_face(complex, load.at);
    if (!nearest.face || nearest.distance > reach) continue;
    visit(complex.faces()[*nearest.face].block, load.force, load.at);
  }
  for (const LineForce& load : spec.lines) {
    const Vec3 along = load.to - load.from;
    for (const Piece& piece : pieces_of(complex, load)) {
      const Vec3 middle = load.from + 0.5 * (piece.from + piece.to) * along;
      visit(complex.faces()[piece.face].block, (piece.to - piece.from) * norm(along) * load.per_metre, middle);
    }
  }
}

IdVector<BlockId, ForceSum> surface_forces(const BlockComplex& complex, const Actions& actions) {
  const ActionSpec& spec = actions.spec();
  if (spec.surcharges.empty() && spec.points.empty() && spec.lines.empty()) return {};
  IdVector<BlockId, ForceSum> sums(complex.blocks().size());
  for_each_surface_load(complex, actions, [&](BlockId block, Vec3 force, Vec3 at) {
    sums[block].add(force, at - complex.blocks()[block].centroid);
  });
  return sums;
}

std::vector<std::size_t> pulling_surcharges(const BlockComplex& complex, const Actions& actions) {
  std::vector<std::size_t> out;
  const std::vector<Surcharge>& surcharges = actions.spec().surcharges;
  for (std::size_t i = 0; i < surcharges.size(); ++i) {
    const Surcharge& load = surcharges[i];
    double pull = 0, size = 0;
    for (const Face& face : complex.faces()) {
      const double area = loaded(complex, face, load).total;
      if (!(area > 0)) continue;
      pull += area * (dot(load.traction, face.outward) - load.pressure.si());
      size += area * (norm(load.traction) + std::abs(load.pressure.si()));
    }
    if (pull > 1e-6 * size) out.push_back(i);
  }
  return out;
}

std::vector<Misplaced> misplaced(const BlockComplex& complex, const Actions& actions) {
  std::vector<Misplaced> out;
  const ActionSpec& spec = actions.spec();
  for (std::size_t i = 0; i < spec.surcharges.size(); ++i) {
    const bool any = std::ranges::any_of(
        complex.faces(), [&](const Face& face) { return loaded(complex, face, spec.surcharges[i]).total > 0; });
    if (!any) out.push_back({Misplaced::Kind::surcharge, i, {}});
  }
  for (std::size_t i = 0; i < spec.points.size(); ++i) {
    const double off = nearest_free_face(complex, spec.points[i].at).distance;
    if (off > reach) out.push_back({Misplaced::Kind::point, i, metres(off)});
  }
  for (std::size_t i = 0; i < spec.lines.size(); ++i) {
    double share = 0;
    for (const Piece& piece : pieces_of(complex, spec.lines[i])) share += piece.to - piece.from;
    const double length = norm(spec.lines[i].to - spec.lines[i].from);
    if ((1 - share) * length > reach) out.push_back({Misplaced::Kind::line, i, metres((1 - share) * length)});
  }
  return out;
}

}  // namespace cleave::stability
