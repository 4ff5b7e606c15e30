#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "cleave/scene3d/key_tables.hpp"
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

constexpr std::array<string_view, 1> all_orders{"all"};

// Micro-blocks are crumbs and slivers: what is larger is a block that may fall.
constexpr NumberRule micro_thickness_rule = rule::length.usually(1e-9, 0.5);
constexpr NumberRule micro_volume_rule =
    rule::volume.usually(1e-15, 10, "blocks of that size are no crumbs: it is taken as it stands, check it");

}  // namespace

const KeyTable& sequence_keys() {
  static const KeyTable keys{
      .name = "sequence",
      .keys = {
          {"fallen", key::word<Fallen>(), "`\"stay_out\"`; with `[support]` `\"put_back\"`",
           "`\"stay_out\"`: key blocks of a stage have fallen when the next one begins, refused with `[support]`, "
           "which "
           "may hold them; `\"put_back\"`: they are held and stay in place"},
          {"compare_orders", key::either({key::word(all_orders), key::array(key::array(key::whole(1, 10'000)))}), "",
           "`\"all\"` orders of the stages (up to 6), or a list such as `[[1, 2, 3], [2, 1, 3]]`: the volume of key "
           "blocks of each"}}};
  return keys;
}

const KeyTable& micro_blocks_keys() {
  static const KeyTable keys{
      .name = "micro_blocks",
      .keys = {
          {"policy", key::word<MicroBlockPolicy>(), "\"report\"",
           "`\"keep\"`: say nothing; `\"report\"`: count them in `summary.json` and the notes; `\"exclude\"`: also "
           "leave them out of stability: not judged, in no batch, and holding nothing (their neighbours find a "
           "free face there)"},
          {"thickness", key::number(micro_thickness_rule), "",
           "m: a block below it, or below `volume`, is a micro-block. Neither: thinner than 1e-6 of the domain's "
           "extent"},
          {"volume", key::number(micro_volume_rule), "", "m3: a block below it is a micro-block"}}};
  return keys;
}

std::optional<SequenceSettings> parse_sequence(const TableReader& root, const std::vector<Excavation>& excavations,
                                               bool supported) {
  // What a support holds in one stage is there in the next. It does not pass where it lets a block fall.
  SequenceSettings settings{.fallen = supported ? Fallen::put_back : Fallen::stay_out, .stages = {}, .orders = {}};
  for (const Excavation& excavation : excavations) settings.stages.push_back(excavation.stage);
  std::ranges::sort(settings.stages);
  const auto repeated = std::ranges::unique(settings.stages);
  settings.stages.erase(repeated.begin(), repeated.end());
  if (const auto table = root.sub("sequence")) {
    if (settings.stages.size() < 2 && root.problems().errors() == 0) {
      root.error("sequence", "asks for excavation in stages, but all excavations are of one stage",
                 "give the excavations different `stage` numbers, or remove the section");
    }
    const auto fallen = table->given_word<Fallen>("fallen");
    if (supported && fallen == Fallen::stay_out) {
      table->error("fallen",
                   "takes out after each stage what the support may hold, and what it holds must be held later",
                   "remove it, or write \"put_back\"; for the blocks that fall without support remove [support]");
    }
    settings.fallen = fallen.value_or(settings.fallen);
    parse_orders(*table, settings);
  }
  if (settings.stages.size() < 2) return std::nullopt;
  return settings;
}

MicroBlocks parse_micro_blocks(const TableReader& root) {
  MicroBlocks limits;
  const auto table = root.sub("micro_blocks");
  if (!table) return limits;
  limits.policy = table->word<MicroBlockPolicy>("policy");
  if (const auto thickness = table->number("thickness")) limits.thickness = metres(*thickness);
  if (const auto volume = table->number("volume")) limits.volume = cubic_metres(*volume);
  return limits;
}

}  // namespace cleave::scene
