#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "cleave/stochastic/ensemble.hpp"
#include "context.hpp"
#include "nearest.hpp"

namespace cleave::scene {
namespace {

using std::string_view;

constexpr std::int64_t most_realizations = 100'000'000;
constexpr NumberRule confidence_rule{0.5, false, 0.9999, false, ""};

std::optional<stochastic::Stop> parse_stop(const TableReader& monte_carlo) {
  constexpr std::array<string_view, 5> keys{"quantity", "relative_half_width", "confidence", "max", "rule"};
  constexpr std::array<string_view, 2> rules{"fixed_looks", "always_valid"};
  constexpr NumberRule width{0, true, 10, false, ""};
  const TomlTable* found = monte_carlo.table("stop");
  if (found == nullptr) return std::nullopt;
  const TableReader table{*found, monte_carlo.line_of("stop"), monte_carlo.path_of("stop"), monte_carlo.problems(),
                          keys};
  stochastic::Stop stop;
  if (const auto word = table.text("quantity")) {
    if (const auto* quantity = stochastic::quantity_named(*word)) {
      stop.quantity = quantity->name;
    } else {
      std::vector<string_view> names;
      for (const auto& known : stochastic::quantities()) names.push_back(known.name);
      const auto guess = nearest(*word, names);
      table.error("quantity", fmt::format("\"{}\" is not known", word->substr(0, 60)),
                  guess ? fmt::format("did you mean \"{}\"?", *guess) : "write quantity = \"key_block_volume\"");
    }
  }
  stop.relative_half_width = table.need_number("relative_half_width", width).value_or(stop.relative_half_width);
  stop.confidence = table.number("confidence", confidence_rule).value_or(stop.confidence);
  if (!table.has("max")) table.missing("max", "add max = 10000: the most realizations to pay for");
  stop.max = static_cast<std::uint64_t>(table.integer("max", 2, most_realizations).value_or(2));
  if (const auto rule = table.choice("rule", rules)) {
    stop.rule = *rule == 0 ? stochastic::StopRule::fixed_looks : stochastic::StopRule::always_valid;
  }
  return stop;
}

std::vector<double> parse_volumes(const TableReader& table, std::vector<double> otherwise) {
  const TomlEntry* entry = table.find("volumes");
  if (entry == nullptr) return otherwise;
  const auto* array = std::get_if<TomlArray>(&entry->node.value);
  if (array == nullptr || array->items.size() > 100) {
    table.error("volumes", "is not a list of at most 100 volumes", "write volumes = [0.1, 1, 10, 100], in m3");
    return otherwise;
  }
  constexpr NumberRule volume{0, false, 1e15, false, " m3"};
  std::vector<double> volumes;
  for (std::size_t i = 0; i < array->items.size(); ++i) {
    const auto value = table.number_of(array->items[i], fmt::format("{}[{}]", table.path_of("volumes"), i + 1), volume);
    if (value) volumes.push_back(*value);
  }
  std::ranges::sort(volumes);
  const auto repeated = std::ranges::unique(volumes);
  volumes.erase(repeated.begin(), repeated.end());
  return volumes;
}

}  // namespace

std::optional<MonteCarloSettings> parse_monte_carlo(const TableReader& root) {
  constexpr std::array<string_view, 7> keys{
      "realizations", "stop", "confidence", "volumes", "chainage_parts", "seismic_factor", "strengths_per_geometry"};
  const TomlTable* found = root.table("monte_carlo");
  if (found == nullptr) return std::nullopt;
  const TableReader table{*found, root.line_of("monte_carlo"), "monte_carlo", root.problems(), keys};
  MonteCarloSettings settings;
  constexpr std::array<string_view, 2> lengths{"realizations", "stop"};
  const TomlEntry* length = table.one_of(lengths);
  if (length != nullptr && length->key == "stop") {
    settings.stop = parse_stop(table);
    if (settings.stop) {
      settings.realizations = settings.stop->max;
      settings.confidence = settings.stop->confidence;
    }
  } else if (length != nullptr) {
    settings.realizations = static_cast<std::uint64_t>(table.integer("realizations", 1, most_realizations).value_or(1));
  }
  settings.confidence = table.number("confidence", confidence_rule).value_or(settings.confidence);
  settings.volumes = parse_volumes(table, settings.volumes);
  if (const auto parts = table.integer("chainage_parts", 1, 1000)) {
    settings.chainage_parts = static_cast<std::uint32_t>(*parts);
  }
  constexpr NumberRule factor{0, false, 1e3, false, ""};
  if (const auto law = parse_number_law(table, "seismic_factor", factor)) settings.seismic_factor = *law;
  if (const auto draws = table.integer("strengths_per_geometry", 1, 10'000)) {
    settings.strengths_per_geometry = static_cast<std::uint64_t>(*draws);
    if (settings.realizations % settings.strengths_per_geometry != 0) {
      table.error("strengths_per_geometry",
                  fmt::format("{} does not divide the {} realizations", *draws, settings.realizations),
                  "realizations (or stop.max) counts every draw: make it a multiple");
    }
  }
  return settings;
}

}  // namespace cleave::scene
