#include "html_key_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "cleave/exchange/text.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/realize/places.hpp"
#include "drawings.hpp"
#include "html_table.hpp"
#include "tables.hpp"

namespace cleave::report {
namespace {

/// Smaller ones an engineer does not look for first.
constexpr Volume shown_from = Volume::from_si(1e-3);

std::string trend_and_plunge(const Page& page, const geometry::Vec3& d) {
  if (norm(d) == 0) return "–";
  const geometry::LineAttitude line = geometry::line_attitude_of(d);
  const double plunge = line.plunge.degrees();
  if (std::abs(plunge) > 89.95) return plunge > 0 ? "straight down" : "straight up";
  return page.azimuth(line.trend.degrees()) + " / " + (plunge < -0.5 ? "−" : "") +
         std::to_string(std::lround(std::abs(plunge))) + "°";
}

/// "roof (11:30), 12.4 m": where on the tunnel, and how far along it.
std::string where(const scene::BlockPlace& place) {
  std::string out{place.location};
  if (place.clock) out += " (" + clock_text(*place.clock) + ")";
  if (place.chainage) out += ", " + display(*place.chainage, 3) + " m";
  return out.empty() ? "–" : out;
}

/// Hidden in the table until they are asked for.
bool is_micro(const topology::Block& block) { return block.sliver || block.volume < shown_from; }

/// A row of the page's table: what key_blocks.csv says, and cells that join figures.
struct ShownBlock {
  const KeyBlockRow& row;
  const Page& page;
};
template <class V>
void fields(V& v, const ShownBlock& x) {
  const stability::Judgement& j = x.row.j;
  fields(v, x.row);
  const std::string swatch =
      j.batch ? "<i class=\"swatch\" style=\"background:" + batch_colour(*j.batch) + "\"></i>" : "";
  v("leaves",
    Html{swatch + (j.batch ? std::to_string(*j.batch) : (j.key ? (j.transferred ? "held" : "later") : "stays")),
         j.batch ? *j.batch : 1e9},
    "when it leaves, from 1");
  v("where", Html{where(x.row.place)});
  v("direction", Html{trend_and_plunge(x.page, j.direction)}, "of first motion, trend / plunge");
  if (x.row.parts.rotation) {
    v("turns_over", Html{!j.rotation ? "–" : j.rotation->turns ? "<b class=\"warn\">topples</b>" : "no"});
  }
}

std::string key_block_table(const Page& page, const std::vector<const stability::Judgement*>& judgements) {
  const stability::Judgement none{.block = topology::BlockId{0U}};
  HtmlTable table{{{"block"},
                   {"leaves", "Batch"},
                   {"mode"},
                   {"where"},
                   {"volume_m3"},
                   {"weight_n"},
                   {"direction"},
                   {"net_force_n"},
                   {"factor_of_safety", {}, 3},
                   {"net_force_n_transferred", "Net force, transferred (kN)", 4, true},
                   {"factor_of_safety_transferred", "Factor, transferred", 3, true},
                   {"factor_of_safety_clamped", "Factor, clamped by field stress", 3, true},
                   {"turns_over", "Topples?", 4, true},
                   {"free_area_m2", {}, 3},
                   {"depth_m", {}, 3},
                   {"extent_m", {}, 3},
                   {"faces"},
                   {"sets"},
                   {"joints"}},
                  ShownBlock{KeyBlockRow{.j = none, .parts = parts_of(page.result)}, page},
                  "class=\"sortable\""};
  for (const stability::Judgement* j : judgements) {
    const KeyBlockRow row = key_block_row(*page.complex, page.result, *j);
    const bool micro = is_micro(page.complex->blocks()[j->block]);
    table.add(ShownBlock{row, page}, "data-block=\"" + std::to_string(j->block.value()) + "\" class=\"" +
                                         (j->key ? "" : "stays ") + (micro ? "micro" : "") + "\"");
  }
  return std::move(table).html();
}

/// A load case, with what moves in groups under it.
struct ShownCase {
  const scene::CaseFigures& load;
};
template <class V>
void fields(V& v, const ShownCase& x) {
  fields(v, x.load);
  const bool judged = x.load.groups && x.load.groups->in_all;
  v("in_all_volume_m3", when(judged, judged ? x.load.groups->in_all->volume : Volume{}));
}

std::string cases_table(const scene::Figures& figures) {
  if (figures.load_cases.empty()) return {};
  const scene::CaseFigures& sample = figures.load_cases.front();
  HtmlTable table{{{"name", "Case"},
                   {"count", "Key blocks"},
                   {"volume_m3"},
                   {"lowest_factor_of_safety", {}, 3},
                   {"below_target", "Below the target"},
                   {"in_all_volume_m3", "Alone or together (m3)", 4, true}},
                  ShownCase{sample},
                  "id=\"load-cases\""};
  for (const scene::CaseFigures& load : figures.load_cases) table.add(ShownCase{load});
  return "<h3>Under the load cases</h3>" + std::move(table).html() + "<p class=\"small\">" +
         (figures.governing_case
              ? "Most moves, or the factor is lowest, under <b>" + escape_xml(*figures.governing_case) + "</b>. "
              : "") +
         "Block by block: load_cases.csv.</p>\n";
}

}  // namespace

std::vector<const stability::Judgement*> by_severity(const stability::Analysis& analysis) {
  std::vector<const stability::Judgement*> out;
  for (const stability::Judgement& j : analysis.judgements) {
    if (stability::moves(j.mode) || j.key) out.push_back(&j);
  }
  std::ranges::stable_sort(out, {}, [](const stability::Judgement* j) {
    return std::pair{j->key ? 0 : 1, j->key ? -j->net.si() : j->factor_of_safety};
  });
  return out;
}

std::string key_blocks_section(const Page& page) {
  if (!page.result.analysis || page.complex == nullptr || !page.figures().key_blocks) return {};
  const scene::KeyBlockFigures& figures = *page.figures().key_blocks;
  std::string out = "<section id=\"keys\"><h2>Key blocks</h2>\n";
  if (figures.stopped_at_max_batches) {
    out += "<p class=\"note\">Stopped at the scene's largest number of batches: more blocks may follow.</p>\n";
  }
  if (!figures.batches.empty())
    out += "<figure class=\"half\">" + batch_bars(figures.batches) +
           "<figcaption>Volume that leaves, by batch. "
           "All blocks of a batch leave together; what they held up leaves in the next.</figcaption></figure>\n";
  const std::vector<const stability::Judgement*> judgements = by_severity(*page.result.analysis);
  if (judgements.empty()) {
    const auto& held = figures.domain_held;
    const bool groups = page.result.key_groups && !page.result.key_groups->groups.empty();
    return out + "<p>By itself no removable block would move, even without friction." +
           (groups ? " Blocks that move together are below." : "") +
           (held && held->count > 0
                ? " Not counted: " + display_count(held->count) + (held->count == 1 ? " block" : " blocks") +
                      " that only a side of the domain holds."
                : "") +
           "</p>" + cases_table(page.figures()) + "</section>\n";
  }
  out +=
      "<p class=\"small\">Every removable block that would move without friction, the largest net force first; those "
      "that friction and cohesion hold are marked “stays” and follow by their factor. Click a heading to sort, a row "
      "to "
      "find the block in the view. Directions are trend / plunge, downwards positive. Depth: how far the block reaches "
      "into the rock; extent: between its corners farthest apart.</p>\n";
  std::size_t micro = 0;
  double micro_volume = 0;
  for (const stability::Judgement* j : judgements) {
    const topology::Block& block = page.complex->blocks()[j->block];
    if (!is_micro(block)) continue;
    ++micro;
    micro_volume += block.volume.si();
  }
  if (micro > 0) {
    out += "<input type=\"checkbox\" id=\"show-micro\"><label for=\"show-micro\" class=\"small\"> show " +
           display_count(micro) + (micro == 1 ? " block" : " blocks") + " below a litre or thinner than 1e-6 of the " +
           "domain too (" + display(micro_volume, 3) + " m³ in all, counted above)</label>\n";
  }
  out += key_block_table(page, judgements);
  if (page.result.field_stress) {
    const scene::FieldStressResult& f = *page.result.field_stress;
    std::string names;
    for (const std::string& tunnel : f.tunnels) names += (names.empty() ? "“" : ", “") + escape_xml(tunnel) + "”";
    out += "<p class=\"small\">Clamped: the same motion with the stress of the rock around " + names +
           " across the joints (elastic section, " + display_count(f.elements) +
           " boundary elements, estimated error " + display(f.error, 2) + "). " + display_count(f.held) +
           (f.held == 1 ? " block that would fall is" : " blocks that would fall are") + " held by it" +
           (f.undecided == 0 ? std::string{}
                             : "; of " + display_count(f.undecided) +
                                   " near another opening, a heading or the ground the section says nothing") +
           ". The stress goes when the rock loosens: do not count on it for support.</p>";
  }
  return out + cases_table(page.figures()) + "</section>\n";
}

}  // namespace cleave::report
