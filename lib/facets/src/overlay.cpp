#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

#include "cleave/core/assert.hpp"
#include "cleave/core/disjoint_sets.hpp"
#include "cleave/exact/fixed.hpp"
#include "cleave/geometry/box_tree.hpp"
#include "detail/as_vec3.hpp"
#include "detail/overlaps.hpp"
#include "detail/weld.hpp"

/// Polygons laid over one another in one plane. Seen along an axis their corners are integers, so which side of a line
/// a corner lies on is exact; only how near is near enough to be one is measured.
namespace cleave::topology::detail {
namespace {

using exact::Int128;
using exact::LatticePoint;
using geometry::Vec3;
using Number = std::uint32_t;
using Ring = std::vector<Number>;
using Members = std::vector<std::size_t>;
using Segment = std::pair<Number, Number>;

struct Seen {
  std::int64_t u, v;
  friend constexpr auto operator<=>(const Seen&, const Seen&) = default;
};

int orient2d(Seen a, Seen b, Seen c) {
  const Int128 t = static_cast<Int128>(b.u - a.u) * (c.v - a.v) - static_cast<Int128>(b.v - a.v) * (c.u - a.u);
  return t > 0 ? 1 : t < 0 ? -1 : 0;
}
bool cross_inside(Seen a, Seen b, Seen c, Seen d) {
  return orient2d(a, b, c) * orient2d(a, b, d) < 0 && orient2d(c, d, a) * orient2d(c, d, b) < 0;
}
/// On the segment, its ends included.
bool on_segment(Seen a, Seen b, Seen p) {
  return orient2d(a, b, p) == 0 && std::min(a.u, b.u) <= p.u && p.u <= std::max(a.u, b.u) &&
         std::min(a.v, b.v) <= p.v && p.v <= std::max(a.v, b.v);
}

/// What is in one and not in both; both sorted.
Members unlike(const Members& a, const Members& b) {
  Members out;
  std::ranges::set_symmetric_difference(a, b, std::back_inserter(out));
  return out;
}

class Plan {
 public:
  Plan(std::vector<std::vector<LatticePoint>> rings, std::size_t axis, double within)
      : given_{std::move(rings)}, axis_{axis}, within_{within} {}

  std::optional<Overlay> run() {
    number_corners();
    for (int round = 0;; ++round) {
      if (round == most_rounds) return std::nullopt;
      if (take_corners_on_sides()) continue;
      const auto crossed = meet_crossing_sides();
      if (!crossed) return std::nullopt;
      if (!*crossed) break;
    }
    if (!collect_sides() || !bridge()) return std::nullopt;
    walk();
    return collect_parts();
  }

 private:
  static constexpr int most_rounds = 16;

  [[nodiscard]] Seen seen(LatticePoint p) const {
    return axis_ == 0 ? Seen{p.y, p.z} : axis_ == 1 ? Seen{p.z, p.x} : Seen{p.x, p.y};
  }
  [[nodiscard]] LatticePoint direction() const { return {axis_ == 0 ? 1 : 0, axis_ == 1 ? 1 : 0, axis_ == 2 ? 1 : 0}; }

  /// Corners nearer to each other than can be told apart in the plane become one.
  void number_corners() {
    Weld weld{4 * within_};
    for (const auto& ring : given_) {
      for (const LatticePoint c : ring) weld.add(c, false);
    }
    weld.finish();
    for (auto& ring : given_) {
      for (LatticePoint& c : ring) {
        const LatticePoint to = weld(c);
        if (to != c) moved_.emplace_back(c, to);
        c = to;
        sites_.push_back(c);
      }
    }
    std::ranges::sort(sites_);
    sites_.erase(std::ranges::unique(sites_).begin(), sites_.end());
    for (const auto& ring : given_) {
      Ring own;
      for (const LatticePoint c : ring) {
        const auto at = static_cast<Number>(std::ranges::lower_bound(sites_, c) - sites_.begin());
        if (own.empty() || own.back() != at) own.push_back(at);
      }
      while (own.size() > 1 && own.back() == own.front()) own.pop_back();
      rings_.push_back(std::move(own));
    }
    for (const LatticePoint c : sites_) seen_.push_back(seen(c));
  }
  [[nodiscard]] std::vector<Segment> all_sides() const {
    std::vector<Segment> sides;
    for (const Ring& ring : rings_) {
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const auto [a, b] = std::minmax(ring[i], ring[(i + 1) % ring.size()]);
        if (a != b) sides.emplace_back(a, b);
      }
    }
    std::ranges::sort(sides);
    sides.erase(std::ranges::unique(sides).begin(), sides.end());
    return sides;
  }
  [[nodiscard]] std::vector<geometry::Box> boxes_of(std::span<const Segment> sides) const {
    std::vector<geometry::Box> boxes;
    for (const auto& [a, b] : sides) boxes.push_back(box_of(std::array{sites_[a], sites_[b]}, within_ + 1));
    return boxes;
  }

