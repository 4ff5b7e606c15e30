#include "clash.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace cleave::dbem {
namespace {

std::size_t after(std::size_t k, std::size_t n) { return k + 1 == n ? 0 : k + 1; }

/// The farthest that all of `other` can be said to lie outside one edge of `own`; stops at one that leaves less than
/// `enough`. Both convex.
double parted_along_edges(std::span<const Vec2> own, std::span<const Vec2> other, double enough, double best) {
  for (std::size_t e = 0; e < own.size(); ++e) {
    const Vec2 along = own[after(e, own.size())] - own[e];
    const double length = norm(along);
    double least = std::numeric_limits<double>::infinity();
    for (const Vec2 p : other) {
      least = std::min(least, cross(p - own[e], along));
      if (least <= best * length) break;
    }
    best = std::max(best, least / length);
    if (best >= -enough) return best;
  }
  return best;
}

struct Segment {
  Vec2 low, high;  // by y
  [[nodiscard]] double x_at(double y) const { return low.x + (y - low.y) / (high.y - low.y) * (high.x - low.x); }
};

std::vector<Segment> segments_between(std::span<const Vec2> corners, double low, double high) {
  std::vector<Segment> out;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    Vec2 a = corners[k], b = corners[after(k, corners.size())];
    if (a.y > b.y) std::swap(a, b);
    if (a.y < b.y && a.y < high && b.y > low) out.push_back({a, b});
  }
  return out;
}

/// Sides that the level y crosses, from left to right: in and out in turn.
void cross_level(const std::vector<Segment>& of, double y, std::vector<Segment>& out) {
  out.clear();
  for (const Segment& s : of) {
    if (s.low.y <= y && y < s.high.y) out.push_back(s);
  }
  std::ranges::sort(out, {}, [y](const Segment& s) { return s.x_at(y); });
}

/// Levels between which no side begins, ends or crosses another.
std::vector<double> levels_of(const std::vector<Segment>& a, const std::vector<Segment>& b, double low, double high) {
  std::vector<double> levels{low, high};
  const auto add = [&](double y) {
    if (y > low && y < high) levels.push_back(y);
  };
  for (const auto* list : {&a, &b}) {
    for (const Segment& s : *list) {
      add(s.low.y);
      add(s.high.y);
    }
  }
  for (const Segment& s : a) {
    const Vec2 d = s.high - s.low;
    for (const Segment& t : b) {
      const Vec2 e = t.high - t.low;
      const double turned = cross(d, e);
      if (turned == 0) continue;
      const double share = cross(t.low - s.low, e) / turned;
      if (share > 0 && share < 1) add(s.low.y + share * d.y);
    }
  }
  std::ranges::sort(levels);
  return levels;
}

/// A connected part of what two bodies share, up to some level.
struct SharedPart {
  double area = 0;
  Box2 extent;
  double left = 0, right = 0;  // at that level
  [[nodiscard]] double depth() const { return area / norm(extent.high - extent.low); }
};

/// What lies between two sides and two levels.
SharedPart between(const Segment& left, const Segment& right, double y0, double y1) {
  const double middle = 0.5 * (y0 + y1), l0 = left.x_at(y0), l1 = left.x_at(y1), r0 = right.x_at(y0),
               r1 = right.x_at(y1);
  return {.area = std::max(right.x_at(middle) - left.x_at(middle), 0.0) * (y1 - y0),
          .extent = {{std::min(l0, l1), y0}, {std::max(r0, r1), y1}},
          .left = l1,
          .right = r1};
}

/// Takes in the parts below that `part` goes on with: they meet it between `left` and `right` at its lower level.
void join(SharedPart& part, std::vector<SharedPart>& below, double left, double right) {
  std::erase_if(below, [&](const SharedPart& other) {
    if (other.right < left || right < other.left) return false;
    part.area += other.area;
    part.extent = {{std::min(part.extent.low.x, other.extent.low.x), std::min(part.extent.low.y, other.extent.low.y)},
                   {std::max(part.extent.high.x, other.extent.high.x), part.extent.high.y}};
    return true;
  });
}

