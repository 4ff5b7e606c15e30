#include "cells.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

namespace cleave::motion {
namespace {

Vec3 area_vector(const std::vector<Vec3>& loop) {
  Vec3 sum;
  for (std::size_t k = 1; k + 1 < loop.size(); ++k) sum += cross(loop[k] - loop[0], loop[k + 1] - loop[0]);
  return 0.5 * sum;
}

/// Sutherland and Hodgman: of a loop that is not convex it keeps the signed area right.
std::vector<Vec3> clip_loop(const std::vector<Vec3>& loop, Vec3 normal, double offset) {
  std::vector<Vec3> out;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vec3 a = loop[k], b = loop[(k + 1) % loop.size()];
    const double da = dot(normal, a) - offset, db = dot(normal, b) - offset;
    if (da <= 0) out.push_back(a);
    if ((da < 0 && db > 0) || (da > 0 && db < 0)) out.push_back(a + da / (da - db) * (b - a));
  }
  return out;
}

/// A facet of the polyhedron as coordinates, with its plane.
struct Sheet {
  std::vector<std::vector<Vec3>> loops = {};
  Vec3 normal = {};
  double offset = 0, area = 0;
  std::uint32_t surface = 0;
};

std::optional<std::vector<Sheet>> sheets_of(const Polyhedron& polyhedron) {
  std::vector<Sheet> out;
  for (const Facet& facet : polyhedron.facets) {
    Sheet sheet{.surface = facet.surface};
    Vec3 area;
    for (const auto& loop : facet.loops) {
      std::vector<Vec3> corners;
      for (const std::uint32_t v : loop) corners.push_back(polyhedron.vertices[v]);
      area += area_vector(corners);
      sheet.loops.push_back(std::move(corners));
    }
    sheet.area = norm(area);
    if (!(sheet.area > 0)) continue;
    sheet.normal = area / sheet.area;
    double sum = 0;
    for (const Vec3 v : sheet.loops[0]) sum += dot(sheet.normal, v);
    sheet.offset = sum / static_cast<double>(sheet.loops[0].size());
    out.push_back(std::move(sheet));
  }
  if (out.size() < 4) return {};
  return out;
}

struct Part {
  double area = 0, extent = 0;
};
/// Of a sheet what is inside a convex piece (on its border counts), moved by nothing.
Part part_inside(const Sheet& sheet, const Piece& piece, double tolerance) {
  Vec3 area;
  Part part;
  for (const auto& loop : sheet.loops) {
    std::vector<Vec3> left = loop;
    for (const auto& polygon : piece.polygons) {
      if (left.empty()) break;
      left = clip_loop(left, polygon.normal, dot(polygon.normal, polygon.corners[0]) + tolerance);
    }
    if (left.size() <= 2) continue;
    area += area_vector(left);
    part.extent = std::max(part.extent, extent_of(left));
  }
  part.area = dot(area, sheet.normal);
  return part;
}

/// Solid angle of a triangle (Van Oosterom and Strackee 1983), signed.
double solid_angle(Vec3 a, Vec3 b, Vec3 c) {
  const double la = norm(a), lb = norm(b), lc = norm(c);
  return 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

bool inside(const std::vector<Sheet>& sheets, Vec3 p) {
  double sum = 0;
  for (const Sheet& sheet : sheets) {
    const Vec3 a = sheet.loops[0][0] - p;
    for (const auto& loop : sheet.loops) {
      for (std::size_t k = 0; k < loop.size(); ++k) sum += solid_angle(a, loop[k] - p, loop[(k + 1) % loop.size()] - p);
    }
  }
  return sum > 2 * std::numbers::pi;
}

Vec3 middle_of(const Piece& piece) {
  Vec3 sum;
  double count = 0;
  for (const auto& polygon : piece.polygons) {
    for (const Vec3 v : polygon.corners) {
      sum += v;
      count += 1;
    }
  }
  return sum / std::max(count, 1.0);
}

double volume_of(const Piece& piece) {
  if (piece.polygons.empty()) return 0;
  const Vec3 o = piece.polygons[0].corners[0];
  double sum = 0;
  for (const auto& polygon : piece.polygons) sum += dot(polygon.corners[0] - o, area_vector(polygon.corners)) / 3;
  return sum;
}

Piece box_around(const std::vector<Vec3>& points, double margin) {
  const auto [lo, hi] = geometry::box_of(points).grown(margin);
  const auto at = [&](unsigned v) {
    return Vec3{(v & 1U) != 0 ? hi.x : lo.x, (v & 2U) != 0 ? hi.y : lo.y, (v & 4U) != 0 ? hi.z : lo.z};
  };
  return {{{{at(0), at(2), at(3), at(1)}, {0, 0, -1}},
           {{at(4), at(5), at(7), at(6)}, {0, 0, 1}},
           {{at(0), at(1), at(5), at(4)}, {0, -1, 0}},
           {{at(2), at(6), at(7), at(3)}, {0, 1, 0}},
           {{at(0), at(4), at(6), at(2)}, {-1, 0, 0}},
           {{at(1), at(3), at(7), at(5)}, {1, 0, 0}}}};
}

/// Numbers of equal points.
class Points {
 public:
  explicit Points(double tolerance) : tolerance_{tolerance} {}
  std::uint32_t operator()(Vec3 p) {
    for (std::uint32_t k = 0; k < points.size(); ++k) {
      if (norm(points[k] - p) <= tolerance_) return k;
    }
    points.push_back(p);
    return static_cast<std::uint32_t>(points.size() - 1);
  }
  std::vector<Vec3> points;

 private:
  double tolerance_;
};

/// Edges are where two sides use the same corners the other way round.
void add_edges(Cell& cell) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> uses;
  for (std::uint32_t s = 0; s < cell.sides.size(); ++s) {
    const auto& corners = cell.sides[s].corners;
    for (std::size_t k = 0; k < corners.size(); ++k) uses[{corners[k], corners[(k + 1) % corners.size()]}] = s;
  }
  for (const auto& [ends, left] : uses) {
    if (ends.first > ends.second) continue;
    const auto back = uses.find({ends.second, ends.first});
    if (back == uses.end()) continue;
    const Side &l = cell.sides[left], &r = cell.sides[back->second];
    if (dot(l.normal, r.normal) > 1 - 1e-12) continue;
    cell.edges.push_back({ends.first, ends.second, left, back->second, l.outer && r.outer});
  }
}

Cell cell_of(const Piece& piece, const std::vector<Sheet>& sheets, double tolerance) {
  Cell cell;
  Points points{tolerance};
  for (const auto& polygon : piece.polygons) {
    Side side{.normal = polygon.normal, .outer = false};
    for (const Vec3 v : polygon.corners) {
      const std::uint32_t number = points(v);
      if (side.corners.empty() || (side.corners.back() != number && side.corners.front() != number)) {
        side.corners.push_back(number);
      }
    }
    if (side.corners.size() < 3) continue;
    const double whole = norm(area_vector(polygon.corners));
    double most = 0;
    for (const Sheet& sheet : sheets) {
      if (dot(sheet.normal, side.normal) < 1 - 1e-9) continue;
      if (std::abs(dot(sheet.normal, polygon.corners[0]) - sheet.offset) > 4 * tolerance) continue;
      const double own = part_inside(sheet, piece, 4 * tolerance).area;
      if (own <= std::max(1e-9 * whole, most)) continue;
      most = own;
      side.outer = true;
      side.surface = sheet.surface;
    }
    cell.sides.push_back(std::move(side));
  }
  cell.vertices = std::move(points.points);
  add_edges(cell);
  return cell;
}

/// Convex, and no two facets on one plane: those become one side.
bool is_convex(const Polyhedron& polyhedron, const std::vector<Sheet>& sheets, double tolerance) {
  for (std::size_t a = 0; a < sheets.size(); ++a) {
    for (std::size_t b = a + 1; b < sheets.size(); ++b) {
      if (dot(sheets[a].normal, sheets[b].normal) > 1 - 1e-9) return false;
    }
  }
  return std::ranges::all_of(sheets, [&](const Sheet& sheet) {
    return sheet.loops.size() == 1 && std::ranges::all_of(polyhedron.vertices, [&](Vec3 v) {
             return dot(sheet.normal, v) <= sheet.offset + tolerance;
           });
  });
}

/// Cuts by the planes of facets that reach into a piece, until none does (binary space partition).
class Partition {
 public:
  Partition(const std::vector<Sheet>& sheets, double size) : sheets_{sheets}, tolerance_{1e-9 * size}, size_{size} {}
  void split(Piece piece, unsigned depth) {
    if (piece.polygons.size() < 4 || cells.size() > most) return;
    // Small parts of facets last: their planes are rounded more, far from them.
    if (split_by(piece, depth, false) || split_by(piece, depth, true)) return;
    if (!inside(sheets_, middle_of(piece))) return;
    volume += volume_of(piece);
    cells.push_back(cell_of(piece, sheets_, tolerance_));
  }
  static constexpr std::size_t most = 5000;
  std::vector<Cell> cells;
  double volume = 0;

