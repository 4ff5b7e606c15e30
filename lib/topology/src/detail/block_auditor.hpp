#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "cleave/exact/wide.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::topology::detail {

/// One side of a face: from corner i to corner i + 1 of a loop.
struct AuditSide {
  std::uint32_t from, to;
  std::uint32_t next;     ///< the side after it in its loop
  std::uint32_t face;     ///< number of the face within the block
  std::uint32_t partner;  ///< the side of the neighbouring face
};
/// Recomputes closedness and Euler-Poincare of blocks, one after another, from the loops of their faces alone.
class BlockAuditor final {
 public:
  explicit BlockAuditor(const BlockComplex& complex) : complex_{complex}, local_(complex.vertices().size(), unset) {}

  /// Is every side used once in each direction?
  [[nodiscard]] bool closed(const Block& block) {
    block_ = &block;
    sides_.clear();
    loops_ = 0;
    for (const std::uint32_t v : known_) local_[v] = unset;
    known_.clear();
    const auto local = [&](VertexId v) {
      std::uint32_t& number = local_[v.index()];
      if (number == unset) {
        number = static_cast<std::uint32_t>(known_.size());
        known_.push_back(v.value());
      }
      return number;
    };
    for (std::uint32_t f = 0; f < block.faces.size(); ++f) {
      for (const auto loop : complex_.loops(block.faces[f])) {
        const auto first = static_cast<std::uint32_t>(sides_.size());
        const auto count = static_cast<std::uint32_t>(loop.size());
        std::uint32_t from = local(loop[0]);
        for (std::uint32_t i = 0; i < count; ++i) {
          const std::uint32_t to = local(loop[i + 1 < count ? i + 1 : 0]);
          sides_.push_back({from, to, i + 1 < count ? first + i + 1 : first, f, unset});
          from = to;
        }
        ++loops_;
      }
    }
    closed_ = pair_sides();
    return closed_;
  }

  /// (B1) shell by shell: an odd or negative genus means an open or wrongly joined shell. Of the block last given to
  /// `closed`.
  [[nodiscard]] bool euler_holds() {
    if (!closed_) return false;
    const auto faces = static_cast<std::uint32_t>(block_->faces.size());
    // Shells: faces joined over their sides.
    parent_.resize(faces);
    std::iota(parent_.begin(), parent_.end(), 0U);
    const auto find = [&](std::uint32_t a) {
      while (parent_[a] != a) a = parent_[a] = parent_[parent_[a]];
      return a;
    };
    std::uint32_t shells = faces;
    for (const AuditSide& s : sides_) {
      const std::uint32_t a = find(s.face), b = find(sides_[s.partner].face);
      if (a == b) continue;
      parent_[std::max(a, b)] = std::min(a, b);
      if (--shells == 1) break;
    }
    // Fans: turning round a vertex from face to face; a pinched vertex has several.
    seen_.assign(sides_.size(), 0);
    first_of_fan_.clear();
    for (std::uint32_t s = 0; s < sides_.size(); ++s) {
      if (seen_[s] != 0) continue;
      first_of_fan_.push_back(s);
      std::uint32_t at = s;
      do {
        seen_[at] = 1;
        at = sides_[sides_[at].next].partner;
      } while (at != s);
    }
    const auto fans = static_cast<std::int64_t>(first_of_fan_.size()), sides = static_cast<std::int64_t>(sides_.size());
    const std::int64_t genus =
        shells == 1 ? genus_of({fans, sides, 2 * std::int64_t{faces} - static_cast<std::int64_t>(loops_)})
                    : genus_of_shells(find);
    const EulerCounts& c = block_->counts;
    return genus >= 0 && c.vertices == fans && c.edges == sides_.size() / 2 && c.faces == faces && c.loops == loops_ &&
           c.shells == shells && c.genus == genus;
  }

 private:
  using Vec3 = geometry::Vec3;
  static constexpr std::uint32_t unset = UINT32_MAX;
  static constexpr std::size_t few_vertices = 24;

  /// Of one shell.
  struct Sum {
    std::int64_t vertices = 0, sides = 0, faces_less_loops = 0;
  };

