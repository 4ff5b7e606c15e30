#include "joint_models.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "drawing_order.hpp"

namespace cleave::scene {
namespace {

using std::string_view;

constexpr NumberRule probability_rule{0, false, 1, false, ""};
constexpr NumberRule share_rule{0, true, 1, false, ""};

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

/// Numbers of the sets that `terminate_at` names; without it all [[joint_set]]s above.
std::vector<std::size_t> parse_terminate_at(const TableReader& set, const OtherSets& others) {
  std::vector<std::size_t> numbers;
  if (!set.has("terminate_at")) {
    for (std::size_t i = 0; i < others.own; ++i) numbers.push_back(i);
    return numbers;
  }
  for (const std::string& name : set.texts("terminate_at").value_or(std::vector<std::string>{})) {
    const std::size_t before = numbers.size();
    for (std::size_t i = 0; i < others.drawn.size(); ++i) {
      if (i != others.own && others.drawn[i] == name) numbers.push_back(i);
    }
    if (const auto given = others.given.find(name); given != others.given.end()) {
      numbers.push_back(others.drawn.size() + given->second.index());
    }
    if (numbers.size() != before) continue;
    set.error("terminate_at",
              name == others.drawn[others.own] ? fmt::format("\"{}\" is this set itself", name.substr(0, 60))
                                               : fmt::format("there are no joints of a set \"{}\"", name.substr(0, 60)),
              "name other sets, of [[joint_set]] or [[joint]]");
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

}  // namespace

std::optional<dfn::Model> parse_model(const TableReader& set, const OtherSets& others,
                                      std::span<const string_view> set_keys) {
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
    case 1: {
      auto ends_at = parse_terminate_at(set, others);
      const double probability = set.number("probability", probability_rule).value_or(1);
      if (ends_at.empty()) return dfn::Baecher{};
      return dfn::EnhancedBaecher{std::move(ends_at), probability};
    }
    case 2: return dfn::Veneziano{share(0.5)};
    case 3: return dfn::Dershowitz{share(0.5)};
    case 4: {
      constexpr std::array<string_view, 3> seeds{"poisson", "grid", "jittered"};
      const auto word = set.choice("seeds", seeds);
      return dfn::Mosaic{static_cast<dfn::Mosaic::Seeds>(word.value_or(0)), share(1)};
    }
    case 5: {
      dfn::Hierarchical hierarchical{parse_terminate_at(set, others), {0.1, 0.5, 1}};
      // The primary set: polygons that nothing older bounds (Ivanova 1995).
      if (hierarchical.terminate_at.empty()) return dfn::Veneziano{share(0.5)};
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
          if (!reader.has("distribution")) {
            reader.missing("distribution", "add distribution = \"poisson\"");
          } else if (const auto word = reader.choice("distribution", laws)) {
            orthogonal.gaps = static_cast<dfn::Orthogonal::Gaps>(*word);
          }
          orthogonal.gap_variation = reader.number("variation", variation).value_or(orthogonal.gap_variation);
        } else if (const auto word = set.choice("gaps", laws)) {
          orthogonal.gaps = static_cast<dfn::Orthogonal::Gaps>(*word);
        }
      }
      // Without a law of their own, bridges are as long as joints.
      const TomlEntry* size = set.find("size");
      const bool persistent = size != nullptr && std::holds_alternative<std::string>(size->node.value);
      if (set.has("bridge")) {
        orthogonal.bridge = parse_size(set, "bridge");
      } else if (size != nullptr && !persistent) {
        orthogonal.bridge = parse_size(set, "size");
      }
      return orthogonal;
    }
    default: return dfn::Baecher{};
  }
}

void refuse_circles(std::span<const TableReader> sets, const std::vector<RandomSet>& joint_sets) {
  const std::vector<std::size_t> order = drawing_order(joint_sets);
  for (std::size_t i = 0; i < sets.size(); ++i) {
    if (std::ranges::find(order, i) != order.end()) continue;
    sets[i].error("terminate_at", "ends at sets that end at this one: nothing is older", "leave one of them out");
    return;
  }
}

}  // namespace cleave::scene