 private:
  /// Whether what a piece has of a facet is no more than rounding: of `small` parts a strip of 16 tolerances, where
  /// what is left uncut and what the rounding of its plane does across the body are about the same.
  [[nodiscard]] bool is_little(const Part& part, bool small) const {
    return part.area <= (small ? std::min(16 * part.extent, size_) : size_) * tolerance_;
  }
  bool split_by(const Piece& piece, unsigned depth, bool small) {
    for (std::size_t s = 0; s < sheets_.size() && depth < 200; ++s) {
      const Sheet& sheet = sheets_[s];
      double low = 0, high = 0;
      for (const auto& polygon : piece.polygons) {
        for (const Vec3 v : polygon.corners) {
          const double side = dot(sheet.normal, v) - sheet.offset;
          low = std::min(low, side);
          high = std::max(high, side);
        }
      }
      if (low > -4 * tolerance_ || high < 4 * tolerance_) continue;
      if (is_little(part_inside(sheet, piece, -tolerance_), small)) continue;
      const auto plane = static_cast<std::int32_t>(s);
      split(clip(piece, sheet.normal, sheet.offset, tolerance_, plane), depth + 1);
      split(clip(piece, -sheet.normal, -sheet.offset, tolerance_, plane), depth + 1);
      return true;
    }
    return false;
  }

