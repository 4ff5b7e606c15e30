#include "plane_cells.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "poisson.hpp"

namespace cleave::dfn::detail {

using geometry::Polygon;
using geometry::Vec3;

namespace {

constexpr double overshoot = 3;  // grid steps

double side(const Line2& line, Vec2 p) { return line.cos * p.x + line.sin * p.y - line.offset; }

/// The part of a convex cell on the negative (or positive) side of a line; empty when the line does not cut it there.
Cell part_of(const Cell& cell, const std::vector<double>& sides, double sign, std::size_t number) {
  Cell part;
  const std::size_t n = cell.corners.size();
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = (i + 1) % n;
    const double a = sign * sides[i], b = sign * sides[j];
    if (a >= 0) {
      part.corners.push_back(cell.corners[i]);
      // Leaving across this corner: the edge that follows lies on the line.
      part.line.push_back(a == 0 && b < 0 ? number : cell.line[i]);
    }
    if ((a > 0 && b < 0) || (a < 0 && b > 0)) {
      const double t = sides[i] / (sides[i] - sides[j]);
      const Vec2 p = cell.corners[i], q = cell.corners[j];
      part.corners.push_back({p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)});
      part.line.push_back(a > 0 ? number : cell.line[i]);
    }
  }
  return part;
}

std::vector<double> sides_of(const Cell& cell, const Line2& line) {
  std::vector<double> sides;
  sides.reserve(cell.corners.size());
  for (const Vec2 p : cell.corners) sides.push_back(side(line, p));
  return sides;
}

Cell square(double half) {
  return {{{-half, -half}, {half, -half}, {half, half}, {-half, half}}, std::vector<std::size_t>(4, Cell::border)};
}

}  // namespace

double area(const Cell& cell) noexcept {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < cell.corners.size(); ++i) {
    const Vec2 o = cell.corners[0], p = cell.corners[i], q = cell.corners[i + 1];
    sum += (p.x - o.x) * (q.y - o.y) - (p.y - o.y) * (q.x - o.x);
  }
  return sum / 2;
}

Vec2 centroid(const Cell& cell) noexcept {
  const Vec2 o = cell.corners[0];
  double sum = 0, x = 0, y = 0;
  for (std::size_t i = 1; i + 1 < cell.corners.size(); ++i) {
    const Vec2 p = cell.corners[i], q = cell.corners[i + 1];
    const double a = (p.x - o.x) * (q.y - o.y) - (p.y - o.y) * (q.x - o.x);
    sum += a;
    x += a * (p.x + q.x - 2 * o.x) / 3;
    y += a * (p.y + q.y - 2 * o.y) / 3;
  }
  return sum > 0 ? Vec2{o.x + x / sum, o.y + y / sum} : o;
}

Calipers calipers(const Cell& cell) noexcept {
  Calipers widths{INFINITY, 0};
  const std::size_t n = cell.corners.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 p = cell.corners[i], q = cell.corners[(i + 1) % n];
    const double length = std::hypot(q.x - p.x, q.y - p.y);
    double width = 0;
    for (const Vec2 r : cell.corners) {
      widths.largest = std::max(widths.largest, std::hypot(r.x - p.x, r.y - p.y));
      if (length > 0) width = std::max(width, ((q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x)) / length);
    }
    if (length > 0) widths.smallest = std::min(widths.smallest, width);
  }
  return widths;
}

double smallest_angle(const Cell& cell) noexcept {
  double smallest = std::numbers::pi;
  const std::size_t n = cell.corners.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 p = cell.corners[i], q = cell.corners[(i + 1) % n], o = cell.corners[(i + n - 1) % n];
    const double ax = q.x - p.x, ay = q.y - p.y, bx = o.x - p.x, by = o.y - p.y;
    smallest = std::min(smallest, std::abs(std::atan2(ax * by - ay * bx, ax * bx + ay * by)));
  }
  return smallest;
}

