#include "html_stability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "cleave/exchange/text.hpp"
#include "html_parts.hpp"
#include "pyramid_net.hpp"

namespace cleave::report {
namespace {

std::string pressure_table(const std::vector<scene::PressureFigures>& pressures) {
  if (pressures.empty()) return {};
  const auto kpa = [](Stress pressure) { return "<td>" + display(pressure.si() / 1000, 3) + "</td>"; };
  std::string out =
      "<table><caption>Support pressure by place (kPa), as shares of the free faces below their target</caption>"
      "<thead><tr><th>Place</th><th>Area (m²)</th><th>Half</th><th>90 %</th><th>95 %</th><th>All</th></tr></thead>"
      "<tbody>\n";
  for (const scene::PressureFigures& row : pressures) {
    out += "<tr><td>" + row.place + "</td><td>" + display(row.area.si(), 3) + "</td>" + kpa(row.p50) + kpa(row.p90) +
           kpa(row.p95) + kpa(row.largest) + "</tr>\n";
  }
  return out + "</tbody></table>\n";
}

}  // namespace

std::string support_section(const Page& page) {
  if (!page.result.support || !page.figures().support) return {};
  const scene::SupportFigures& f = *page.figures().support;
  std::string out =
      "<section id=\"support\"><h2>Support</h2>\n<p>" +
      std::string{f.passes ? "Every block reaches its target." : "Some blocks miss their target."} + " " +
      display_count(f.blocks) + " blocks need support: " + display_count(f.held_by_bolts) + " held by bolts, " +
      display_count(f.held_by_shotcrete) + " by shotcrete, " + display_count(f.held_by_both) + " by both together, " +
      display_count(f.not_held) + " not held. " + display_count(f.bolts) + " bolts (" + display_count(f.spot_bolts) +
      " spot bolts): " + display_count(f.bolts_used) + " needed, " + display_count(f.bolts_redundant) + " redundant, " +
      display_count(f.bolts_too_short) + " too short. " + display_count(f.combined) +
      " bodies stitched together by bolts, " + display_count(f.combined_failing) + " of them below their target.";
  if (page.result.tunnel_length > 0) {
    out += " Required force: " + display(f.required_force_n / page.result.tunnel_length / 1000, 3) +
           " kN per metre of tunnel.";
  }
  out += "</p>\n" + pressure_table(f.pressures);
  if (!page.result.support->blocks.empty()) {
    out +=
        "<div class=\"scroll\"><table class=\"sortable\"><thead><tr><th>Block</th><th>Mode</th><th>Net force (kN)</th>"
        "<th>Factor</th><th>Target</th><th>Held by</th><th>Bolts</th><th>Bolts alone</th><th>Factor with "
        "support</th><th>Share used</th>"
        "<th>Missing (kN)</th><th>Required force (kN)</th><th>Required pressure (kPa)</th></tr></thead><tbody>\n";
    for (const stability::SupportedBlock& b : page.result.support->blocks) {
      out += "<tr data-block=\"" + std::to_string(b.block.value()) + "\"><td>" + std::to_string(b.block.value()) +
             "</td><td>" + std::string{stability::name(b.mode)} + "</td><td>" + display(b.net_force / 1000) +
             "</td><td>" + display(b.factor_of_safety, 3) + "</td><td>" + display(b.target, 3) + "</td><td>" +
             std::string{stability::name(b.held)} + "</td><td>" + std::to_string(b.bolts) + "</td><td>" +
             display(b.factor_with_bolts, 3) + "</td><td>" +
             (b.factor_with_support ? display(*b.factor_with_support, 3) : "–") + "</td><td>" +
             (b.mobilised ? display(*b.mobilised, 3) : "–") + "</td><td>" + display(b.missing_force / 1000) +
             "</td><td>" + display(b.required_force / 1000) + "</td><td>" + display(b.required_pressure / 1000, 3) +
             "</td></tr>\n";
    }
    out += "</tbody></table></div>\n";
  }
  if (!page.result.support->combined.empty()) {
    out +=
        "<h3>Stitched bodies</h3><div class=\"scroll\"><table id=\"combined\"><thead><tr><th>Blocks</th><th>Volume "
        "(m³)</th><th>Mode</th><th>Net force (kN)</th><th>Factor</th><th>Target</th><th>Passes</th><th>Missing "
        "(kN)</th></tr></thead><tbody>\n";
    for (const stability::CombinedBlock& b : page.result.support->combined) {
      constexpr std::size_t most_named = 12;
      std::string members;
      for (std::size_t k = 0; k < std::min(b.members.size(), most_named); ++k) {
        members += (k == 0 ? "" : ", ") + std::to_string(b.members[k].value());
      }
      if (b.members.size() > most_named) members += " and " + display_count(b.members.size() - most_named) + " more";
      const std::string mode = b.removable ? std::string{stability::name(b.mode)} : "cannot move";
      out += "<tr><td class=\"wide\">" + members + "</td><td>" + display(b.volume) + "</td><td>" + mode + "</td><td>" +
             display(b.net_force / 1000) + "</td><td>" + display(b.factor_of_safety, 3) + "</td><td>" +
             display(b.target, 3) + "</td><td>" + (b.passes ? "yes" : "no") + "</td><td>" +
             display(b.missing_force / 1000) + "</td></tr>\n";
    }
    out += "</tbody></table></div>\n";
  }
  if (!page.figures().support_cases.empty()) {
    out +=
        "<h3>Under the load cases</h3><table id=\"support-cases\"><thead><tr><th>Case</th><th>Passes</th><th>Blocks "
        "that need support</th><th>Not held</th><th>Stitched bodies</th><th>Of them "
        "failing</th></tr></thead><tbody>\n";
    for (const auto& [name, c] : page.figures().support_cases) {
      out += "<tr><td>" + escape_xml(name) + "</td><td>" + (c.passes ? "yes" : "no") + "</td><td>" +
             display_count(c.blocks) + "</td><td>" + display_count(c.not_held) + "</td><td>" +
             display_count(c.combined) + "</td><td>" + display_count(c.combined_failing) + "</td></tr>\n";
    }
    out += "</tbody></table><p class=\"small\">Block by block: support_blocks.csv, combined_blocks.csv.</p>\n";
  }
  if (!page.result.designs.empty()) {
    out +=
        "<h3>Search for a pattern</h3><div class=\"scroll\"><table id=\"designs\"><thead><tr><th>Length (m)</th>"
        "<th>Spacing (m)</th><th>Rings</th><th>Bolts</th><th>Spot bolts</th><th>Cost</th><th>Random places that "
        "fail</th><th>Governing block</th></tr></thead><tbody>\n";
    for (const scene::DesignResult& d : page.result.designs) {
      const auto if_found = [&](std::string text) { return d.found ? std::move(text) : std::string{"–"}; };
      out += detail::table_row(
          {display(d.length, 3), d.found ? display(d.spacing[0], 3) + " × " + display(d.spacing[1], 3) : "none passes",
           if_found(d.rings > 0 ? display_count(d.rings) : "a grid"), if_found(display_count(d.bolts)),
           if_found(display_count(d.spot_bolts)), if_found(display(d.cost, 4)),
           fmt::format("{} of {} ({:.0f} to {:.0f} %)", d.failing, d.offsets, 100 * d.failing_share[0],
                       100 * d.failing_share[1]),
           d.governing ? std::to_string(*d.governing) : "–"});
    }
    out +=
        "</tbody></table></div><p class=\"small\">Widest spacing at which every offset of the pattern that was tried "
        "holds all blocks, alone and stitched; spacing and rings of the first pattern. Random places: offsets drawn at "
        "random at which that pattern was tried again (where none passes, the tightest one), with the 95 % interval of "
        "the share that fails. The governing block misses its target most often, or has the least margin.</p>\n";
  }
  return out + "</section>\n";
}

std::string maximum_section(const Page& page) {
  if (page.result.maximum_blocks.empty()) return {};
  std::string out =
      "<section id=\"maximum\"><h2>Largest key blocks of block theory</h2>\n<p class=\"small\">What joints without "
      "end, in the mean orientations of three sets and anywhere, can make at the tunnel; orientations alone decide. "
      "Volumes are upper bounds of blocks with one joint of each of the three sets; scale: where the scene limits the "
      "length of joints, what all lengths were multiplied by. Blocks between two joints of one "
      "set are not among them, nor is the scatter of a set about its mean: either may make a larger one.</p>\n"
      "<div class=\"scroll\"><table class=\"sortable\"><thead><tr><th>Sets</th><th>Below</th>"
      "<th>Where</th><th>Scale</th><th>Volume (m³)</th><th>Weight (kN)</th><th>Height (m)</th><th>Face "
      "(m²)</th><th>Mode</th>"
      "<th>Factor</th><th>Target</th><th>Required pressure (kPa)</th></tr></thead><tbody>\n";
  for (const scene::MaximumRow& row : page.result.maximum_blocks) {
    const stability::MaximumKeyBlock& b = row.block;
    std::string below;
    for (std::size_t i = 0; i < 3; ++i) {
      if (((b.block.code >> i) & 1U) != 0) below += (below.empty() ? "" : ", ") + escape_xml(row.sets[i]);
    }
    out += "<tr><td>" + escape_xml(row.sets[0]) + ", " + escape_xml(row.sets[1]) + ", " + escape_xml(row.sets[2]) +
           "</td><td>" + (below.empty() ? "–" : below) + "</td><td>" +
           (row.position.empty() ? row.where : row.position) + "</td><td>" + display(b.scale, 3) + "</td><td>" +
           display(b.block.volume) + "</td><td>" + display(b.weight.si() / 1000) + "</td><td>" +
           display(b.block.height, 3) + "</td><td>" + display(b.block.face_area, 3) + "</td><td>" +
           std::string{stability::name(b.mode)} + "</td><td>" + display(b.factor_of_safety, 3) + "</td><td>" +
           display(b.target, 3) + "</td><td>" + display(b.required_pressure / 1000, 3) + "</td></tr>\n";
  }
  out += "</tbody></table></div>\n<div class=\"columns\">\n";
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
