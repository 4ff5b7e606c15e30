#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "context.hpp"

namespace cleave::scene {
namespace {

using std::string_view;

/// More stages than this would make more orders than anyone compares: 7! = 5040.
constexpr std::size_t most_permuted = 6;

std::string list_of(const std::vector<std::uint32_t>& stages) { return fmt::format("[{}]", fmt::join(stages, ", ")); }

void parse_orders(const TableReader& table, SequenceSettings& settings) {
  const TomlEntry* entry = table.find("compare_orders");
  if (entry == nullptr) return;
  const auto bad = [&](std::string what) {
    table.error("compare_orders", std::move(what),
                fmt::format("write \"all\", or a list of orders of the stages {} such as [{}]",
                            list_of(settings.stages), list_of(settings.stages)));
  };
  if (const auto* word = std::get_if<std::string>(&entry->node.value)) {
    if (*word != "all") return bad(fmt::format("is \"{}\"", word->substr(0, 60)));
    if (settings.stages.size() > most_permuted) {
      return bad(fmt::format("\"all\" is for up to {} stages and there are {}", most_permuted, settings.stages.size()));
    }
    auto order = settings.stages;
    while (std::ranges::next_permutation(order).found) settings.orders.push_back(order);
    return;
  }
  const auto* list = std::get_if<TomlArray>(&entry->node.value);
  if (list == nullptr) return bad("is neither \"all\" nor a list of orders");
  for (const TomlNode& item : list->items) {
    const auto* numbers = std::get_if<TomlArray>(&item.value);
    std::vector<std::uint32_t> order;
    for (std::size_t i = 0; numbers != nullptr && i < numbers->items.size(); ++i) {
      const auto* number = std::get_if<std::int64_t>(&numbers->items[i].value);
      if (number == nullptr || *number < 1 || *number > 10'000) break;
      order.push_back(static_cast<std::uint32_t>(*number));
    }
    auto sorted = order;
    std::ranges::sort(sorted);
    if (numbers == nullptr || order.size() != numbers->items.size() || sorted != settings.stages) {
      return bad(fmt::format("order {} does not name every stage once", settings.orders.size() + 1));
    }
    settings.orders.push_back(std::move(order));
  }
}

}  // namespace

std::optional<SequenceSettings> parse_sequence(const TableReader& root, const std::vector<Excavation>& excavations) {
  SequenceSettings settings;
  for (const Excavation& excavation : excavations) settings.stages.push_back(excavation.stage);
  std::ranges::sort(settings.stages);
  const auto repeated = std::ranges::unique(settings.stages);
  settings.stages.erase(repeated.begin(), repeated.end());
  if (const TomlTable* found = root.table("sequence")) {
    constexpr std::array<string_view, 2> keys{"fallen", "compare_orders"};
    constexpr std::array<string_view, 2> ways{"stay_out", "put_back"};
    const TableReader table{*found, root.line_of("sequence"), "sequence", root.problems(), keys};
    if (settings.stages.size() < 2 && root.problems().errors() == 0) {
      root.error("sequence", "asks for excavation in stages, but all excavations are of one stage",
                 "give the excavations different `stage` numbers, or remove the section");
    }
    if (const auto way = table.choice("fallen", ways)) {
      settings.fallen = *way == 0 ? Fallen::stay_out : Fallen::put_back;
    }
    parse_orders(table, settings);
  }
  if (settings.stages.size() < 2) return std::nullopt;
  return settings;
}

MicroBlocks parse_micro_blocks(const TableReader& root) {
  MicroBlocks limits;
  const TomlTable* found = root.table("micro_blocks");
  if (found == nullptr) return limits;
  constexpr std::array<string_view, 3> keys{"policy", "thickness", "volume"};
  constexpr std::array<string_view, 3> policies{"keep", "report", "exclude"};
  const TableReader table{*found, root.line_of("micro_blocks"), "micro_blocks", root.problems(), keys};
  if (const auto policy = table.choice("policy", policies)) limits.policy = static_cast<MicroBlockPolicy>(*policy);
  if (const auto thickness = table.number("thickness", rule::length)) limits.thickness = metres(*thickness);
  if (const auto volume = table.number("volume", rule::length)) limits.volume = cubic_metres(*volume);
  return limits;
}

}  // namespace cleave::scene
