#include "key_groups.hpp"

#include <algorithm>
#include <cmath>

#include "cleave/exchange/text.hpp"

namespace cleave::report {
namespace {

constexpr std::size_t most_rows = 100;

std::string blocks_text(const stability::KeyGroup& group, std::size_t most) {
  std::string out;
  for (std::size_t k = 0; k < std::min(most, group.blocks.size()); ++k) {
    out += (k == 0 ? "" : " ") + std::to_string(group.blocks[k].value());
  }
  if (group.blocks.size() > most) out += " ...";
  return out;
}

std::string shown(double factor, bool known) {
  if (!known) return "";
  return std::isinf(factor) ? "no limit" : display(factor, 3);
}

}  // namespace

std::string key_groups_csv(const stability::KeyGroups& groups) {
  std::string out =
      "group,batch,verdict,blocks,volume_m3,factor_up,factor_move,direction_x,direction_y,direction_z,moments\n";
  std::size_t number = 0;
  for (const stability::KeyGroup& group : groups.groups) {
    out += std::to_string(++number) + ',' + std::to_string(group.batch) + ',';
    out += assembly::name(group.verdict);
    out += ',' + blocks_text(group, group.blocks.size()) + ',';
    append_number(out, group.volume.si());
    for (const double factor : {group.factor_up, group.factor_move}) {
      out += ',';
      if (group.factors) append_number(out, factor);
    }
    for (const double d : {group.direction.x, group.direction.y, group.direction.z}) {
      out += ',';
      append_number(out, d);
    }
    out += group.moments ? ",1\n" : ",0\n";
  }
  return out;
}

std::string key_groups_section(const stability::KeyGroups& groups) {
  if (groups.groups.empty()) return {};
  std::string out =
      "<section id=\"groups\"><h2>Blocks judged together</h2>\n<p class=\"small\">Groups that move together. Certain: "
      "no forces in the joints hold it, whatever the stress in the rock. Unsafe: only stress locked in between the "
      "blocks could. In doubt: not decided, not stable. The factor of safety is that of motion from rest; above the "
      "upper factor motion is certain.</p>\n<div class=\"scroll\"><table "
      "class=\"sortable\"><thead><tr><th>Group</th><th>Batch</th>"
      "<th>Verdict</th><th>Blocks</th><th>Volume (m³)</th><th>Factor of safety</th><th>Upper factor</th><th>Turns</th>"
      "</tr></thead><tbody>\n";
  for (std::size_t k = 0; k < std::min(most_rows, groups.groups.size()); ++k) {
    const stability::KeyGroup& group = groups.groups[k];
    std::string verdict{assembly::name(group.verdict)};
    std::ranges::replace(verdict, '_', ' ');
    out += "<tr>";
    for (const std::string& cell : {std::to_string(k + 1), std::to_string(group.batch), verdict, blocks_text(group, 20),
                                    display(group.volume.si(), 4), shown(group.factor_move, group.factors),
                                    shown(group.factor_up, group.factors), std::string{group.moments ? "yes" : "no"}}) {
      out += "<td>" + cell + "</td>";
    }
    out += "</tr>\n";
  }
  out += "</tbody></table></div>\n";
  if (groups.groups.size() > most_rows) out += "<p class=\"note\">All are in key_groups.csv.</p>\n";
  return out + "</section>\n";
}

}  // namespace cleave::report
