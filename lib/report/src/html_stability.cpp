#include "html_stability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "cleave/exchange/text.hpp"
#include "html_parts.hpp"
#include "html_table.hpp"
#include "key_groups.hpp"
#include "pyramid_net.hpp"
#include "tables.hpp"

namespace cleave::report {
namespace {

std::string pressure_table(const std::vector<scene::PressureFigures>& pressures) {
  if (pressures.empty()) return {};
  return "<p class=\"small\">Support pressure by place, as shares of the loaded faces: those through which single "
         "blocks below their target come out. Groups of blocks are not in it.</p>\n" +
         html_table({{"place"},
                     {"opening_area_m2", "Walls (m2)", 3},
                     {"area_m2", "Loaded (m2)", 3},
                     {"p50_pa", "Half (kPa)", 3},
                     {"p90_pa", "90 % (kPa)", 3},
                     {"p95_pa", "95 % (kPa)", 3},
                     {"largest_pa", "All (kPa)", 3}},
                    scene::PressureFigures{}, pressures);
}

std::string blocks_table(const stability::SupportResult& support) {
  if (support.blocks.empty()) return {};
  const stability::SupportedBlock none{.block = topology::BlockId{0U}};
  HtmlTable table{{{"block"},
                   {"mode"},
                   {"net_force_n"},
                   {"factor_of_safety", "Factor", 3},
                   {"target", {}, 3},
                   {"held_by"},
                   {"bolts"},
                   {"factor_with_bolts", "Bolts alone", 3},
                   {"factor_with_support", {}, 3},
                   {"mobilised_share", "Share used (%)", 3},
                   {"missing_force_n", "Missing (kN)"},
                   {"required_force_n"},
                   {"required_pressure_pa", {}, 3}},
                  SupportBlockRow{"", none},
                  "class=\"sortable\""};
  for (const stability::SupportedBlock& b : support.blocks) {
    table.add(SupportBlockRow{"", b}, "data-block=\"" + std::to_string(b.block.value()) + "\"");
  }
  return std::move(table).html();
}

std::string combined_table(const stability::SupportResult& support) {
  if (support.combined.empty()) return {};
  const stability::CombinedBlock none{};
  HtmlTable table{{{"members", "Blocks"},
                   {"volume_m3"},
                   {"removable"},
                   {"mode"},
                   {"net_force_n"},
                   {"factor_of_safety", "Factor", 3},
                   {"target", {}, 3},
                   {"passes"},
                   {"missing_force_n", "Missing (kN)"}},
                  CombinedBlockRow{.load = "", .b = none},
                  "id=\"combined\""};
  for (const stability::CombinedBlock& b : support.combined) table.add(CombinedBlockRow{.load = "", .b = b});
  return "<h3>Stitched bodies</h3>" + std::move(table).html();
}

/// A search for a pattern; what only a pattern that was found has is empty for others.
struct DesignRow {
  const scene::DesignResult& d;
};
template <class V>
void fields(V& v, const DesignRow& x) {
  const scene::DesignResult& d = x.d;
  fields(v, d);
  const Html none{"–"};
  const auto if_found = [&](std::string text) { return d.found ? Html{std::move(text)} : none; };
  v("spacing", d.found ? Html{display(d.spacing[0], 3) + " × " + display(d.spacing[1], 3)} : Html{"none passes"});
  v("found_rings", if_found(d.rings ? display_count(*d.rings) : "a grid"));
  v("found_bolts", if_found(display_count(d.bolts)));
  v("found_spot_bolts", if_found(display_count(d.spot_bolts)));
  v("found_cost", if_found(display(d.cost, 4)));
  v("groups_left", d.found && d.groups ? Html{fmt::format("{} of {}, {} in doubt", d.groups->not_held, d.groups->count,
                                                          d.groups->in_doubt)}
                                       : none);
  v("failing", Html{fmt::format("{} of {} ({:.0f} to {:.0f} %)", d.failing, d.offsets, 100 * d.failing_share[0],
                                100 * d.failing_share[1])});
}

std::string designs_table(const std::vector<scene::DesignResult>& designs) {
  if (designs.empty()) return {};
  const scene::DesignResult none{};
  HtmlTable table{{{"length_m", {}, 3},
                   {"spacing", "Spacing (m)"},
                   {"found_rings", "Rings"},
                   {"found_bolts", "Bolts"},
                   {"found_spot_bolts", "Spot bolts"},
                   {"found_cost", "Cost"},
                   {"groups_left", "Groups not held"},
                   {"failing", "Random places that fail"},
                   {"governing_block"}},
                  DesignRow{none},
                  "id=\"designs\""};
  for (const scene::DesignResult& d : designs) table.add(DesignRow{d});
  return "<h3>Search for a pattern</h3>" + std::move(table).html() +
         "<p class=\"small\">Widest spacing at which every offset of the pattern that was tried holds all blocks, "
         "alone and stitched, and all groups of blocks that the tightest pattern holds; spacing and rings of the first "
         "pattern. Random places: offsets drawn at random at which "
         "that pattern was tried again (where none passes, the tightest one), with the 95 % interval of the share that "
         "fails. The governing block misses its target most often, or has the least margin. An optimum is not among "
         "what was tried "
         "where the widest holds: see the notes.</p>\n";
}

std::string held_in_failing_groups(const scene::SupportFigures& f) {
  if (f.held_in_failing_groups == 0) return {};
  return " <b>" + display_count(f.held_in_failing_groups) + " of those held " +
         (f.held_in_failing_groups == 1 ? "lies" : "lie") + " in a group of blocks that is not, or in doubt</b>.";
}

std::string support_verdict(const scene::SupportFigures& support, const std::vector<scene::SupportCaseFigures>& cases) {
  using enum scene::GroupsJudged;
  if (!support.passes()) {
    return support.block_by_block && support.turning_not_held == 0 && support.groups_judged == too_many
               ? "Every block reaches its target by itself; <b>groups of blocks were not judged</b>, too many blocks "
                 "lie "
                 "near free faces."
               : "Some blocks miss their target, alone or together with others.";
  }
  const scene::FailsElsewhere elsewhere = scene::fails_elsewhere(support, cases);
  const scene::NotAsked& rest = support.not_asked;
  std::string out = rest.count == 0 ? "Every block reaches its target"
                                    : "Every block that the support is asked to hold reaches its target";
  if (!elsewhere.fails.empty()) out += " " + elsewhere.passes + ", <b>not " + escape_xml(elsewhere.fails) + "</b>";
  out += ".";
  if (rest.count > 0) {
    out += " <b>" + display_count(rest.count) + (rest.count == 1 ? " block" : " blocks") + " (" +
           display(rest.volume.si(), 4) + " m3) would miss it</b> without sides of the domain, a slight taper of " +
           "joints or what lies inside" +
           (std::isfinite(rest.lowest_factor_of_safety)
                ? ", the lowest factor of safety " + display(rest.lowest_factor_of_safety, 3)
                : "") +
           ": see the notes.";
  }
  if (support.groups_judged == not_asked) out += " Whether groups of blocks are held was not asked.";
  return out;
}

}  // namespace

std::string support_section(const Page& page) {
  if (!page.result.support || !page.figures().support) return {};
  const scene::SupportFigures& f = *page.figures().support;
  std::string out = "<section id=\"support\"><h2>Support</h2>\n<p>" + support_verdict(f, page.figures().support_cases) +
                    " " + display_count(f.blocks) +
                    (f.blocks == 1 ? " block needs support by itself: " : " blocks need support by themselves: ") +
                    display_count(f.held_by_bolts) + " held by bolts, " + display_count(f.held_by_shotcrete) +
                    " by shotcrete, " + display_count(f.held_by_both) + " by both together, " +
                    display_count(f.not_held) + " not held." + held_in_failing_groups(f) + " " +
                    display_count(f.bolts) + " bolts (" + display_count(f.spot_bolts) +
                    " spot bolts): " + display_count(f.bolts_used) + " that no other can replace, " +
                    (f.groups ? display_count(f.bolts_of_groups) + " more pull at groups of blocks, " : "") +
                    display_count(f.bolts_redundant) + " redundant, " + display_count(f.bolts_too_short) +
                    " too short. " + display_count(f.combined) + " bodies stitched together by bolts, " +
                    display_count(f.combined_failing) + " of them below their target.";
  if (f.key_blocks_behind > 0) {
    out += " " + display_count(f.key_blocks_behind) +
           " more key blocks lie behind: they leave only after others have left, and stay where those are held.";
  }
  if (page.result.tunnel_length && !f.only_groups()) {
    out += " Required force: " + display(f.required_force_n / page.result.tunnel_length->si() / 1000, 3) +
           " kN per metre of tunnel, for blocks by themselves.";
  }
  if (f.turning > 0) {
    out += " " + display_count(f.turning) + " more only turn, " + display_count(f.turning_not_held) +
           " of these not held, or not judged with moments.";
  }
  if (f.groups && f.groups->count > 0) {
    out += " <b>" + display_count(f.groups->count) +
           " groups of blocks need support together</b>: " + display_count(f.groups->not_held) + " not held, " +
           display_count(f.groups->in_doubt) + " in doubt.";
  }
  out += "</p>\n" + pressure_table(f.pressures) + blocks_table(*page.result.support) +
         combined_table(*page.result.support) + supported_groups_table(page.result, page.complex);
  if (!page.figures().support_cases.empty()) {
    out += "<h3>Under the load cases</h3>" +
           html_table({{"name", "Case"},
                       {"passes"},
                       {"blocks", "Blocks that need support"},
                       {"not_held"},
                       {"target_falling", "Target (falling)"},
                       {"target_sliding", "Target (sliding)"},
                       {"required_force_n", "Required (kN)"},
                       {"missing_force_n", "Missing (kN)"},
                       {"combined_blocks", "Stitched bodies"},
                       {"combined_failing", "Of them failing"}},
                      scene::SupportCaseFigures{}, page.figures().support_cases, "id=\"support-cases\"") +
           "<p class=\"small\">Block by block: support_blocks.csv, combined_blocks.csv.</p>\n";
  }
  return out + designs_table(page.result.designs) + "</section>\n";
}

namespace {

/// A largest key block, its sets and place as a reader names them.
struct LargestRow {
  const scene::MaximumRow& row;
};
template <class V>
void fields(V& v, const LargestRow& x) {
  fields(v, x.row);
  std::vector<std::string> below;
  for (std::size_t i = 0; i < 3; ++i) {
    if (((x.row.block.block.code >> i) & 1U) != 0) below.push_back(x.row.sets[i]);
  }
  v("sets", x.row.sets);
  v("below_planes", below);
  v("place", x.row.position.empty() ? x.row.where : x.row.position);
}

}  // namespace

std::string maximum_section(const Page& page) {
  if (page.result.maximum_blocks.empty()) return {};
  std::string out =
      "<section id=\"maximum\"><h2>Largest key blocks of block theory</h2>\n<p class=\"small\">What joints without "
      "end, in the mean orientations of three sets and anywhere, can make at the tunnel; orientations alone decide. "
      "Volumes are upper bounds of blocks with one joint of each of the three sets; scale: where the scene limits the "
      "length of joints, what all lengths were multiplied by. Blocks between two joints of one "
      "set are not among them, nor is the scatter of a set about its mean: either may make a larger one.</p>\n";
  const scene::MaximumRow none{};
  HtmlTable table{{{"sets"},
                   {"below_planes", "Below"},
                   {"place", "Where"},
                   {"scale", {}, 3},
                   {"volume_m3"},
                   {"weight_n"},
                   {"height_m", {}, 3},
                   {"face_area_m2", "Face (m²)", 3},
                   {"mode"},
                   {"factor_of_safety", "Factor", 3},
                   {"target", {}, 3},
                   {"required_pressure_pa", {}, 3}},
                  LargestRow{none},
                  "class=\"sortable\""};
  for (const scene::MaximumRow& row : page.result.maximum_blocks) table.add(LargestRow{row});
  out += std::move(table).html() + "<div class=\"columns\">\n";
  constexpr std::size_t most_nets = 4;
  const std::span<const scene::MaximumRow> rows{page.result.maximum_blocks};
  std::size_t nets = 0;
  for (std::size_t from = 0, to = 0; from < rows.size() && nets < most_nets; from = to, ++nets) {
    while (to < rows.size() && rows[to].block.planes == rows[from].block.planes) ++to;
    out +=
        "<figure>" + pyramid_net(rows.subspan(from, to - from)) +
        "<figcaption>Joint pyramids, stereographic projection of the whole sphere: inside the dashed rim what looks "
        "down. Digits: one a set, 1 below its plane. Filled: can come out at the tunnel (orange falls, green a wedge, "
        "blue slides, grey stays). Crosses: direction of motion.</figcaption></figure>\n";
  }
  return out + "</div></section>\n";
}

}  // namespace cleave::report
