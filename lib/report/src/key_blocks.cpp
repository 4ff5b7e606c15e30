#include "cleave/report/key_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "cleave/exchange/csv.hpp"
#include "tables.hpp"

namespace cleave::report {
namespace {

const stability::Judgement no_judgement{.block = topology::BlockId{0U}};

/// Calls `row` with the name and the analysis of the base case and of each named one.
void for_each_case(const scene::RunResult& result, auto&& row) {
  row("base", *result.analysis);
  for (const scene::CaseResult& load : result.load_cases) row(load.name, load.analysis);
}
void for_each_support(const scene::RunResult& result, auto&& row) {
  row("base", *result.support);
  for (const scene::CaseSupport& load : result.support_cases) row(load.name, load.support);
}

/// The row of a block in rows that are in order of block; null: none.
template <class Row>
const Row* row_of(const std::vector<Row>& rows, topology::BlockId block) {
  const auto found = std::ranges::lower_bound(rows, block, {}, &Row::block);
  return found != rows.end() && found->block == block ? &*found : nullptr;
}

/// Of the block's groups below the target, the worst; empty: it is in none.
std::optional<std::string_view> held_in_group(const stability::GroupSupport& groups, topology::BlockId block) {
  bool known = false;
  std::optional<assembly::Verdict> worst;
  for (const stability::KeyGroup& group : groups.below.groups) {
    if (!std::ranges::binary_search(group.blocks, block)) continue;
    known = true;
    const std::optional<assembly::Verdict> left = groups.left_of(group);
    if (left && (!worst || *left < *worst)) worst = left;
  }
  return known ? std::optional{held_word(worst)} : std::nullopt;
}

/// Where a block is, and the names of the sets that bound it.
std::pair<scene::BlockPlace, std::vector<std::string>> place_and_sets(const topology::BlockComplex& complex,
                                                                      const scene::RunResult& result,
                                                                      topology::BlockId id) {
  scene::BlockPlace place = scene::place_of(result, complex, id, scene::joints_of(complex, id));
  std::vector<std::string> sets;
  for (const scene::SetId set : place.sets) sets.push_back(result.sets[set].name);
  return {std::move(place), std::move(sets)};
}

}  // namespace

KeyBlockRow key_block_row(const topology::BlockComplex& complex, const scene::RunResult& result,
                          const stability::Judgement& j) {
  const topology::Block& block = complex.blocks()[j.block];
  KeyBlockRow row{.j = j,
                  .volume_m3 = block.volume.si(),
                  .faces = block.faces.size(),
                  .joints = scene::joints_of(complex, j.block),
                  .parts = parts_of(result),
                  .supported = result.support ? row_of(result.support->blocks, j.block) : nullptr,
                  .clamped = result.field_stress ? row_of(result.field_stress->blocks, j.block) : nullptr};
  if (result.group_support) row.group_supported = held_in_group(*result.group_support, j.block);
  std::tie(row.place, row.sets) = place_and_sets(complex, result, j.block);
  return row;
}

std::string clock_text(double hours) {
  const auto halves = static_cast<int>(std::lround(2 * hours)) % 24;
  return std::to_string(halves < 2 ? 12 : halves / 2) + (halves % 2 == 0 ? ":00" : ":30");
}

std::string key_blocks_csv(const topology::BlockComplex& complex, const scene::RunResult& result) {
  const stability::Analysis& analysis = *result.analysis;
  CsvTable table{KeyBlockRow{.j = no_judgement, .parts = parts_of(result)}};
  for (const stability::Judgement& j : analysis.judgements) {
    if (!stability::moves(j.mode) && !j.key) continue;  // key without moving: it turns, and that was to decide
    table.add(key_block_row(complex, result, j));
  }
  return std::move(table).text();
}

std::string load_cases_csv(const topology::BlockComplex& complex, const scene::RunResult& result) {
  CsvTable table{LoadCaseRow{"", no_judgement}};
  for_each_case(result, [&](std::string_view name, const stability::Analysis& analysis) {
    for (const stability::Judgement& j : analysis.judgements) {
      if (!stability::moves(j.mode) && !j.key) continue;
      LoadCaseRow row{name, j, complex.blocks()[j.block].volume.si()};
      std::tie(row.place, row.sets) = place_and_sets(complex, result, j.block);
      table.add(row);
    }
  });
  return std::move(table).text();
}

std::string border_blocks_csv(const topology::BlockComplex& complex, const scene::RunResult& result) {
  CsvTable table{BorderBlockRow{.load = "", .block = topology::BlockId{0U}}};
  const auto add = [&](std::string_view name, const std::optional<stability::DomainHeld>& held) {
    if (!held) return;
    for (const topology::BlockId id : held->blocks) {
      BorderBlockRow row{name, id, row_of(held->alone, id), complex.blocks()[id].volume.si()};
      std::tie(row.place, row.sets) = place_and_sets(complex, result, id);
      table.add(row);
    }
  };
  add("base", result.domain_held);
  for (const scene::CaseResult& load : result.load_cases) add(load.name, load.domain_held);
  return std::move(table).text();
}

std::string bolts_csv(const scene::RunResult& result) {
  const stability::BoltResult none{};
  CsvTable table{BoltRow{.pattern = {}, .b = none}};
  const auto& groups = result.bolt_groups;
  for (std::size_t i = 0; const stability::BoltResult& b : result.support->bolts) {
    BoltRow row{i++, b.spot ? "spot" : b.bolt.group < groups.size() ? groups[b.bolt.group] : "", b};
    std::ranges::replace_if(row.pattern, [](char c) { return c == ',' || c == '"' || c == '\n' || c == '\r'; }, ' ');
    for (const auto& pierced : b.pierced) {
      row.blocks.push_back(std::to_string(pierced.block.value()) + ':' + number(pierced.from) + '-' +
                           number(pierced.to));
    }
    if (result.motion) {
      const auto& moved = result.motion->bolts;
      const auto own = std::ranges::lower_bound(moved, row.number, {}, &scene::MotionBolt::bolt);
      if (own != moved.end() && own->bolt == row.number) row.motion = &*own;
    }
    table.add(row);
  }
  return std::move(table).text();
}

std::string support_blocks_csv(const scene::RunResult& result) {
  const stability::SupportedBlock none{.block = topology::BlockId{0U}};
  CsvTable table{SupportBlockRow{"", none}};
  for_each_support(result, [&](std::string_view name, const stability::SupportResult& support) {
    for (const stability::SupportedBlock& b : support.blocks) table.add(SupportBlockRow{name, b});
  });
  return std::move(table).text();
}

std::string combined_blocks_csv(const scene::RunResult& result) {
  const stability::CombinedBlock none{};
  CsvTable table{CombinedBlockRow{.load = "", .b = none}};
  for_each_support(result, [&](std::string_view name, const stability::SupportResult& support) {
    for (std::size_t i = 0; const stability::CombinedBlock& b : support.combined) {
      table.add(CombinedBlockRow{name, i++, b});
    }
  });
  return std::move(table).text();
}

std::string maximum_blocks_csv(const scene::RunResult& result) {
  return csv_table(scene::MaximumRow{}, result.maximum_blocks);
}

}  // namespace cleave::report
