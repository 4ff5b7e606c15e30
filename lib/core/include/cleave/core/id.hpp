#pragma once

#include <compare>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <iterator>
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
  /// For literals: `BlockId{0}`.
  constexpr explicit Id(int value) noexcept : value_{static_cast<std::uint32_t>(value)} { CLEAVE_ASSERT(value >= 0); }
  [[nodiscard]] constexpr std::uint32_t value() const noexcept { return value_; }
  [[nodiscard]] constexpr std::size_t index() const noexcept { return value_; }
  friend constexpr auto operator<=>(Id, Id) noexcept = default;
  friend constexpr bool operator==(Id, Id) noexcept = default;

 private:
  std::uint32_t value_;
};

/// Neighbouring ids: first, first + 1, ...
template <class Id>
class IdRange final {
 public:
  class Iterator {
   public:
    using value_type = Id;
    using difference_type = std::ptrdiff_t;
    Iterator() = default;
    explicit Iterator(std::uint32_t at) noexcept : at_{at} {}
    [[nodiscard]] Id operator*() const noexcept { return Id{at_}; }
    Iterator& operator++() noexcept {
      ++at_;
      return *this;
    }
    Iterator operator++(int) noexcept { return Iterator{at_++}; }
    friend bool operator==(Iterator, Iterator) noexcept = default;

   private:
    std::uint32_t at_ = 0;
  };

  IdRange() = default;
  IdRange(Id first, std::uint32_t count) noexcept : first_{first.value()}, count_{count} {}

  [[nodiscard]] std::size_t size() const noexcept { return count_; }
  [[nodiscard]] bool empty() const noexcept { return count_ == 0; }
  [[nodiscard]] Id operator[](std::size_t k) const {
    CLEAVE_ASSERT(k < count_);
    return Id{first_ + static_cast<std::uint32_t>(k)};
  }
  [[nodiscard]] Id front() const { return (*this)[0]; }
  [[nodiscard]] Iterator begin() const noexcept { return Iterator{first_}; }
  [[nodiscard]] Iterator end() const noexcept { return Iterator{first_ + count_}; }

 private:
  std::uint32_t first_ = 0, count_ = 0;
};

/// A vector that only ids of its own kind can index; every access is checked, in every build and in that of whoever
/// uses the library.
template <class Id, class T>
class IdVector final {
 public:
  IdVector() = default;
  explicit IdVector(std::size_t count, const T& value = T{}) : items_(count, value) {}
  explicit IdVector(std::vector<T> items) noexcept : items_{std::move(items)} {}

  [[nodiscard]] decltype(auto) operator[](std::same_as<Id> auto id) { return items_[checked(id)]; }
  [[nodiscard]] decltype(auto) operator[](std::same_as<Id> auto id) const { return items_[checked(id)]; }

  [[nodiscard]] std::size_t size() const noexcept { return items_.size(); }
  [[nodiscard]] bool empty() const noexcept { return items_.empty(); }
  void reserve(std::size_t count) { items_.reserve(count); }

  Id push_back(T item) {
    items_.push_back(std::move(item));
    return Id{items_.size() - 1};
  }

  /// All ids in order.
  [[nodiscard]] IdRange<Id> ids() const noexcept {
    return {Id{std::uint32_t{0}}, static_cast<std::uint32_t>(items_.size())};
  }
  [[nodiscard]] auto begin() { return items_.begin(); }
  [[nodiscard]] auto end() { return items_.end(); }
  [[nodiscard]] auto begin() const { return items_.begin(); }
  [[nodiscard]] auto end() const { return items_.end(); }
  [[nodiscard]] const std::vector<T>& items() const noexcept { return items_; }

  friend bool operator==(const IdVector&, const IdVector&) = default;

 private:
  [[nodiscard]] std::size_t checked(Id id) const noexcept {
    CLEAVE_ASSERT(id.index() < items_.size());
    return id.index();
  }
  std::vector<T> items_;
};

}  // namespace cleave

template <class Tag>
struct std::hash<cleave::Id<Tag>> {
  std::size_t operator()(cleave::Id<Tag> id) const noexcept { return std::hash<std::uint32_t>{}(id.value()); }
};