/// Mean width of the part that is widest so. Parts beside one another are no one part: a corner deep inside would be
/// lost in the length of a side that touches elsewhere.
double depth_by_levels(const Solid& a, const Solid& b) {
  const double low = std::max(a.box.low.y, b.box.low.y);
  const double high = std::min(a.box.high.y, b.box.high.y);
  const std::vector<Segment> sides_a = segments_between(a.corners, low, high);
  const std::vector<Segment> sides_b = segments_between(b.corners, low, high);
  const std::vector<double> levels = levels_of(sides_a, sides_b, low, high);
  const double rounding = 1e-14 * (std::abs(low) + std::abs(high) + norm(a.box.high) + norm(a.box.low));
  std::vector<Segment> in_a, in_b;
  std::vector<SharedPart> below, here;
  double worst = 0;
  for (std::size_t k = 0; k + 1 < levels.size(); ++k) {
    const double y0 = levels[k], y1 = levels[k + 1];
    if (!(y1 > y0)) continue;
    const double y = 0.5 * (y0 + y1);
    cross_level(sides_a, y, in_a);
    cross_level(sides_b, y, in_b);
    here.clear();
    for (std::size_t p = 0; p + 1 < in_a.size(); p += 2) {
      for (std::size_t q = 0; q + 1 < in_b.size(); q += 2) {
        const Segment& left = in_a[p].x_at(y) > in_b[q].x_at(y) ? in_a[p] : in_b[q];
        const Segment& right = in_a[p + 1].x_at(y) < in_b[q + 1].x_at(y) ? in_a[p + 1] : in_b[q + 1];
        if (!(right.x_at(y) > left.x_at(y))) continue;
        here.push_back(between(left, right, y0, y1));
        join(here.back(), below, left.x_at(y0) - rounding, right.x_at(y0) + rounding);
      }
    }
    for (const SharedPart& ended : below) worst = std::max(worst, ended.depth());
    std::swap(below, here);
  }
  for (const SharedPart& ended : below) worst = std::max(worst, ended.depth());
  return worst;
}

}  // namespace

double clash_depth(const Solid& a, const Solid& b, double enough) {
  const double across = std::min(std::min(a.box.high.x, b.box.high.x) - std::max(a.box.low.x, b.box.low.x),
                                 std::min(a.box.high.y, b.box.high.y) - std::max(a.box.low.y, b.box.low.y));
  if (across <= 0) return 0;
  if (a.convex && b.convex) {
    double best = parted_along_edges(a.corners, b.corners, enough, -across);
    if (best < -enough) best = parted_along_edges(b.corners, a.corners, enough, best);
    return std::max(-best, 0.0);
  }
  // No deeper than the boxes overlap.
  return across <= enough ? across : std::min(across, depth_by_levels(a, b));
}

void Sweep::choose_axis(std::span<const Box2> boxes) {
  order_.resize(boxes.size());
  std::iota(order_.begin(), order_.end(), 0U);
  // Along the axis on which fewer boxes lie beside one another.
  const auto share = [&](double Vec2::* axis) {
    double low = std::numeric_limits<double>::infinity(), high = -low, widths = 0;
    for (const Box2& box : boxes) {
      low = std::min(low, box.low.*axis);
      high = std::max(high, box.high.*axis);
      widths += box.high.*axis - box.low.*axis;
    }
    return widths / std::max(high - low, std::numeric_limits<double>::min());
  };
  if (share(&Vec2::y) < share(&Vec2::x)) std::swap(along_, across_);
}

std::vector<BodyPair> Sweep::pairs(std::span<const Box2> boxes, std::span<const std::uint8_t> idle) {
  const auto low = [&](std::uint32_t b) { return boxes[b].low.*along_; };
  if (order_.size() != boxes.size()) {
    choose_axis(boxes);
    std::ranges::sort(order_, {}, low);
  }
  for (std::size_t k = 1; k < order_.size(); ++k) {  // nearly in order
    const std::uint32_t body = order_[k];
    std::size_t to = k;
    for (; to > 0 && low(order_[to - 1]) > low(body); --to) order_[to] = order_[to - 1];
    order_[to] = body;
  }
  std::vector<BodyPair> found;
  std::vector<std::uint32_t> open;
  for (const std::uint32_t b : order_) {
    const Box2& box = boxes[b];
    std::size_t kept = 0;
    for (const std::uint32_t a : open) {
      const Box2& other = boxes[a];
      if (other.high.*along_ <= box.low.*along_) continue;
      open[kept++] = a;
      if (idle[a] != 0 && idle[b] != 0) continue;
      if (other.low.*across_ < box.high.*across_ && box.low.*across_ < other.high.*across_) {
        found.push_back({std::min(a, b), std::max(a, b)});
      }
    }
    open.resize(kept);
    open.push_back(b);
  }
  std::ranges::sort(found);
  return found;
}

}  // namespace cleave::dbem