  /// Corners to put into sides: side, place along it, corner.
  using Splits = std::vector<std::tuple<Segment, double, Number>>;
  bool split(Splits splits) {
    if (splits.empty()) return false;
    std::ranges::sort(splits);
    const auto into = [&](Number a, Number b, Ring& out) {
      const Segment side = std::minmax(a, b);
      const auto first = out.size();
      for (auto at = std::ranges::lower_bound(splits, side, {}, [](const auto& s) { return std::get<0>(s); });
           at != splits.end() && std::get<0>(*at) == side; ++at) {
        if (out.size() == first || out.back() != std::get<2>(*at)) out.push_back(std::get<2>(*at));
      }
      if (a > b) std::reverse(out.begin() + static_cast<std::ptrdiff_t>(first), out.end());
    };
    for (Ring& ring : rings_) {
      Ring longer;
      for (std::size_t i = 0; i < ring.size(); ++i) {
        longer.push_back(ring[i]);
        into(ring[i], ring[(i + 1) % ring.size()], longer);
      }
      ring = std::move(longer);
    }
    return true;
  }
  bool take_corners_on_sides() {
    const auto sides = all_sides();
    const auto boxes = boxes_of(sides);
    const geometry::BoxTree tree{boxes};
    Splits splits;
    for (Number c = 0; c < sites_.size(); ++c) {
      const Vec3 p = as_vec3(sites_[c]);
      tree.overlapping({p, p}, [&](std::uint32_t s) {
        const auto [a, b] = sides[s];
        if (c == a || c == b) return;
        const Vec3 from = as_vec3(sites_[a]), side = as_vec3(sites_[b] - sites_[a]), to = p - from;
        const double length = geometry::norm(side), along = dot(to, side) / length;
        if (along <= 0 || along >= length) return;
        if (geometry::norm(cross(side, to)) <= within_ * length || on_segment(seen_[a], seen_[b], seen_[c])) {
          splits.emplace_back(sides[s], along, c);
        }
      });
    }
    return split(std::move(splits));
  }
  /// Whether any did; none where they cross in the view only.
  std::optional<bool> meet_crossing_sides() {
    const auto sides = all_sides();
    const auto boxes = boxes_of(sides);
    const geometry::BoxTree tree{boxes};
    struct Meeting {
      LatticePoint at;
      std::size_t one, other;
    };
    std::vector<Meeting> meetings;
    bool apart = false;
    for (std::size_t s = 0; s < sides.size(); ++s) {
      tree.overlapping(boxes[s], [&](std::uint32_t t) {
        if (t <= s || apart) return;
        const auto [a, b] = sides[s];
        const auto [c, d] = sides[t];
        if (!cross_inside(seen_[a], seen_[b], seen_[c], seen_[d])) return;
        const Vec3 p = as_vec3(sites_[a]), along = as_vec3(sites_[b] - sites_[a]), q = as_vec3(sites_[c]),
                   other = as_vec3(sites_[d] - sites_[c]);
        const double over = across(along, other);
        if (!(std::abs(over) > 0)) return;
        const Vec3 of_one = p + across(q - p, other) / over * along, of_other = q + across(q - p, along) / over * other;
        apart = apart || geometry::norm(of_one - of_other) > 4 * within_;
        const Vec3 middle = 0.5 * (of_one + of_other);
        meetings.push_back({{std::llround(middle.x), std::llround(middle.y), std::llround(middle.z)}, s, t});
      });
    }
    if (apart) return std::nullopt;
    Splits splits;
    for (const Meeting& m : meetings) {
      const Number c = corner_at(m.at);
      for (const std::size_t s : {m.one, m.other}) {
        const auto [a, b] = sides[s];
        if (c == a || c == b) continue;
        const Vec3 side = as_vec3(sites_[b] - sites_[a]);
        splits.emplace_back(sides[s], dot(as_vec3(sites_[c] - sites_[a]), side) / geometry::norm(side), c);
      }
    }
    return split(std::move(splits));
  }
  [[nodiscard]] double across(Vec3 a, Vec3 b) const {
    return axis_ == 0 ? a.y * b.z - a.z * b.y : axis_ == 1 ? a.z * b.x - a.x * b.z : a.x * b.y - a.y * b.x;
  }
  /// The corner there, or a new one. (Corners near a side are on it by now, so a crossing is near new corners only.)
  Number corner_at(LatticePoint at) {
    const auto cell = [&](std::int64_t x) {
      return static_cast<std::int64_t>(std::floor(static_cast<double>(x) / (2 * within_)));
    };
    const std::array home{cell(at.x), cell(at.y), cell(at.z)};
    for (std::int64_t i = -1; i <= 1; ++i) {
      for (std::int64_t j = -1; j <= 1; ++j) {
        for (std::int64_t k = -1; k <= 1; ++k) {
          const auto found = fresh_.find({home[0] + i, home[1] + j, home[2] + k});
          if (found == fresh_.end()) continue;
          for (const Number c : found->second) {
            if (geometry::norm(as_vec3(sites_[c] - at)) <= 2 * within_) return c;
          }
        }
      }
    }
    const auto number = static_cast<Number>(sites_.size());
    sites_.push_back(at);
    seen_.push_back(seen(at));
    fresh_[home].push_back(number);
    return number;
  }

