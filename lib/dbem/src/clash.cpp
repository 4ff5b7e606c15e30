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

/// How far inside an outline a point lies; 0 outside.
double depth_inside(std::span<const Vec2> corners, Vec2 p) {
  double nearest = std::numeric_limits<double>::infinity();
  bool in = false;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vec2 a = corners[k], b = corners[after(k, corners.size())], along = b - a, to = p - a;
    const double share = std::clamp(dot(to, along) / dot(along, along), 0.0, 1.0);
    nearest = std::min(nearest, norm(to - share * along));
    if ((a.y <= p.y) != (b.y <= p.y) && (cross(along, to) > 0) == (b.y > a.y)) in = !in;
  }
  return in ? nearest : 0;
}

/// Deepest place of the outline of `own` in `other`: of its corners and of the middles of what two sides of `other` cut
/// out of a side.
double depth_along_outline(const Solid& own, const Solid& other) {
  const Vec2 low{std::max(own.box.low.x, other.box.low.x), std::max(own.box.low.y, other.box.low.y)};
  const Vec2 high{std::min(own.box.high.x, other.box.high.x), std::min(own.box.high.y, other.box.high.y)};
  double deepest = 0;
  std::vector<double> cuts;
  for (std::size_t k = 0; k < own.corners.size(); ++k) {
    const Vec2 p = own.corners[k], along = own.corners[after(k, own.corners.size())] - p, q = p + along;
    if (std::max(p.x, q.x) < low.x || std::min(p.x, q.x) > high.x) continue;
    if (std::max(p.y, q.y) < low.y || std::min(p.y, q.y) > high.y) continue;
    cuts.assign(1, 0.0);
    for (std::size_t e = 0; e < other.corners.size(); ++e) {
      const Vec2 from = other.corners[e] - p, side = other.corners[after(e, other.corners.size())] - other.corners[e];
      const double turned = cross(along, side);
      if (turned == 0) continue;
      const double here = cross(from, side) / turned, there = cross(from, along) / turned;
      if (here > 0 && here < 1 && there >= 0 && there <= 1) cuts.push_back(here);
    }
    std::ranges::sort(cuts);
    deepest = std::max(deepest, depth_inside(other.corners, p));
    for (std::size_t c = 0; c < cuts.size(); ++c) {
      const double middle = 0.5 * (cuts[c] + (c + 1 < cuts.size() ? cuts[c + 1] : 1.0));
      deepest = std::max(deepest, depth_inside(other.corners, p + middle * along));
    }
  }
  return deepest;
}

/// Deepest place in both among the middles of every three corners in turn: outlines that coincide are not in one
/// another.
double depth_between_corners(const Solid& own, const Solid& other) {
  double deepest = 0;
  const std::size_t n = own.corners.size();
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t next = after(k, n);
    const Vec2 middle = (own.corners[k] + own.corners[next] + own.corners[after(next, n)]) / 3;
    const double there = depth_inside(other.corners, middle);
    if (there > deepest) deepest = std::max(deepest, std::min(there, depth_inside(own.corners, middle)));
  }
  return deepest;
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
  if (across <= enough) return across;
  const double along = std::max(depth_along_outline(a, b), depth_along_outline(b, a));
  const double between = std::max(depth_between_corners(a, b), depth_between_corners(b, a));
  return std::min(across, std::max(along, between));
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
