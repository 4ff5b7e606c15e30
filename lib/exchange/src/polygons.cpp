#include "cleave/exchange/polygons.hpp"

#include <algorithm>
#include <array>

#include "cleave/exchange/exports.hpp"
#include "cleave/exchange/triangulate.hpp"

namespace cleave::report::detail {
namespace {

bool passes_a_vertex_twice(const std::vector<std::uint32_t>& loop) {
  if (loop.size() <= 16) {
    for (std::size_t i = 1; i < loop.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (loop[i] == loop[j]) return true;
      }
    }
    return false;
  }
  auto sorted = loop;
  std::ranges::sort(sorted);
  return std::ranges::adjacent_find(sorted) != sorted.end();
}

/// The loops of a face by vertex number.
void read_loops(const topology::BlockComplex& complex, const topology::Face& face, FaceLoops& loops) {
  const auto all = complex.loops(face);
  loops.resize(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    loops[i].clear();
    for (const topology::VertexId v : all[i]) loops[i].push_back(v.value());
  }
}

}  // namespace

void append_triangles(const topology::BlockComplex& complex, const topology::Face& face,
                      std::span<const geometry::Vec3> points, FaceLoops& loops, std::vector<Triangle>& triangles) {
  read_loops(complex, face, loops);
  report::append_triangles(loops, points, face.outward, triangles);
}

std::vector<Polygon> surface_of(const topology::BlockComplex& complex, topology::BlockId block,
                                std::span<const geometry::Vec3> points, bool triangles_only) {
  std::vector<Polygon> polygons;
  FaceLoops loops;
  std::uint32_t number = 0;
  for (const topology::FaceId id : complex.blocks()[block].faces) {
    const topology::Face& face = complex.faces()[id];
    read_loops(complex, face, loops);
    const bool simple = loops.size() == 1 && !passes_a_vertex_twice(loops.front());
    if (simple && (!triangles_only || loops.front().size() == 3)) {
      polygons.push_back({.corners = std::move(loops.front()), .outward = face.outward, .face = number});
    } else {
      for (const Triangle& t : triangulate(loops, points, face.outward)) {
        polygons.push_back({.corners = {t[0], t[1], t[2]}, .outward = face.outward, .face = number});
      }
    }
    ++number;
  }
  return polygons;
}

}  // namespace cleave::report::detail

namespace cleave::report {

std::vector<std::array<topology::VertexId, 3>> triangles_of(const topology::BlockComplex& complex,
                                                            topology::BlockId block) {
  std::vector<Triangle> triangles;
  FaceLoops loops;
  for (const topology::FaceId face : complex.blocks()[block].faces) {
    detail::append_triangles(complex, complex.faces()[face], complex.vertices().items(), loops, triangles);
  }
  std::vector<std::array<topology::VertexId, 3>> out;
  out.reserve(triangles.size());
  for (const auto& [a, b, c] : triangles)
    out.push_back({topology::VertexId{a}, topology::VertexId{b}, topology::VertexId{c}});
  return out;
}

}  // namespace cleave::report
