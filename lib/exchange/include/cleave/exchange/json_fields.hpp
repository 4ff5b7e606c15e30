#pragma once

#include <array>
#include <concepts>
#include <functional>
#include <ranges>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include "cleave/core/fields.hpp"
#include "cleave/exchange/json.hpp"

/// Visitors over `fields` that write JSON: the figures themselves, and the schema of them.
namespace cleave::report {

template <class T, template <class...> class Of>
inline constexpr bool is_a = false;
template <template <class...> class Of, class... Args>
inline constexpr bool is_a<Of<Args...>, Of> = true;

template <class T>
concept TextLike = std::convertible_to<const T&, std::string_view>;
template <class T>
concept Point3 = requires(const T& p) { std::tuple{p.x, p.y, p.z}; };
template <class T>
concept Point2 = !Point3<T> && requires(const T& p) { std::tuple{p.x, p.y}; };
template <class T>
concept HasUnit = requires(const T& q) {
  { q.si() } -> std::same_as<double>;
};
template <class T>
concept Numbered = requires(const T& id) {
  { id.value() } -> std::unsigned_integral;
};

/// The body of an `Each` or `ByName`, with or without the index.
template <class Body, class V, class Item>
void call_body(const Body& body, V& v, const Item& item, std::size_t index) {
  if constexpr (std::invocable<const Body&, V&, const Item&, std::size_t>) {
    body(v, item, index);
  } else {
    body(v, item);
  }
}

/// Writes the figures.
class JsonFields final {
 public:
  explicit JsonFields(JsonWriter& json) noexcept : json_{&json} {}

  template <class T>
  void operator()(std::string_view name, const T& x, std::string_view help = {}) {
    if constexpr (is_a<T, std::optional>) {
      if (x) (*this)(name, *x, help);
    } else if constexpr (is_a<T, When>) {
      if (x.present) (*this)(name, x.value, help);
    } else {
      json_->key(name);
      put(x);
    }
  }

  template <class T>
  void put(const T& x) {
    if constexpr (std::same_as<T, OneOf>) {
      json_->value(x.value);
    } else if constexpr (is_a<T, OrNull>) {
      x.value ? put(*x.value) : json_->null();
    } else if constexpr (is_a<T, Group>) {
      object([&] { x.body(*this); });
    } else if constexpr (is_a<T, Each>) {
      std::size_t i = 0;
      array(x.range, [&](const auto& item) { object([&] { call_body(x.body, *this, item, i++); }); });
    } else if constexpr (is_a<T, ByName>) {
      object([&] {
        for (const auto& item : x.range) {
          json_->key(std::invoke(x.name, item));
          object([&] { call_body(x.body, *this, item, 0); });
        }
      });
    } else if constexpr (std::is_arithmetic_v<T> || TextLike<T> || std::same_as<T, Short>) {
      json_->value(x);
    } else if constexpr (HasUnit<T>) {
      json_->value(x.si());
    } else if constexpr (Numbered<T>) {
      json_->value(x.value());
    } else if constexpr (Point3<T>) {
      array(std::array{x.x, x.y, x.z}, [&](double v) { json_->value(v); });
    } else if constexpr (Point2<T>) {
      array(std::array{x.x, x.y}, [&](double v) { json_->value(v); });
    } else if constexpr (std::ranges::range<T>) {
      array(x, [&](const auto& item) { put(item); });
    } else {
      object([&] { fields(*this, x); });
    }
  }

 private:
  void object(auto&& body) {
    json_->begin_object();
    body();
    json_->end_object();
  }
  void array(const auto& range, auto&& put_item) {
    json_->begin_array();
    for (const auto& item : range) put_item(item);
    json_->end_array();
  }
  JsonWriter* json_;
};

/// Writes the schema of the figures, from values that need hold nothing: `properties`, and `required` for those that
/// are always written.
class SchemaFields final {
 public:
  explicit SchemaFields(JsonWriter& json) noexcept : json_{&json} {}