  /// -1 where there is no such surface.
  static std::int64_t genus_of(const Sum& shell) {
    const std::int64_t twice = 2 - (shell.vertices - shell.sides / 2 + shell.faces_less_loops);
    return twice < 0 || twice % 2 != 0 ? -1 : twice / 2;
  }
  /// The sum over all shells; `root` gives the face that stands for a face's shell.
  std::int64_t genus_of_shells(const auto& root) {
    const std::size_t faces = block_->faces.size();
    sums_.assign(faces, {});
    for (std::uint32_t f = 0; f < faces; ++f) {
      sums_[root(f)].faces_less_loops += 2 - static_cast<std::int64_t>(complex_.loops(block_->faces[f]).size());
    }
    for (const AuditSide& side : sides_) ++sums_[root(side.face)].sides;
    for (const std::uint32_t s : first_of_fan_) ++sums_[root(sides_[s].face)].vertices;
    std::int64_t genus = 0;
    for (std::uint32_t f = 0; f < faces; ++f) {
      if (parent_[f] != f) continue;
      const std::int64_t own = genus_of(sums_[f]);
      if (own < 0) return -1;
      genus += own;
    }
    return genus;
  }

  /// A pair of vertices joined by sides; those of one lower vertex form a chain.
  struct Record {
    std::uint32_t high, next;
    std::uint32_t forward, backward;  ///< a side from the lower to the higher vertex, and one back
  };

  /// Each side needs one in the opposite direction. Where the boundary touches itself along an edge there are several:
  /// the partner of a face is then the next one met when turning from it through the inside of the block.
  bool pair_sides() {
    if (known_.size() <= few_vertices) return pair_by_table();
    records_.clear();
    first_record_.assign(known_.size(), unset);
    bool several = false;
    for (std::uint32_t s = 0; s < sides_.size() && !several; ++s) {
      const std::uint32_t low = std::min(sides_[s].from, sides_[s].to), high = std::max(sides_[s].from, sides_[s].to);
      std::uint32_t r = first_record_[low];
      while (r != unset && records_[r].high != high) r = records_[r].next;
      if (r == unset) {
        r = static_cast<std::uint32_t>(records_.size());
        records_.push_back({high, first_record_[low], unset, unset});
        first_record_[low] = r;
      }
      std::uint32_t& own = sides_[s].from == low ? records_[r].forward : records_[r].backward;
      several = own != unset || low == high;
      own = s;
    }
    if (several) return pair_groups();
    for (const Record& r : records_) {
      if (r.forward == unset || r.backward == unset) return false;
      sides_[r.forward].partner = r.backward;
      sides_[r.backward].partner = r.forward;
    }
    return true;
  }

  /// The same for a block of few vertices: side number + 1 of each pair of them, 0 where there is none.
  bool pair_by_table() {
    const std::size_t vertices = known_.size();
    table_.assign(vertices * vertices, 0);
    for (std::uint32_t s = 0; s < sides_.size(); ++s) {
      std::uint32_t& own = table_[sides_[s].from * vertices + sides_[s].to];
      if (own != 0 || sides_[s].from == sides_[s].to) return pair_groups();
      own = s + 1;
    }
    for (AuditSide& side : sides_) {
      const std::uint32_t back = table_[side.to * vertices + side.from];
      if (back == 0) return false;
      side.partner = back - 1;
    }
    return true;
  }

