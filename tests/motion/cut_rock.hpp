#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "assemblies.hpp"

/// Random assemblies of another kind than `AssemblyMaker` has: a box of rock is cut by one plane after the other, each
/// through one cell, so that cells are polyhedra of any shape, their corners lie on sides of others, and every joint
/// has a friction of its own. Below some of them never move, some are missing.
namespace cleave::motion::shapes {

class CutRock final {
 public:
  explicit CutRock(std::uint64_t seed) : random_{0x9E3779B97F4A7C15U * (seed + 1)} {}

  RandomAssembly make(std::size_t count) {
    const double most = between(0, 1) < 0.2 ? 0 : between(5, 60);
    planes_.assign(6, {});
    cells_.assign(1, whole());
    for (int tries = 0; cells_.size() < count && tries < 100; ++tries) cut();
    RandomAssembly out;
    out.scene.surfaces.clear();
    for (std::size_t k = 0; k < planes_.size(); ++k) {
      out.scene.surfaces.push_back({std::tan(between(0, most) * degree), 0});
    }
    if (between(0, 1) < 0.5) out.gravity = 9.81 * direction();
    choose(out);
    for (std::size_t a = 0; a < cells_.size(); ++a) {
      for (std::size_t b = 0; b < cells_.size(); ++b) add_contacts(a, b, out);
    }
    return out;
  }

