#include "detail/nest_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "cleave/core/assert.hpp"
#include "detail/exact_ray.hpp"
#include "detail/pieces.hpp"

namespace cleave::topology::detail {
namespace {

using exact::Sign;

double dot(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Numbers from -1 to 1, the same ones each time.
class Numbers {
 public:
  double operator()() {
    state_ += 0x9E3779B97F4A7C15U;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    return static_cast<double>((z ^ (z >> 31U)) >> 11U) * 0x1p-52 - 1.0;
  }
  Vec direction() {
    Vec ray{};
    do {
      ray = {(*this)(), (*this)(), (*this)()};
    } while (dot(ray, ray) > 1 || dot(ray, ray) < 0.1);
    return ray;
  }

 private:
  std::uint64_t state_ = 0x9E3779B97F4A7C15U;
};

/// Whether a ray (or line) passes a box by.
constexpr double margin = 0x1p-34;
bool misses(const Vec& lo, const Vec& hi, const Vec& from, const Vec& ray) {
  double t0 = -margin, t1 = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    if (std::abs(ray[k]) < 1e-3) continue;
    double a = (lo[k] - margin - from[k]) / ray[k], b = (hi[k] + margin - from[k]) / ray[k];
    if (a > b) std::swap(a, b);
    t0 = std::max(t0, a - margin);
    t1 = std::min(t1, b + margin);
  }
  return t0 > t1;
}

/// A face with its box.
struct Target {
  Index face;
  Vec lo, hi;
  Index piece;
};

/// A tree of boxes over targets; a leaf holds a few of them.
class TargetTree {
 public:
  explicit TargetTree(std::vector<Target> targets) : targets_{std::move(targets)} {
    grow(0, static_cast<Index>(targets_.size()));
  }

  /// Visits the targets whose boxes the ray may meet, until `visit` returns false.
  void along(const Vec& from, const Vec& ray, const auto& visit) const {
    std::vector<Index> open{0};
    while (!open.empty()) {
      const Node& node = nodes_[open.back()];
      open.pop_back();
      if (misses(node.lo, node.hi, from, ray)) continue;
      if (node.left != none) {
        open.push_back(node.left);
        open.push_back(node.right);
        continue;
      }
      for (Index t = node.first; t < node.last; ++t) {
        const Target& target = targets_[t];
        if (!misses(target.lo, target.hi, from, ray) && !visit(target)) return;
      }
    }
  }

 private:
  struct Node {
    Vec lo, hi;
    Index first, last;  ///< targets
    Index left = none, right = none;
  };

  Index grow(Index first, Index last) {
    Node node{{1, 1, 1}, {-1, -1, -1}, first, last};
    for (Index t = first; t < last; ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        node.lo[k] = std::min(node.lo[k], targets_[t].lo[k]);
        node.hi[k] = std::max(node.hi[k], targets_[t].hi[k]);
      }
    }
    const auto place = static_cast<Index>(nodes_.size());
    nodes_.push_back(node);
    if (last - first <= 8) return place;
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k) {
      if (node.hi[k] - node.lo[k] > node.hi[axis] - node.lo[axis]) axis = k;
    }
    const Index middle = first + (last - first) / 2;
    std::nth_element(targets_.begin() + first, targets_.begin() + middle, targets_.begin() + last,
                     [axis](const Target& a, const Target& b) {
                       const double x = a.lo[axis] + a.hi[axis], y = b.lo[axis] + b.hi[axis];
                       return x < y || (!(y < x) && a.face < b.face);
                     });
    const Index left = grow(first, middle);
    const Index right = grow(middle, last);
    nodes_[place].left = left;
    nodes_[place].right = right;
    return place;
  }

  std::vector<Target> targets_;
  std::vector<Node> nodes_;
};

struct Side {  ///< of a face of a piece
  Index from, to;
};

class Nester {
 public:
  Nester(const Prepared& prepared, const Graph& graph, const Arrangement& arrangement,
         const std::vector<Vec>& positions, const std::vector<Index>& piece_of_face, std::size_t pieces)
      : prepared_{prepared},
        graph_{graph},
        arrangement_{arrangement},
        positions_{positions},
        sides_of_(pieces),
        tree_{targets(piece_of_face)} {}

  [[nodiscard]] Index faced(Index piece) const {
    const auto clear = by_doubles(piece);
    return clear ? *clear : exactly(piece);
  }

 private:
  [[nodiscard]] const Vec& start_of(Index half_edge) const { return positions_[arrangement_.start[half_edge]]; }

