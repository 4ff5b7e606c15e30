#include "key_groups.hpp"

#include <algorithm>
#include <cmath>
#include <ranges>
#include <utility>
#include <vector>

#include "cleave/exchange/csv.hpp"
#include "cleave/exchange/text.hpp"
#include "html_table.hpp"
#include "tables.hpp"

namespace cleave::report {
namespace {

constexpr std::size_t most_rows = 100;

/// "roof, 12:00, chainage 10.3 m"; empty where it is not known.
std::string where_of(const std::optional<scene::GroupPlace>& place) {
  if (!place) return {};
  std::string out{place->location};
  if (place->clock) out += ", " + clock_text(*place->clock);
  if (place->chainage) out += ", chainage " + display(place->chainage->si(), 4) + " m";
  return out;
}

/// A group as a page shows it: words for its verdict, and that a factor has no limit.
struct ShownGroup {
  const KeyGroupRow& row;
};
template <class V>
void fields(V& v, const ShownGroup& x) {
  const stability::KeyGroup& g = x.row.g;
  const auto factor = [&](std::optional<double> f) {
    return !g.factors || !f ? Html{} : std::isinf(*f) ? Html{"no limit", *f} : Html{display(*f, 3), *f};
  };
  std::string verdict{assembly::name(g.verdict)};
  std::ranges::replace(verdict, '_', ' ');
  v("group", x.row.number);
  v("batch", g.batch);
  v("verdict", verdict);
  v("blocks", g.blocks);
  v("volume_m3", g.volume);
  v("factor_move", factor(g.factor_move), "of motion from rest: the factor of safety of the group");
  v("factor_with_moments", factor(g.factor_turning), "the same with moments, of what translation alone moves");
  v("factor_of_largest", factor(g.factor_of_largest), "at which the largest of several blocks starts to move");
  v("factor_up", factor(g.factor_up), "above it motion is certain");
  v("moments", g.moments, "blocks turn: translation alone does not move them");
  v("location", where_of(x.row.place));
  v("load_case", x.row.load_case);
  v("stage", x.row.stage);
  std::string let_go{x.row.let_go ? scene::name_of(*x.row.let_go) : std::string_view{}};
  std::ranges::replace(let_go, '_', ' ');
  v("let_go", let_go, "what a group in doubt does in motion from rest");
}

/// Of the base case in the final state, then of the load cases, then of the stages, each without and under load.
std::vector<KeyGroupRow> rows_of(const scene::RunResult& result, const topology::BlockComplex* complex) {
  std::vector<KeyGroupRow> rows;
  const auto add = [&](const std::optional<stability::KeyGroups>& groups, std::string_view load_case,
                       std::optional<std::uint32_t> stage) {
    if (!groups) return;
    for (std::size_t number = 0; const stability::KeyGroup& group : groups->groups) {
      KeyGroupRow& row = rows.emplace_back(group, ++number, load_case, stage);
      if (stage || complex == nullptr) continue;
      row.place = scene::place_of(result, *complex, group.blocks);
      for (const scene::SetId set : row.place->sets) row.sets.push_back(result.sets[set].name);
    }
  };
  add(result.key_groups, {}, {});
  for (std::size_t k = 0; k < std::min(rows.size(), result.let_go.size()); ++k) rows[k].let_go = result.let_go[k];
  for (const scene::CaseResult& load : result.load_cases) add(load.groups, load.name, {});
  if (result.sequence) {
    for (const scene::StageResult& stage : result.sequence->stages) {
      // The same blocks as when all is excavated, unless some fell before.
      const bool last = &stage == &result.sequence->stages.back();
      if (last && !stage.block_hash.empty() && stage.block_hash == result.block_hash) continue;
      add(stage.groups, {}, stage.stage);
      for (const scene::StageCase& under : stage.cases) add(under.groups, under.name, stage.stage);
    }
  }
  return rows;
}

/// Of the base case, then of the load cases.
std::vector<SupportedGroupRow> supported_rows_of(const scene::RunResult& result,
                                                 const topology::BlockComplex* complex) {
  std::vector<SupportedGroupRow> rows;
  const auto add = [&](const std::optional<stability::GroupSupport>& groups, std::string_view load_case) {
    if (!groups) return;
    for (std::size_t number = 0; const stability::KeyGroup& group : groups->below.groups) {
      SupportedGroupRow& row =
          rows.emplace_back(group, ++number, groups->left_of(group), load_case, groups->net_left_of(group));
      if (complex != nullptr) row.place = scene::place_of(result, *complex, group.blocks);
    }
  };
  add(result.group_support, {});
  for (const scene::CaseSupport& load : result.support_cases) add(load.groups, load.name);
  return rows;
}

}  // namespace

std::string key_groups_csv(const scene::RunResult& result, const topology::BlockComplex* complex) {
  const stability::KeyGroup none{};
  return csv_table(KeyGroupRow{none}, rows_of(result, complex));
}

bool judged_with_support(const scene::RunResult& result) {
  return result.group_support || std::ranges::any_of(result.support_cases, [](const scene::CaseSupport& load) {
           return load.groups.has_value();
         });
}

std::string supported_groups_csv(const scene::RunResult& result, const topology::BlockComplex* complex) {
  const stability::KeyGroup none{};
  return csv_table(SupportedGroupRow{none}, supported_rows_of(result, complex));
}

std::string supported_groups_table(const scene::RunResult& result, const topology::BlockComplex* complex) {
  const std::vector<SupportedGroupRow> rows = supported_rows_of(result, complex);
  if (rows.empty()) return {};
  std::vector<Shown> columns{{"group"},
                             {"without", "Without support"},
                             {"with", "With support"},
                             {"blocks"},
                             {"volume_m3"},
                             {"moments", "Turns"},
                             {"net_force_n", "Out of balance (kN)"},
                             {"location"}};
  if (std::ranges::any_of(rows, [](const SupportedGroupRow& row) { return !row.load_case.empty(); })) {
    columns.push_back({"load_case", "Load case"});
  }
  const stability::KeyGroup none{};
  HtmlTable table{std::move(columns), SupportedGroupRow{none}, "id=\"supported-groups\" class=\"sortable\""};
  for (const SupportedGroupRow& row : rows | std::views::take(most_rows)) table.add(row);
  return "<h3>Blocks that move together</h3>" + std::move(table).html() +
         "<p class=\"small\">Groups below their target of safety without support. In doubt: not decided, or within 5 % "
         "of the target. Out of balance: mass times acceleration with the support, at the target." +
         (rows.size() > most_rows ? " All are in supported_groups.csv." : "") + "</p>\n";
}

std::string key_groups_section(const scene::RunResult& result, const topology::BlockComplex* complex) {
  const std::vector<KeyGroupRow> rows = rows_of(result, complex);
  if (rows.empty()) return {};
  std::string out =
      "<section id=\"groups\"><h2>Blocks judged together</h2>\n<p class=\"small\">Groups that move together. Certain: "
      "no forces in the joints hold it, whatever the stress in the rock. Unsafe: only stress locked in between the "
      "blocks could. In doubt: not decided, not stable. The factor of safety is that of motion from rest; above the "
      "upper factor motion is certain.</p>\n";
  const bool turning = std::ranges::any_of(rows, [](const KeyGroupRow& row) { return bool{row.g.factor_turning}; });
  const bool several = std::ranges::any_of(rows, [](const KeyGroupRow& row) { return bool{row.g.factor_of_largest}; });
  const bool cases = std::ranges::any_of(rows, [](const KeyGroupRow& row) { return !row.load_case.empty(); });
  const bool stages = std::ranges::any_of(rows, [](const KeyGroupRow& row) { return row.stage.has_value(); });
  std::vector<Shown> columns{{"group"},
                             {"batch"},
                             {"verdict"},
                             {"blocks"},
                             {"volume_m3"},
                             {"factor_move", "Factor of safety"},
                             {"factor_up", "Upper factor"},
                             {"moments", "Turns"}};
  if (turning) columns.insert(columns.end() - 2, {"factor_with_moments", "With moments"});
  if (several) columns.insert(columns.end() - 2, {"factor_of_largest", "Its largest block"});
  if (std::ranges::any_of(rows, [](const KeyGroupRow& row) { return row.place && !row.place->location.empty(); }))
    columns.push_back({"location", "Where"});
  if (std::ranges::any_of(rows, [](const KeyGroupRow& row) { return row.let_go.has_value(); }))
    columns.push_back({"let_go", "Let go"});
  if (cases) columns.push_back({"load_case", "Load case"});
  if (stages) columns.push_back({"stage", "After stage"});
  const stability::KeyGroup none{};
  HtmlTable table{columns, ShownGroup{KeyGroupRow{none}}, "class=\"sortable\""};
  for (std::size_t k = 0; k < std::min(most_rows, rows.size()); ++k) {
    // Those of the blocks that the page shows can be picked.
    const bool here = rows[k].load_case.empty() && !rows[k].stage;
    table.add(ShownGroup{rows[k]}, here ? "data-group=\"" + std::to_string(rows[k].number) + "\"" : "");
  }
  out += std::move(table).html();
  if (rows.size() > most_rows) out += "<p class=\"note\">All are in key_groups.csv.</p>\n";
  return out + "</section>\n";
}

}  // namespace cleave::report
