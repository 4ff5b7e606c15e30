#include "detail/convex_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "cleave/exact/predicates.hpp"

/// A sweep over the corners, exact throughout: corners have integer coordinates in the view along an axis.
namespace cleave::topology::detail {
namespace {

using exact::Int128;
using exact::LatticePoint;
using exact::Sign;
using Number = std::size_t;

std::int64_t component(LatticePoint p, std::size_t axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }
LatticePoint unit(std::size_t axis, std::int64_t sense) {
  return {axis == 0 ? sense : 0, axis == 1 ? sense : 0, axis == 2 ? sense : 0};
}

/// The plane as seen against `along`, moved along it onto the coordinate plane that it is farthest from.
struct Sight {
  LatticePoint along;
  std::size_t right, up, depth;  ///< axes

  explicit Sight(LatticePoint a) : along{a}, right{0}, up{1}, depth{2} {
    for (const std::size_t axis : {1U, 0U}) {
      if (std::abs(component(a, axis)) > std::abs(component(a, depth))) depth = axis;
    }
    right = (depth + 1) % 3;
    up = (depth + 2) % 3;
    if (component(a, depth) < 0) std::swap(right, up);
  }
  [[nodiscard]] Int128 seen(LatticePoint p, std::size_t axis) const {
    return static_cast<Int128>(component(p, axis)) * component(along, depth) -
           static_cast<Int128>(component(p, depth)) * component(along, axis);
  }
};

bool touch(LatticePoint a, LatticePoint b, LatticePoint c, LatticePoint d, LatticePoint along) {
  if (a == c || a == d || b == c || b == d) return false;
  const auto apart = [](Sign x, Sign y) { return x == y && x != Sign::zero; };
  return !apart(orient2d(a, b, c, along), orient2d(a, b, d, along)) &&
         !apart(orient2d(c, d, a, along), orient2d(c, d, b, along));
}

/// One sweep, upwards in the view; cuts go to the right and left.
class Sweep {
 public:
  Sweep(std::span<const std::vector<LatticePoint>> loops, LatticePoint along, bool upright) : along_{along} {
    const Sight sight{along};
    rightwards_ = unit(upright ? sight.right : sight.up, component(along, sight.depth) < 0 ? -1 : 1);
    for (const auto& loop : loops) {
      const Number first = corners_.size();
      for (Number i = 0; i < loop.size(); ++i) {
        corners_.push_back(loop[i]);
        before_.push_back(first + (i + loop.size() - 1) % loop.size());
        after_.push_back(first + (i + 1) % loop.size());
        const Int128 u = sight.seen(loop[i], sight.right), v = sight.seen(loop[i], sight.up);
        place_.push_back(upright ? std::pair{v, u} : std::pair{-u, v});
      }
    }
  }

  /// False where loops touch or cross.
  bool run() {
    std::vector<Number> order(corners_.size());
    std::iota(order.begin(), order.end(), Number{0});
    std::ranges::sort(order, {}, [&](Number p) { return place_[p]; });
    const auto again = std::ranges::adjacent_find(order, {}, [&](Number p) { return place_[p]; });
    return again == order.end() && std::ranges::all_of(order, [&](Number p) { return pass(p); }) && active_.empty();
  }
  [[nodiscard]] double length_of_cuts() const { return length_; }
  [[nodiscard]] std::vector<ConvexPiece> pieces() && { return std::move(pieces_); }

 private:
  using Point = std::array<double, 3>;
  /// Part of the level line of a corner that is inside.
  struct Cut {
    Number at;
    Point left, right;
  };
  /// The end below and above of a side that bounds a region.
  struct Wall {
    Number low, high;
  };
  /// What is inside between two walls, above a cut or a lowest corner; not yet closed above.
  struct Region {
    Wall left, right;
    Number lowest;
    std::optional<Cut> floor;
    std::vector<Number> left_sides = {}, right_sides = {};
    std::vector<Point> left_corners = {}, right_corners = {};
  };
  using Place = std::ptrdiff_t;

