#include "key_groups.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "cleave/exchange/csv.hpp"
#include "cleave/exchange/text.hpp"
#include "html_table.hpp"
#include "tables.hpp"

namespace cleave::report {
namespace {

constexpr std::size_t most_rows = 100;

/// A group as a page shows it: words for its verdict, and that a factor has no limit.
struct ShownGroup {
  const stability::KeyGroup& g;
  std::size_t number;
};
template <class V>
void fields(V& v, const ShownGroup& x) {
  const auto factor = [&](double f) {
    return !x.g.factors ? Html{} : std::isinf(f) ? Html{"no limit", f} : Html{display(f, 3), f};
  };
  std::string verdict{assembly::name(x.g.verdict)};
  std::ranges::replace(verdict, '_', ' ');
  v("group", x.number);
  v("batch", x.g.batch);
  v("verdict", verdict);
  v("blocks", x.g.blocks);
  v("volume_m3", x.g.volume);
  v("factor_move", factor(x.g.factor_move), "of motion from rest: the factor of safety of the group");
  v("factor_up", factor(x.g.factor_up), "above it motion is certain");
  v("moments", x.g.moments, "blocks turn: translation alone does not move them");
}

}  // namespace

std::string key_groups_csv(const stability::KeyGroups& groups) {
  const stability::KeyGroup none{};
  CsvTable table{KeyGroupRow{none}};
  for (std::size_t number = 0; const stability::KeyGroup& group : groups.groups) {
    table.add(KeyGroupRow{group, ++number});
  }
  return std::move(table).text();
}

std::string key_groups_section(const stability::KeyGroups& groups) {
  if (groups.groups.empty()) return {};
  std::string out =
      "<section id=\"groups\"><h2>Blocks judged together</h2>\n<p class=\"small\">Groups that move together. Certain: "
      "no forces in the joints hold it, whatever the stress in the rock. Unsafe: only stress locked in between the "
      "blocks could. In doubt: not decided, not stable. The factor of safety is that of motion from rest; above the "
      "upper factor motion is certain.</p>\n";
  const stability::KeyGroup none{};
  HtmlTable table{{{"group"},
                   {"batch"},
                   {"verdict"},
                   {"blocks"},
                   {"volume_m3"},
                   {"factor_move", "Factor of safety"},
                   {"factor_up", "Upper factor"},
                   {"moments", "Turns"}},
                  ShownGroup{none, 0},
                  "class=\"sortable\""};
  for (std::size_t k = 0; k < std::min(most_rows, groups.groups.size()); ++k) {
    table.add(ShownGroup{groups.groups[k], k + 1});
  }
  out += std::move(table).html();
  if (groups.groups.size() > most_rows) out += "<p class=\"note\">All are in key_groups.csv.</p>\n";
  return out + "</section>\n";
}

}  // namespace cleave::report
