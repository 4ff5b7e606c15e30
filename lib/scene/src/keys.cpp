#include "cleave/scene/keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

namespace cleave::scene {

using Form = KeyType::Form;
using std::string_view;

bool NumberRule::accepts(double v) const noexcept {
  return (low_open ? v > low : v >= low) && (high_open ? v < high : v <= high);
}

std::string NumberRule::words() const {
  if (!low_open && !high_open) return fmt::format("from {:g} to {:g}{}", low, high, unit);
  return fmt::format("{} {:g} and {} {:g}{}", low_open ? "above" : "at least", low, high_open ? "below" : "at most",
                     high, unit);
}

const KeyType* KeyType::as(Form wanted) const noexcept {
  if (form == wanted) return this;
  if (form != Form::either) return nullptr;
  const auto at = std::ranges::find(of, wanted, &KeyType::form);
  return at == of.end() ? nullptr : std::to_address(at);
}

namespace key {

KeyType number(const NumberRule& rule) { return {.form = Form::number, .rule = rule}; }
KeyType whole(std::int64_t low, std::int64_t high) { return {.form = Form::whole, .low = low, .high = high}; }
KeyType flag() { return {.form = Form::flag}; }
KeyType text() { return {.form = Form::text}; }
KeyType word(std::span<const string_view> words) { return {.form = Form::word, .words = words}; }
KeyType array(KeyType of, std::int64_t low, std::int64_t high) {
  return {.form = Form::array, .low = low, .high = high, .of = {std::move(of)}};
}
KeyType vector(const NumberRule& rule) { return array(number(rule), 3, 3); }
KeyType pair(const NumberRule& rule) { return array(number(rule), 2, 2); }
KeyType points(const NumberRule& rule) { return array(vector(rule)); }
KeyType pairs(const NumberRule& rule) { return array(pair(rule)); }
KeyType texts() { return array(text()); }
KeyType table(const KeyTable& (*keys)()) { return {.form = Form::table, .keys = keys}; }
KeyType tables(const KeyTable& (*keys)()) { return array(table(keys)); }
KeyType named(KeyType of) { return {.form = Form::named, .of = {std::move(of)}}; }
KeyType either(std::initializer_list<KeyType> alternatives) { return {.form = Form::either, .of = alternatives}; }

}  // namespace key

const Key* KeyTable::find(string_view key, std::optional<std::size_t> variant) const noexcept {
  const auto within = [&](const std::vector<Key>& list) -> const Key* {
    const auto at = std::ranges::find(list, key, &Key::name);
    return at == list.end() ? nullptr : std::to_address(at);
  };
  if (const Key* common = within(keys)) return common;
  return variant ? within(variants.at(*variant).keys) : nullptr;
}

std::vector<string_view> KeyTable::names(std::optional<std::size_t> variant) const {
  std::vector<string_view> names;
  for (const Key& key : keys) names.push_back(key.name);
  if (variant) {
    for (const Key& key : variants.at(*variant).keys) names.push_back(key.name);
  }
  return names;
}

}  // namespace cleave::scene