  std::vector<Target> targets(const std::vector<Index>& piece_of_face) {
    std::vector<Target> all;
    for (Index f = 0; f < piece_of_face.size(); ++f) {
      if (piece_of_face[f] == none) continue;
      Target target{f, {1, 1, 1}, {-1, -1, -1}, piece_of_face[f]};
      const Index start = arrangement_.loops[arrangement_.faces[f].first_loop];
      Index h = start;
      do {
        const Vec& p = start_of(h);
        for (std::size_t k = 0; k < 3; ++k) {
          target.lo[k] = std::min(target.lo[k], p[k]);
          target.hi[k] = std::max(target.hi[k], p[k]);
        }
        sides_of_[target.piece].push_back({arrangement_.start[h], arrangement_.start[h ^ 1U]});
        h = arrangement_.next[h];
      } while (h != start);
      all.push_back(target);
    }
    return all;
  }

  /// By rays from an extreme point of the piece, going out. Directions in which a ray passes too close to an edge to
  /// call, or meets two faces too close together, are given up for others; empty when none was clear. A start that
  /// touches another piece's face is no difficulty: pieces do not cross, so an edge of this one says on which side it
  /// lies there.
  [[nodiscard]] std::optional<Index> by_doubles(Index piece) const {
    Numbers random;
    const auto& sides = sides_of_[piece];
    for (int attempt = 0; attempt < 100; ++attempt) {
      const Vec ray = random.direction();
      const Index start =
          std::ranges::max_element(sides, {}, [&](const Side& e) { return dot(positions_[e.from], ray); })->from;
      Hit nearest{std::numeric_limits<double>::infinity(), 0, false, false, false};
      Index met = none;
      bool unclear = false;
      tree_.along(positions_[start], ray, [&](const Target& target) {
        if (target.piece == piece) return true;
        const auto hit = shoot(target.face, start, ray);
        if (!hit) return true;
        unclear = hit->unclear || std::abs(hit->at - nearest.at) <= hit->error + nearest.error;
        if (unclear) return false;
        if (hit->at < nearest.at) {
          nearest = *hit;
          const bool positive = hit->touching ? on_positive_side(target.face, sides, start) : hit->from_positive;
          met = 2 * target.face + (positive ? 0 : 1);
        }
        return true;
      });
      if (!unclear) return met;
    }
    return std::nullopt;
  }

