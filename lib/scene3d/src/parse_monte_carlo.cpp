#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "cleave/core/nearest.hpp"
#include "cleave/scene3d/key_tables.hpp"
#include "cleave/stochastic/ensemble.hpp"
#include "context.hpp"

namespace cleave::scene {
namespace {

using std::string_view;

constexpr std::int64_t most_realizations = 100'000'000;
constexpr NumberRule confidence_rule{0.5, false, 0.9999, false, ""};
constexpr NumberRule volume_rule{0, false, 1e15, false, " m3"};
constexpr NumberRule seismic_factor_rule{0, false, 1e3, false, ""};

const KeyTable& stop_keys() {
  static const KeyTable keys{
      .name = "monte_carlo.stop",
      .keys = {{"quantity", key::text(), "\"key_block_volume\"", "whose mean is to be known"},
               {"relative_half_width", key::number(rule::share), required,
                "of the mean, 0.1 for 10 %: stops when the normal quantile times the standard error (with "
                "`always_valid` the half "
                "width of the confidence sequence) is no more than this times the mean; the interval of a skewed "
                "figure is printed wider"},
               {"confidence", key::number(confidence_rule), "0.95", "of the interval"},
               {"max", key::whole(2, most_realizations), required,
                "the most realizations; reaching it first ends with exit code 4 and status `not converged`"},
               {"rule", key::word<stochastic::StopRule>(), "\"fixed_looks\"",
                "looks only after 100, 150, 225, ... realizations, and not before 300 while the skewness is above 2; "
                "`\"always_valid\"` goes by a confidence sequence that holds at every look"}}};
  return keys;
}

/// Written in per cent it would stop at once: ten times the mean is no width to stop at.
std::optional<double> need_half_width(const TableReader& stop) {
  constexpr string_view key = "relative_half_width";
  const TomlEntry* entry = stop.find(key);
  const auto* whole = entry == nullptr ? nullptr : std::get_if<std::int64_t>(&entry->node.value);
  const auto* real = entry == nullptr ? nullptr : std::get_if<double>(&entry->node.value);
  const double value = whole != nullptr ? static_cast<double>(*whole) : real != nullptr ? *real : 0;
  if (!(value > 1 && value <= 100)) return stop.need_number(key);
  stop.error(key, fmt::format("is {0:g}, which is {0:g} times the mean", value),
             fmt::format("for {:g} % of the mean write {:g}", value, value / 100));
  return std::nullopt;
}

std::optional<stochastic::Stop> parse_stop(const TableReader& monte_carlo) {
  const auto table = monte_carlo.sub("stop");
  if (!table) return std::nullopt;
  stochastic::Stop stop;
  if (const auto word = table->text("quantity")) {
    if (const auto* quantity = stochastic::quantity_named(*word)) {
      stop.quantity = quantity->name;
    } else {
      std::vector<string_view> names;
      for (const auto& known : stochastic::quantities()) names.push_back(known.name);
      const auto guess = nearest(*word, names);
      table->error("quantity", fmt::format("\"{}\" is not known", word->substr(0, 60)),
                   guess ? fmt::format("did you mean \"{}\"?", *guess) : "write quantity = \"key_block_volume\"");
    }
  }
  stop.relative_half_width = need_half_width(*table).value_or(stop.relative_half_width);
  stop.confidence = table->value("confidence");
  if (!table->has("max")) table->missing("max", "add max = 10000: the most realizations to pay for");
  stop.max = static_cast<std::uint64_t>(table->integer("max").value_or(2));
  stop.rule = table->word<stochastic::StopRule>("rule");
  return stop;
}

std::vector<double> parse_volumes(const TableReader& table, std::vector<double> otherwise) {
  auto volumes = table.numbers("volume_thresholds").value_or(std::move(otherwise));
  std::ranges::sort(volumes);
  const auto repeated = std::ranges::unique(volumes);
  volumes.erase(repeated.begin(), repeated.end());
  return volumes;
}

}  // namespace

const KeyTable& monte_carlo_keys() {
  static const KeyTable keys{
      .name = "monte_carlo",
      .keys = {{"realizations", key::whole(1, most_realizations), "", "exactly so many; or `stop`"},
               {"stop", key::table(&stop_keys), "", "ends when the interval of the mean is narrow enough"},
               {"confidence", key::number(confidence_rule), "0.95", "of all intervals"},
               {"volume_thresholds", key::array(key::number(volume_rule), 0, 100), "[0.1, 1, 10, 100]",
                "m3: the probability of a key block above each, by realization, per metre and by chainage", "volumes"},
               {"chainage_bins", key::whole(1, 1000), "20", "equal parts of the axis of the first tunnel",
                "chainage_parts"},
               {"seismic_factor", number_or_law<seismic_factor_rule>(), "1",
                "a number or law, drawn once a realization; multiplies `seismic` of `[stability]` and of the load "
                "cases"},
               {"strength_draws_per_network", key::whole(1, 10'000), "1",
                "nested design: so many realizations in a row have the same joints, which are cut once, and strengths "
                "and loads of their own; it must divide `realizations` (or `stop.max`), which counts every draw",
                "strengths_per_geometry"}},
      .one_of = {{"realizations", "stop"}}};
  return keys;
}

std::optional<MonteCarloSettings> parse_monte_carlo(const TableReader& root) {
  const auto table = root.sub("monte_carlo");
  if (!table) return std::nullopt;
  MonteCarloSettings settings;
  const TomlEntry* length = table->one_of();
  if (length != nullptr && length->key == "stop") {
    settings.stop = parse_stop(*table);
    if (settings.stop) {
      settings.realizations = settings.stop->max;
      settings.confidence = settings.stop->confidence;
    }
  } else if (length != nullptr) {
    settings.realizations = static_cast<std::uint64_t>(table->integer("realizations").value_or(1));
  }
  settings.confidence = table->number("confidence").value_or(settings.confidence);
  settings.volumes = parse_volumes(*table, settings.volumes);
  settings.chainage_parts = static_cast<std::uint32_t>(table->count("chainage_bins"));
  if (const auto law = parse_number_law(*table, "seismic_factor")) settings.seismic_factor = *law;
  settings.strengths_per_geometry = static_cast<std::uint64_t>(table->count("strength_draws_per_network"));
  if (settings.realizations % settings.strengths_per_geometry != 0) {
    table->error(
        "strength_draws_per_network",
        fmt::format("{} does not divide the {} realizations", settings.strengths_per_geometry, settings.realizations),
        "realizations (or stop.max) counts every draw: make it a multiple");
  }
  return settings;
}

}  // namespace cleave::scene
