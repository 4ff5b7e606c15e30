#include "mapped.hpp"

#include <algorithm>
#include <vector>

#include "cleave/exchange/csv.hpp"
#include "cleave/exchange/text.hpp"
#include "html_parts.hpp"
#include "html_table.hpp"
#include "tables.hpp"

namespace cleave::report {
namespace {

constexpr std::size_t most_mapped_rows = 100;

}  // namespace

std::string mapped_joints_csv(const scene::MappedResult& mapped) {
  return csv_table(scene::MappedJointResult{}, mapped.joints);
}

std::string mapped_section(const scene::MappedResult& mapped) {
  std::string out =
      "<section id=\"mapped\"><h2>Joints that were mapped</h2>\n<div class=\"scroll\">" +
      detail::facts_table(facts({{"faces", "Faces"},
                                 {"holes", "Holes"},
                                 {"joints", "Joints seen"},
                                 {"honoured", "Joints drawn that show what was mapped"},
                                 {"not_honoured", "Joints that do not"},
                                 {"random_joints_taken_out", "Random joints that would have been seen: taken out"}},
                                mapped)) +
      "</div>\n";
  std::vector<const scene::MappedJointResult*> rows;
  for (const scene::MappedJointResult& joint : mapped.joints) {
    if (!joint.honours) rows.push_back(&joint);
  }
  if (rows.empty()) {
    return out + "<p class=\"small\">Each is drawn anew in every realization, with the same traces and picks: " +
           "mapped_joints.csv.</p></section>\n";
  }
  std::ranges::stable_sort(rows, std::ranges::greater{}, &scene::MappedJointResult::misfit);
  HtmlTable table{
      {{"source", {}, 4, false, "wide"}, {"joint"}, {"set"}, {"traces"}, {"picks"}, {"misfit_m", "Misfit (m)", 3}},
      scene::MappedJointResult{},
      "class=\"sortable\""};
  for (std::size_t k = 0; k < std::min(rows.size(), most_mapped_rows); ++k) table.add(*rows[k]);
  out += "<h3>Not honoured</h3>\n" + std::move(table).html();
  if (rows.size() > most_mapped_rows) {
    out += "<p class=\"small\">The " + display_count(most_mapped_rows) + " worst; all are in mapped_joints.csv.</p>\n";
  }
  return out + "</section>\n";
}

}  // namespace cleave::report
