#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <initializer_list>
#include <utility>

#include "cleave/core/overloaded.hpp"
#include "cleave/core/special.hpp"
#include "cleave/dfn/joint_set.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/scene3d/key_tables.hpp"
#include "context.hpp"
#include "joint_models.hpp"

namespace cleave::scene {
namespace {

using std::string_view;

constexpr NumberRule size_rule = rule::length.usually(0.01, 2000);
constexpr NumberRule spacing_rule = rule::length.usually(0.01, 200);
constexpr NumberRule spread_rule{0, false, 360, false, " degrees"};
constexpr NumberRule exponent_rule{0, true, 100, false, ""};
constexpr NumberRule aspect_rule{0, true, 1e6, false, ""};
constexpr NumberRule per_metre_rule{0, false, 1e9, false, " 1/m"};
constexpr NumberRule per_volume_rule{0, false, 1e9, false, ""};
constexpr NumberRule buffer_rule{1, true, 100, false, ""};
constexpr std::int64_t most_sides = 256;
constexpr std::array<string_view, 2> count_boxes{"domain", "buffer"};
constexpr std::array<string_view, 1> persistent_word{"persistent"};
constexpr std::array<string_view, 3> rotation_laws{"uniform", "normal", "constant"};
constexpr std::array<string_view, 5> shape_words{"rectangle", "square", "disc", "ellipse", "polygon"};

const KeyTable& size_keys() {
  static const KeyTable keys{
      .name = "size",
      .keys = {
          {"distribution", key::word<dfn::SizeDistribution>(), required, "law of the size"},
          {"mean", key::number(size_rule), "",
           "m, before the law is cut to `min`..`max`; not of `power` and `uniform`"},
          {"std", key::number(rule::length_or_zero), "", "m, before the law is cut: of `normal`, `lognormal`, `gamma`"},
          {"min", key::number(rule::length_or_zero), "", "m"},
          {"max", key::number(rule::length), "", "m"},
          {"clamp", key::flag(), "false",
           "true: what the law draws beyond `min` or `max` becomes these; false: it is drawn again"},
          {"exponent", key::number(exponent_rule), "", "of the power law"}}};
  return keys;
}

const KeyTable& rotation_keys() {
  static const KeyTable keys{.name = "rotation",
                             .keys = {{"distribution", key::word(rotation_laws), required, "law of the rotation"},
                                      {"min", key::number(rule::turn), "", "degrees"},
                                      {"max", key::number(rule::turn), "", "degrees"},
                                      {"mean", key::number(rule::turn), "", "degrees"},
                                      {"std", key::number(spread_rule), "", "degrees"}}};
  return keys;
}

const KeyTable& intensity_keys() {
  static const KeyTable keys{
      .name = "intensity",
      .keys =
          {{"count", key::whole(0, 10'000'000), "", "exactly so many centres, in the domain's box"},
           {"count_in", key::word(count_boxes), "\"domain\"",
            "`\"domain\"`: `count` is that of the domain's box, in a larger box (`buffer`) there are as many more as "
            "it is larger; `\"buffer\"`: it is that of the larger box"},
           {"p32", key::number(per_metre_rule), "", "1/m, area in a volume"},
           {"p30", key::number(per_volume_rule), "", "1/m3, centres in a volume"},
           {"p10", key::number(per_metre_rule), "", "1/m, number along the mean normal"},
           {"spacing", key::number(spacing_rule), "", "m, along the mean normal"}},
      .one_of = {{"count", "p32", "p30", "p10", "spacing"}}};
  return keys;
}

/// `distribution` of a table that has no default of it.
std::optional<std::size_t> distribution_of(const TableReader& table, string_view example) {
  if (!table.has("distribution")) {
    table.missing("distribution", fmt::format("add distribution = \"{}\"", example));
    return std::nullopt;
  }
  return table.choice("distribution");
}

/// Keys of a law (by its word) that say nothing about it, with the law that each may be meant for.
void refuse_keys_of_others(const TableReader& table, string_view law,
                           std::initializer_list<std::pair<string_view, string_view>> keys) {
  for (const auto& [key, owner] : keys) {
    if (!table.has(key)) continue;
    table.error(key, fmt::format("has no meaning for the distribution \"{}\"", law),
                owner.empty() ? "remove it" : fmt::format("remove it, or set distribution = \"{}\"", owner));
  }
}

void refuse_keys_of_other_sizes(const TableReader& table, dfn::SizeDistribution law) {
  const string_view word = enum_name(law);
  if (law != dfn::SizeDistribution::power) refuse_keys_of_others(table, word, {{"exponent", "power"}});
  switch (law) {
    case dfn::SizeDistribution::constant:
      refuse_keys_of_others(table, word, {{"std", "normal"}, {"clamp", "normal"}});
      break;
    case dfn::SizeDistribution::exponential: refuse_keys_of_others(table, word, {{"std", "gamma"}}); break;
    case dfn::SizeDistribution::power:
      refuse_keys_of_others(table, word, {{"mean", "exponential"}, {"std", "lognormal"}});
      break;
    case dfn::SizeDistribution::uniform:
      refuse_keys_of_others(table, word, {{"mean", "exponential"}, {"std", "normal"}, {"clamp", "normal"}});
      break;
    case dfn::SizeDistribution::normal:
    case dfn::SizeDistribution::lognormal:
    case dfn::SizeDistribution::gamma: break;
  }
}

}  // namespace

KeyType size_type() {
  return key::either({key::number(size_rule), key::word(persistent_word), key::table(&size_keys)});
}

const KeyTable& joint_set_keys() {
  static const KeyTable keys = [] {
    KeyTable table{
        .name = "joint_set",
        .keys = {
            {"name", key::text(), "\"default\"", "the set, for `[joints.NAME]`"},
            {"orientation", key::table(&orientation_keys), required,
             "`dip`, `dip_direction` and the law of the deviations from them, below"},
            {"shape", key::either({key::word(shape_words), key::text()}), "\"rectangle\"",
             "`\"rectangle\"`, `\"square\"`, `\"disc\"`, `\"ellipse\"`, `\"polygon(6)\"`; `\"disc(16)\"`, "
             "`\"ellipse(16)\"` or `sides = 16` for another number of sides than 32"},
            {"sides", key::whole(3, most_sides), "32", "of discs, ellipses and polygons"},
            {"size", size_type(), required,
             "m: side, or diameter (ellipse: first axis; polygon: through the corners). A number, `\"persistent\"`, or "
             "a law, below"},
            {"size_2", size_type(), "an independent draw of `size`",
             "rectangles and ellipses: own law of the second side"},
            {"aspect", key::number(aspect_rule), "",
             "rectangles and ellipses: first side over second, instead of `size_2`"},
            {"rotation", key::either({key::number(rule::turn), key::table(&rotation_keys)}), "0",
             "degrees in the joint's plane from strike, or a law `uniform` (`min`, `max`) or `normal` (`mean`, `std`)"},
            {"intensity", key::table(&intensity_keys), required,
             "one of `count` (exactly so many centres in the domain's box), `p32` (1/m), `p30` (1/m3), `p10` (1/m "
             "along the mean normal), `spacing` (m)"},
            {"buffer", key::number(buffer_rule), "",
             "joints have their centres in a box so many times as large as the domain's, about its centre, at the same "
             "density; without it `count` fills the domain's box, the others a box that all joints are drawn in that "
             "can reach the domain"}}};
    for (Key& key : model_keys()) table.keys.push_back(std::move(key));
    return table;
  }();
  return keys;
}

bool is_persistent(const TableReader& set) {
  const TomlEntry* size = set.find("size");
  const auto* word = size != nullptr ? std::get_if<std::string>(&size->node.value) : nullptr;
  return word != nullptr && *word == persistent_word.front();
}

namespace {
/// A normal law of which a good part lies below 0: sizes drawn are not of its mean.
void note_wide_law(const TableReader& table, const dfn::SizeSpec& spec) {
  if (spec.distribution != dfn::SizeDistribution::normal || !spec.mean || !spec.std || !(*spec.std > Length{})) return;
  const double below = 100 * special::normal_cdf(-*spec.mean / *spec.std);
  if (below < 5) return;
  table.note(
      "std",
      fmt::format("is {:g} m of a normal law with mean = {:g} m: {:.3g} % of it lies below 0 and is not drawn, so "
                  "that sizes are larger than its mean",
                  spec.std->si(), spec.mean->si(), below),
      "take a smaller std, or distribution = \"lognormal\"");
}
}  // namespace

std::optional<dfn::SizeLaw> parse_size(const TableReader& set, string_view key) {
  const TomlEntry* entry = set.find(key);
  if (entry == nullptr) return std::nullopt;
  dfn::SizeSpec spec;
  std::string path = set.path_of(key);
  if (!std::holds_alternative<TomlTable>(entry->node.value)) {
    const auto* text = std::get_if<std::string>(&entry->node.value);
    if (text != nullptr && !with_unit(*text, size_rule)) {
      set.error(key, "is text that is no size",
                "give a number of metres, a text with a unit such as \"600 mm\", or { distribution = \"normal\", mean "
                "= 100, std = 30, min = 1, max = 300 }"
                " (size alone may also be \"persistent\")");
      return std::nullopt;
    }
    const auto value = set.number(key);
    if (!value) return std::nullopt;
    spec.mean = metres(*value);
  } else {
    const std::size_t before = set.problems().errors();
    const TableReader table = *set.sub(key);
    const auto law = distribution_of(table, enum_names<dfn::SizeDistribution>.front());
    const auto length = [&](string_view name) -> std::optional<Length> {
      const auto value = table.number(name);
      return value ? std::optional{metres(*value)} : std::nullopt;
    };
    spec.mean = length("mean");
    spec.std = length("std");
    spec.min = length("min");
    spec.max = length("max");
    spec.exponent = table.number("exponent");
    spec.clamp = table.flag("clamp");
    if (law) refuse_keys_of_other_sizes(table, static_cast<dfn::SizeDistribution>(*law));
    // A lower limit of 0 says no more than that sizes are positive.
    if (spec.min && spec.min->si() == 0) spec.min = std::nullopt;
    if (!law || set.problems().errors() != before) return std::nullopt;
    if (spec.mean && ((spec.min && *spec.mean < *spec.min) || (spec.max && *spec.max < *spec.mean))) {
      table.note(
          "mean",
          fmt::format("is {:g} m, outside of min..max: no more than a tail of the law is drawn", spec.mean->si()),
          "mean and std are those of the law before it is cut to min..max");
    }
    spec.distribution = static_cast<dfn::SizeDistribution>(*law);
    note_wide_law(table, spec);
  }
  auto law = dfn::SizeLaw::make(spec);
  if (law) return std::move(*law);
  const std::string detail = std::visit(overloaded{[](const dfn::MissingParameter& e) { return "." + e.key; },
                                                   [](const dfn::BadParameter& e) { return "." + e.key; },
                                                   [](const dfn::EmptyRange&) { return std::string{}; }},
                                        law.error());
  const string_view name = detail.empty() ? string_view{} : string_view{detail}.substr(1);
  const auto* table = std::get_if<TomlTable>(&entry->node.value);
  std::uint32_t line = entry->line;
  if (table != nullptr) {
    for (const TomlEntry& part : table->entries) {
      if (part.key == name) line = part.line;
    }
  }
  set.problems().error(line, path + detail, describe(law.error()), "");
  return std::nullopt;
}

namespace {

std::optional<dfn::RotationLaw> parse_rotation(const TableReader& set) {
  const TomlEntry* entry = set.find("rotation");
  if (entry == nullptr) return dfn::FixedRotation{};
  if (!std::holds_alternative<TomlTable>(entry->node.value)) {
    const auto angle = set.number("rotation");
    if (!angle) return std::nullopt;
    return dfn::FixedRotation{dfn::Rotation::degrees(*angle)};
  }
  const TableReader table = *set.sub("rotation");
  const auto law = distribution_of(table, rotation_laws.front());
  if (!law) return std::nullopt;
  const string_view word = rotation_laws[*law];
  if (*law == 0) refuse_keys_of_others(table, word, {{"mean", "normal"}, {"std", "normal"}});
  if (*law != 0) refuse_keys_of_others(table, word, {{"min", "uniform"}, {"max", "uniform"}});
  if (*law == 2) refuse_keys_of_others(table, word, {{"std", "normal"}});
  if (*law == 0) {
    const auto from = table.need_number("min"), to = table.need_number("max");
    if (!from || !to) return std::nullopt;
    if (*from > *to) {
      table.error("min", fmt::format("is {}, above max = {}", *from, *to), "swap them");
      return std::nullopt;
    }
    return dfn::UniformRotation{dfn::Rotation::degrees(*from), dfn::Rotation::degrees(*to)};
  }
  const auto mean = table.need_number("mean");
  if (*law == 2)
    return mean ? std::optional<dfn::RotationLaw>{dfn::FixedRotation{dfn::Rotation::degrees(*mean)}} : std::nullopt;
  const auto std = table.need_number("std");
  if (!mean || !std) return std::nullopt;
  return dfn::NormalRotation{dfn::Rotation::degrees(*mean), dfn::Rotation::degrees(*std)};
}

std::optional<dfn::Intensity> parse_intensity(const TableReader& set) {
  if (!set.has("intensity")) {
    set.missing("intensity", "add intensity = { p32 = 0.1 }, or count, p10, p30, spacing");
    return std::nullopt;
  }
  const auto found = set.sub("intensity");
  if (!found) return std::nullopt;
  const TableReader& table = *found;
  const TomlEntry* entry = table.one_of();
  if (entry == nullptr) return std::nullopt;
  if (entry->key == "count") {
    const auto count = table.integer("count");
    if (!count) return std::nullopt;
    const bool in_buffer = table.has("count_in") && table.choice("count_in") == 1;
    if (in_buffer && !set.has("buffer")) {
      table.error("count_in", "needs a box that is larger than the domain's", "add buffer, or remove it");
      return std::nullopt;
    }
    return dfn::Count{static_cast<std::uint64_t>(*count), in_buffer};
  }
  if (table.has("count_in")) {
    table.error("count_in", fmt::format("has no meaning for \"{}\"", entry->key), "remove it");
    return std::nullopt;
  }
  const auto value = table.number(entry->key);
  if (!value) return std::nullopt;
  if (entry->key == "p32") return dfn::P32{*value};
  if (entry->key == "p30") return dfn::P30{*value};
  if (entry->key == "p10") return dfn::P10{*value};
  return dfn::Spacing{metres(*value)};
}

struct ShapeWord {
  std::size_t kind;  // 0 rectangle, 1 square, 2 disc, 3 ellipse, 4 polygon
  std::optional<std::uint32_t> sides;
};

/// "rectangle", "disc", "polygon(6)", ...
std::optional<ShapeWord> parse_shape_word(const TableReader& set) {
  std::optional<std::uint32_t> sides;
  if (const auto given = set.integer("sides")) sides = static_cast<std::uint32_t>(*given);
  if (!set.has("shape")) return ShapeWord{0, sides};
  const auto word = set.text("shape");
  if (!word) return std::nullopt;
  const std::size_t open = word->find('(');
  if (open == std::string::npos || !word->ends_with(')')) {
    const auto kind = set.choice("shape");
    if (!kind) return std::nullopt;
    if (*kind == 4 && !sides) {
      set.error("shape", "does not say how many sides the polygon has", "write shape = \"polygon(6)\"");
      return std::nullopt;
    }
    return ShapeWord{*kind, sides};
  }
  const string_view name = string_view{*word}.substr(0, open);
  const string_view digits = string_view{*word}.substr(open + 1, word->size() - open - 2);
  std::uint32_t count = 0;
  const char* const end = std::to_address(digits.end());
  const auto [stop, failed] = std::from_chars(std::to_address(digits.begin()), end, count);
  const bool whole = failed == std::errc{} && stop == end && count >= 3 && count <= most_sides;
  for (std::size_t kind = 2; kind < shape_words.size(); ++kind) {
    if (shape_words[kind] == name && whole) return ShapeWord{kind, count};
  }
  set.error("shape", fmt::format("\"{}\" is not known", word->substr(0, 60)),
            fmt::format("write polygon(N), disc(N) or ellipse(N) with N from 3 to {}", most_sides));
  return std::nullopt;
}

std::optional<dfn::SecondSize> parse_second(const TableReader& set) {
  if (set.has("size_2") && set.has("aspect")) {
    set.error("aspect", "stands beside \"size_2\"", "give one of them");
    return std::nullopt;
  }
  if (set.has("size_2")) {
    const auto law = parse_size(set, "size_2");
    if (!law) return std::nullopt;
    return *law;
  }
  if (set.has("aspect")) {
    const auto ratio = set.number("aspect");
    if (!ratio) return std::nullopt;
    return dfn::AspectRatio{*ratio};
  }
  return dfn::IndependentSize{};
}

std::optional<dfn::Shape> parse_shape(const TableReader& set) {
  const auto word = parse_shape_word(set);
  const auto second = parse_second(set);
  if (!set.has("size")) {
    set.missing(
        "size",
        "add size = { distribution = \"normal\", mean = 100, std = 30, min = 1, max = 300 }, or \"persistent\"");
    return std::nullopt;
  }
  if (is_persistent(set)) {
    for (const string_view key : {"shape", "size_2", "aspect", "rotation", "sides"}) {
      if (set.has(key)) set.note(key, "has no meaning for persistent joints", "remove it");
    }
    return dfn::Persistent{};
  }
  const auto size = parse_size(set, "size");
  if (!word || !second || !size) return std::nullopt;
  const bool two_sizes = word->kind == 0 || word->kind == 3;
  if (!two_sizes && !std::holds_alternative<dfn::IndependentSize>(*second)) {
    set.error(set.has("aspect") ? "aspect" : "size_2", "has no meaning for a shape with one size",
              "remove it, or use the shape rectangle or ellipse");
    return std::nullopt;
  }
  switch (word->kind) {
    case 0: return dfn::Rectangle{*size, *second};
    case 1: return dfn::Square{*size};
    case 2: return dfn::Disc{*size, word->sides.value_or(32)};
    case 3: return dfn::Ellipse{*size, *second, word->sides.value_or(32)};
    default: return dfn::RegularPolygon{*size, word->sides.value_or(6)};
  }
}

void parse_joint_set(Context& context, const TableReader& set, const OtherSets& others,
                     std::vector<RandomSet>& joint_sets) {
  const std::size_t before = context.problems.errors();
  auto name = set.text("name");
  const auto model = parse_model(set, others);
  const bool mosaic = model && std::holds_alternative<dfn::Mosaic>(*model);
  const bool sizeless =
      mosaic ||
      (model && (std::holds_alternative<dfn::Dershowitz>(*model) || std::holds_alternative<dfn::Hierarchical>(*model)));
  if (mosaic && set.has("orientation")) {
    set.note("orientation", "is not used: faces of the model \"mosaic\" look every way", "remove it");
  }
  for (const string_view key : {"shape", "size", "size_2", "aspect", "sides"}) {
    if (sizeless && set.has(key)) {
      set.note(key, "is not used: in this model sizes follow from the planes", "remove it");
    }
  }
  const auto orientation =
      mosaic ? std::optional<dfn::OrientationLaw>{dfn::FisherOrientation{Dip::degrees(0), DipDirection::degrees(0), 0}}
             : parse_orientation(context, set);
  const auto shape = sizeless ? std::optional<dfn::Shape>{dfn::Persistent{}} : parse_shape(set);
  const auto rotation = parse_rotation(set);
  const auto intensity = parse_intensity(set);
  if (context.problems.errors() != before || !orientation || !shape || !rotation || !intensity || !model) return;
  const auto buffer = set.number("buffer");
  auto law = dfn::JointSet::make({*orientation, *shape, *rotation, *intensity, *model, buffer});
  if (!law) {
    struct Refusal {
      std::string key, what, remedy;
    };
    const Refusal refusal = std::visit(
        overloaded{
            [](const dfn::BadValue& e) { return Refusal{e.key, fmt::format("{} is out of range", e.value), e.remedy}; },
            [](const dfn::ModelMismatch& e) { return Refusal{e.key, e.what, e.remedy}; },
            [](dfn::NoCentres) {
              return Refusal{"intensity", "persistent joints have no centres", "give p32, p10, spacing or count"};
            }},
        law.error());
    set.problems().error(set.line_of(refusal.key.substr(0, refusal.key.find('.'))), set.path_of(refusal.key),
                         refusal.what, refusal.remedy);
    return;
  }
  joint_sets.push_back({context.set_named(name.value_or("default")), std::move(*law), set.line()});
}

}  // namespace

void parse_joint_sets(Context& context, const TableReader& root, const std::vector<MeasuredJoint>& given,
                      std::vector<RandomSet>& joint_sets) {
  const std::vector<TableReader> sets = root.each("joint_set");
  OtherSets others;
  for (const MeasuredJoint& joint : given) others.given.try_emplace(context.sets[joint.set].name, joint.set);
  for (const TableReader& set : sets) {
    const auto* name = set.find("name");
    const auto* text = name == nullptr ? nullptr : std::get_if<std::string>(&name->node.value);
    others.drawn.push_back(text == nullptr ? "default" : *text);
  }
  for (const TableReader& set : sets) {
    others.own = static_cast<std::size_t>(&set - sets.data());
    parse_joint_set(context, set, others, joint_sets);
  }
  if (joint_sets.size() == sets.size()) refuse_circles(sets, joint_sets);
}

}  // namespace cleave::scene
