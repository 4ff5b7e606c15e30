#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "hull.hpp"
#include "world_impl.hpp"

namespace cleave::motion {
namespace {

using Pair = std::pair<std::uint32_t, std::uint32_t>;

/// What `part(first, last)` makes of [0, count), piece by piece, in order.
template <class Part>
auto in_pieces(std::size_t count, ThreadLimit threads, const Part& part) {
  constexpr std::size_t piece = 256;
  auto parts = parallel_map((count + piece - 1) / piece, threads,
                            [&](std::size_t k) { return part(k * piece, std::min(count, (k + 1) * piece)); });
  if (parts.size() == 1) return std::move(parts[0]);
  decltype(part(0, 0)) out;
  std::size_t size = 0;
  for (const auto& own : parts) size += own.size();
  out.reserve(size);
  for (const auto& own : parts) out.insert(out.end(), own.begin(), own.end());
  return out;
}

/// Whether a point lies in a cell, by more than `depth`.
bool within(const Placed& cell, Vec3 p, double depth) {
  for (std::size_t s = 0; s < cell.normals.size(); ++s) {
    if (dot(cell.normals[s], p - cell.vertices[cell.cell->sides[s].corners[0]]) > -depth) return false;
  }
  return true;
}

/// Of the touches of two bodies on one plane only the corners of their convex hull: no pressure leaves it. `plane`: one
/// normal, one pair of surfaces, gaps equal to rounding.
void keep_hull(const std::vector<Touch>& plane, std::vector<Touch>& out) {
  if (plane.size() < 4) {
    out.insert(out.end(), plane.begin(), plane.end());
    return;
  }
  const Frame frame = frame_of(plane[0].normal);
  const double tolerance = 1e-9 * plane[0].size;
  std::vector<Flat> at;
  for (const Touch& t : plane) at.push_back({dot(frame.t1, t.point), dot(frame.t2, t.point)});
  for (const std::uint32_t k : hull_of(at, tolerance)) out.push_back(plane[k]);
}

/// All touches with those that lie within hulls of others left out.
std::vector<Touch> reduced(const std::vector<Touch>& list) {
  std::vector<Touch> out, plane;
  out.reserve(list.size());
  std::vector<std::uint8_t> used(list.size(), 0);
  const auto pair_of = [&](std::uint32_t k) {
    return Pair{std::min(list[k].body, list[k].other), std::max(list[k].body, list[k].other)};
  };
  std::vector<std::uint32_t> order(list.size());
  std::iota(order.begin(), order.end(), std::uint32_t{0});
  std::ranges::stable_sort(order, {}, pair_of);
  for (std::size_t first_of_pair = 0, end = 0; first_of_pair < order.size(); first_of_pair = end) {
    while (end < order.size() && pair_of(order[end]) == pair_of(order[first_of_pair])) ++end;
    const auto own = std::span<const std::uint32_t>{order}.subspan(first_of_pair, end - first_of_pair);
    for (std::size_t a = 0; a < own.size(); ++a) {
      if (used[own[a]] != 0) continue;
      const Touch& first = list[own[a]];
      plane.assign(1, first);
      for (std::size_t b = a + 1; b < own.size(); ++b) {
        Touch t = list[own[b]];
        if (used[own[b]] != 0) continue;
        if (t.body != first.body) {
          std::swap(t.body, t.other);
          std::swap(t.cell, t.other_cell);
          std::swap(t.surface, t.other_surface);
          t.normal = -t.normal;
        }
        const double near = 1e-8 * first.size;
        if (t.surface != first.surface || t.other_surface != first.other_surface ||
            dot(t.normal, first.normal) < 1 - 1e-14 || std::abs(t.gap - first.gap) > near ||
            std::abs(dot(first.normal, t.point - first.point)) > near) {
          continue;
        }
        used[own[b]] = 1;
        plane.push_back(t);
      }
      keep_hull(plane, out);
    }
  }
  return out;
}

}  // namespace

void World::Impl::place_all(const std::vector<State>& s, bool everything) {
  for (Placed& p : placed) {
    if (everything || moves(p.body)) place(p, centroid(s[p.body], p.body), s[p.body].turn);
  }
}

std::vector<Pair> World::Impl::near_pairs(const std::vector<double>& travel) const {
  // A tree of what moves alone: most of a large scene may be asleep.
  std::vector<std::uint32_t> moving;
  std::vector<geometry::Box> boxes;
  for (std::uint32_t c = 0; c < placed.size(); ++c) {
    if (!moves(placed[c].body)) continue;
    moving.push_back(c);
    boxes.push_back(placed[c].box.grown(travel[placed[c].body]));
  }
  if (moving.empty()) return {};
  const geometry::BoxTree tree{boxes};
  std::vector<Pair> out =
      in_pieces(placed.size(), ThreadLimit{options.threads}, [&](std::size_t first, std::size_t last) {
        std::vector<Pair> own;
        for (auto c = static_cast<std::uint32_t>(first); c < last; ++c) {
          const std::uint32_t body = placed[c].body;
          tree.overlapping(placed[c].box.grown(travel[body]), [&](std::uint32_t at) {
            const std::uint32_t other = moving[at];
            if (placed[other].body == body || (moves(body) && other < c)) return;
            own.emplace_back(std::min(c, other), std::max(c, other));
          });
        }
        return own;
      });
  std::ranges::sort(out);
  return out;
}

std::vector<Touch> World::Impl::touches_of(const std::vector<Pair>& pairs, const std::vector<double>& travel,
                                           bool strict) const {
  return reduced(in_pieces(pairs.size(), ThreadLimit{options.threads}, [&](std::size_t first, std::size_t last) {
    std::vector<Touch> out, own;
    for (const auto& [i, j] : std::span{pairs}.subspan(first, last - first)) {
      const Placed &a = placed[i], &b = placed[j];
      const auto axis = widest_axis(a, b);
      const double reach = travel[a.body] + travel[b.body];
      if (!axis || axis->gap > reach) continue;
      own.clear();
      touches_along(a, b, *axis, reach, strict, own);
      if (!own.empty() && !is_covered(own)) out.insert(out.end(), own.begin(), own.end());
    }
    return out;
  }));
}

bool World::Impl::is_covered(const std::vector<Touch>& own) const {
  const Shape& shape = shapes[own[0].other];
  if (shape.last_cell - shape.first_cell < 2) return false;
  Vec3 middle;
  for (const Touch& t : own) middle += (t.point - t.gap * t.normal) / static_cast<double>(own.size());
  const Vec3 probe = middle + 1e-6 * own[0].size * own[0].normal;
  for (std::uint32_t c = shape.first_cell; c < shape.last_cell; ++c) {
    if (c != own[0].other_cell && within(placed[c], probe, 1e-8 * own[0].size)) return true;
  }
  return false;
}

void World::Impl::recall(std::vector<Touch>& list, double step) const {
  if (!(last_step > 0)) return;
  const auto key = [](const Touch& t) { return std::pair{std::min(t.body, t.other), std::max(t.body, t.other)}; };
  const double ratio = step / last_step;
  std::vector<std::uint32_t> order(touches.size());
  for (std::uint32_t k = 0; k < order.size(); ++k) order[k] = k;
  std::ranges::stable_sort(order, {}, [&](std::uint32_t k) { return key(touches[k]); });
  std::vector<std::uint8_t> used(touches.size(), 0);
  for (Touch& t : list) {
    const auto own = std::ranges::equal_range(order, key(t), {}, [&](std::uint32_t k) { return key(touches[k]); });
    double nearest = 0.1 * t.size;
    std::optional<std::uint32_t> best;
    for (const std::uint32_t k : own) {
      const double same = touches[k].body == t.body ? 1 : -1;
      if (used[k] != 0 || same * dot(touches[k].normal, t.normal) < 0.99) continue;
      if (const double d = norm(touches[k].point - t.point); d < nearest) {
        nearest = d;
        best = k;
      }
    }
    if (!best) continue;
    used[*best] = 1;
    t.impulse = (touches[*best].body == t.body ? ratio : -ratio) * touches[*best].impulse;
  }
}

std::vector<Touch> World::Impl::missed(const std::vector<Touch>& list, const std::vector<Touch>& at_end,
                                       const std::vector<State>& mid, const std::vector<State>& end) const {
  std::vector<Touch> out;
  for (const Touch& t : at_end) {
    if (t.gap > -1e-8 * t.size) continue;
    const bool known = std::ranges::any_of(list, [&](const Touch& l) {
      const bool same = l.body == t.body && l.other == t.other;
      const bool turned = l.body == t.other && l.other == t.body;
      if (!same && !turned) return false;
      const double along = dot(l.normal, t.normal);
      return (same ? along : -along) > 0.99 && std::abs(dot(l.normal, l.point - t.point)) < 0.2 * t.size;
    });
    if (known) continue;
    Touch back = t;
    const auto at_kick = [&](std::uint32_t b) {
      return centroid(mid[b], b) + mid[b].turn * end[b].turn.back(t.point - centroid(end[b], b));
    };
    const Vec3 foot = t.point - t.gap * t.normal;
    back.normal = mid[t.other].turn * end[t.other].turn.back(t.normal);
    back.point = at_kick(t.body);
    const Vec3 base = centroid(mid[t.other], t.other) +
                      mid[t.other].turn * end[t.other].turn.back(foot - centroid(end[t.other], t.other));
    back.gap = dot(back.normal, back.point - base);
    out.push_back(back);
  }
  return out;
}

World::Impl::Look World::Impl::look() const {
  const std::vector<double> none(shapes.size(), 0);
  Look out{near_pairs(none), {}};
  out.touches = touches_of(out.pairs, none, false);
  return out;
}

double World::Impl::deepest_overlap(const std::vector<Pair>& near, std::vector<std::uint32_t>& pair) const {
  std::vector<double> shares(near.size());
  parallel_for(near.size(), ThreadLimit{options.threads}, [&](std::size_t k) {
    const Placed &a = placed[near[k].first], &b = placed[near[k].second];
    const double size = std::min(shapes[a.body].size, shapes[b.body].size);
    shares[k] = overlap_depth(a, b, 0.1 * options.overlap * size) / size;
  });
  const auto worst = std::ranges::max_element(shares);
  if (worst == shares.end() || !(*worst > 0)) return 0;
  const Pair& of = near[static_cast<std::size_t>(worst - shares.begin())];
  pair = {placed[of.first].body, placed[of.second].body};
  return *worst;
}

}  // namespace cleave::motion
