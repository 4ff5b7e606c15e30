#pragma once

#include <compare>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <ranges>
#include <utility>
#include <vector>

#include "cleave/core/assert.hpp"

namespace cleave {

/// A number that names one thing of one kind. No arithmetic, no null (use std::optional), no mixing of kinds.
template <class Tag>
class Id final {
 public:
  constexpr explicit Id(std::uint32_t value) noexcept : value_{value} {}
  constexpr explicit Id(std::size_t value) noexcept : value_{static_cast<std::uint32_t>(value)} {
    CLEAVE_ASSERT(value <= UINT32_MAX);
  }
  [[nodiscard]] constexpr std::uint32_t value() const noexcept { return value_; }
  [[nodiscard]] constexpr std::size_t index() const noexcept { return value_; }
  friend constexpr auto operator<=>(Id, Id) noexcept = default;
  friend constexpr bool operator==(Id, Id) noexcept = default;

 private:
  std::uint32_t value_;
};

/// A vector that only ids of its own kind can index; every access is checked.
template <class Id, class T>
class IdVector final {
 public:
  IdVector() = default;
  explicit IdVector(std::size_t count, const T& value = T{}) : items_(count, value) {}
  explicit IdVector(std::vector<T> items) noexcept : items_{std::move(items)} {}

  [[nodiscard]] decltype(auto) operator[](std::same_as<Id> auto id) { return items_[id.index()]; }
  [[nodiscard]] decltype(auto) operator[](std::same_as<Id> auto id) const { return items_[id.index()]; }

  [[nodiscard]] std::size_t size() const noexcept { return items_.size(); }
  [[nodiscard]] bool empty() const noexcept { return items_.empty(); }
  void reserve(std::size_t count) { items_.reserve(count); }

  Id push_back(T item) {
    items_.push_back(std::move(item));
    return Id{items_.size() - 1};
  }

  /// All ids in order.
  [[nodiscard]] auto ids() const {
    return std::views::iota(std::size_t{0}, items_.size()) | std::views::transform([](std::size_t i) { return Id{i}; });
  }
  [[nodiscard]] auto begin() { return items_.begin(); }
  [[nodiscard]] auto end() { return items_.end(); }
  [[nodiscard]] auto begin() const { return items_.begin(); }
  [[nodiscard]] auto end() const { return items_.end(); }
  [[nodiscard]] const std::vector<T>& items() const noexcept { return items_; }

  friend bool operator==(const IdVector&, const IdVector&) = default;

 private:
  std::vector<T> items_;
};

}  // namespace cleave

template <class Tag>
struct std::hash<cleave::Id<Tag>> {
  std::size_t operator()(cleave::Id<Tag> id) const noexcept { return std::hash<std::uint32_t>{}(id.value()); }
};