 private:
  struct Plane {
    Vec3 normal;
    double offset = 0;
  };
  enum class Side : std::uint8_t { rim, below, above };
  struct Face {
    std::vector<Vec3> corners = {};  ///< counter-clockwise from outside
    std::uint32_t plane = 0;
    Side side = Side::rim;  ///< where the cell lies
  };
  enum class Kind : std::uint8_t { missing, moves, fixed };
  struct Cell {
    std::vector<Face> faces = {};
    Kind kind = Kind::moves;
    std::uint32_t body = 0;
  };

  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11U) * 0x1p-53;
  }
  Vec3 direction() {
    for (;;) {
      const Vec3 v{between(-1, 1), between(-1, 1), between(-1, 1)};
      if (const double length = norm(v); length > 0.1 && length < 1) return v / length;
    }
  }
  Cell whole() {
    const Vec3 half{between(0.8, 1.4), between(0.8, 1.4), between(0.8, 1.4)};
    const Polyhedron shape = box(-half, half);
    Cell out;
    for (std::uint32_t k = 0; k < 6; ++k) {
      Face& face = out.faces.emplace_back(Face{.plane = k});
      for (const std::uint32_t v : shape.facets[k].loops[0]) face.corners.push_back(shape.vertices[v]);
    }
    return out;
  }
  static Polyhedron shape_of(const Cell& cell) {
    Polyhedron out;
    for (const Face& face : cell.faces) {
      Facet facet{.loops = {{}}, .surface = face.plane};
      for (const Vec3 corner : face.corners) {
        const auto at = std::ranges::find_if(out.vertices, [&](Vec3 v) { return norm(v - corner) < 1e-8; });
        facet.loops[0].push_back(static_cast<std::uint32_t>(at - out.vertices.begin()));
        if (at == out.vertices.end()) out.vertices.push_back(corner);
      }
      out.facets.push_back(std::move(facet));
    }
    return out;
  }
  /// No edge is short.
  static bool is_good(const Cell& cell) {
    return cell.faces.size() > 3 && std::ranges::all_of(cell.faces, [](const Face& face) {
             for (std::size_t k = 0; k < face.corners.size(); ++k) {
               if (norm(face.corners[k] - face.corners[(k + 1) % face.corners.size()]) < 0.06) return false;
             }
             return face.corners.size() > 2;
           });
  }

  /// Part of a cell below a plane; ends of the new sides in `rim`.
  static Cell below(const Cell& cell, const Plane& plane, std::vector<Vec3>& rim) {
    Cell out;
    for (const Face& face : cell.faces) {
      Face kept{.corners = {}, .plane = face.plane, .side = face.side};
      for (std::size_t k = 0; k < face.corners.size(); ++k) {
        const Vec3 p = face.corners[k], q = face.corners[(k + 1) % face.corners.size()];
        const double dp = dot(plane.normal, p) - plane.offset, dq = dot(plane.normal, q) - plane.offset;
        if (dp < 0) kept.corners.push_back(p);
        if ((dp < 0) == (dq < 0)) continue;
        // The same point from either face and from either side.
        const Vec3 at = dp < 0 ? p + dp / (dp - dq) * (q - p) : q + dq / (dq - dp) * (p - q);
        kept.corners.push_back(at);
        rim.push_back(at);
      }
      if (!kept.corners.empty()) out.faces.push_back(std::move(kept));
    }
    return out;
  }
  void cut() {
    std::size_t largest = 0;
    double most = 0;
    for (std::size_t k = 0; k < cells_.size(); ++k) {
      if (const double v = mass_properties(shape_of(cells_[k])).value().volume; v > most) {
        most = v;
        largest = k;
      }
    }
    const Vec3 middle = mass_properties(shape_of(cells_[largest])).value().centroid;
    const Vec3 at = middle + 0.25 * std::cbrt(most) * between(0, 1) * direction();
    Plane plane{direction(), 0};
    plane.offset = dot(plane.normal, at);
    std::vector<Vec3> rim, same;
    Cell low = below(cells_[largest], plane, rim);
    Cell high = below(cells_[largest], {-plane.normal, -plane.offset}, same);
    Vec3 centre;
    for (const Vec3 p : rim) centre += p / static_cast<double>(rim.size());
    if (rim.size() < 3) return;
    const Vec3 first = geometry::normalized(rim[0] - centre), second = cross(plane.normal, first);
    std::ranges::sort(rim, {}, [&](Vec3 p) { return std::atan2(dot(second, p - centre), dot(first, p - centre)); });
    Face side{.plane = static_cast<std::uint32_t>(planes_.size()), .side = Side::below};
    for (const Vec3 p : rim) {
      if (side.corners.empty() || norm(p - side.corners.back()) > 1e-9) side.corners.push_back(p);
    }
    if (norm(side.corners.front() - side.corners.back()) < 1e-9) side.corners.pop_back();
    low.faces.push_back(side);
    std::ranges::reverse(side.corners);
    side.side = Side::above;
    high.faces.push_back(std::move(side));
    if (!is_good(low) || !is_good(high)) return;
    planes_.push_back(plane);
    cells_[largest] = std::move(low);
    cells_.push_back(std::move(high));
  }

  /// Which cells move: the lower ones hardly.
  void choose(RandomAssembly& out) {
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t k = 0; k < cells_.size(); ++k) {
      order.emplace_back(dot(out.gravity, mass_properties(shape_of(cells_[k])).value().centroid), k);
    }
    std::ranges::sort(order);
    const bool buried = between(0, 1) < 0.5;
    const double low = between(0.4, 0.9), missing = between(0, 0.1),
                 held = buried ? between(0.6, 0.9) : between(0, 0.5);
    for (std::size_t r = 0; r < order.size(); ++r) {
      const double u = between(0, 1);
      const bool fixed = static_cast<double>(r) >= (1 - low) * static_cast<double>(order.size()) || u < missing + held;
      cells_[order[r].second].kind = r == 0 || (!fixed && u >= missing) ? Kind::moves
                                     : u < missing                      ? Kind::missing
                                                                        : Kind::fixed;
    }
    for (Cell& cell : cells_) {
      if (cell.kind != Kind::moves) continue;
      cell.body = static_cast<std::uint32_t>(out.statics.bodies.size());
      add_body(shape_of(cell), out);
    }
    for (const Cell& cell : cells_) {
      if (cell.kind == Kind::fixed) out.scene.bodies.push_back({.shape = shape_of(cell), .fixed = true});
    }
  }

  /// What two convex polygons on one plane have in common.
  static std::vector<Vec3> common(std::vector<Vec3> polygon, const std::vector<Vec3>& other, Vec3 normal) {
    for (std::size_t k = 0; k < other.size() && !polygon.empty(); ++k) {
      const Vec3 in = geometry::normalized(cross(normal, other[(k + 1) % other.size()] - other[k]));
      std::vector<Vec3> left;
      for (std::size_t m = 0; m < polygon.size(); ++m) {
        const Vec3 p = polygon[m], q = polygon[(m + 1) % polygon.size()];
        const double dp = dot(in, p - other[k]), dq = dot(in, q - other[k]);
        if (dp >= -1e-12) left.push_back(p);
        if ((dp >= -1e-12) != (dq >= -1e-12)) left.push_back(p + dp / (dp - dq) * (q - p));
      }
      polygon = std::move(left);
    }
    std::vector<Vec3> out;
    for (const Vec3 p : polygon) {
      if (out.empty() || (norm(p - out.back()) > 1e-9 && norm(p - out.front()) > 1e-9)) out.push_back(p);
    }
    return out;
  }
  void add_contacts(std::size_t low, std::size_t high, RandomAssembly& out) const {
    const Cell &a = cells_[low], &b = cells_[high];
    if (a.kind == Kind::missing || b.kind == Kind::missing || (a.kind == Kind::fixed && b.kind == Kind::fixed)) return;
    for (const Face& below : a.faces) {
      for (const Face& above : b.faces) {
        if (below.side != Side::below || above.side != Side::above || below.plane != above.plane) continue;
        const Vec3 normal = planes_[below.plane].normal;
        assembly::Contact contact{.normal = normal,
                                  .points = common(above.corners, below.corners, normal),
                                  .friction = out.scene.surfaces[below.plane].friction};
        if (contact.points.size() < 3) continue;
        contact.body = b.kind == Kind::moves ? b.body : a.body;
        if (b.kind == Kind::moves && a.kind == Kind::moves) contact.other = a.body;
        if (b.kind != Kind::moves) contact.normal = -normal;
        out.statics.contacts.push_back(std::move(contact));
      }
    }
  }

  std::mt19937_64 random_;
  std::vector<Plane> planes_;
  std::vector<Cell> cells_;
};

}  // namespace cleave::motion::shapes