  [[nodiscard]] Sign side(Wall wall, Number p) const {
    return orient2d(corners_[wall.low], corners_[wall.high], corners_[p], along_);
  }
  [[nodiscard]] bool later(Number p, Number than) const { return place_[than] < place_[p]; }
  [[nodiscard]] Point point(Number p) const {
    return {static_cast<double>(corners_[p].x), static_cast<double>(corners_[p].y), static_cast<double>(corners_[p].z)};
  }
  /// Where a wall is on the level of a corner.
  [[nodiscard]] Point level(Wall wall, Number p) const {
    const Int128 rise = place_[wall.high].first - place_[wall.low].first;
    const double share =
        rise > 0 ? static_cast<double>(place_[p].first - place_[wall.low].first) / static_cast<double>(rise) : 0;
    const Point a = point(wall.low), b = point(wall.high);
    return {a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2])};
  }
  Region& region(Place k) { return regions_[active_[static_cast<Number>(k)]]; }
  [[nodiscard]] const Region& region(Place k) const { return regions_[active_[static_cast<Number>(k)]]; }
  [[nodiscard]] Place count() const { return static_cast<Place>(active_.size()); }

  void open(Place k, Wall left, Wall right, Number lowest, std::optional<Cut> floor) {
    Region fresh{left, right, lowest, floor};
    fresh.left_sides.push_back(left.high);
    fresh.right_sides.push_back(right.low);
    if (!floor) fresh.left_corners.push_back(point(lowest));
    active_.insert(active_.begin() + k, regions_.size());
    regions_.push_back(std::move(fresh));
  }

  [[nodiscard]] bool flat_side(Number side, Number level) const {
    return place_[side].first == place_[level].first && place_[after_[side]].first == place_[level].first;
  }
  void add_cut(ConvexPiece& piece, const Region& of, Number at, LatticePoint direction) const {
    const auto on_it = [&](Number side) { return flat_side(side, at); };
    if (std::ranges::any_of(of.left_sides, on_it) || std::ranges::any_of(of.right_sides, on_it)) return;
    piece.sides.push_back({corners_[at], direction, ConvexPiece::cut});
  }
  /// What is left of a region below its highest corner, or below a cut there.
  void close(Place k, Number highest, std::optional<Cut> ceiling) {
    const Region done = std::move(region(k));
    active_.erase(active_.begin() + k);
    if (place_[done.lowest].first == place_[highest].first) return;  // all on one line
    ConvexPiece piece;
    const auto add = [&](const Point& p) {
      if (piece.corners.empty() || piece.corners.back() != p) piece.corners.push_back(p);
    };
    if (done.floor) {
      add_cut(piece, done, done.floor->at, rightwards_);
      add(done.floor->left);
      add(done.floor->right);
    }
    for (const auto* sides : {&done.left_sides, &done.right_sides}) {
      for (const Number s : *sides) piece.sides.push_back({corners_[s], corners_[after_[s]] - corners_[s], s});
    }
    std::ranges::for_each(done.right_corners, add);
    if (ceiling) {
      add_cut(piece, done, ceiling->at, LatticePoint{} - rightwards_);
      add(ceiling->right);
      add(ceiling->left);
    } else {
      add(point(highest));
    }
    for (Number i = done.left_corners.size(); i-- > 0;) add(done.left_corners[i]);
    if (piece.corners.back() == piece.corners.front()) piece.corners.pop_back();
    pieces_.push_back(std::move(piece));
  }
  Cut across(Number p, const Point& left, const Point& right) {
    length_ += std::hypot(right[0] - left[0], right[1] - left[1], right[2] - left[2]);
    return {p, left, right};
  }

  /// Neighbouring walls around the regions from `first` to `last`.
  [[nodiscard]] bool walls_apart(Place first, Place last) const {
    const auto apart = [&](Wall a, Wall b) {
      return !touch(corners_[a.low], corners_[a.high], corners_[b.low], corners_[b.high], along_);
    };
    for (Place k = std::max<Place>(first, 0); k <= std::min(last, count() - 1); ++k) {
      if (!apart(region(k).left, region(k).right)) return false;
      if (k > 0 && !apart(region(k - 1).right, region(k).left)) return false;
    }
    return last + 1 < 1 || last + 1 >= count() || apart(region(last).right, region(last + 1).left);
  }