  bool pair_groups() {
    std::vector<std::uint32_t> order(sides_.size());
    std::iota(order.begin(), order.end(), 0U);
    const auto key = [&](std::uint32_t s) {
      return std::array{std::min(sides_[s].from, sides_[s].to), std::max(sides_[s].from, sides_[s].to)};
    };
    std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
      const auto x = key(a), y = key(b);
      return x < y || (x == y && a < b);
    });
    for (std::size_t first = 0; first < order.size();) {
      std::size_t last = first;
      while (last < order.size() && key(order[last]) == key(order[first])) ++last;
      if (!pair_group(
              {order.begin() + static_cast<std::ptrdiff_t>(first), order.begin() + static_cast<std::ptrdiff_t>(last)}))
        return false;
      first = last;
    }
    return true;
  }

  bool pair_group(std::vector<std::uint32_t> group) {
    const auto forward = [&](std::uint32_t s) { return sides_[s].from < sides_[s].to; };
    if (group.size() % 2 != 0 || static_cast<std::size_t>(std::ranges::count_if(group, forward)) * 2 != group.size())
      return false;
    if (group.size() == 2) {
      sides_[group[0]].partner = group[1];
      sides_[group[1]].partner = group[0];
      return true;
    }
    const AuditSide& any = sides_[group[0]];
    const Vec3 a = complex_.vertices()[VertexId{known_[std::min(any.from, any.to)]}],
               b = complex_.vertices()[VertexId{known_[std::max(any.from, any.to)]}];
    // An edge shorter than doubles can tell has no direction; any will do to go on, at worst the certificate does not
    // pass.
    const Vec3 axis = b == a ? Vec3{0, 0, 1} : geometry::normalized(b - a);
    const Vec3 e1 = geometry::normalized(geometry::cross(axis, std::abs(axis.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
    const Vec3 e2 = geometry::cross(axis, e1);
    std::vector<std::pair<double, std::uint32_t>> around;
    for (const std::uint32_t s : group) {
      // Into the face: outward normal x direction of the side.
      const Vec3 m = face_of(s).outward;
      const Vec3 into = geometry::cross(m, forward(s) ? axis : -axis);
      around.emplace_back(std::atan2(geometry::dot(into, e2), geometry::dot(into, e1)), s);
    }
    order_closely(around, axis);
    // Turning counter-clockwise about the axis leaves a forward side towards the outside: the inside is met clockwise.
    for (std::size_t i = 0; i < around.size(); ++i) {
      const std::uint32_t s = around[i].second;
      if (!forward(s)) continue;
      const std::uint32_t t = around[(i + around.size() - 1) % around.size()].second;
      if (forward(t)) return false;
      sides_[s].partner = t;
      sides_[t].partner = s;
    }
    return std::ranges::none_of(group, [&](std::uint32_t s) { return sides_[s].partner == unset; });
  }

  /// By angle about the axis, from after the widest gap; where doubles cannot tell, by the integers of the planes.
  void order_closely(std::vector<std::pair<double, std::uint32_t>>& around, Vec3 axis) const {
    std::ranges::sort(around);
    std::size_t start = 0;
    double widest = around.front().first + 2 * std::numbers::pi - around.back().first;
    for (std::size_t i = 1; i < around.size(); ++i) {
      const double gap = around[i].first - around[i - 1].first;
      if (gap <= widest) continue;
      widest = gap;
      start = i;
    }
    for (std::size_t i = 0; i < start; ++i) around[i].first += 2 * std::numbers::pi;
    std::ranges::rotate(around, around.begin() + static_cast<std::ptrdiff_t>(start));
    constexpr double close = 1e-7;
    for (std::size_t i = 1; i < around.size(); ++i) {
      for (std::size_t j = i; j > 0; --j) {
        const double apart = around[j].first - around[j - 1].first;
        if (std::abs(apart) > close || !comes_after(around[j - 1].second, around[j].second, axis)) break;
        std::swap(around[j - 1], around[j]);
      }
    }
  }

  /// Of two faces about an edge at nearly the same angle: whether the first is met after the second, counter-clockwise
  /// about the axis. Exact for faces whose planes hold the edge.
  [[nodiscard]] bool comes_after(std::uint32_t s, std::uint32_t t, Vec3 axis) const {
    const Face one = face_of(s), other = face_of(t);
    const auto line = exact::exact_line(complex_.planes()[one.plane], complex_.planes()[other.plane]);
    const Vec3 size{std::abs(axis.x), std::abs(axis.y), std::abs(axis.z)};
    const std::size_t k = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const double along = k == 0 ? axis.x : k == 1 ? axis.y : axis.z;
    const bool flipped = (along < 0) != (turned(s, one) != turned(t, other));
    return flipped ? line.m.at(k) > 0 : line.m.at(k) < 0;
  }
  [[nodiscard]] Face face_of(std::uint32_t s) const { return complex_.faces()[block_->faces[sides_[s].face]]; }
  /// Whether the face's plane has to be turned for its normal, crossed with the axis, to point into the face.
  [[nodiscard]] bool turned(std::uint32_t s, const Face& face) const {
    return face.block_on_positive_side == (sides_[s].from < sides_[s].to);
  }

  const BlockComplex& complex_;
  const Block* block_ = nullptr;
  std::vector<std::uint32_t> local_;  ///< number of each vertex within the block
  std::vector<std::uint32_t> known_;  ///< vertices of the block
  std::vector<std::uint32_t> first_record_;
  std::vector<Record> records_;
  std::vector<std::uint32_t> table_;
  std::vector<AuditSide> sides_;
  std::vector<std::uint32_t> parent_;
  std::vector<Sum> sums_;
  std::vector<std::uint8_t> seen_;
  std::vector<std::uint32_t> first_of_fan_;
  std::size_t loops_ = 0;
  bool closed_ = false;
};

}  // namespace cleave::topology::detail