std::vector<Cell> cut_by_lines(Cell outline, const std::vector<Line2>& lines) {
  std::vector<Cell> cells;
  if (outline.corners.size() < 3) return cells;
  cells.push_back(std::move(outline));
  for (std::size_t number = 0; number < lines.size(); ++number) {
    const std::size_t before = cells.size();
    for (std::size_t i = 0; i < before; ++i) {
      const std::vector<double> sides = sides_of(cells[i], lines[number]);
      const auto [low, high] = std::ranges::minmax(sides);
      if (low >= 0 || high <= 0) continue;
      Cell other = part_of(cells[i], sides, -1, number);
      cells[i] = part_of(cells[i], sides, 1, number);
      cells.push_back(std::move(other));
    }
  }
  return cells;
}

std::vector<Cell> cells_reaching(const Cell& region, double radius, const std::vector<Line2>& lines) {
  Cell outline = square(radius);
  std::vector<Line2> crossing;
  for (const Line2& line : lines) {
    const std::vector<double> sides = sides_of(region, line);
    const auto [low, high] = std::ranges::minmax(sides);
    if (low < 0 && high > 0) {
      crossing.push_back(line);
      continue;
    }
    const std::vector<double> distances = sides_of(outline, line);
    const auto [least, most] = std::ranges::minmax(distances);
    if (least < 0 && most > 0) outline = part_of(outline, distances, low >= 0 ? 1 : -1, Cell::border);
  }
  return cut_by_lines(std::move(outline), crossing);
}

Cell common_part(Cell cell, const Cell& region) {
  const std::size_t n = region.corners.size();
  for (std::size_t i = 0; i < n && !cell.corners.empty(); ++i) {
    const Vec2 p = region.corners[i], q = region.corners[(i + 1) % n];
    const double length = std::hypot(q.x - p.x, q.y - p.y);
    if (!(length > 0)) continue;
    const double cosine = (p.y - q.y) / length, sine = (q.x - p.x) / length;  // inwards
    const std::vector<double> sides = sides_of(cell, {cosine, sine, cosine * p.x + sine * p.y});
    const auto [low, high] = std::ranges::minmax(sides);
    if (high <= 0) return {};
    if (low < 0) cell = part_of(cell, sides, 1, Cell::border);
  }
  return cell;
}

Cell cell_at_origin(Rng& rng) {
  // The nearest lines first, 2r of them within r, until the next is farther than all corners. The square is as good as
  // the plane: a cell that reaches its sides has a chance of e^-38.
  Cell cell = square(60);
  double distance = 0, reach = INFINITY;
  for (;;) {
    distance -= std::log1p(-rng.uniform()) / 2;
    if (distance >= reach) return cell;
    const double angle = 2 * std::numbers::pi * rng.uniform();
    const std::vector<double> sides = sides_of(cell, {std::cos(angle), std::sin(angle), distance});
    if (std::ranges::max(sides) <= 0) continue;
    cell = part_of(cell, sides, -1, Cell::border);
    reach = 0;
    for (const Vec2 p : cell.corners) reach = std::max(reach, std::hypot(p.x, p.y));
  }
}

std::vector<Line2> poisson_lines(double density, double radius, Rng& rng) {
  // Lines that meet a convex body: density * perimeter / pi in the mean.
  const std::uint64_t n = poisson(2 * radius * density, rng);
  std::vector<Line2> lines;
  lines.reserve(n);
  for (std::uint64_t i = 0; i < n; ++i) {
    const double angle = std::numbers::pi * rng.uniform();
    const double offset = (2 * rng.uniform() - 1) * radius;
    lines.push_back({std::cos(angle), std::sin(angle), offset});
  }
  return lines;
}

GridPlane::GridPlane(Vec3 through, Vec3 strike, Vec3 normal, double reach) {
  constexpr double bits = 4194304;  // 2^22
  const double largest = std::max({std::abs(through.x), std::abs(through.y), std::abs(through.z)});
  int exponent = 0;
  std::frexp(2 * reach, &exponent);
  const double quantum = std::ldexp(1.0, exponent - 44);
  step_ = quantum * bits;
  // The origin on the same grid; far from zero on the grid that doubles still have there.
  int far = 0;
  std::frexp(largest, &far);
  const double coarse = std::max(quantum, std::ldexp(1.0, far - 50));
  const auto rounded = [](Vec3 v, double unit) {
    return Vec3{std::nearbyint(v.x / unit) * unit, std::nearbyint(v.y / unit) * unit,
                std::nearbyint(v.z / unit) * unit};
  };
  origin_ = rounded(through, coarse);
  const Vec3 up_dip = cross(normal, strike);
  a_ = quantum * rounded(bits * strike, 1);
  b_ = quantum * rounded(bits * up_dip, 1);
  along_ = strike;
  across_ = up_dip;
  normal_ = normalized(cross(a_, b_));
  if (normal_.z < 0) normal_ = -normal_;
}

