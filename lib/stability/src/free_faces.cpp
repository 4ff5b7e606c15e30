#include "free_faces.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "cleave/stability/analyse.hpp"
#include "flat.hpp"
#include "surface_loads.hpp"

namespace cleave::stability {

using geometry::cross;
using geometry::dot;
using geometry::norm;
using geometry::Vec3;
using topology::Face;
using topology::FaceId;

constexpr double infinite = std::numeric_limits<double>::infinity();

bool is_open(const topology::BlockComplex& complex, const Face& face,
             const std::function<bool(topology::BlockId)>& gone) {
  if (face.role != topology::Role::joint) return face.role == topology::Role::free;
  bool any = false;
  for (const topology::Patch& patch : complex.patches(face)) {
    if (patch.neighbour && !gone(*patch.neighbour)) return false;
    any = any || patch.neighbour.has_value();
  }
  return any;
}

bool moves_out_of(const Face& face, Vec3 motion) { return dot(face.outward, motion) > along_face; }

Vec3 push_of_pressure(const topology::BlockComplex& complex, topology::BlockId block, Vec3 motion,
                      const std::function<bool(topology::BlockId)>& gone) {
  Vec3 push;
  for (const FaceId id : complex.blocks()[block].faces) {
    const Face& face = complex.faces()[id];
    if (moves_out_of(face, motion) && is_open(complex, face, gone)) push -= face.area.si() * face.outward;
  }
  return push;
}

Sprayed::Sprayed(const topology::BlockComplex& complex, const Shotcrete& layer,
                 const std::function<bool(topology::BlockId)>& gone)
    : complex_{&complex}, on_{layer.on}, gone_from_(complex.blocks().size(), std::uint8_t{0}) {
  if (std::ranges::none_of(complex.blocks().ids(), gone)) return;
  // First from what is sprayed: a block between both was in front of the layer.
  for (const std::uint8_t from : {from_sprayed, from_bare}) {
    std::vector<topology::BlockId> reached;
    const auto add = [&](topology::BlockId id) {
      if (!gone(id) || gone_from_[id] != enclosed) return;
      gone_from_[id] = from;
      reached.push_back(id);
    };
    for (const Face& face : complex.faces()) {
      if (from == from_sprayed ? on_surface(face) : face.role == topology::Role::free) add(face.block);
    }
    while (!reached.empty()) {
      const topology::BlockId id = reached.back();
      reached.pop_back();
      for (const FaceId face_id : complex.blocks()[id].faces) {
        for (const topology::Patch& patch : complex.patches(complex.faces()[face_id])) {
          if (patch.neighbour) add(*patch.neighbour);
        }
      }
    }
  }
}

bool Sprayed::on_surface(const Face& face) const {
  if (on_.empty()) return face.role == topology::Role::free && face.excavation.has_value();
  return std::ranges::any_of(on_, [&](const FreeSurface& surface) { return lies_on(face, surface); });
}

bool Sprayed::operator()(const Face& face) const {
  if (face.role != topology::Role::joint) return on_surface(face);
  return std::ranges::all_of(complex_->patches(face), [&](const topology::Patch& patch) {
    return !patch.neighbour || gone_from_[*patch.neighbour] != from_bare;
  });
}

std::vector<KeyedEdge> keyed_edges(const topology::BlockComplex& complex, topology::BlockId block,
                                   const std::function<bool(topology::BlockId)>& gone) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, FaceId> beyond;
  const auto key = [](topology::VertexId a, topology::VertexId b) {
    return std::pair{std::min(a.value(), b.value()), std::max(a.value(), b.value())};
  };
  const auto edges = [&](bool open, auto&& use) {
    for (const FaceId face_id : complex.blocks()[block].faces) {
      const Face& face = complex.faces()[face_id];
      if (is_open(complex, face, gone) != open || (!open && face.role != topology::Role::joint)) continue;
      for (const auto& loop : complex.loops(face)) {
        for (std::size_t i = 0; i < loop.size(); ++i) use(face_id, loop[i], loop[(i + 1) % loop.size()]);
      }
    }
  };
  edges(false, [&](FaceId face, auto a, auto b) { beyond.insert_or_assign(key(a, b), face); });
  std::vector<KeyedEdge> out;
  edges(true, [&](FaceId face, auto a, auto b) {
    const auto it = beyond.find(key(a, b));
    if (it != beyond.end()) out.push_back({a, b, face, it->second});
  });
  return out;
}

std::vector<EdgePart> parts_along(const topology::BlockComplex& complex, const KeyedEdge& edge) {
  const Vec3 a = complex.position(edge.from), along = complex.position(edge.to) - a;
  const double length = norm(along);
  const Face& face = complex.faces()[edge.beyond];
  std::vector<topology::BlockId> beyond;
  for (const topology::Patch& patch : complex.patches(face)) {
    if (patch.neighbour) beyond.push_back(*patch.neighbour);
  }
  std::ranges::sort(beyond);
  beyond.erase(std::ranges::unique(beyond).begin(), beyond.end());
  if (beyond.size() == 1) return {{beyond.front(), a + 0.5 * along, length}};
  // Of what the face shares with each, the corners on the edge.
  constexpr double on_edge = 1e-6;
  std::vector<EdgePart> parts;
  double sum = 0;
  for (const topology::BlockId neighbour : beyond) {
    double low = 1, high = 0;
    for (const Vec3 corner : shared_corners(complex, face, neighbour)) {
      const double share = dot(corner - a, along) / (length * length);
      if (norm(corner - a - share * along) > on_edge * length) continue;
      low = std::min(low, std::clamp(share, 0.0, 1.0));
      high = std::max(high, std::clamp(share, 0.0, 1.0));
    }
    if (!(high - low > on_edge)) continue;
    parts.push_back({neighbour, a + 0.5 * (low + high) * along, (high - low) * length});
    sum += parts.back().length;
  }
  for (EdgePart& part : parts) part.length *= std::min(1.0, length / sum);
  return parts;
}

