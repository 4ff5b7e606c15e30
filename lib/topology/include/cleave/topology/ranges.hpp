#pragma once

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>

#include "cleave/core/id.hpp"
#include "cleave/topology/ids.hpp"

namespace cleave::topology {

/// Neighbouring face numbers: the faces of one block.
using FaceRange = IdRange<FaceId>;

/// The loops of one face, each a span of corners; the outer loop first.
class LoopRange final {
 public:
  class Iterator {
   public:
    using value_type = std::span<const VertexId>;
    using difference_type = std::ptrdiff_t;
    Iterator() = default;
    Iterator(const LoopRange& loops, std::size_t at) noexcept
        : corners_{loops.corners_}, holes_{loops.holes_}, at_{at} {}
    [[nodiscard]] value_type operator*() const { return LoopRange{corners_, holes_}[at_]; }
    Iterator& operator++() noexcept {
      ++at_;
      return *this;
    }
    Iterator operator++(int) noexcept {
      Iterator old = *this;
      ++at_;
      return old;
    }
    friend bool operator==(const Iterator& a, const Iterator& b) noexcept { return a.at_ == b.at_; }

   private:
    std::span<const VertexId> corners_;
    std::span<const std::uint32_t> holes_;
    std::size_t at_ = 0;
  };

  /// `holes` say where the second, third, ... loop begins in `corners`.
  LoopRange(std::span<const VertexId> corners, std::span<const std::uint32_t> holes) noexcept
      : corners_{corners}, holes_{holes} {}

  [[nodiscard]] std::size_t size() const noexcept { return corners_.empty() ? 0 : 1 + holes_.size(); }
  [[nodiscard]] bool empty() const noexcept { return corners_.empty(); }
  [[nodiscard]] std::span<const VertexId> operator[](std::size_t k) const {
    const std::size_t first = k == 0 ? 0 : holes_[k - 1];
    const std::size_t last = k < holes_.size() ? holes_[k] : corners_.size();
    return corners_.subspan(first, last - first);
  }
  [[nodiscard]] std::span<const VertexId> front() const { return (*this)[0]; }
  [[nodiscard]] Iterator begin() const noexcept { return {*this, 0}; }
  [[nodiscard]] Iterator end() const noexcept { return {*this, size()}; }
  /// The corners of all loops, one loop after another.
  [[nodiscard]] std::span<const VertexId> all_corners() const noexcept { return corners_; }

 private:
  std::span<const VertexId> corners_;
  std::span<const std::uint32_t> holes_;
};

}  // namespace cleave::topology