Vec3 GridPlane::at(Vec2 p) const noexcept {
  return origin_ + (std::nearbyint(p.x / step_) * a_ + std::nearbyint(p.y / step_) * b_);
}

Vec2 GridPlane::flat(Vec3 p) const noexcept { return {dot(p - origin_, along_), dot(p - origin_, across_)}; }

std::optional<Line2> GridPlane::trace(Vec3 through, Vec3 normal) const noexcept {
  const double x = dot(normal, along_), y = dot(normal, across_), length = std::hypot(x, y);
  if (length < 1e-9) return std::nullopt;
  return Line2{x / length, y / length, dot(normal, through - origin_) / length};
}

Cell section(const GridPlane& plane, const DomainBox& box) {
  const Vec3 middle = (box.min + box.max) / 2, half = (box.max - box.min) / 2;
  const Vec2 centre = plane.flat(middle);
  const double r = 2 * norm(half);
  Cell cell{{{centre.x - r, centre.y - r},
             {centre.x + r, centre.y - r},
             {centre.x + r, centre.y + r},
             {centre.x - r, centre.y + r}},
            std::vector<std::size_t>(4, Cell::border)};
  const std::array<std::pair<Vec3, Vec3>, 6> sides{{{box.min, {1, 0, 0}},
                                                    {box.max, {-1, 0, 0}},
                                                    {box.min, {0, 1, 0}},
                                                    {box.max, {0, -1, 0}},
                                                    {box.min, {0, 0, 1}},
                                                    {box.max, {0, 0, -1}}}};
  for (const auto& [through, inwards] : sides) {
    if (cell.corners.size() < 3) return {};
    const auto line = plane.trace(through, inwards);
    if (!line) {
      // Parallel to the side: wholly within or without.
      if (dot(inwards, plane.at(centre) - through) < 0) return {};
      continue;
    }
    const std::vector<double> distances = sides_of(cell, *line);
    const auto [low, high] = std::ranges::minmax(distances);
    if (high <= 0) return {};
    if (low < 0) cell = part_of(cell, distances, 1, Cell::border);
  }
  return cell;
}

std::optional<Polygon> joint_of(const GridPlane& plane, const Cell& cell) {
  const double by = overshoot * plane.step();
  if (cell.corners.size() < 3 || calipers(cell).smallest < 4 * by) return std::nullopt;
  // Corners closer than some steps are one: the offset below needs edges with a direction.
  std::vector<Vec2> corners;
  for (const Vec2 p : cell.corners) {
    const auto near = [&](Vec2 q) { return std::hypot(p.x - q.x, p.y - q.y) < 2 * by; };
    if (!corners.empty() && (near(corners.back()) || near(corners.front()))) continue;
    corners.push_back(p);
  }
  const std::size_t n = corners.size();
  if (n < 3) return std::nullopt;
  std::vector<Vec3> outline;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 o = corners[(i + n - 1) % n], p = corners[i], q = corners[(i + 1) % n];
    const double u = std::hypot(p.x - o.x, p.y - o.y), v = std::hypot(q.x - p.x, q.y - p.y);
    const Vec2 m{(p.y - o.y) / u, -(p.x - o.x) / u}, k{(q.y - p.y) / v, -(q.x - p.x) / v};  // outward normals
    const double spread = std::max(1 + m.x * k.x + m.y * k.y, 0.05);  // needle corners move less far
    outline.push_back(plane.at({p.x + by * (m.x + k.x) / spread, p.y + by * (m.y + k.y) / spread}));
  }
  auto polygon = Polygon::make(std::move(outline));
  if (!polygon) return std::nullopt;
  return *std::move(polygon);
}

}  // namespace cleave::dfn::detail
