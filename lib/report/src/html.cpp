#include "html.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "assets.hpp"
#include "cleave/core/version.hpp"
#include "cleave/exchange/text.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/realize/block_sizes.hpp"
#include "drawings.hpp"
#include "flow.hpp"
#include "html_key_blocks.hpp"
#include "html_loads.hpp"
#include "html_parts.hpp"
#include "html_stability.hpp"
#include "html_table.hpp"
#include "html_why.hpp"
#include "key_groups.hpp"
#include "mapped.hpp"
#include "motion.hpp"
#include "stages_section.hpp"
#include "stereonet.hpp"
#include "unrolled.hpp"
#include "view3d.hpp"

namespace cleave::report {
namespace {

using detail::fact, detail::facts_table, detail::key_figure, detail::page_begin, detail::page_foot, detail::page_end,
    detail::script, detail::plan_section, detail::cost_section, detail::notes_list;

template <class T>
const T* pointer_to(const std::optional<T>& value) {
  return value ? &*value : nullptr;
}

/// What single key blocks leave out: groups that only move together, and blocks that the border of the domain holds.
std::string cards_beyond_single_blocks(const Page& page) {
  std::string out;
  if (page.figures().groups) {
    const scene::KeyGroupFigures& groups = *page.figures().groups;
    const std::string_view name = page.figures().load_cases.empty() ? "Key groups" : "Key groups, base case";
    const std::uint64_t shown = groups.count + groups.in_doubt;
    const std::string link = shown > 0 ? "<a href=\"#groups\">" : "", end = shown > 0 ? "</a>" : "";
    if (!groups.judged) {
      out += key_figure(name, "not judged", "too many blocks near free faces to be judged together", "warn");
    } else {
      out += key_figure(name, link + display_count(groups.count) + end,
                        display(groups.volume_m3) + " m³ that move, together or alone; " +
                            display_count(groups.in_doubt) + " in doubt",
                        shown > 0 ? "warn" : "");
    }
  }
  const auto& keys = page.figures().key_blocks;
  if (keys && keys->domain_held && keys->domain_held->count > 0) {
    const scene::DomainHeldFigures& held = *keys->domain_held;
    out += key_figure("Held by the domain's border", "<a href=\"#notes\">" + display_count(held.count) + "</a>",
                      display(held.volume.si()) + " m³ that would move without it, " + display(100 * held.share, 3) +
                          " % of the free area",
                      "warn");
  }
  return out;
}

std::string cards(const Page& page) {
  const scene::Figures& s = page.figures();
  const topology::Certificate& certificate = page.result.certificate();
  const scene::RunCost& cost = page.result.cost;
  std::string out = "<section class=\"cards\" aria-label=\"Key figures\">\n";
  if (s.blocks) {
    out += key_figure("Blocks", display_count(s.blocks->count), display(s.blocks->volume_m3) + " m³ of rock");
  }
  if (s.key_blocks) {
    const auto& k = *s.key_blocks;
    out += key_figure(s.load_cases.empty() ? "Key blocks" : "Key blocks, base case", display_count(k.count),
                      display(k.volume_m3) + " m³ in " + std::to_string(k.batches.size()) +
                          (k.batches.size() == 1 ? " batch" : " batches") +
                          (k.stopped_at_max_batches ? ", stopped there" : ""),
                      k.count > 0 ? "warn" : "");
  }
  out += cards_beyond_single_blocks(page) + governing_card(s);
  out += detail::notes_figure(page.result.notes.size());
  out += key_figure("Joints", display_count(s.input.joints),
                    "moved by at most " + display(s.input.largest_snap_m, 2) + " m onto the lattice");
  out +=
      key_figure("Certificate", certificate.passed ? "passed" : "not passed",
                 "volume error " + display(certificate.volume_relative_error, 2), certificate.passed ? "good" : "bad");
  out += key_figure("Time", display(cost.wall_s, 3) + " s",
                    display(cost.cpu_s, 3) + " s CPU, " + display(cost.peak_rss_mb, 3) + " MB, " +
                        std::to_string(cost.threads) + (cost.threads == 1 ? " thread" : " threads"));
  return out + "</section>\n";
}

ViewSets sets_of(const scene::RunResult& result) {
  ViewSets out;
  for (const scene::SetInfo& set : result.sets) out.names.push_back(set.name);
  for (const scene::JointInfo& joint : result.joints) out.of.push_back(static_cast<std::uint16_t>(joint.set.index()));
  return out;
}

std::string view_section(const Page& page, std::string& view_json) {
  if (page.complex == nullptr) return {};
  const stability::Analysis* analysis = pointer_to(page.result.analysis);
  const ViewSets sets = sets_of(page.result);
  View3d view = pack_view(*page.complex, analysis, view_budget_bytes, pointer_to(page.result.support),
                          pointer_to(page.result.key_groups), &sets);
  view_json = std::move(view.json);
  std::string out =
      "<section id=\"view\"><h2>Blocks in three dimensions</h2>\n<div class=\"stage\">\n<div id=\"scene\">";
  out += "<div id=\"still\">" + still_picture(*page.complex, analysis) + "</div>";
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

/// "25", or "20 … 32" where joints differ.
struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  void add(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
  [[nodiscard]] std::string text() const {
    return low == high ? display(low, 3) : display(low, 3) + " … " + display(high, 3);
  }
};

struct SetRow {
  Html name = {};
  std::uint64_t joints = 0;
  MeanPole mean = {};
  Range friction = {}, cohesion = {};
};
template <class V>
void fields(V& v, const SetRow& x) {
  const auto tenth = [](double degrees) { return display(std::round(degrees * 10) / 10) + "°"; };
  v("set", x.name);
  v("joints", x.joints);
  v("mean", Html{tenth(x.mean.dip_degrees) + " / " + tenth(x.mean.dip_direction_degrees)});
  v("kappa", x.joints > 1 ? std::optional{x.mean.kappa} : std::nullopt);
  v("friction", Html{x.friction.text()});
  v("cohesion", Html{x.cohesion.text()});
}

std::string set_table(const Page& page) {
  HtmlTable table{{{"set"},
                   {"joints"},
                   {"mean", "Mean dip / dip direction"},
                   {"kappa", "Concentration κ", 3},
                   {"friction", "Friction (°)"},
                   {"cohesion", "Cohesion (kPa)"}},
                  SetRow{}};
  for (const scene::SetId id : page.result.sets.ids()) {
    SetRow row;
    std::vector<geometry::Vec3> normals;
    for (const scene::JointInfo& joint : page.result.joints) {
      if (joint.set != id) continue;
      normals.push_back(joint.normal);
      row.friction.add(joint.strength.friction().degrees());
      row.cohesion.add(joint.strength.cohesion().si() / 1000);
    }
    if (normals.empty()) continue;
    row.name.text = "<svg class=\"mark\" viewBox=\"0 0 16 16\">" + set_marker(id.index(), 8, 8, 5) + "</svg>" +
                    escape_xml(page.result.sets[id].name);
    row.joints = normals.size();
    row.mean = mean_of(normals);
    row.mean.dip_direction_degrees = geometry::wrap_degrees(row.mean.dip_direction_degrees - page.result.north);
    table.add(row);
  }
  return std::move(table).html();
}

std::string stereonet_section(const Page& page) {
  if (page.result.joints.empty()) return {};
  std::vector<NetSet> sets;
  for (const scene::SetInfo& set : page.result.sets) sets.push_back({.name = set.name, .joints = set.joints});
  std::vector<Pole> joints;
  for (const scene::JointInfo& joint : page.result.joints) joints.push_back({joint.normal, joint.set.value()});
  std::string out =
      "<section id=\"net\"><h2>Joints</h2>\n<div class=\"columns\"><figure class=\"net\">\n"
      "<div class=\"choice\"><input type=\"radio\" name=\"net\" id=\"net-area\" checked><label for=\"net-area\">equal "
      "area</label>"
      "<input type=\"radio\" name=\"net\" id=\"net-angle\"><label for=\"net-angle\">equal angle</label>\n";
  out += "<div class=\"area\">" + stereonet_svg(joints, sets, Net::equal_area, page.result.north) + "</div>";
  out += "<div class=\"angle\">" + stereonet_svg(joints, sets, Net::equal_angle, page.result.north) + "</div></div>\n";
  out +=
      "<figcaption>Poles of joints, lower hemisphere; large marks and great circles: means of the sets. Inner circles: "
      "dips of 30° and 60°.";
  if (joints.size() > max_plotted_poles) {
    const std::size_t step = (joints.size() + max_plotted_poles - 1) / max_plotted_poles;
    out += " One in " + std::to_string(step) + " poles is drawn; the means use all.";
  }
  out += "</figcaption></figure>\n<div>" + set_table(page) + "</div></div></section>\n";
  return out;
}

std::string blocks_section(const Page& page) {
  if (!page.figures().blocks || page.complex == nullptr) return {};
  const scene::BlockFigures& b = *page.figures().blocks;
  const topology::Certificate& c = page.result.certificate();
  std::vector<double> volumes;
  for (const topology::Block& block : page.complex->blocks()) volumes.push_back(block.volume.si());
  std::string out = "<section id=\"blocks\"><h2>Block system and certificate</h2>\n<div class=\"columns\"><div>";
  std::string rows;
  const auto system = group([&](auto& w) { scene::block_fields(w, page.figures().blocks, c, page.result.window); });
  rows += facts({{"count", "Blocks"},
                 {"concave", "Not convex"},
                 {"with_holes"},
                 {"with_cavities"},
                 {"slivers", "Slivers (kept)"},
                 {"volume_m3", "Sum of block volumes", 8},
                 {"domain_volume_m3", "Domain less excavations", 8},
                 {"volume_relative_error", "Volume error (relative)", 2}},
                system);
  rows += facts({{"euler_violations", "Euler–Poincaré violations"},
                 {"open_shells"},
                 {"unpaired_patches", "Unpaired joint patches"},
                 {"face_vector_max_relative", "Largest face-vector sum (relative)", 2}},
                c);
  rows += facts({{"exact_share", "Decisions that needed exact numbers", 3}}, system);
  rows += fact("Hash of the block system", "<code>" + escape_xml(b.hash) + "</code>");
  if (b.sizes) {
    const scene::BlockSizes& sizes = *b.sizes;
    const std::string which = sizes.inner ? " (touching no fixed side)" : " (all)";
    rows += fact("Whole blocks measured", display_count(sizes.count) + which);
    for (const char* const level : {"p10", "p50", "p90"}) {
      rows += fact(std::string{"Volume "} + level + ", by number; by volume",
                   display(sizes.by_number.at(level)) + "; " + display(sizes.by_volume.at(level)) + " m³");
    }
    rows += facts({{"d50_m", "D50"}, {"d80_m", "D80"}}, sizes);
    rows += facts({{"cubic"}, {"platy"}, {"elongated"}, {"bladed"}}, sizes.shapes);
    rows += fact("Volumetric joint count Jv", display(sizes.jv) + " 1/m");
  }
  return out + facts_table(rows) + "</div>\n<figure>" + size_curve(std::move(volumes)) +
         "<figcaption>Share of the <span class=\"key-a\">number of blocks</span> and of the <span class=\"key-b\">rock "
         "volume</span> "
         "in blocks smaller than V.</figcaption></figure></div></section>\n";
}

/// What the figures rest on and leave out.
std::string limits_of(const scene::RunResult& r) {
  std::vector<std::string_view> limits{
      "Blocks are rigid. Joints are flat, have the Coulomb (or Barton–Bandis) strengths above and no stiffness."};
  const auto item = [&](std::string_view text) { limits.push_back(text); };
  if (!r.analysis) {
    item("Stability was not asked for: nothing is said of what moves.");
    return detail::limits_list(limits);
  }
  item("A block is judged by limit equilibrium of its translation, in the state after the batches before it.");
  item(r.analysis->rotation == stability::RotationCheck::off
           ? "Turning and toppling were not checked."
           : "Turning is checked for blocks that cannot slide; no factor of safety against it is given.");
  item(r.field_stress
           ? "The stress of the rock is counted beside, in the columns “clamped”, not in the factors of safety."
           : "In-situ stress is not counted.");
  item("Sides of the domain that are not free hold what touches them.");
  item(
      "Earthquakes are static forces; blasting, creep, weathering and loss of strength with movement are not counted.");
  return detail::limits_list(limits);
}

std::string inputs_section(const Page& page) {
  const scene::RunResult& r = page.result;
  const scene::CutFigures& input = r.figures.input;
  const auto row = [](std::string_view name, const std::string& value) { return fact(name, value, "wide"); };
  std::string out = detail::input_rows("Scene", r.scene_file, r.scene_sha256, r.files, r.seed);
  out += facts({{"joints"}}, input, "wide");
  std::string excavations;
  for (const scene::ExcavationFigures& e : input.excavations) {
    excavations +=
        (excavations.empty() ? "" : ", ") + escape_xml(e.name) + " (" + display(e.volume.si(), 4) + " m³" +
        (e.outside_share.value_or(0) > 0 ? ", " + display(100 * *e.outside_share, 3) + " % of it outside the domain)"
                                         : ")");
  }
  if (!excavations.empty()) out += row("Excavations", excavations);
  out += load_rows(r);
  out += facts({{"lattice_pitch_m", {}, 3},
                {"largest_snap_m", "Largest shift onto the lattice", 3},
                {"merged_planes", "Planes merged by snap"}},
               input, "wide");
  if (input.near_misses.sides > 0) {
    out +=
        row("Sides that nearly reach another polygon",
            display_count(input.near_misses.sides) + ", " + display(input.near_misses.largest.si(), 2) + " m at most");
  }
  for (const scene::LineFigures& line : input.lines) {
    out += row("Scanline " + escape_xml(line.name),
               display_count(line.joints) + " joints on " + display(line.length.si()) + " m of rock, " +
                   display(line.frequency.value.value_or(0)) + " per m, RQD " + display(line.rqd.value.value_or(0)) +
                   " [" + display(line.rqd.low) + " … " + display(line.rqd.high) + "] %, longest piece " +
                   display(line.longest_piece.si()) + " m");
  }
  if (!input.snapped.empty()) out += row("Joints changed by snap", display_count(input.snapped.size()));
  return "<section id=\"inputs\"><h2>Inputs</h2>\n" + facts_table(out) + limits_of(r) + notes_list(r.notes) +
         "</section>\n";
}

/// What coordinates and dip directions mean.
std::string axes_of(double north) {
  if (north == 0) return "x east, y north, z up; dip directions clockwise from north";
  return "z up, true north " + display(north, 6) + "° clockwise from y; dip directions clockwise from true north";
}

}  // namespace

double Page::tan_friction(topology::JointId joint) const {
  return joint.index() < result.joints.size() ? std::tan(result.joints[joint].strength.friction().radians()) : 0;
}

std::string Page::azimuth(double from_y) const {
  return std::to_string(std::lround(geometry::wrap_degrees(from_y - result.north)) % 360) + "°";
}

std::string report_html(const Page& page) {
  const scene::RunResult& r = page.result;
  const std::string title = escape_xml(r.title.empty() ? "cleave report" : r.title);
  std::string out = page_begin(title, detail::project_line(r.project) + escape_xml(r.scene_file) + " · seed " +
                                          std::to_string(r.seed) + " · lengths in metres, " + axes_of(r.north));
  std::string view_json;
  out += cards(page);
  out += view_section(page, view_json);
  out += key_blocks_section(page);
  out += why_section(page);
  out += unrolled_section(page);
  out += key_groups_section(page.result, page.complex);
  if (page.result.mapped) out += mapped_section(*page.result.mapped);
  if (page.result.motion) out += motion_section(*page.result.motion);
  if (page.result.flow) out += flow_section(*page.result.flow);
  out += support_section(page);
  out += maximum_section(page);
  if (r.sequence) out += stages_section(*r.sequence);
  out += stereonet_section(page);
  out += blocks_section(page);
  out += plan_section(r.plan);
  out += cost_section(r.cost);
  out += inputs_section(page);
  out += page_foot(" The 3D view uses three.js (MIT licence, the three.js authors).");
  out += script(assets::tables());
  if (!view_json.empty()) {
    out += "<script type=\"application/json\" id=\"data\">\n";
    out = std::move(view_json.insert(0, out));  // the long text has room for the page around it
    out += "</script>\n";
    for (const auto pieces : {assets::three(), assets::orbit_controls(), assets::blocks3d(), assets::caps3d(),
                              assets::camera3d(), assets::pick3d(), assets::view(), assets::panel()}) {
      out += script(pieces);
    }
  }
  out += page_end;
  return out;
}

}  // namespace cleave::report