  /// The sides with what changes across them. False where sides still lie on one another.
  bool collect_sides() {
    std::map<Segment, Members> members;
    for (std::size_t r = 0; r < rings_.size(); ++r) {
      const Ring& ring = rings_[r];
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Segment side = std::minmax(ring[i], ring[(i + 1) % ring.size()]);
        if (side.first == side.second) continue;
        if (seen_[side.first] == seen_[side.second]) return false;
        Members& own = members[side];
        own = unlike(own, {r});
      }
    }
    for (auto& [side, own] : members) {
      if (own.empty()) continue;
      sides_.push_back(side);
      changes_.push_back(std::move(own));
    }
    return true;
  }
  /// Pieces that hang on nothing are joined to the rest, so that every part has one rim.
  bool bridge() {
    DisjointSets<Number> pieces{sites_.size()};
    std::vector<std::uint8_t> used(sites_.size(), 0);
    for (const auto& [a, b] : sides_) {
      pieces.join(a, b);
      used[a] = used[b] = 1;
    }
    std::vector<Number> corners;
    for (Number c = 0; c < sites_.size(); ++c) {
      if (used[c] != 0) corners.push_back(c);
    }
    std::ranges::sort(corners, {}, [&](Number c) { return std::tuple{seen_[c], sites_[c]}; });
    for (const Number c : corners) {  // from the left: the first of each piece but that of the very first
      if (pieces.find(c) == pieces.find(corners.front())) continue;
      std::vector<std::pair<double, Number>> others;
      for (const Number other : corners) {
        if (pieces.find(other) != pieces.find(c))
          others.emplace_back(geometry::norm(as_vec3(sites_[other] - sites_[c])), other);
      }
      std::ranges::sort(others);
      const auto to = std::ranges::find_if(others, [&](const auto& o) { return sees(c, o.second, corners); });
      if (to == others.end()) return false;
      pieces.join(c, to->second);
      sides_.emplace_back(std::minmax(c, to->second));
      changes_.emplace_back();
    }
    return true;
  }
  [[nodiscard]] bool sees(Number from, Number to, std::span<const Number> corners) const {
    const Seen a = seen_[from], b = seen_[to];
    return std::ranges::none_of(
               sides_, [&](const Segment& s) { return cross_inside(a, b, seen_[s.first], seen_[s.second]); }) &&
           std::ranges::none_of(corners, [&](Number c) { return c != from && c != to && on_segment(a, b, seen_[c]); });
  }

  // Half-side 2 s leads from the first corner of side s to the second, 2 s + 1 back.
  [[nodiscard]] Number start(std::size_t half) const {
    return half % 2 == 0 ? sides_[half / 2].first : sides_[half / 2].second;
  }
  [[nodiscard]] Number end(std::size_t half) const { return start(half ^ 1U); }

