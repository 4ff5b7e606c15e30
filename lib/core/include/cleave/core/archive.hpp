#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "cleave/core/sha256.hpp"
#include "cleave/core/vec2.hpp"

/// Values as bytes, one after the other, that read back to the last bit: states that a run goes on from. A type says
/// what it holds once, for both ways:
///   template <class A> void archive(A& a, Archived<Thing> auto& x) { a(x.first, x.second); }
namespace cleave {

/// `T` to be read into, or `const T` to be written.
template <class X, class T>
concept Archived = std::same_as<std::remove_const_t<X>, T>;

/// Whole numbers least significant byte first, doubles by their bits, lists behind their length.
class ArchiveWriter final {
 public:
  template <class... T>
  void operator()(const T&... values) {
    (put(values), ...);
  }
  /// An enumeration whose enumerators are 0 to `last`.
  template <class E>
  void word(const E& value, E /*last*/) {
    put(static_cast<std::uint8_t>(value));
  }
  [[nodiscard]] const std::string& bytes() const noexcept { return bytes_; }

 private:
  void put(bool value) { put(static_cast<std::uint8_t>(value ? 1 : 0)); }
  void put(double value) { put(std::bit_cast<std::uint64_t>(value)); }
  template <std::unsigned_integral U>
    requires(!std::same_as<U, bool>)
  void put(U value) {
    for (std::size_t k = 0; k < sizeof(U); ++k) {
      bytes_.push_back(static_cast<char>(static_cast<std::uint8_t>((std::uint64_t{value} >> (8 * k)) & 0xffU)));
    }
  }
  void put(const std::string& text) {
    put(text.size());
    bytes_ += text;
  }
  void put(Vec2 v) { (*this)(v.x, v.y); }
  void put(const Box2& box) { (*this)(box.low, box.high); }
  template <class T>
  void put(const std::vector<T>& list) {
    put(list.size());
    for (const T& value : list) put(value);
  }
  template <class T, std::size_t N>
  void put(const std::array<T, N>& list) {
    for (const T& value : list) put(value);
  }
  template <class T>
  void put(const std::optional<T>& value) {
    put(value.has_value());
    if (value) put(*value);
  }
  template <class T>
    requires std::is_class_v<T>
  void put(const T& value) {
    archive(*this, value);
  }

  std::string bytes_;
};

/// What ArchiveWriter wrote. Where bytes are missing, or are none of a type's, all that follows is left as it is and
/// `good` is false. Never makes more than the bytes hold.
class ArchiveReader final {
 public:
  explicit ArchiveReader(std::string_view bytes) : left_{bytes} {}
  template <class... T>
  void operator()(T&... values) {
    (get(values), ...);
  }
  template <class E>
  void word(E& value, E last) {
    std::uint8_t number = 0;
    get(number);
    if (number > static_cast<std::uint8_t>(last)) good_ = false;
    if (good_) value = static_cast<E>(number);
  }
  [[nodiscard]] bool good() const noexcept { return good_; }
  /// Everything was read and nothing is left over.
  [[nodiscard]] bool complete() const noexcept { return good_ && left_.empty(); }

 private:
  void get(bool& value) {
    std::uint8_t number = 0;
    get(number);
    if (number > 1) good_ = false;
    if (good_) value = number != 0;
  }
  void get(double& value) {
    std::uint64_t bits = 0;
    get(bits);
    if (good_) value = std::bit_cast<double>(bits);
  }
  template <std::unsigned_integral U>
    requires(!std::same_as<U, bool>)
  void get(U& value) {
    if (left_.size() < sizeof(U)) good_ = false;
    if (!good_) return;
    std::uint64_t number = 0;
    for (std::size_t k = 0; k < sizeof(U); ++k) {
      number |= std::uint64_t{static_cast<std::uint8_t>(left_[k])} << (8 * k);
    }
    left_.remove_prefix(sizeof(U));
    value = static_cast<U>(number);
  }
  void get(std::string& text) {
    std::size_t size = 0;
    get(size);
    if (size > left_.size()) good_ = false;
    if (!good_) return;
    text.assign(left_.substr(0, size));
    left_.remove_prefix(size);
  }
  void get(Vec2& v) { (*this)(v.x, v.y); }
  void get(Box2& box) { (*this)(box.low, box.high); }
  template <class T>
  void get(std::vector<T>& list) {
    std::size_t size = 0;
    get(size);
    // Each value takes at least a byte: a length that cannot be is no reason to make room for it.
    if (size > left_.size()) good_ = false;
    if (!good_) return;
    list.clear();
    for (std::size_t k = 0; k < size && good_; ++k) {
      T value{};
      get(value);
      list.push_back(std::move(value));
    }
  }
  template <class T, std::size_t N>
  void get(std::array<T, N>& list) {
    for (T& value : list) get(value);
  }
  template <class T>
  void get(std::optional<T>& value) {
    bool there = false;
    get(there);
    if (!good_) return;
    value.reset();
    if (there) get(value.emplace());
  }
  template <class T>
    requires std::is_class_v<T>
  void get(T& value) {
    archive(*this, value);
  }

  std::string_view left_;
  bool good_ = true;
};

/// Bytes behind a line that says what they are and their SHA-256, so that nobody goes on from damaged ones.
[[nodiscard]] std::string sealed(std::string_view kind, std::uint32_t version, std::string_view bytes);
/// A view of `text`, or `foreign`, `other_version` or `damaged`.
[[nodiscard]] std::expected<std::string_view, SavedFault> unsealed(std::string_view kind, std::uint32_t version,
                                                                   std::string_view text);
/// The same behind the name of what it is a state of, which was written first: `other_world` if it is not `name`.
[[nodiscard]] std::expected<ArchiveReader, SavedFault> unsealed_of(std::string_view name, std::string_view kind,
                                                                   std::uint32_t version, std::string_view text);

}  // namespace cleave