  /// By rays from a point inside an edge of the piece, in any direction: beyond the last face of its own a ray is
  /// outside of the piece, and what it meets next is what the piece looks at.
  [[nodiscard]] Index exactly(Index piece) const {
    Numbers random;
    const auto& sides = sides_of_[piece];
    for (std::size_t attempt = 0; attempt < 10000; ++attempt) {
      const Vec along = random.direction();
      const Side& side = sides[attempt % sides.size()];
      const auto whole = [](double x, double by) { return static_cast<std::int64_t>(std::nearbyint(x * by)); };
      const std::array direction{whole(along[0], 0x1p30), whole(along[1], 0x1p30), whole(along[2], 0x1p30)};
      Vec ray{};
      for (std::size_t k = 0; k < 3; ++k) ray[k] = static_cast<double>(direction[k]) * 0x1p-30;
      const double share = 0.5 + 0.25 * random();
      const ExactRay exact{prepared_, graph_,   arrangement_, graph_.meet(side.from), graph_.meet(side.to),
                           share,     direction};
      const Vec &a = positions_[side.from], &b = positions_[side.to];
      const Vec from{a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2])};
      if (const auto met = beyond_own(piece, exact, from, ray)) return *met;
    }
    CLEAVE_ASSERT(false);  // edges and corners take up no share of the directions
    return none;
  }

  /// Empty when the ray passes through a rim, or through two faces at one place.
  [[nodiscard]] std::optional<Index> beyond_own(Index piece, const ExactRay& exact, const Vec& from,
                                                const Vec& ray) const {
    Rational last_own = 0;
    std::vector<std::pair<Rational, Index>> others;
    bool unclear = false;
    tree_.along(from, ray, [&](const Target& target) {
      const ExactRay::Hit hit = exact.shoot(target.face);
      if (hit.kind == ExactRay::Hit::Kind::missed) return true;
      const bool own = target.piece == piece;
      // The faces at its own edge are met at the start.
      unclear = hit.kind == ExactRay::Hit::Kind::unclear ? !(own && hit.at == 0) : !own && hit.at == 0;
      if (unclear) return false;
      if (own) {
        last_own = std::max(last_own, hit.at);
      } else {
        others.emplace_back(hit.at, 2 * target.face + (hit.from_positive ? 0 : 1));
      }
      return true;
    });
    if (unclear) return std::nullopt;
    std::erase_if(others, [&](const auto& hit) { return hit.first < last_own; });
    std::ranges::sort(others);
    if (others.empty()) return none;
    if (others.front().first == last_own || (others.size() > 1 && others[1].first == others[0].first))
      return std::nullopt;
    return others.front().second;
  }

  /// Exact.
  [[nodiscard]] Sign side_of(Index vertex, Index face) const {
    const auto& [p, q, r] = graph_.meet(vertex);
    const Index plane = arrangement_.faces[face].plane;
    if (plane == p || plane == q || plane == r) return Sign::zero;
    return exact::side_exact(prepared_.planes[p], prepared_.planes[q], prepared_.planes[r], prepared_.planes[plane]);
  }

  /// On which side of a face that it touches with the vertex `at` the piece lies.
  [[nodiscard]] bool on_positive_side(Index face, const std::vector<Side>& sides, Index at) const {
    for (const auto& [from, to] : sides) {
      if (from != at && to != at) continue;
      const Sign side = side_of(from == at ? to : from, face);
      if (side != Sign::zero) return side == Sign::positive;
    }
    return false;
  }

  struct Hit {
    double at, error;
    bool from_positive;
    bool touching;  ///< the start lies on the face's plane
    bool unclear;
  };
  [[nodiscard]] std::optional<Hit> shoot(Index f, Index start_vertex, const Vec& ray) const {
    const PlaneFace& face = arrangement_.faces[f];
    const Vec& from = positions_[start_vertex];
    const auto& n = prepared_.planes[face.plane].approx();
    const double rate = n[0] * ray[0] + n[1] * ray[1] + n[2] * ray[2];
    const double height = n[0] * from[0] + n[1] * from[1] + n[2] * from[2] + n[3];
    constexpr Hit not_clear{0, 0, false, false, true};
    if (std::abs(rate) < 1e-4) return not_clear;
    const double t = -height / rate;
    if (t < -margin) return std::nullopt;
    Sign side = height > 0 ? Sign::positive : Sign::negative;
    if (t < margin) {
      side = side_of(start_vertex, f);
      if (side != Sign::zero && (side == Sign::positive) == (rate > 0)) return std::nullopt;  // it lies behind
    }
    const Vec p{from[0] + t * ray[0], from[1] + t * ray[1], from[2] + t * ray[2]};
    const auto within = contains(face, p);
    if (!within) return not_clear;
    if (!*within) return std::nullopt;
    constexpr double error_of_heights = 0x1p-40;
    return Hit{t, error_of_heights / std::abs(rate), side == Sign::positive, side == Sign::zero, false};
  }

  /// Empty near the rim.
  [[nodiscard]] std::optional<bool> contains(const PlaneFace& face, const Vec& p) const {
    const auto [u, v] = View{prepared_.planes[face.plane].approx()};
    bool inside = false;
    for (Index l = face.first_loop; l < face.first_loop + face.loop_count; ++l) {
      const Index start = arrangement_.loops[l];
      Index h = start;
      do {
        const Index g = arrangement_.next[h];
        const Vec &a = start_of(h), &b = start_of(g);
        const double du = b[u] - a[u], dv = b[v] - a[v];
        const double length = std::sqrt(du * du + dv * dv);
        const double off = du * (p[v] - a[v]) - dv * (p[u] - a[u]);
        const double along = du * (p[u] - a[u]) + dv * (p[v] - a[v]);
        if (std::abs(off) <= margin * length && along >= -margin * length && along <= length * (length + margin)) {
          return std::nullopt;
        }
        if ((a[v] > p[v]) != (b[v] > p[v]) && (off > 0) == (dv > 0)) inside = !inside;
        h = g;
      } while (h != start);
    }
    return inside;
  }

  const Prepared& prepared_;
  const Graph& graph_;
  const Arrangement& arrangement_;
  const std::vector<Vec>& positions_;
  std::vector<std::vector<Side>> sides_of_;
  TargetTree tree_;
};

}  // namespace

std::vector<Index> find_faced(const Prepared& prepared, const Graph& graph, const Arrangement& arrangement,
                              const std::vector<Vec>& positions, const std::vector<Index>& piece_of_face,
                              std::size_t pieces, ThreadLimit threads) {
  const Nester nester{prepared, graph, arrangement, positions, piece_of_face, pieces};
  std::vector<Index> faced(pieces, none);
  parallel_for(pieces, threads, [&](std::size_t piece) { faced[piece] = nester.faced(static_cast<Index>(piece)); });
  return faced;
}

}  // namespace cleave::topology::detail
