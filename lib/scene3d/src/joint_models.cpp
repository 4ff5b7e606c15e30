#include "joint_models.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "cleave/scene3d/drawing_order.hpp"
#include "cleave/scene3d/key_tables.hpp"

namespace cleave::scene {
namespace {

using std::string_view;

constexpr NumberRule angle_rule{0, false, 60, false, " degrees"};
constexpr NumberRule elongation_rule{1.2, false, 1e6, false, ""};
constexpr NumberRule variation_rule{0, true, 10, false, ""};
constexpr std::array<string_view, 8> models{"baecher", "enhanced_baecher", "veneziano", "dershowitz",
                                            "mosaic",  "hierarchical",     "mit",       "orthogonal"};

const KeyTable& zone_keys() {
  static const KeyTable keys{
      .name = "joint_set.zones",
      .keys = {{"min", key::vector(rule::coordinate), required, "m, the lowest corner"},
               {"max", key::vector(rule::coordinate), required, "m, the highest corner"},
               {"probability", key::number(rule::probability), required, "that a polygon in it is kept"}}};
  return keys;
}

const KeyTable& gap_keys() {
  static const KeyTable keys{
      .name = "joint_set.gaps",
      .keys = {{"distribution", key::word<dfn::Orthogonal::Gaps>(), required, "law of the distances of the planes"},
               {"variation", key::number(variation_rule), "", "standard deviation over mean, of `lognormal`"}}};
  return keys;
}

/// Which keys beside those of every set a model takes.
bool takes(std::size_t model, string_view key) {
  switch (model) {
    case 1: return key == "terminates_at" || key == "probability";
    case 2:
    case 3: return key == "share";
    case 4: return key == "share" || key == "seeds";
    case 5: return key == "terminates_at" || key == "share";
    case 6:
      return key == "share" || key == "min_corners" || key == "min_angle" || key == "max_elongation" ||
             key == "zones" || key == "shift" || key == "rotation_kappa";
    case 7: return key == "gaps" || key == "bridge" || key == "through";
    default: return false;
  }
}

/// Numbers of the sets that `terminates_at` names; without it all [[joint_set]]s above.
std::vector<std::size_t> parse_terminate_at(const TableReader& set, const OtherSets& others) {
  std::vector<std::size_t> numbers;
  if (!set.has("terminates_at")) {
    for (std::size_t i = 0; i < others.own; ++i) numbers.push_back(i);
    return numbers;
  }
  for (const std::string& name : set.texts("terminates_at").value_or(std::vector<std::string>{})) {
    const std::size_t before = numbers.size();
    for (std::size_t i = 0; i < others.drawn.size(); ++i) {
      if (i != others.own && others.drawn[i] == name) numbers.push_back(i);
    }
    if (const auto given = others.given.find(name); given != others.given.end()) {
      numbers.push_back(others.drawn.size() + given->second.index());
    }
    if (numbers.size() != before) continue;
    set.error("terminates_at",
              name == others.drawn[others.own] ? fmt::format("\"{}\" is this set itself", name.substr(0, 60))
                                               : fmt::format("there are no joints of a set \"{}\"", name.substr(0, 60)),
              "name other sets, of [[joint_set]] or [[joint]]");
  }
  return numbers;
}

std::vector<dfn::Zone> parse_zones(const TableReader& set) {
  std::vector<dfn::Zone> zones;
  for (const TableReader& zone : set.each("zones")) {
    const auto min = zone.need_vec3("min"), max = zone.need_vec3("max");
    const auto probability = zone.need_number("probability");
    if (min && max && probability) zones.push_back({*min, *max, *probability});
  }
  return zones;
}

}  // namespace

std::vector<Key> model_keys() {
  return {
      {"model", key::word(models), "\"baecher\"",
       "`baecher`: centres, orientations and sizes independent of each other; the others below"},
      {"terminates_at", key::texts(), "all random sets above",
       "names of other sets, random or given, anywhere in the scene, but not in a circle (`enhanced_baecher`, "
       "`hierarchical`)",
       "terminate_at"},
      {"probability", key::number(rule::probability), "1",
       "that a joint ends where it meets one of them (`enhanced_baecher`)"},
      {"share", key::either({key::number(rule::share), key::array(key::number(rule::probability), 3, 3)}), "0.5",
       "probability that a polygon is a joint (1 in `mosaic`); `hierarchical`: bounded by none, one, two or more "
       "older joints, `[0.1, 0.5, 1]`"},
      {"seeds", key::word<dfn::Mosaic::Seeds>(), "\"poisson\"", "of the cells (`mosaic`)"},
      {"min_corners", key::whole(3, 8), "4", "polygons with fewer corners are no joints (`mit`)"},
      {"min_angle", key::number(angle_rule), "60", "degrees, smallest angle of a polygon (`mit`)"},
      {"max_elongation", key::number(elongation_rule), "1.6", "of a polygon (`mit`)"},
      {"zones", key::tables(&zone_keys), "[]", "boxes with a probability of their own (`mit`)"},
      {"shift", key::number(rule::length_or_zero), "0", "m, of each polygon (`mit`)"},
      {"rotation_kappa", key::number(rule::kappa), "", "kappa of a Fisher rotation of each polygon (`mit`)",
       "turn_kappa"},
      {"gaps", key::either({key::word<dfn::Orthogonal::Gaps>(), key::table(&gap_keys)}), "\"poisson\"",
       "distances of the planes: a law (`constant`: regular ones), or `{ distribution, variation }`; with it a set of "
       "persistent joints is `orthogonal`"},
      {"through", key::vector(rule::coordinate), "",
       "m, a point that one of the planes passes, for `gaps = \"constant\"`; without it the first lies at random"},
      {"bridge", size_type(), "the law of `size`", "m, rock between the joints of a row (`orthogonal`)"}};
}

namespace {

std::optional<dfn::Model> parse_hierarchical(const TableReader& set, const OtherSets& others) {
  dfn::Hierarchical hierarchical{parse_terminate_at(set, others), {0.1, 0.5, 1}};
  // The primary set: polygons that nothing older bounds (Ivanova 1995).
  if (hierarchical.terminate_at.empty()) return dfn::Veneziano{set.number("share").value_or(0.5)};
  if (const TomlEntry* entry = set.find("share")) {
    const auto* list = std::get_if<TomlArray>(&entry->node.value);
    if (list == nullptr || list->items.size() != 3) {
      set.error("share", "is not a list of three probabilities",
                "write share = [0.1, 0.5, 1]: bounded by none, one, two or more older joints");
      return std::nullopt;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      hierarchical.share[i] =
          set.number_of(list->items[i], fmt::format("{}[{}]", set.path_of("share"), i + 1), rule::probability)
              .value_or(0);
    }
  }
  return hierarchical;
}

dfn::Mit parse_mit(const TableReader& set) {
  dfn::Mit mit;
  mit.share = set.number("share").value_or(0.5);
  mit.min_corners = static_cast<std::uint32_t>(set.count("min_corners"));
  mit.min_angle = set.value("min_angle");
  mit.max_elongation = set.value("max_elongation");
  if (set.has("zones")) mit.zones = parse_zones(set);
  mit.shift = set.value("shift");
  mit.turn_kappa = set.number("rotation_kappa");
  return mit;
}

/// `persistent`: its planes are endless.
dfn::Orthogonal parse_orthogonal(const TableReader& set, bool persistent) {
  dfn::Orthogonal orthogonal;
  if (const TomlEntry* gaps = set.find("gaps")) {
    if (std::holds_alternative<TomlTable>(gaps->node.value)) {
      const TableReader table = *set.sub("gaps");
      if (!table.has("distribution")) table.missing("distribution", "add distribution = \"poisson\"");
      orthogonal.gaps =
          table.given_word<dfn::Orthogonal::Gaps>("distribution").value_or(dfn::Orthogonal::Gaps::poisson);
      orthogonal.gap_variation = table.number("variation").value_or(orthogonal.gap_variation);
    } else {
      orthogonal.gaps = set.word<dfn::Orthogonal::Gaps>("gaps");
    }
  }
  // Without a law of their own, bridges are as long as joints.
  if (set.has("bridge")) {
    orthogonal.bridge = parse_size(set, "bridge");
  } else if (set.find("size") != nullptr && !persistent) {
    orthogonal.bridge = parse_size(set, "size");
  }
  orthogonal.through = set.vec3("through");
  return orthogonal;
}

}  // namespace

std::optional<dfn::Model> parse_model(const TableReader& set, const OtherSets& others) {
  std::size_t model = 0;
  if (set.has("model")) {
    const auto word = set.choice("model");
    if (!word) return std::nullopt;
    model = *word;
  }
  const bool persistent = is_persistent(set);
  // Endless joints with a law of gaps are parallel planes.
  if (model == 0 && persistent && set.has("gaps")) model = 7;
  for (const Key& own_key : model_keys()) {
    const string_view key = own_key.name;
    if (key == "probability" && model == 0 && set.has("terminates_at")) continue;
    const bool own =
        std::ranges::any_of(std::array{1U, 2U, 3U, 4U, 5U, 6U, 7U}, [&](std::size_t m) { return takes(m, key); });
    if (!own || !set.has(key) || takes(model, key)) continue;
    if (model == 0 && key == "terminates_at") continue;
    set.error(key, fmt::format("has no meaning for the model \"{}\"", models[model]),
              "remove it, or take another model");
  }
  // A Baecher set that ends at others is an enhanced Baecher set.
  if (model == 0 && set.has("terminates_at")) model = 1;
  const auto share = [&](double otherwise) { return set.number("share").value_or(otherwise); };
  switch (model) {
    case 1: {
      auto ends_at = parse_terminate_at(set, others);
      const double probability = set.value("probability");
      if (ends_at.empty()) return dfn::Baecher{};
      return dfn::EnhancedBaecher{std::move(ends_at), probability};
    }
    case 2: return dfn::Veneziano{share(0.5)};
    case 3: return dfn::Dershowitz{share(0.5)};
    case 4: {
      return dfn::Mosaic{set.word<dfn::Mosaic::Seeds>("seeds"), share(1)};
    }
    case 5: return parse_hierarchical(set, others);
    case 6: return parse_mit(set);
    case 7: return parse_orthogonal(set, persistent);
    default: return dfn::Baecher{};
  }
}

void refuse_circles(std::span<const TableReader> sets, const std::vector<RandomSet>& joint_sets) {
  const std::vector<std::size_t> order = drawing_order(joint_sets);
  for (std::size_t i = 0; i < sets.size(); ++i) {
    if (std::ranges::find(order, i) != order.end()) continue;
    sets[i].error("terminates_at", "ends at sets that end at this one: nothing is older", "leave one of them out");
    return;
  }
}

}  // namespace cleave::scene
