#include "vtu_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

#include "height_limits.hpp"
#include "surface_measure.hpp"

namespace cleave::io {
namespace {

using geometry::Vec3;
using Face = std::vector<std::uint32_t>;  ///< numbers of points

/// For each point the first one at the same place: files may give every face points of its own.
std::vector<std::uint32_t> places_of(const std::vector<Vec3>& points) {
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto key = [&](std::uint32_t i) { return std::tuple{points[i].x, points[i].y, points[i].z}; };
  std::ranges::stable_sort(order, {}, key);
  std::vector<std::uint32_t> place(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && key(order[i]) == key(order[i - 1]);
    place[order[i]] = same ? place[order[i - 1]] : order[i];
  }
  return place;
}

std::vector<Face> faces_of(std::span<const std::int64_t> stream, const std::vector<std::uint32_t>& place) {
  std::vector<Face> faces(static_cast<std::size_t>(stream[0]));
  std::size_t at = 1;
  for (Face& face : faces) {
    const auto count = static_cast<std::size_t>(stream[at]);
    for (const std::int64_t point : stream.subspan(at + 1, count)) {
      face.push_back(place[static_cast<std::size_t>(point)]);
    }
    at += count + 1;
  }
  return faces;
}

/// No wider than the rounding of coordinates: cells of thin blocks have several such faces along one edge.
bool is_folded(const Face& face, const std::vector<Vec3>& points) {
  const Vec3 origin = points[face[0]];
  Vec3 two_areas;
  double length = 0, reach = 0;
  for (std::size_t i = 0; i < face.size(); ++i) {
    const Vec3 p = points[face[i]], q = points[face[(i + 1) % face.size()]];
    two_areas += cross(p - origin, q - origin);
    length += norm(q - p);
    reach = std::max({reach, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }
  constexpr double rounding = 1e-14;
  return norm(two_areas) <= rounding * reach * length;
}

/// Two faces with the same corners in the same sense, but for folded ones.
std::optional<std::pair<std::size_t, std::size_t>> repeated_face(std::span<const Face> faces,
                                                                 const std::vector<Vec3>& points) {
  std::vector<std::pair<Face, std::size_t>> turned;  // each begins with its smallest corner
  for (std::size_t f = 0; f < faces.size(); ++f) {
    Face face = faces[f];
    if (is_folded(face, points)) continue;
    std::ranges::rotate(face, std::ranges::min_element(face));
    turned.emplace_back(std::move(face), f);
  }
  std::ranges::sort(turned);
  const auto same = std::ranges::adjacent_find(turned, {}, &std::pair<Face, std::size_t>::first);
  if (same == turned.end()) return std::nullopt;
  return std::pair{same->second, (same + 1)->second};
}

/// An edge that faces do not pass as often in one direction as in the other.
struct LooseEdge {
  std::uint32_t from, to;
  std::size_t faces;
};
std::optional<LooseEdge> loose_edge(std::span<const Face> faces) {
  struct Pass {
    std::uint32_t low, high;
    bool up;
  };
  std::vector<Pass> passes;
  for (const Face& face : faces) {
    for (std::size_t i = 0; i < face.size(); ++i) {
      const std::uint32_t a = face[i], b = face[(i + 1) % face.size()];
      if (a != b) passes.push_back({std::min(a, b), std::max(a, b), a < b});
    }
  }
  std::ranges::sort(passes, {}, [](const Pass& p) { return std::tuple{p.low, p.high, p.up}; });
  for (std::size_t begin = 0; begin < passes.size();) {
    std::size_t end = begin, up = 0;
    for (; end < passes.size() && passes[end].low == passes[begin].low && passes[end].high == passes[begin].high; ++end)
      up += passes[end].up ? 1U : 0U;
    if (2 * up != end - begin) return LooseEdge{passes[begin].low, passes[begin].high, end - begin};
    begin = end;
  }
  return std::nullopt;
}

std::string shown(Vec3 p) { return fmt::format("({}, {}, {})", p.x, p.y, p.z); }

std::optional<CellFault> fault_of_surface(std::span<const Face> faces, const std::vector<Vec3>& points) {
  for (const Face& face : faces) {
    for (const std::uint32_t p : face) {
      if (std::max({std::abs(points[p].x), std::abs(points[p].y), std::abs(points[p].z)}) <= farthest) continue;
      return CellFault{fmt::format("has a corner {} further than 1e9 m from the origin", shown(points[p])),
                       "check its numbers; coordinates are metres"};
    }
  }
  if (const auto twice = repeated_face(faces, points)) {
    return CellFault{fmt::format("has one face twice: {} and {}, counted from 0", twice->first, twice->second),
                     "remove one of them"};
  }
  if (const auto edge = loose_edge(faces)) {
    const std::string where = fmt::format("the edge {} to {}", shown(points[edge->from]), shown(points[edge->to]));
    if (edge->faces % 2 == 0) {
      return CellFault{
          fmt::format("has faces that look inwards: {} is passed in one direction by both its faces", where),
          "give the corners of all faces counter-clockwise as seen from outside"};
    }
    return CellFault{
        fmt::format("is not closed: {} belongs to {} face{}", where, edge->faces, edge->faces == 1 ? " only" : "s"),
        "give all faces around the cell, meeting along whole edges"};
  }
  return std::nullopt;
}

std::optional<CellFault> fault_of_volume(const SurfaceMeasure& found, std::optional<double> stated) {
  const double noise = found.noise(4e-15);
  if (found.volume < -noise) {
    return CellFault{fmt::format("has the volume {:.7g} m3: its faces look inwards", found.volume),
                     "give the corners of all faces counter-clockwise as seen from outside"};
  }
  if (!stated && !(found.volume > noise)) return CellFault{"has no volume", "remove it"};
  if (!stated || std::abs(found.volume - *stated) <= 1e-6 * std::abs(*stated) + noise) return std::nullopt;
  return CellFault{
      fmt::format("has the volume {:.10g} m3, but the cell array \"volume\" says {:.10g}", found.volume, *stated),
      "get the file again from the program that wrote it, or leave the array out"};
}

}  // namespace

std::optional<CellFault> fault_of_cells(const Polyhedra& cells, const std::vector<double>& stated) {
  const std::vector<std::uint32_t> place = places_of(cells.points);
  std::size_t begin = 0;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const auto end = static_cast<std::size_t>(cells.face_ends[c]);
    const auto faces = faces_of(std::span{cells.face_stream}.subspan(begin, end - begin), place);
    begin = end;
    auto fault = fault_of_surface(faces, cells.points);
    if (!fault) {
      fault = fault_of_volume(measure_surface(
                                  faces.size(), [&](std::size_t f) -> const Face& { return faces[f]; }, cells.points),
                              stated.empty() ? std::nullopt : std::optional{stated[c]});
    }
    if (!fault) continue;
    fault->what = fmt::format("block {} (cell {}) {}", cells.block[c], c, fault->what);
    return fault;
  }
  return std::nullopt;
}

}  // namespace cleave::io