  const std::vector<Sheet>& sheets_;
  double tolerance_, size_;
};

}  // namespace

double extent_of(const std::vector<Vec3>& points) noexcept {
  return points.empty() ? 0 : norm(geometry::box_of(points).size());
}

Piece clip(const Piece& piece, Vec3 normal, double offset, double tolerance, std::int32_t plane) {
  Piece out;
  std::vector<std::pair<Vec3, Vec3>> rim;
  bool any = false;
  const auto side = [&](Vec3 v) {
    const double d = dot(normal, v) - offset;
    return std::abs(d) <= tolerance ? 0.0 : d;
  };
  for (const auto& polygon : piece.polygons) {
    Piece::Polygon kept{{}, polygon.normal, polygon.plane};
    std::vector<Vec3> border;
    bool below = false;
    for (std::size_t k = 0; k < polygon.corners.size(); ++k) {
      const Vec3 a = polygon.corners[k], b = polygon.corners[(k + 1) % polygon.corners.size()];
      const double da = side(a), db = side(b);
      if (da <= 0) kept.corners.push_back(a);
      if (da == 0) border.push_back(a);
      below = below || da < 0;
      if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
        const Vec3 p = a + da / (da - db) * (b - a);
        kept.corners.push_back(p);
        border.push_back(p);
      }
    }
    if (!below) continue;
    any = true;
    if (kept.corners.size() < 3) continue;
    out.polygons.push_back(std::move(kept));
    if (border.size() == 2) rim.emplace_back(border[0], border[1]);
  }
  if (!any) return {};
  // The new side: the rim's ends, around their middle.
  std::vector<Vec3> corners;
  for (const auto& [a, b] : rim) {
    for (const Vec3 p : {a, b}) {
      if (std::ranges::none_of(corners, [&](Vec3 q) { return norm(p - q) <= tolerance; })) corners.push_back(p);
    }
  }
  if (corners.size() < 3) return out;
  Vec3 middle;
  for (const Vec3 p : corners) middle += p / static_cast<double>(corners.size());
  Vec3 far = corners[0] - middle;
  far = geometry::normalized(far - dot(far, normal) * normal);
  const Vec3 across = cross(normal, far);
  std::ranges::sort(corners, {}, [&](Vec3 p) { return std::atan2(dot(across, p - middle), dot(far, p - middle)); });
  out.polygons.push_back({std::move(corners), normal, plane});
  return out;
}

std::expected<std::vector<Cell>, BadPolyhedron> convex_cells(const Polyhedron& polyhedron, double volume) {
  const auto sheets = sheets_of(polyhedron);
  if (!sheets) return std::unexpected(BadPolyhedron{"it has fewer than four sides with an area"});
  const double size = extent_of(polyhedron.vertices), tolerance = 1e-9 * size;
  if (is_convex(polyhedron, *sheets, tolerance)) {
    Piece piece;
    for (const Sheet& sheet : *sheets) piece.polygons.push_back({sheet.loops[0], sheet.normal, 0});
    Cell cell = cell_of(piece, *sheets, tolerance);
    if (cell.sides.size() < 4) return std::unexpected(BadPolyhedron{"it is thinner than a billionth of its extent"});
    return std::vector{std::move(cell)};
  }
  Partition partition{*sheets, size};
  partition.split(box_around(polyhedron.vertices, 0.01 * size), 0);
  // Corners that lie off their planes by rounding leave a skin over the sides, which is much of a thin plate.
  double skin = 0;
  for (const Sheet& sheet : *sheets) skin += 4 * tolerance * sheet.area;
  if (!(std::abs(partition.volume - volume) <= std::clamp(skin, 1e-7 * volume, 1e-4 * volume))) {
    return std::unexpected(BadPolyhedron{"its convex parts do not add up to its volume"});
  }
  std::erase_if(partition.cells, [](const Cell& cell) { return cell.sides.size() < 4; });
  return std::move(partition.cells);
}

}  // namespace cleave::motion
