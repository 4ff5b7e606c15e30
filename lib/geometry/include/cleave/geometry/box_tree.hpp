#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "cleave/geometry/vec3.hpp"

namespace cleave::geometry {

/// The box of points as arrays by axis; empty until a point is added.
struct Extents {
  static constexpr double far = std::numeric_limits<double>::infinity();
  std::array<double, 3> lo{far, far, far}, hi{-far, -far, -far};

  constexpr void add(const std::array<double, 3>& p) noexcept {
    for (std::size_t k = 0; k < 3; ++k) {
      lo[k] = std::min(lo[k], p[k]);
      hi[k] = std::max(hi[k], p[k]);
    }
  }
  constexpr void add(Vec3 p) noexcept { add(std::array{p.x, p.y, p.z}); }
};

/// Binary tree over boxes, split at the median of the longest axis: O(n log n) to build, for finding overlapping boxes.
class BoxTree final {
 public:
  explicit BoxTree(std::span<const Box> boxes) : boxes_{boxes}, order_(boxes.size()) {
    std::iota(order_.begin(), order_.end(), std::uint32_t{0});
    if (!boxes.empty()) build(0, order_.size());
  }

  /// Calls visit(number) for each box that overlaps `probe`, in an order that depends on the boxes only.
  template <class Visit>
  void overlapping(const Box& probe, Visit&& visit) const {
    if (nodes_.empty()) return;
    std::array<std::size_t, 128> stack{};  // the tree is balanced: two entries a level
    std::size_t depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const std::size_t self = stack[--depth];
      const Node& node = nodes_[self];
      if (!node.box.overlaps(probe)) continue;
      if (node.right == 0) {
        for (std::size_t i = node.begin; i < node.end; ++i) {
          if (boxes_[order_[i]].overlaps(probe)) visit(order_[i]);
        }
      } else {
        stack[depth++] = node.right;
        stack[depth++] = self + 1;
      }
    }
  }

 private:
  struct Node {
    Box box;
    std::size_t begin, end;
    std::size_t right = 0;  ///< the left child follows its parent; 0 marks a leaf
  };

  std::size_t build(std::size_t begin, std::size_t end) {
    Box box = boxes_[order_[begin]];
    for (std::size_t i = begin + 1; i < end; ++i) box.grow(boxes_[order_[i]]);
    const std::size_t self = nodes_.size();
    nodes_.push_back({box, begin, end});
    if (end - begin > 4) {
      const Vec3 extent = box.size();
      const double longest = std::max({extent.x, extent.y, extent.z});
      const auto centre = [&](std::uint32_t i) {
        const Box& b = boxes_[i];
        return extent.x == longest ? b.min.x + b.max.x : extent.y == longest ? b.min.y + b.max.y : b.min.z + b.max.z;
      };
      const std::size_t middle = begin + (end - begin) / 2;
      const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
      std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
        return std::pair{centre(a), a} < std::pair{centre(b), b};
      });
      build(begin, middle);
      const std::size_t right = build(middle, end);
      nodes_[self].right = right;
    }
    return self;
  }

  std::span<const Box> boxes_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace cleave::geometry