double held_per_metre(const Shotcrete& layer) {
  const double shear = layer.thickness.si() * layer.shear_strength.si();
  return layer.adhesion ? std::min(shear, layer.bond_width.si() * layer.adhesion->si()) : shear;
}

double keyed_perimeter(const topology::BlockComplex& complex, topology::BlockId block, Vec3 motion,
                       const Sprayed& sprayed, const std::function<bool(topology::BlockId)>& loose,
                       const std::function<bool(topology::BlockId)>& gone) {
  double perimeter = 0;
  for (const KeyedEdge& edge : keyed_edges(complex, block, gone)) {
    const Face& open = complex.faces()[edge.open];
    const bool keyed =
        moves_out_of(open, motion) && sprayed(open) &&
        std::ranges::none_of(complex.patches(complex.faces()[edge.beyond]),
                             [&](const topology::Patch& patch) { return patch.neighbour && loose(*patch.neighbour); });
    if (keyed) perimeter += norm(complex.position(edge.to) - complex.position(edge.from));
  }
  return perimeter;
}

namespace {

/// A free face that spot bolts may go into.
struct SpotFace {
  Face face;
  Vec3 direction;  ///< of the bolts
  std::vector<Vec3> collars = {};
};

/// Van der Corput's sequence.
double halton(std::uint32_t i, std::uint32_t base) {
  double f = 1, r = 0;
  for (; i > 0; i /= base) {
    f /= base;
    r += f * (i % base);
  }
  return r;
}

/// Spread over the face, its centroid first.
std::vector<Vec3> collars_on(const topology::BlockComplex& complex, const Face& face) {
  const Vec3 u = geometry::normalized(std::abs(face.outward.z) < 0.9 ? cross(face.outward, {0, 0, 1})
                                                                     : cross(face.outward, {1, 0, 0}));
  const Vec3 v = cross(face.outward, u);
  double u0 = infinite, u1 = -infinite, v0 = infinite, v1 = -infinite;
  for (const auto& loop : complex.loops(face)) {
    for (const topology::VertexId vertex : loop) {
      const Vec3 x = complex.position(vertex) - face.centroid;
      u0 = std::min(u0, dot(x, u));
      u1 = std::max(u1, dot(x, u));
      v0 = std::min(v0, dot(x, v));
      v1 = std::max(v1, dot(x, v));
    }
  }
  std::vector<Vec3> collars;
  for (std::uint32_t i = 0; i < 400; ++i) {
    const Vec3 x = i == 0 ? face.centroid
                          : face.centroid + (u0 + halton(i, 2) * (u1 - u0)) * u + (v0 + halton(i, 3) * (v1 - v0)) * v;
    if (contains(complex, face, x)) collars.push_back(x);
  }
  return collars;
}

/// Those from which bolts would hold the block: on walls of excavations, where it has such, else its largest.
std::vector<SpotFace> spot_faces(const topology::BlockComplex& complex, topology::BlockId block,
                                 std::span<const Vec3> wanted, Vec3 motion) {
  std::vector<SpotFace> walls;
  std::optional<SpotFace> largest;
  for (const FaceId face_id : complex.blocks()[block].faces) {
    const Face& face = complex.faces()[face_id];
    if (face.role != topology::Role::free) continue;
    Vec3 direction = -face.outward;
    for (const Vec3 better : wanted) {
      if (!(dot(better, face.outward) < -0.3)) continue;
      direction = better;
      break;
    }
    const bool holds = dot(direction, motion) < 0;
    if (holds && face.excavation) walls.push_back({face, direction});
    if (!largest || face.area > largest->face.area) largest = SpotFace{face, direction};
  }
  if (walls.empty() && largest && dot(largest->direction, motion) < 0) walls.push_back(*largest);
  std::ranges::stable_sort(walls, std::ranges::greater{}, [](const SpotFace& f) { return f.face.area; });
  for (SpotFace& wall : walls) wall.collars = collars_on(complex, wall.face);
  return walls;
}

}  // namespace

std::vector<Bolt> spot_places(const topology::BlockComplex& complex, topology::BlockId block,
                              std::span<const Vec3> wanted, Vec3 motion, const SpotBolts& spot) {
  const std::vector<SpotFace> faces = spot_faces(complex, block, wanted, motion);
  std::vector<std::size_t> taken(faces.size(), 0);
  std::vector<Bolt> places;
  while (places.size() < 400) {
    // The face with most area for each bolt that it would have then.
    std::optional<std::size_t> next;
    const auto area_each = [&](std::size_t k) { return faces[k].face.area.si() / static_cast<double>(taken[k] + 1); };
    for (std::size_t k = 0; k < faces.size(); ++k) {
      if (taken[k] < faces[k].collars.size() && (!next || area_each(k) > area_each(*next))) next = k;
    }
    if (!next) break;
    places.push_back({.collar = faces[*next].collars[taken[*next]++],
                      .direction = faces[*next].direction,
                      .length = spot.length,
                      .type = spot.type});
  }
  return places;
}

}  // namespace cleave::stability
