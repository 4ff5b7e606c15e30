#include <algorithm>
#include <cmath>
#include <numeric>

#include "cleave/scene2d/contact.hpp"

namespace cleave::scene {
namespace {

using bem::Vec2;
using Polygon = std::vector<Vec2>;

Vec2 next_of(const Polygon& polygon, std::size_t k) { return polygon[k + 1 == polygon.size() ? 0 : k + 1]; }

double distance_to(const Polygon& polygon, Vec2 p) {
  double best = 1e300;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec2 a = polygon[k], d = next_of(polygon, k) - a;
    const double t = std::clamp(dot(p - a, d) / dot(d, d), 0.0, 1.0);
    best = std::min(best, norm(p - a - t * d));
  }
  return best;
}

bool contains(const Polygon& polygon, Vec2 p) {
  bool in = false;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec2 a = polygon[k], b = next_of(polygon, k);
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) in = !in;
  }
  return in;
}

/// A point well inside: the middle of the longest chord of the level through the middle of the box's height, shifted
/// off the corners' levels.
Vec2 inner_point(const Polygon& polygon) {
  std::vector<double> levels;
  for (const Vec2 p : polygon) levels.push_back(p.y);
  std::ranges::sort(levels);
  double gap = 0, y = levels.front();
  for (std::size_t k = 0; k + 1 < levels.size(); ++k) {
    if (levels[k + 1] - levels[k] > gap) {
      gap = levels[k + 1] - levels[k];
      y = (levels[k + 1] + levels[k]) / 2;
    }
  }
  std::vector<double> xs;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec2 a = polygon[k], b = next_of(polygon, k);
    if ((a.y > y) != (b.y > y)) xs.push_back(a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
  }
  std::ranges::sort(xs);
  double width = -1, x = polygon.front().x;
  for (std::size_t k = 0; k + 1 < xs.size(); k += 2) {
    if (xs[k + 1] - xs[k] > width) {
      width = xs[k + 1] - xs[k];
      x = (xs[k] + xs[k + 1]) / 2;
    }
  }
  return {x, y};
}

/// Keeps the deepest of points of `a`'s boundary that lie in `b`.
void probe(const Polygon& a, const Polygon& b, Overlap& deepest) {
  const auto test = [&](Vec2 p) {
    if (!contains(b, p)) return;
    const double depth = distance_to(b, p);
    if (depth > deepest.depth) {
      deepest.depth = depth;
      deepest.at = p;
    }
  };
  std::vector<double> cuts;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const Vec2 p = a[k], d = next_of(a, k) - p;
    test(p);
    cuts.assign({0.0, 1.0});
    for (std::size_t m = 0; m < b.size(); ++m) {
      const Vec2 q = b[m], e = next_of(b, m) - q;
      const double det = cross(d, e);
      if (det != 0) {
        const double t = cross(q - p, e) / det, s = cross(q - p, d) / det;
        if (t > 0 && t < 1 && s >= -1e-9 && s <= 1 + 1e-9) cuts.push_back(t);
      }
      // Ends of sides that run along this one.
      const double along = dot(q - p, d) / dot(d, d);
      if (along > 0 && along < 1) cuts.push_back(along);
    }
    std::ranges::sort(cuts);
    for (std::size_t c = 0; c + 1 < cuts.size(); ++c) test(p + (cuts[c] + cuts[c + 1]) / 2 * d);
  }
  test(inner_point(a));
}

}  // namespace

std::vector<Overlap> overlaps_of(const std::vector<Polygon>& polygons, double tolerance) {
  std::vector<Box2> boxes;
  boxes.reserve(polygons.size());
  for (const Polygon& polygon : polygons) boxes.push_back(box_of(polygon));
  // Sweeps along the axis on which the boxes lie further apart: a pile of thousands has one place on the other.
  const auto spread = [&](double Vec2::* axis) {
    double low = 1e300, high = -1e300, widths = 0;
    for (const Box2& box : boxes) {
      low = std::min(low, box.low.*axis);
      high = std::max(high, box.high.*axis);
      widths += box.high.*axis - box.low.*axis;
    }
    return widths > 0 ? (high - low) / widths : 0;
  };
  const bool upright = spread(&Vec2::y) > spread(&Vec2::x);
  const auto along = upright ? &Vec2::y : &Vec2::x;
  const auto other = upright ? &Vec2::x : &Vec2::y;
  std::vector<std::size_t> order(polygons.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return boxes[k].low.*along; });
  std::vector<Overlap> found;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Box2& a = boxes[order[i]];
    for (std::size_t j = i + 1; j < order.size() && boxes[order[j]].low.*along < a.high.*along; ++j) {
      const Box2& b = boxes[order[j]];
      if (b.low.*other >= a.high.*other || a.low.*other >= b.high.*other) continue;
      Overlap deepest{std::min(order[i], order[j]), std::max(order[i], order[j]), tolerance, {}};
      probe(polygons[order[i]], polygons[order[j]], deepest);
      probe(polygons[order[j]], polygons[order[i]], deepest);
      if (deepest.depth > tolerance) found.push_back(deepest);
    }
  }
  std::ranges::sort(found, [](const Overlap& a, const Overlap& b) {
    return a.first != b.first ? a.first < b.first : a.second < b.second;
  });
  return found;
}

}  // namespace cleave::scene
