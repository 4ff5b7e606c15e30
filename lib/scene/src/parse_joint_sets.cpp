#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "cleave/core/overloaded.hpp"
#include "cleave/dfn/joint_set.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/io/joint_csv.hpp"
#include "context.hpp"

namespace cleave::scene {
namespace {

using std::string_view;

constexpr std::array<string_view, 23> set_keys{
    "name",      "model",          "orientation", "shape",        "size",        "size_2", "aspect", "rotation",
    "sides",     "intensity",      "set",         "terminate_at", "probability", "share",  "seeds",  "min_corners",
    "min_angle", "max_elongation", "zones",       "shift",        "turn_kappa",  "gaps",   "bridge"};
constexpr NumberRule probability_rule{0, false, 1, false, ""};
constexpr NumberRule share_rule{0, true, 1, false, ""};

/// The words a key `distribution` may hold, and those that a later version will take.
std::optional<std::size_t> distribution_of(const TableReader& table, std::span<const string_view> now,
                                           std::span<const string_view> later = {}) {
  if (!table.has("distribution")) {
    table.missing("distribution", fmt::format("add distribution = \"{}\"", now.front()));
    return std::nullopt;
  }
  return table.choice("distribution", now, later);
}

/// Normals of a table of orientations, drawn with replacement.
std::optional<dfn::OrientationLaw> parse_bootstrap(Context& context, const TableReader& table) {
  for (const string_view key : {"dip", "dip_direction"}) {
    if (table.has(key)) table.error(key, "has no meaning for the distribution \"bootstrap\"", "remove it");
  }
  constexpr NumberRule kappa_rule{0, false, 1e12, false, ""};
  const auto jitter = table.number("jitter", kappa_rule);
  const auto only = table.text("set");
  if (!table.has("file")) {
    table.missing("file", "add file = \"poles.csv\" with columns dip and dip_direction");
    return std::nullopt;
  }
  const auto file = context.file(table, "file");
  if (!file) return std::nullopt;
  const auto joints = io::parse_joint_csv(file->bytes, file->shown, {.wrap = false, .need_position = false});
  if (!joints) {
    for (const io::ReadError& e : joints.error()) {
      context.problems.error_in(e.file, std::max(1U, e.line), "file", e.what, e.remedy);
    }
    return std::nullopt;
  }
  std::vector<geometry::Vec3> normals;
  for (const io::JointRow& row : joints->rows) {
    if (only && row.set != *only) continue;
    normals.push_back(geometry::upward_normal({row.plane.dip, context.turned(row.plane.direction.degrees())}));
  }
  if (normals.empty()) {
    table.error("file", only ? fmt::format("holds no joint of the set \"{}\"", only->substr(0, 60)) : "holds no joints",
                "name a table with at least one row");
    return std::nullopt;
  }
  std::vector<double> weights(normals.size(), 1.0);
  return dfn::BootstrapOrientation::make(std::move(normals), std::move(weights), jitter);
}

std::optional<dfn::OrientationLaw> parse_orientation(Context& context, const TableReader& set) {
  constexpr std::array<string_view, 5> laws{"fisher", "uniform", "normal", "constant", "bootstrap"};
  if (!set.has("orientation")) {
    set.missing("orientation",
                "add orientation = { dip = 30, dip_direction = 30, distribution = \"fisher\", kappa = 40 }");
    return std::nullopt;
  }
  const TomlTable* found = set.table("orientation");
  if (found == nullptr) return std::nullopt;
  constexpr std::array<string_view, 11> keys{
      "dip",       "dip_direction",       "distribution",      "kappa", "dip_std",
      "dip_range", "dip_direction_range", "dip_direction_std", "file",  "jitter",
      "set"};
  const TableReader table{*found, set.line_of("orientation"), set.path_of("orientation"), set.problems(), keys};
  if (const auto* word = table.find("distribution")) {
    const auto* text = std::get_if<std::string>(&word->node.value);
    if (text != nullptr && *text == "bootstrap") return parse_bootstrap(context, table);
  }
  for (const string_view key : {"file", "jitter", "set"}) {
    if (table.has(key)) {
      table.error(key, "has a meaning only for the distribution \"bootstrap\"",
                  "remove it, or set distribution = \"bootstrap\"");
    }
  }
  const auto dip = table.need_number("dip", rule::dip);
  const auto direction = table.need_number("dip_direction", rule::dip_direction);
  const auto law = table.has("distribution") ? table.choice("distribution", laws) : std::optional<std::size_t>{3};
  if (!law) return std::nullopt;

  constexpr std::array<std::pair<string_view, std::size_t>, 5> own{
      {{"kappa", 0}, {"dip_range", 1}, {"dip_direction_range", 1}, {"dip_std", 2}, {"dip_direction_std", 2}}};
  for (const auto& [key, owner] : own) {
    if (owner == *law || !table.has(key)) continue;
    table.error(key, fmt::format("has no meaning for the distribution \"{}\"", laws[*law]),
                fmt::format("remove it, or set distribution = \"{}\"", laws[owner]));
  }
  constexpr NumberRule half_turn{0, false, 180, false, " degrees"};
  constexpr NumberRule kappa_rule{0, false, 1e12, false, ""};
  switch (*law) {
    case 0: {
      const auto kappa = table.need_number("kappa", kappa_rule);
      if (!dip || !direction || !kappa) return std::nullopt;
      return dfn::FisherOrientation{Dip::degrees(*dip), context.turned(*direction), *kappa};
    }
    case 1: {
      const auto a = table.need_number("dip_range", rule::dip);
      const auto b = table.need_number("dip_direction_range", half_turn);
      if (!dip || !direction || !a || !b) return std::nullopt;
      return dfn::UniformOrientation{Dip::degrees(*dip), context.turned(*direction), Dip::degrees(*a),
                                     DipDirection::degrees(*b)};
    }
    case 2: {
      const auto a = table.need_number("dip_std", rule::dip);
      const auto b = table.need_number("dip_direction_std", half_turn);
      if (!dip || !direction || !a || !b) return std::nullopt;
      return dfn::NormalOrientation{Dip::degrees(*dip), context.turned(*direction), Dip::degrees(*a),
                                    DipDirection::degrees(*b)};
    }
    default: break;
  }
  if (!dip || !direction) return std::nullopt;
  return dfn::UniformOrientation{Dip::degrees(*dip), context.turned(*direction), Dip::degrees(0),
                                 DipDirection::degrees(0)};
}

std::optional<dfn::SizeLaw> parse_size(const TableReader& set, string_view key) {
  const TomlEntry* entry = set.find(key);
  if (entry == nullptr) return std::nullopt;
  dfn::SizeSpec spec;
  std::string path = set.path_of(key);
  if (!std::holds_alternative<TomlTable>(entry->node.value)) {
    if (std::holds_alternative<std::string>(entry->node.value)) {
      set.error(key, "is text that is no size",
                "give a number of metres or { distribution = \"normal\", mean = 100, std = 30, min = 1, max = 300 }"
                " (size alone may also be \"persistent\")");
      return std::nullopt;
    }
    const auto value = set.number(key, rule::length);
    if (!value) return std::nullopt;
    spec.mean = metres(*value);
  } else {
    constexpr std::array<string_view, 6> keys{"distribution", "mean", "std", "min", "max", "exponent"};
    constexpr std::array<string_view, 6> laws{"constant", "normal", "exponential", "lognormal", "power", "gamma"};
    constexpr std::array<dfn::SizeDistribution, 6> kinds{
        dfn::SizeDistribution::constant,  dfn::SizeDistribution::normal, dfn::SizeDistribution::exponential,
        dfn::SizeDistribution::lognormal, dfn::SizeDistribution::power,  dfn::SizeDistribution::gamma};
    constexpr NumberRule exponent_rule{0, true, 100, false, ""};
    const TomlTable* found = set.table(key);
    if (found == nullptr) return std::nullopt;
    const std::size_t before = set.problems().errors();
    const TableReader table{*found, entry->line, path, set.problems(), keys};
    const auto law = distribution_of(table, laws);
    const auto length = [&](string_view name, const NumberRule& allowed) -> std::optional<Length> {
      const auto value = table.number(name, allowed);
      return value ? std::optional{metres(*value)} : std::nullopt;
    };
    spec.mean = length("mean", rule::length);
    spec.std = length("std", rule::length_or_zero);
    spec.min = length("min", rule::length_or_zero);
    spec.max = length("max", rule::length);
    spec.exponent = table.number("exponent", exponent_rule);
    // A lower limit of 0 says no more than that sizes are positive.
    if (spec.min && spec.min->si() == 0) spec.min = std::nullopt;
    if (!law || set.problems().errors() != before) return std::nullopt;
    spec.distribution = kinds[*law];
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

std::optional<dfn::RotationLaw> parse_rotation(const TableReader& set) {
  const TomlEntry* entry = set.find("rotation");
  if (entry == nullptr) return dfn::FixedRotation{};
  if (!std::holds_alternative<TomlTable>(entry->node.value)) {
    const auto angle = set.number("rotation", rule::turn);
    if (!angle) return std::nullopt;
    return dfn::FixedRotation{dfn::Rotation::degrees(*angle)};
  }
  constexpr std::array<string_view, 5> keys{"distribution", "min", "max", "mean", "std"};
  constexpr std::array<string_view, 3> laws{"uniform", "normal", "constant"};
  const TomlTable* found = set.table("rotation");
  if (found == nullptr) return std::nullopt;
  const TableReader table{*found, entry->line, set.path_of("rotation"), set.problems(), keys};
  const auto law = distribution_of(table, laws);
  if (!law) return std::nullopt;
  constexpr NumberRule spread{0, false, 360, false, " degrees"};
  if (*law == 0) {
    const auto from = table.need_number("min", rule::turn), to = table.need_number("max", rule::turn);
    if (!from || !to) return std::nullopt;
    if (*from > *to) {
      table.error("min", fmt::format("is {}, above max = {}", *from, *to), "swap them");
      return std::nullopt;
    }
    return dfn::UniformRotation{dfn::Rotation::degrees(*from), dfn::Rotation::degrees(*to)};
  }
  const auto mean = table.need_number("mean", rule::turn);
  if (*law == 2)
    return mean ? std::optional<dfn::RotationLaw>{dfn::FixedRotation{dfn::Rotation::degrees(*mean)}} : std::nullopt;
  const auto std = table.need_number("std", spread);
  if (!mean || !std) return std::nullopt;
  return dfn::NormalRotation{dfn::Rotation::degrees(*mean), dfn::Rotation::degrees(*std)};
}

std::optional<dfn::Intensity> parse_intensity(const TableReader& set) {
  if (!set.has("intensity")) {
    set.missing("intensity", "add intensity = { p32 = 0.1 }, or count, p10, p30, spacing");
    return std::nullopt;
  }
  constexpr std::array<string_view, 5> keys{"count", "p32", "p30", "p10", "spacing"};
  constexpr NumberRule per_metre{0, false, 1e9, false, " 1/m"};
  const TomlTable* found = set.table("intensity");
  if (found == nullptr) return std::nullopt;
  const TableReader table{*found, set.line_of("intensity"), set.path_of("intensity"), set.problems(), keys};
  const TomlEntry* entry = table.one_of(keys);
  if (entry == nullptr) return std::nullopt;
  if (entry->key == "count") {
    const auto count = table.integer("count", 0, 10'000'000);
    if (!count) return std::nullopt;
    return dfn::Count{static_cast<std::uint64_t>(*count)};
  }
  const auto value = table.number(entry->key, entry->key == "spacing" ? rule::length : per_metre);
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
  constexpr std::array<string_view, 5> shapes{"rectangle", "square", "disc", "ellipse", "polygon"};
  constexpr std::int64_t most_sides = 256;
  std::optional<std::uint32_t> sides;
  if (const auto given = set.integer("sides", 3, most_sides)) sides = static_cast<std::uint32_t>(*given);
  if (!set.has("shape")) return ShapeWord{0, sides};
  const auto word = set.text("shape");
  if (!word) return std::nullopt;
  const std::size_t open = word->find('(');
  if (open == std::string::npos || !word->ends_with(')')) {
    const auto kind = set.choice("shape", shapes);
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
  for (std::size_t kind = 2; kind < shapes.size(); ++kind) {
    if (shapes[kind] == name && whole) return ShapeWord{kind, count};
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
    constexpr NumberRule aspect_rule{0, true, 1e6, false, ""};
    const auto ratio = set.number("aspect", aspect_rule);
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
  if (const auto* text = std::get_if<std::string>(&set.find("size")->node.value);
      text != nullptr && *text == "persistent") {
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

/// Which keys beside those of every set a model takes.
bool takes(std::size_t model, string_view key) {
  switch (model) {
    case 1: return key == "terminate_at" || key == "probability";
    case 2:
    case 3: return key == "share";
    case 4: return key == "share" || key == "seeds";
    case 5: return key == "terminate_at" || key == "share";
    case 6:
      return key == "share" || key == "min_corners" || key == "min_angle" || key == "max_elongation" ||
             key == "zones" || key == "shift" || key == "turn_kappa";
    case 7: return key == "gaps" || key == "bridge";
    default: return false;
  }
}

/// Numbers of the earlier [[joint_set]]s of the sets named.
std::vector<std::size_t> parse_terminate_at(const Context& context, const TableReader& set,
                                            const std::vector<RandomSet>& earlier) {
  std::vector<std::size_t> numbers;
  if (!set.has("terminate_at")) {
    set.missing("terminate_at", "add terminate_at = [\"A\"] with names of earlier joint sets");
    return numbers;
  }
  const auto names = set.texts("terminate_at");
  if (!names) return numbers;
  for (const std::string& name : *names) {
    const std::size_t before = numbers.size();
    for (std::size_t i = 0; i < earlier.size(); ++i) {
      if (context.sets[earlier[i].set].name == name) numbers.push_back(i);
    }
    if (numbers.size() == before) {
      set.error("terminate_at", fmt::format("\"{}\" is no earlier [[joint_set]]", name.substr(0, 60)),
                "name a set that stands above this one: younger joints end at older ones");
    }
  }
  return numbers;
}

std::vector<dfn::Zone> parse_zones(const TableReader& set) {
  std::vector<dfn::Zone> zones;
  const auto found = set.tables("zones");
  constexpr std::array<string_view, 3> keys{"min", "max", "probability"};
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto* table = std::get_if<TomlTable>(&found[i]->value);
    const TableReader zone{*table, found[i]->line, fmt::format("{}[{}]", set.path_of("zones"), i + 1), set.problems(),
                           keys};
    const auto min = zone.need_vec3("min", rule::coordinate), max = zone.need_vec3("max", rule::coordinate);
    const auto probability = zone.need_number("probability", probability_rule);
    if (min && max && probability) zones.push_back({*min, *max, *probability});
  }
  return zones;
}

/// The model with its own keys; only the keys of other models are wrong.
std::optional<dfn::Model> parse_model(const Context& context, const TableReader& set,
                                      const std::vector<RandomSet>& earlier) {
  constexpr std::array<string_view, 8> models{"baecher", "enhanced_baecher", "veneziano", "dershowitz",
                                              "mosaic",  "hierarchical",     "mit",       "orthogonal"};
  std::size_t model = 0;
  if (set.has("model")) {
    const auto word = set.choice("model", models);
    if (!word) return std::nullopt;
    model = *word;
  }
  for (const string_view key : set_keys) {
    if (key == "probability" && model == 0) continue;
    const bool own =
        std::ranges::any_of(std::array{1U, 2U, 3U, 4U, 5U, 6U, 7U}, [&](std::size_t m) { return takes(m, key); });
    if (!own || !set.has(key) || takes(model, key)) continue;
    if (model == 0 && key == "terminate_at") continue;
    set.error(key, fmt::format("has no meaning for the model \"{}\"", models[model]),
              "remove it, or take another model");
  }
  // A Baecher set that ends at others is an enhanced Baecher set.
  if (model == 0 && set.has("terminate_at")) model = 1;
  const auto share = [&](double otherwise) { return set.number("share", share_rule).value_or(otherwise); };
  switch (model) {
    case 1:
      return dfn::EnhancedBaecher{parse_terminate_at(context, set, earlier),
                                  set.number("probability", probability_rule).value_or(1)};
    case 2: return dfn::Veneziano{share(0.5)};
    case 3: return dfn::Dershowitz{share(0.5)};
    case 4: {
      constexpr std::array<string_view, 3> seeds{"poisson", "grid", "jittered"};
      const auto word = set.choice("seeds", seeds);
      return dfn::Mosaic{static_cast<dfn::Mosaic::Seeds>(word.value_or(0)), share(1)};
    }
    case 5: {
      dfn::Hierarchical hierarchical{parse_terminate_at(context, set, earlier), {0.1, 0.5, 1}};
      if (const TomlEntry* entry = set.find("share")) {
        const auto* list = std::get_if<TomlArray>(&entry->node.value);
        if (list == nullptr || list->items.size() != 3) {
          set.error("share", "is not a list of three probabilities",
                    "write share = [0.1, 0.5, 1]: bounded by none, one, two or more older joints");
          return std::nullopt;
        }
        for (std::size_t i = 0; i < 3; ++i) {
          hierarchical.share[i] =
              set.number_of(list->items[i], fmt::format("{}[{}]", set.path_of("share"), i + 1), probability_rule)
                  .value_or(0);
        }
      }
      return hierarchical;
    }
    case 6: {
      dfn::Mit mit;
      constexpr NumberRule angle{0, false, 60, false, " degrees"};
      constexpr NumberRule elongation{1.2, false, 1e6, false, ""};
      constexpr NumberRule kappa_rule{0, false, 1e12, false, ""};
      mit.share = share(0.5);
      mit.min_corners = static_cast<std::uint32_t>(set.integer("min_corners", 3, 8).value_or(4));
      mit.min_angle = set.number("min_angle", angle).value_or(mit.min_angle);
      mit.max_elongation = set.number("max_elongation", elongation).value_or(mit.max_elongation);
      if (set.has("zones")) mit.zones = parse_zones(set);
      mit.shift = set.number("shift", rule::length_or_zero).value_or(0);
      mit.turn_kappa = set.number("turn_kappa", kappa_rule);
      return mit;
    }
    case 7: {
      dfn::Orthogonal orthogonal;
      if (const TomlEntry* gaps = set.find("gaps")) {
        constexpr std::array<string_view, 3> laws{"poisson", "constant", "lognormal"};
        constexpr std::array<string_view, 2> keys{"distribution", "variation"};
        constexpr NumberRule variation{0, true, 10, false, ""};
        if (const auto* table = std::get_if<TomlTable>(&gaps->node.value)) {
          const TableReader reader{*table, gaps->line, set.path_of("gaps"), set.problems(), keys};
          if (const auto word = distribution_of(reader, laws)) {
            orthogonal.gaps = static_cast<dfn::Orthogonal::Gaps>(*word);
          }
          orthogonal.gap_variation = reader.number("variation", variation).value_or(orthogonal.gap_variation);
        } else if (const auto word = set.choice("gaps", laws)) {
          orthogonal.gaps = static_cast<dfn::Orthogonal::Gaps>(*word);
        }
      }
      if (set.has("bridge")) orthogonal.bridge = parse_size(set, "bridge");
      return orthogonal;
    }
    default: return dfn::Baecher{};
  }
}

void parse_joint_set(Context& context, const TableReader& set, std::vector<RandomSet>& joint_sets) {
  const std::size_t before = context.problems.errors();
  auto name = set.text("name");
  if (set.has("set")) set.error("set", "is no key of a [[joint_set]]", "write name instead");
  const auto model = parse_model(context, set, joint_sets);
  const bool mosaic = model && std::holds_alternative<dfn::Mosaic>(*model);
  const bool sizeless =
      mosaic ||
      (model && (std::holds_alternative<dfn::Dershowitz>(*model) || std::holds_alternative<dfn::Hierarchical>(*model)));
  if (mosaic && set.has("orientation")) {
    set.error("orientation", "has no meaning for the model \"mosaic\": its faces look every way", "remove it");
  }
  for (const string_view key : {"shape", "size", "size_2", "aspect", "sides"}) {
    if (sizeless && set.has(key)) {
      set.error(key, "has no meaning for this model: sizes follow from the planes", "remove it");
    }
  }
  const auto orientation =
      mosaic ? std::optional<dfn::OrientationLaw>{dfn::FisherOrientation{Dip::degrees(0), DipDirection::degrees(0), 0}}
             : parse_orientation(context, set);
  const auto shape = sizeless ? std::optional<dfn::Shape>{dfn::Persistent{}} : parse_shape(set);
  const auto rotation = parse_rotation(set);
  const auto intensity = parse_intensity(set);
  if (context.problems.errors() != before || !orientation || !shape || !rotation || !intensity || !model) return;
  auto law = dfn::JointSet::make({*orientation, *shape, *rotation, *intensity, *model});
  if (!law) {
    const std::string key = std::visit(
        overloaded{[](const dfn::BadValue& e) { return e.key; }, [](const dfn::ModelMismatch& e) { return e.key; },
                   [](const dfn::NoCentres&) { return std::string{"intensity"}; }},
        law.error());
    set.problems().error(set.line_of(key.substr(0, key.find('.'))), set.path_of(key), describe(law.error()), "");
    return;
  }
  joint_sets.push_back({context.set_named(name.value_or("default")), std::move(*law), set.line()});
}

}  // namespace

void parse_joint_sets(Context& context, const TableReader& root, std::vector<RandomSet>& joint_sets) {
  const auto found = root.tables("joint_set");
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto* table = std::get_if<TomlTable>(&found[i]->value);
    const TableReader set{*table, found[i]->line, fmt::format("joint_set[{}]", i + 1), context.problems, set_keys};
    parse_joint_set(context, set, joint_sets);
  }
}

}  // namespace cleave::scene
