#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "cleave/core/overloaded.hpp"
#include "cleave/dfn/joint_set.hpp"
#include "context.hpp"
#include "parse_joint_laws.hpp"

namespace cleave::scene {
namespace {

using std::string_view;

constexpr std::array<string_view, 23> set_keys{
    "name",      "model",          "orientation", "shape",        "size",        "size_2", "aspect", "rotation",
    "sides",     "intensity",      "set",         "terminate_at", "probability", "share",  "seeds",  "min_corners",
    "min_angle", "max_elongation", "zones",       "shift",        "turn_kappa",  "gaps",   "bridge"};
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