  bool pass(Number p) {
    const auto found =
        std::ranges::partition_point(active_, [&](Number r) { return side(regions_[r].right, p) == Sign::negative; });
    const Place k = found - active_.begin();
    const bool rises = later(after_[p], p), falls = later(before_[p], p);
    const bool convex = orient2d(corners_[before_[p]], corners_[p], corners_[after_[p]], along_) == Sign::positive;
    if (rises && falls) return convex ? begin(k, p) : split(k, p);
    if (k == count()) return false;
    if (!rises && !falls) return convex ? end(k, p) : merge(k, p);
    return rises ? bend_right(k, p, convex) : bend_left(k, p, convex);
  }
  [[nodiscard]] Wall left_wall(Number low) const { return {low, before_[low]}; }
  [[nodiscard]] Wall right_wall(Number low) const { return {low, after_[low]}; }

  bool begin(Place k, Number p) {
    if (k < count() && side(region(k).left, p) != Sign::positive) return false;
    open(k, left_wall(p), right_wall(p), p, std::nullopt);
    return walls_apart(k, k);
  }
  bool split(Place k, Number p) {
    if (k == count() || side(region(k).left, p) != Sign::negative || side(region(k).right, p) != Sign::positive) {
      return false;
    }
    const Wall left = region(k).left, right = region(k).right;
    const Cut cut = across(p, level(left, p), level(right, p));
    close(k, p, cut);
    open(k, left, right_wall(p), p, Cut{p, cut.left, point(p)});
    open(k + 1, left_wall(p), right, p, Cut{p, point(p), cut.right});
    return walls_apart(k, k + 1);
  }
  bool end(Place k, Number p) {
    if (region(k).left.high != p || region(k).right.high != p) return false;
    close(k, p, std::nullopt);
    return k == 0 || walls_apart(k - 1, k - 1);
  }
  bool merge(Place k, Number p) {
    if (region(k).right.high != p || k + 1 == count() || region(k + 1).left.high != p) return false;
    const Wall left = region(k).left, right = region(k + 1).right;
    const Cut cut = across(p, level(left, p), level(right, p));
    close(k + 1, p, Cut{p, point(p), cut.right});
    close(k, p, Cut{p, cut.left, point(p)});
    open(k, left, right, p, cut);
    return walls_apart(k, k);
  }
  bool bend_right(Place k, Number p, bool convex) {
    if (region(k).right.high != p) return false;
    if (convex) {
      region(k).right_corners.push_back(point(p));
      region(k).right_sides.push_back(p);
      region(k).right = right_wall(p);
    } else {
      const Wall left = region(k).left;
      const Cut cut = across(p, level(left, p), point(p));
      close(k, p, cut);
      open(k, left, right_wall(p), p, cut);
    }
    return walls_apart(k, k);
  }
  bool bend_left(Place k, Number p, bool convex) {
    if (region(k).left.high != p) return false;
    if (convex) {
      region(k).left_corners.push_back(point(p));
      region(k).left_sides.push_back(before_[p]);
      region(k).left = left_wall(p);
    } else {
      const Wall right = region(k).right;
      const Cut cut = across(p, point(p), level(right, p));
      close(k, p, cut);
      open(k, left_wall(p), right, p, cut);
    }
    return walls_apart(k, k);
  }

  LatticePoint along_, rightwards_;
  std::vector<LatticePoint> corners_;
  std::vector<Number> before_, after_;
  std::vector<std::pair<Int128, Int128>> place_;  ///< up and right in the view
  std::vector<Region> regions_;
  std::vector<Number> active_;  ///< from left to right
  std::vector<ConvexPiece> pieces_;
  double length_ = 0;
};

}  // namespace

std::vector<ConvexPiece> convex_pieces(std::span<const std::vector<LatticePoint>> loops, LatticePoint along) {
  Sweep level{loops, along, true}, upright{loops, along, false};
  if (!level.run() || !upright.run()) return {};
  return (upright.length_of_cuts() < level.length_of_cuts() ? std::move(upright) : std::move(level)).pieces();
}

}  // namespace cleave::topology::detail