  template <class T>
  void operator()(std::string_view name, const T& x, std::string_view help = {}) {
    if constexpr (is_a<T, std::optional>) {
      property(name, x.value_or(Sample<typename T::value_type>::make()), help);
    } else if constexpr (is_a<T, When>) {
      property(name, x.value, help);
    } else {
      property(name, x, help);
      required_.emplace_back(name);
    }
  }

  /// An object with the figures that `body` names.
  static void object(JsonWriter& json, auto&& body) {
    SchemaFields inner{json};
    json.member("type", "object");
    json.key("properties");
    json.begin_object();
    body(inner);
    json.end_object();
    if (!inner.required_.empty()) inner.list("required", inner.required_);
  }
  [[nodiscard]] const std::vector<std::string>& required() const noexcept { return required_; }

 private:
  template <class T>
  void property(std::string_view name, const T& x, std::string_view help) {
    json_->key(name);
    json_->begin_object();
    if (!help.empty()) json_->member("description", help);
    type(x);
    json_->end_object();
  }

  template <class T>
  static constexpr std::string_view scalar() {
    if constexpr (std::same_as<T, bool>) {
      return "boolean";
    } else if constexpr (std::unsigned_integral<T> || Numbered<T>) {
      return "integer";
    } else if constexpr (std::floating_point<T> || HasUnit<T>) {
      return "number";
    } else if constexpr (TextLike<T> || std::same_as<T, OneOf>) {
      return "string";
    } else {
      return {};
    }
  }

  template <class T>
  void type(const T& x) {
    if constexpr (is_a<T, std::optional>) {
      type(x.value_or(Sample<typename T::value_type>::make()));
    } else if constexpr (is_a<T, OrNull>) {
      list("type", std::array<std::string_view, 2>{scalar<std::remove_cvref_t<decltype(x.value.value())>>(), "null"});
    } else if constexpr (!scalar<T>().empty()) {
      json_->member("type", scalar<T>());
      if constexpr (scalar<T>() == "integer") json_->member("minimum", 0U);
      if constexpr (std::same_as<T, OneOf>) list("enum", x.names);
    } else if constexpr (is_a<T, Group>) {
      object(*json_, [&](SchemaFields& inner) { x.body(inner); });
    } else if constexpr (is_a<T, Each>) {
      items({}, [&] { object(*json_, [&](SchemaFields& inner) { call_body(x.body, inner, sample(x.range), 0); }); });
    } else if constexpr (is_a<T, ByName>) {
      json_->member("type", "object");
      json_->key("additionalProperties");
      json_->begin_object();
      object(*json_, [&](SchemaFields& inner) { call_body(x.body, inner, sample(x.range), 0); });
      json_->end_object();
    } else if constexpr (Point3<T>) {
      items(3, [&] { json_->member("type", "number"); });
    } else if constexpr (Point2<T>) {
      items(2, [&] { json_->member("type", "number"); });
    } else if constexpr (std::ranges::range<T>) {
      items({}, [&] { type(sample(x)); });
    } else {
      object(*json_, [&](SchemaFields& inner) { fields(inner, x); });
    }
  }

  template <class Range>
  static auto sample(const Range&) {
    return Sample<std::ranges::range_value_t<Range>>::make();
  }
  void items(std::optional<unsigned> count, auto&& type_of_item) {
    json_->member("type", "array");
    if (count) json_->member("minItems", *count);
    if (count) json_->member("maxItems", *count);
    json_->key("items");
    json_->begin_object();
    type_of_item();
    json_->end_object();
  }
  void list(std::string_view name, const auto& texts) {
    json_->key(name);
    json_->begin_array();
    for (const std::string_view text : texts) json_->value(text);
    json_->end_array();
  }

  JsonWriter* json_;
  std::vector<std::string> required_;
};

}  // namespace cleave::report
