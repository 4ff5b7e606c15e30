#include "cleave/report/html.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "assets.hpp"
#include "cleave/report/drawings.hpp"
#include "cleave/report/key_blocks.hpp"
#include "cleave/report/text.hpp"
#include "cleave/report/view3d.hpp"
#include "html_parts.hpp"
#include "html_stability.hpp"
#include "stages_section.hpp"

namespace cleave::report {
namespace {

std::string card(std::string_view label, const std::string& figure, const std::string& below,
                 std::string_view kind = "") {
  std::string out = "<div class=\"card ";
  out += kind;
  out += "\"><span class=\"label\">";
  out += label;
  return out + "</span><strong>" + figure + "</strong><span class=\"below\">" + below + "</span></div>\n";
}

std::string cards(const Page& page) {
  const Summary& s = page.summary;
  std::string out = "<section class=\"cards\" aria-label=\"Key figures\">\n";
  if (s.blocks) {
    out += card("Blocks", display_count(s.blocks->count), display(s.blocks->volume_m3) + " m³ of rock");
  }
  if (s.key_blocks) {
    const auto& k = *s.key_blocks;
    out +=
        card("Key blocks", display_count(k.count),
             display(k.volume_m3) + " m³ in " + std::to_string(k.batches.size()) +
                 (k.batches.size() == 1 ? " batch" : " batches") + (k.stopped_at_max_batches ? ", stopped there" : ""),
             k.count > 0 ? "warn" : "");
  }
  out += card("Joints", display_count(s.input.joints),
              "moved by at most " + display(s.input.largest_snap_m, 2) + " m onto the lattice");
  out += card("Certificate", s.certificate.passed ? "passed" : "not passed",
              "volume error " + display(s.certificate.volume_relative_error, 2), s.certificate.passed ? "good" : "bad");
  out += card("Time", display(s.cost.wall_s, 3) + " s",
              display(s.cost.cpu_s, 3) + " s CPU, " + display(s.cost.peak_rss_mb, 3) + " MB, " +
                  std::to_string(s.cost.threads) + (s.cost.threads == 1 ? " thread" : " threads"));
  return out + "</section>\n";
}

std::string view_section(const Page& page, std::string& view_json) {
  if (page.complex == nullptr) return {};
  View3d view = pack_view(*page.complex, page.analysis, view_budget_bytes, page.support);
  view_json = std::move(view.json);
  std::string out =
      "<section id=\"view\"><h2>Blocks in three dimensions</h2>\n<div class=\"stage\">\n<div id=\"scene\">";
  out += "<div id=\"still\">" + still_picture(*page.complex, page.analysis) + "</div>";
  out +=
      "<p id=\"no3d\">The still picture is shown: this browser gives no WebGL (or runs no scripts), which the 3D view "
      "needs.</p>";
  out +=
      "<div id=\"compass\" aria-hidden=\"true\"></div><p id=\"hint\">Drag to turn, wheel or two fingers to zoom, right "
      "button to shift; "
      "click a block to see its figures.</p></div>\n<div id=\"panel\" hidden></div>\n</div>\n";
  if (view.shown < view.total) {
    out += "<p class=\"note\">The view holds " + display_count(view.shown) + " of " + display_count(view.total) +
           " blocks: key blocks and those near free faces first. All blocks are in blocks.vtu.</p>\n";
  }
  return out + "</section>\n";
}

void cell(std::string& out, double value, const std::string& shown) {
  out += "<td data-v=\"";
  append_number(out, value);
  out += "\">" + shown + "</td>";
}

std::string trend_and_plunge(const geometry::Vec3& d) {
  constexpr double to_degrees = 57.29577951308232;
  if (norm(d) == 0) return "–";
  double trend = std::atan2(d.x, d.y) * to_degrees;
  if (trend < 0) trend += 360;
  const double plunge = std::asin(std::clamp(-d.z, -1.0, 1.0)) * to_degrees;
  const auto whole = [](double v) { return std::to_string(std::lround(v)); };
  if (std::abs(plunge) > 89.95) return plunge > 0 ? "straight down" : "straight up";
  return whole(trend) + "° / " + (plunge < -0.5 ? "−" : "") + whole(std::abs(plunge)) + "°";
}

std::string key_block_rows(const Page& page) {
  std::string out;
  for (const stability::Judgement& j : page.analysis->judgements) {
    if (!stability::moves(j.mode) && !j.key) continue;
    const topology::Block& block = page.complex->blocks()[j.block];
    out += "<tr data-block=\"" + std::to_string(j.block.value()) + "\"" + (j.key ? "" : " class=\"stays\"") + ">";
    cell(out, j.block.value(), std::to_string(j.block.value()));
    const std::string swatch =
        j.batch ? "<i class=\"swatch\" style=\"background:" + batch_colour(*j.batch) + "\"></i>" : "";
    cell(out, j.batch ? *j.batch : 1e9,
         swatch + (j.batch ? std::to_string(*j.batch) : (j.key ? (j.transferred ? "held" : "later") : "stays")));
    out += "<td>";
    out += stability::name(j.mode);
    out += "</td>";
    cell(out, block.volume.si(), display(block.volume.si()));
    cell(out, j.weight.si(), display(j.weight.si() / 1000));
    out += "<td>" + trend_and_plunge(j.direction) + "</td>";
    cell(out, j.net.si(), display(j.net.si() / 1000));
    cell(out, j.factor_of_safety, display(j.factor_of_safety, 3));
    if (page.analysis->force_transfer) {
      const double net = j.transferred ? j.transferred->net.si() : j.net.si();
      const double factor = j.transferred ? j.transferred->factor_of_safety : j.factor_of_safety;
      cell(out, net, display(net / 1000));
      cell(out, factor, display(factor, 3));
    }
    if (page.field_stress != nullptr) {
      const auto& clamped = page.field_stress->blocks;
      const auto found = std::ranges::lower_bound(clamped, j.block, {}, &scene::ClampedBlock::block);
      if (found != clamped.end() && found->block == j.block) {
        cell(out, found->factor_of_safety, display(found->factor_of_safety, 3));
      } else {
        out += "<td>–</td>";
      }
    }
    if (page.analysis->rotation != stability::RotationCheck::off) {
      out += !j.rotation ? "<td>–</td>" : j.rotation->turns ? "<td class=\"warn\">turns</td>" : "<td>no</td>";
    }
    cell(out, static_cast<double>(block.faces.size()), std::to_string(block.faces.size()));
    std::string joints;
    for (const topology::JointId joint : joints_of(*page.complex, j.block)) {
      joints += (joints.empty() ? "" : ", ") + std::to_string(joint.value());
    }
    out += "<td class=\"wide\">" + joints + "</td></tr>\n";
  }
  return out;
}

std::string key_blocks_section(const Page& page) {
  if (page.analysis == nullptr || page.complex == nullptr || !page.summary.key_blocks) return {};
  const KeyBlockFigures& figures = *page.summary.key_blocks;
  std::string out = "<section id=\"keys\"><h2>Key blocks</h2>\n";
  if (figures.stopped_at_max_batches) {
    out += "<p class=\"note\">Stopped at the scene's largest number of batches: more blocks may follow.</p>\n";
  }
  if (!figures.batches.empty())
    out += "<figure class=\"half\">" + batch_bars(figures.batches) +
           "<figcaption>Volume that leaves, by batch. "
           "All blocks of a batch leave together; what they held up leaves in the next.</figcaption></figure>\n";
  const std::string rows = key_block_rows(page);
  if (rows.empty()) return out + "<p>No removable block would move, even without friction.</p></section>\n";
  out +=
      "<p class=\"small\">Every removable block that would move without friction; those that friction and cohesion "
      "hold are marked “stays”. "
      "Click a heading to sort, a row to find the block in the view. Directions are trend / plunge, downwards "
      "positive.</p>\n"
      "<div class=\"scroll\"><table class=\"sortable\"><thead><tr><th>Block</th><th>Batch</th><th>Mode</th><th>Volume "
      "(m³)</th>"
      "<th>Weight (kN)</th><th>Direction</th><th>Net force (kN)</th><th>Factor of safety</th>";
  if (page.analysis->force_transfer) out += "<th>Net force, transferred (kN)</th><th>Factor, transferred</th>";
  if (page.field_stress != nullptr) out += "<th>Factor, clamped by field stress</th>";
  if (page.analysis->rotation != stability::RotationCheck::off) out += "<th>Turns?</th>";
  out += "<th>Faces</th><th class=\"wide\">Joints</th></tr></thead><tbody>\n";
  out += rows + "</tbody></table></div>";
  if (page.field_stress != nullptr) {
    const scene::FieldStressResult& f = *page.field_stress;
    out += "<p class=\"small\">Clamped: equilibrium with the normal and shear forces of the rock around “" +
           escape_xml(f.tunnel) + "” across the joints (elastic section, " + display_count(f.elements) +
           " boundary elements, estimated error " + display(f.error, 2) + "). " + display_count(f.held) +
           (f.held == 1 ? " block that would fall is" : " blocks that would fall are") +
           " held by it. The stress goes when the rock loosens: do not count on it for support.</p>";
  }
  return out + "</section>\n";
}

std::string set_rows(const Page& page) {
  std::string out;
  for (std::size_t set = 0; set < page.sets.size(); ++set) {
    std::vector<geometry::Vec3> normals;
    for (const Pole& pole : page.joints) {
      if (pole.set == set) normals.push_back(pole.normal);
    }
    if (normals.empty()) continue;
    const MeanPole mean = mean_of(normals);
    out += "<tr><td><svg class=\"mark\" viewBox=\"0 0 16 16\">" + set_marker(set, 8, 8, 5) + "</svg>" +
           escape_xml(page.sets[set].name) + "</td><td>" + display_count(normals.size()) + "</td><td>" +
           display(std::round(mean.dip_degrees * 10) / 10) + "° / " +
           display(std::round(mean.dip_direction_degrees * 10) / 10) + "°</td><td>" +
           (normals.size() > 1 ? display(mean.kappa, 3) : "–") + "</td></tr>\n";
  }
  return out;
}

std::string stereonet_section(const Page& page) {
  if (page.joints.empty()) return {};
  std::string out =
      "<section id=\"net\"><h2>Joints</h2>\n<div class=\"columns\"><figure class=\"net\">\n"
      "<div class=\"choice\"><input type=\"radio\" name=\"net\" id=\"net-area\" checked><label for=\"net-area\">equal "
      "area</label>"
      "<input type=\"radio\" name=\"net\" id=\"net-angle\"><label for=\"net-angle\">equal angle</label>\n";
  out += "<div class=\"area\">" + stereonet_svg(page.joints, page.sets, Net::equal_area, page.north) + "</div>";
  out +=
      "<div class=\"angle\">" + stereonet_svg(page.joints, page.sets, Net::equal_angle, page.north) + "</div></div>\n";
  out +=
      "<figcaption>Poles of joints, lower hemisphere; large marks and great circles: means of the sets. Inner circles: "
      "dips of 30° and 60°.";
  if (page.joints.size() > max_plotted_poles) {
    const std::size_t step = (page.joints.size() + max_plotted_poles - 1) / max_plotted_poles;
    out += " One in " + std::to_string(step) + " poles is drawn; the means use all.";
  }
  out +=
      "</figcaption></figure>\n<div><table><thead><tr><th>Set</th><th>Joints</th><th>Mean dip / dip direction</th>"
      "<th>Concentration κ</th></tr></thead><tbody>\n";
  return out + set_rows(page) + "</tbody></table></div></div></section>\n";
}

std::string blocks_section(const Page& page) {
  if (!page.summary.blocks || page.complex == nullptr) return {};
  const BlockFigures& b = *page.summary.blocks;
  const topology::Certificate& c = page.summary.certificate;
  std::vector<double> volumes;
  for (const topology::Block& block : page.complex->blocks()) volumes.push_back(block.volume.si());
  const auto row = [](std::string_view name, const std::string& value) {
    std::string line = "<tr><th scope=\"row\">";
    line += name;
    return line + "</th><td>" + value + "</td></tr>\n";
  };
  std::string out =
      "<section id=\"blocks\"><h2>Block system and certificate</h2>\n<div class=\"columns\"><div><table "
      "class=\"facts\"><tbody>\n";
  out += row("Blocks", display_count(b.count));
  out += row("Not convex", display_count(b.concave));
  out += row("With holes", display_count(b.with_holes));
  out += row("With cavities", display_count(b.with_cavities));
  out += row("Slivers (kept)", display_count(b.slivers));
  out += row("Sum of block volumes", display(b.volume_m3, 8) + " m³");
  out += row("Domain less excavations", display(b.domain_volume_m3, 8) + " m³");
  out += row("Volume error", display(c.volume_relative_error, 2) + " (relative)");
  out += row("Euler–Poincaré violations", display_count(c.euler_violations));
  out += row("Open shells", display_count(c.open_shells));
  out += row("Unpaired joint patches", display_count(c.unpaired_patches));
  out += row("Largest face-vector sum", display(c.face_vector_max_relative, 2) + " (relative)");
  out += row("Decisions that needed exact numbers", display(100 * b.exact_share, 3) + " %");
  out += row("Hash of the block system", "<code>" + escape_xml(b.hash) + "</code>");
  out += "</tbody></table></div>\n<figure>" + size_curve(std::move(volumes));
  return out +
         "<figcaption>Share of the <span class=\"key-a\">number of blocks</span> and of the <span class=\"key-b\">rock "
         "volume</span> "
         "in blocks smaller than V.</figcaption></figure></div></section>\n";
}

std::string plan_section(const Summary& summary) {
  std::string out =
      "<section id=\"plan\"><h2>What ran, what was left out, and "
      "why</h2>\n<table><thead><tr><th>Stage</th><th></th><th class=\"wide\">Why</th></tr></thead><tbody>\n";
  for (const PlanRow& row : summary.plan) {
    out += "<tr" + std::string{row.run ? "" : " class=\"off\""} + "><td>" + escape_xml(row.stage) + "</td><td>" +
           (row.run ? "ran" : "left out") + "</td><td class=\"wide\">" + escape_xml(row.why) + "</td></tr>\n";
  }
  return out + "</tbody></table></section>\n";
}

std::string cost_section(const CostTable& cost) {
  double longest = 0;
  for (const CostRow& row : cost.stages) longest = std::max(longest, row.wall_s);
  std::string out =
      "<section id=\"cost\"><h2>Cost by stage</h2>\n<table><thead><tr><th>Stage</th><th>Wall (s)</th><th "
      "class=\"bar\"></th><th>CPU (s)</th>"
      "<th>Peak memory (MB)</th></tr></thead><tbody>\n";
  for (const CostRow& row : cost.stages) {
    const double share = longest > 0 ? 100 * row.wall_s / longest : 0;
    out += "<tr><td>" + escape_xml(row.stage) + "</td><td>" + display(row.wall_s, 3) +
           "</td><td class=\"bar\"><i style=\"width:" + number(std::round(share * 10) / 10) + "%\"></i></td><td>" +
           display(row.cpu_s, 3) + "</td><td>" + display(row.peak_rss_mb, 4) + "</td></tr>\n";
  }
  return out +
         "</tbody></table>\n<p class=\"small\">Up to the writing of this page; summary.json has the "
         "rest.</p></section>\n";
}

std::string inputs_section(const Page& page) {
  const Summary& s = page.summary;
  const auto row = [](std::string_view name, const std::string& value) {
    std::string line = "<tr><th scope=\"row\">";
    line += name;
    return line + "</th><td class=\"wide\">" + value + "</td></tr>\n";
  };
  std::string out = "<section id=\"inputs\"><h2>Inputs</h2>\n<table class=\"facts\"><tbody>\n";
  out += row("Scene", escape_xml(page.scene_file) + " <code>" + escape_xml(s.scene_sha256) + "</code>");
  for (const FileRow& file : page.files) {
    out += row("File", escape_xml(file.name) + ", " + display_count(file.bytes) + " bytes <code>" +
                           escape_xml(file.sha256) + "</code>");
  }
  out += row("Seed", std::to_string(s.seed));
  out += row("Joints", display_count(s.input.joints));
  std::string excavations;
  for (const std::string& name : page.excavations) excavations += (excavations.empty() ? "" : ", ") + escape_xml(name);
  if (!excavations.empty()) out += row("Excavations", excavations);
  if (page.loads) out += row("Loads", escape_xml(*page.loads));
  out += row("Lattice pitch", display(s.input.lattice_pitch_m, 3) + " m");
  out += row("Largest shift onto the lattice", display(s.input.largest_snap_m, 3) + " m");
  out += row("Planes merged by snap", display_count(s.input.merged_planes));
  if (!s.input.snapped.empty()) out += row("Joints changed by snap", display_count(s.input.snapped.size()));
  out += "</tbody></table>\n";
  if (!page.notes.empty()) {
    out += "<h3>Notes</h3>\n<ul>\n";
    for (const std::string& note : page.notes) out += "<li>" + escape_xml(note) + "</li>\n";
    out += "</ul>\n";
  }
  return out + "</section>\n";
}

void append(std::string& out, std::span<const std::string_view> pieces) {
  for (const std::string_view piece : pieces) out += piece;
}

}  // namespace

namespace detail {

std::string page_begin(const std::string& title, const std::string& sub) {
  std::string out =
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta name=\"color-scheme\" "
      "content=\"light dark\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data: blob:; "
      "style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n"
      "<link rel=\"icon\" href=\"data:,\">\n<title>";
  out += title + "</title>\n<style>\n";
  append(out, assets::style());
  return out + "</style>\n</head>\n<body>\n<header><p class=\"kicker\">cleave " CLEAVE_VERSION "</p><h1>" + title +
         "</h1>\n<p class=\"sub\">" + sub + "</p></header>\n<main>\n";
}

std::string page_end() { return "</main>\n<footer>Made by cleave " CLEAVE_VERSION ".</footer>\n</body>\n</html>\n"; }

std::string key_figure(std::string_view label, const std::string& figure, const std::string& below,
                       std::string_view kind) {
  return card(label, figure, below, kind);
}
std::string plan_part(const Summary& summary) { return plan_section(summary); }
std::string cost_part(const CostTable& cost) { return cost_section(cost); }

}  // namespace detail

std::string report_html(const Page& page) {
  const std::string title = escape_xml(page.summary.title.empty() ? "cleave report" : page.summary.title);
  std::string out =
      detail::page_begin(title, escape_xml(page.scene_file) + " · seed " + std::to_string(page.summary.seed) +
                                    " · lengths in metres, x east, y north, z up; dip directions clockwise from +y");
  std::string view_json;
  out += cards(page);
  out += view_section(page, view_json);
  out += key_blocks_section(page);
  out += why_section(page);
  out += support_section(page);
  out += maximum_section(page);
  if (page.summary.sequence) out += stages_section(*page.summary.sequence);
  out += stereonet_section(page);
  out += blocks_section(page);
  out += plan_section(page.summary);
  out += cost_section(page.summary.cost);
  out += inputs_section(page);
  out += "</main>\n<footer>Made by cleave " CLEAVE_VERSION
         ". The 3D view uses three.js (MIT licence, the three.js authors).</footer>\n";
  out += "<script>\n";
  append(out, assets::tables());
  out += "</script>\n";
  if (!view_json.empty()) {
    out += "<script type=\"application/json\" id=\"data\">\n";
    out = std::move(view_json.insert(0, out));  // the long text has room for the page around it
    out += "</script>\n<script>\n";
    append(out, assets::three());
    out += "\n</script>\n<script>\n";
    append(out, assets::orbit_controls());
    out += "\n</script>\n<script>\n";
    append(out, assets::view());
    append(out, assets::panel());
    out += "</script>\n";
  }
  return out + "</body>\n</html>\n";
}

}  // namespace cleave::report