  /// The faces to the left of all half-sides.
  void walk() {
    std::vector<std::size_t> around(2 * sides_.size());
    for (std::size_t h = 0; h < around.size(); ++h) around[h] = h;
    const auto upper = [&](std::size_t h) {
      const Seen a = seen_[start(h)], b = seen_[end(h)];
      return b.v > a.v || (b.v == a.v && b.u > a.u) ? 0 : 1;
    };
    std::ranges::sort(around, [&](std::size_t g, std::size_t h) {
      if (start(g) != start(h)) return start(g) < start(h);
      if (upper(g) != upper(h)) return upper(g) < upper(h);
      const int t = orient2d(seen_[start(g)], seen_[end(g)], seen_[end(h)]);
      return t != 0 ? t > 0 : g < h;
    });
    next_.assign(around.size(), 0);
    for (std::size_t first = 0, last = 0; first < around.size(); first = last) {
      while (last < around.size() && start(around[last]) == start(around[first])) ++last;
      for (std::size_t k = first; k < last; ++k) {  // who comes in by the twin goes on clockwise of it
        next_[around[k] ^ 1U] = around[k == first ? last - 1 : k - 1];
      }
    }
    face_.assign(around.size(), none);
    for (std::size_t h = 0; h < around.size(); ++h) {
      if (face_[h] != none) continue;
      for (std::size_t at = h; face_[at] == none; at = next_[at]) face_[at] = static_cast<Number>(begin_.size());
      begin_.push_back(h);
    }
  }
  [[nodiscard]] Ring rim(std::size_t face) const {
    Ring ring;
    std::size_t at = begin_[face];
    do {
      ring.push_back(start(at));
      at = next_[at];
    } while (at != begin_[face]);
    return ring;
  }

  /// Parts with who covers them, from the outside inwards.
  std::optional<Overlay> collect_parts() {
    Overlay out;
    out.moved = std::move(moved_);
    if (sides_.empty()) return out;
    std::vector<std::optional<Members>> cover(begin_.size());
    // The half-side that leaves the leftmost corner last in the circle, downwards, has the outside to its right.
    std::size_t outermost = 0;
    for (std::size_t h = 0; h < face_.size(); ++h) {
      const Seen a = seen_[start(h)], best = seen_[start(outermost)];
      if (a < best || (a == best && orient2d(a, seen_[end(outermost)], seen_[end(h)]) < 0)) outermost = h;
    }
    const Number outside = face_[outermost ^ 1U];
    cover[outside] = Members{};
    std::vector<std::vector<std::size_t>> of_face(begin_.size());
    for (std::size_t h = 0; h < face_.size(); ++h) of_face[face_[h]].push_back(h);
    std::vector<std::size_t> reached{outside};
    for (std::size_t k = 0; k < reached.size(); ++k) {
      for (const std::size_t h : of_face[reached[k]]) {
        const Members beyond = unlike(*cover[reached[k]], changes_[h / 2]);
        auto& own = cover[face_[h ^ 1U]];
        if (own && *own != beyond) return std::nullopt;
        if (own) continue;
        own = beyond;
        reached.push_back(face_[h ^ 1U]);
      }
    }
    for (std::size_t f = 0; f < begin_.size(); ++f) {
      if (f == outside || !cover[f] || cover[f]->empty()) continue;
      if (!add_part(rim(f), *cover[f], out)) return std::nullopt;
    }
    return out;
  }
  bool add_part(const Ring& ring, const Members& members, Overlay& out) const {
    std::vector<LatticePoint> corners;
    for (const Number c : ring) corners.push_back(sites_[c]);
    Ring sorted = ring;
    std::ranges::sort(sorted);
    if (std::ranges::adjacent_find(sorted) == sorted.end()) {
      out.parts.push_back({std::move(corners), members});
      return true;
    }
    LatticePolygon shape{exact::Plane::spanned({}, {1, 0, 0}, {0, 1, 0}).value(), direction(), corners, false, false};
    const auto triangles = triangulate(shape);
    if (triangles.empty()) return false;
    for (const auto& [a, b, c] : triangles) out.parts.push_back({{corners[a], corners[b], corners[c]}, members});
    return true;
  }

  std::vector<std::vector<LatticePoint>> given_;
  std::size_t axis_;
  double within_;
  std::vector<std::pair<LatticePoint, LatticePoint>> moved_;
  std::vector<LatticePoint> sites_;
  std::vector<Seen> seen_;  ///< of each site
  std::vector<Ring> rings_;
  std::map<std::array<std::int64_t, 3>, std::vector<Number>> fresh_;  ///< corners where sides cross, by cell
  std::vector<Segment> sides_;
  std::vector<Members> changes_;  ///< which rings begin or end across each side
  std::vector<std::size_t> next_;
  std::vector<Number> face_;
  std::vector<std::size_t> begin_;  ///< a half-side of each face
};

}  // namespace

std::optional<Overlay> overlay(std::vector<std::vector<LatticePoint>> rings, std::size_t axis, double within) {
  return Plan{std::move(rings), axis, within}.run();
}

}  // namespace cleave::topology::detail
