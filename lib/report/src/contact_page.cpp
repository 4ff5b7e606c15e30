#include <algorithm>
#include <cmath>
#include <numbers>

#include "assets.hpp"
#include "cleave/report/contact.hpp"
#include "cleave/report/text.hpp"
#include "plane_parts.hpp"

namespace cleave::report {
namespace {

using bem::Vec2;

/// Seven significant digits: enough for a picture, half of the bytes.
void short_number(std::string& out, double v) {
  if (!std::isfinite(v) || std::abs(v) < 1e-99) {  // far below, powers of ten overflow
    out += "0";
    return;
  }
  const double power = std::floor(std::log10(std::abs(v))) - 6;
  // 10^-power is a whole power of ten: multiplying and dividing by it gives short decimals.
  const double rounded = power < 0 ? std::round(v * std::pow(10, -power)) / std::pow(10, -power)
                                   : std::round(v / std::pow(10, power)) * std::pow(10, power);
  append_number(out, rounded);
}

void numbers(std::string& out, std::initializer_list<double> values) {
  bool first = true;
  for (const double v : values) {
    if (!first) out += ",";
    first = false;
    short_number(out, v);
  }
}

/// Frames and rows are thinned so that a page stays below some tens of megabytes.
std::size_t stride(std::size_t count, double each, double most) {
  std::size_t step = 1;
  while (static_cast<double>(count / step) * each > most) ++step;
  return step;
}

std::string page_data(const scene::ContactResult& result) {
  // Relative to the first body: far from the origin digits would be lost.
  const Vec2 origin = result.bodies.empty() ? Vec2{} : result.bodies.front().start;
  double turned = 0, moved = 0;
  for (const scene::ContactBodyResult& body : result.bodies) {
    turned = std::max(turned, std::abs(body.rotation));
    moved = std::max(moved, norm(body.centroid - body.start));
  }
  std::string out = "{\"way\":";
  append_json_string(out, result.to_rest ? "relaxation time (s)" : "time (s)");
  out += ",\"turned\":";
  short_number(out, turned);
  out += ",\"moved\":";
  short_number(out, moved);
  out += ",\"bodies\":[";
  for (std::size_t b = 0; b < result.bodies.size(); ++b) {
    const scene::ContactBodyResult& body = result.bodies[b];
    out += b > 0 ? ",{\"n\":" : "{\"n\":";
    append_json_string(out, body.name);
    out += body.fixed ? ",\"f\":1,\"c\":[" : ",\"f\":0,\"c\":[";
    numbers(out, {body.start.x - origin.x, body.start.y - origin.y});
    out += "],\"o\":[";
    for (std::size_t k = 0; k < body.outline.size(); ++k) {
      if (k > 0) out += ",";
      numbers(out, {body.outline[k].x - body.start.x, body.outline[k].y - body.start.y});
    }
    out += "]}";
  }
  double each = 3 * static_cast<double>(result.bodies.size());
  std::size_t most_contacts = 0;
  for (const scene::ContactFrame& frame : result.frames) most_contacts = std::max(most_contacts, frame.contacts.size());
  each += 5 * static_cast<double>(most_contacts);
  for (const scene::ContactBodyResult& body : result.bodies) {
    if (body.elastic) each += 2 * static_cast<double>(body.outline.size());
  }
  const std::size_t skip = stride(result.frames.size(), each, 1.5e6);
  out += "],\"frames\":[";
  bool first = true;
  for (std::size_t f = 0; f < result.frames.size(); ++f) {
    if (f % skip != 0 && f + 1 != result.frames.size()) continue;
    const scene::ContactFrame& frame = result.frames[f];
    out += first ? "{\"t\":" : ",{\"t\":";
    first = false;
    short_number(out, frame.time);
    out += ",\"p\":[";
    for (std::size_t b = 0; b < frame.places.size(); ++b) {
      if (b > 0) out += ",";
      numbers(out,
              {frame.places[b].centroid.x - origin.x, frame.places[b].centroid.y - origin.y, frame.places[b].rotation});
    }
    out += "],\"d\":{";
    bool first_body = true;
    for (std::size_t b = 0; b < frame.corners.size(); ++b) {
      if (frame.corners[b].empty()) continue;
      out += first_body ? "\"" : ",\"";
      first_body = false;
      out += std::to_string(b) + "\":[";
      const scene::ContactBodyResult& body = result.bodies[b];
      for (std::size_t k = 0; k < body.outline.size(); ++k) {
        const Vec2 rigid =
            frame.places[b].centroid + bem::rotated(body.outline[k] - body.start, frame.places[b].rotation);
        if (k > 0) out += ",";
        numbers(out, {frame.corners[b][k].x - rigid.x, frame.corners[b][k].y - rigid.y});
      }
      out += "]";
    }
    out += "},\"c\":[";
    for (std::size_t c = 0; c < frame.contacts.size(); ++c) {
      const scene::ContactMark& mark = frame.contacts[c];
      if (c > 0) out += ",";
      numbers(out, {mark.at.x - origin.x, mark.at.y - origin.y, mark.force.x, mark.force.y,
                    mark.state == scene::ContactMarkState::slip ? 1.0 : 0.0});
    }
    out += "],\"u\":[";
    for (std::size_t p = 0; p < frame.points.size(); ++p) {
      out += p > 0 ? ",[" : "[";
      numbers(out, {frame.points[p].x, frame.points[p].y});
      out += "]";
    }
    out += "]}";
  }
  out += "],\"points\":[";
  for (std::size_t p = 0; p < result.points.size(); ++p) {
    out += p > 0 ? ",{\"k\":" : "{\"k\":";
    out += std::to_string(p) + ",\"n\":";
    append_json_string(out, result.points[p].name);
    out += ",\"x\":";
    short_number(out, result.points[p].at.x - origin.x);
    out += ",\"y\":";
    short_number(out, result.points[p].at.y - origin.y);
    out += "}";
  }
  const std::size_t rows = stride(result.history.size(), 1, 1200);
  out += "],\"history\":[";
  for (std::size_t k = 0; k < result.history.size(); ++k) {
    if (k % rows != 0 && k + 1 != result.history.size()) continue;
    const scene::ContactHistory& row = result.history[k];
    out += k > 0 ? ",[" : "[";
    numbers(out, {row.time, row.kinetic, row.elastic, row.gravity, row.work, row.friction, row.lost, row.step,
                  static_cast<double>(row.iterations), static_cast<double>(row.sticking + row.slipping)});
    for (const Vec2 u : row.points) {
      out += ",";
      numbers(out, {u.x, u.y});
    }
    out += "]";
  }
  return out + "]}";
}

std::string row(std::initializer_list<std::string> cells, bool head = false) {
  std::string out = "<tr>";
  for (const std::string& cell : cells) out += (head ? "<th>" : "<td>") + cell + (head ? "</th>" : "</td>");
  return out + "</tr>\n";
}

std::string card(const std::string& label, const std::string& value, const std::string& below, const char* kind = "") {
  return std::string{"<div class=\"card "} + kind + "\"><span class=\"label\">" + label + "</span><strong>" + value +
         "</strong><span class=\"below\">" + below + "</span></div>\n";
}

std::string bodies_table(const scene::ContactResult& result) {
  constexpr std::size_t most = 60;
  std::vector<std::size_t> order;
  for (std::size_t b = 0; b < result.bodies.size(); ++b) {
    if (!result.bodies[b].fixed) order.push_back(b);
  }
  if (order.size() > most) {
    std::ranges::stable_sort(order, std::ranges::greater{}, [&](std::size_t b) { return result.bodies[b].largest; });
  }
  std::string out =
      "<div class=\"scroll\"><table>\n" + row({"body", "freedoms", "largest displacement (m)", "u<sub>x</sub> (m)",
                                               "u<sub>y</sub> (m)", "rotation (°)", "contact force on it (kN/m)"},
                                              true);
  for (std::size_t k = 0; k < order.size() && k < most; ++k) {
    const scene::ContactBodyResult& body = result.bodies[order[k]];
    out += row({escape_xml(body.name), display_count(body.freedoms), display(body.largest),
                display(body.centroid.x - body.start.x), display(body.centroid.y - body.start.y),
                display(body.rotation * 180 / std::numbers::pi),
                display(body.force.x / 1e3) + ", " + display(body.force.y / 1e3)});
  }
  out += "</table></div>\n";
  if (order.size() > most) {
    out += "<p class=\"small\">The " + display_count(most) + " of " + display_count(order.size()) +
           " that moved most; bodies.csv has all.</p>\n";
  }
  return out;
}

std::string solver_bars(const scene::ContactResult& result) {
  std::uint64_t all = 0;
  for (const scene::SolverShare& share : result.solvers) all += share.groups;
  if (all == 0 && result.steps == 0) return "<p>No step was solved.</p>\n";
  if (all == 0) return "<p>Nothing touched.</p>\n";
  std::string out =
      "<div class=\"scroll\"><table>\n" + row({"solver", "groups of contacts solved", "iterations", "", "share"}, true);
  for (const scene::SolverShare& share : result.solvers) {
    const double part = static_cast<double>(share.groups) / static_cast<double>(all);
    out += row({escape_xml(share.name), display_count(share.groups), display_count(share.iterations),
                "<i class=\"bar\" style=\"width:" + number(std::round(1000 * part) / 10) + "%\"></i>",
                display(100 * part, 3) + " %"});
  }
  return out + "</table></div>\n<p class=\"small\">" + display_count(result.iterations) +
         " linear solves and pivots in all; every answer is accepted by its residual only, the worst was " +
         display(result.residual, 2) + ".</p>\n";
}

/// What contact.js draws in and is steered by.
constexpr std::string_view motion = R"html(<section><h2>Motion</h2>
<p class="controls" id="player"><button id="play">Play</button>
<label>frame <input id="frame" type="range" min="0" max="0" value="0"></label> <span id="time"></span></p>
<p class="controls"><label><input id="arrows" type="checkbox" checked> contact forces</label>
<label>their size <input id="force" type="range" min="-1" max="1.5" step="0.05" value="0"></label>
<label>colour <select id="colour"><option>plain</option><option>displacement</option><option>rotation</option></select></label>
<span class="ramp" id="ramp" hidden><span id="ramp-low"></span><i></i><span id="ramp-high"></span></span>
<label>deformation <input id="scale" type="range" min="-2" max="2" step="0.05" value="0"> <span id="bent"></span></label></p>
<canvas id="view" role="img" aria-label="bodies and contact forces"></canvas>
<noscript><p>The picture and the plots need scripts; the tables and the files of the result do not.</p></noscript>
<p class="small"><span id="states"><span class="key" style="background:#1f5f8b"></span>contact that sticks
<span class="key" style="background:#d1495b;margin-left:1em"></span>that slips; a line through the contact shows its
force on both sides (the largest cut short).</span>
<span id="fixed"><span class="key" style="background:var(--wall)"></span>fixed</span></p>
</section>
<section><h2>Histories</h2>
<div class="plots">
)html";

}  // namespace

std::string contact_report_html(const scene::ContactResult& result) {
  std::string out = plane_page_head(
      result.title,
      escape_xml(result.scene_file) +
          " · lengths in metres, x to the right, y up; forces and energies per metre of thickness",
      ".controls label,.controls span{display:inline-block;margin:.2em 1em .2em 0}#view{width:100%;display:block}"
      ".plots{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,460px),1fr));gap:12px}"
      ".bar{display:block;height:10px;min-width:1px;margin-top:7px;background:var(--accent)}td:has(>.bar){width:30%}"
      ".ramp i{display:inline-block;width:140px;height:10px;margin:0 .5em;"
      "background:linear-gradient(90deg,#440154,#3b528b,#21918c,#5ec962,#fde725)}.controls .ramp[hidden]{display:none}"
      ".card "
      "strong{font-size:1.35rem}section.cards{grid-template-columns:repeat(auto-fit,minmax(158px,1fr))}.note.bad{"
      "border-"
      "color:var(--bad);color:var(--bad)}"
      ".key{display:inline-block;width:12px;height:12px;border-radius:6px;vertical-align:-1px;margin-right:4px}"
      ".scroll{overflow-x:auto}@media print{.controls{display:none}}");
  out += "<section class=\"cards\">\n";
  out += result.converged ? card("run", "converged", display_count(result.steps) + " steps", "good")
                          : card("run", "stopped", display_count(result.steps) + " steps", "bad");
  out += card("largest displacement", display(result.largest_displacement, 3) + " m",
              !result.to_rest    ? "after " + display(result.end_time, 4) + " s"
              : result.converged ? "at rest"
                                 : "not at rest: means nothing");
  const auto moving =
      static_cast<std::uint64_t>(std::ranges::count_if(result.bodies, [](const auto& b) { return !b.fixed; }));
  out += card("bodies that move", display_count(moving), result.elastic ? "elastic" : "rigid");
  out += card("penetration", display(result.largest_penetration, 2) + " m", "largest, after a step");
  out += card("energy gained", display(result.energy_gain, 2) + " J/m",
              "from nothing; momentum drift " + display(result.drift_momentum, 2));
  out += "</section>\n";
  if (!result.converged) {
    out += "<p class=\"note bad\">Stopped: " + escape_xml(result.stopped_why) +
           ". What follows is the state that was reached.</p>\n";
  }
  for (const std::string& note : result.notes) out += "<p class=\"note\">Note: " + escape_xml(note) + "</p>\n";
  out += motion;
  if (!result.points.empty()) out += "<div id=\"ux\"></div><div id=\"uy\"></div>\n";
  out += "<div id=\"energy\"></div><div id=\"contacts\"></div>\n</div>\n</section>\n";
  if (!result.points.empty()) {
    out += "<section><h2>Points</h2>\n<div class=\"scroll\"><table>\n" +
           row({"point", "x (m)", "y (m)", "u<sub>x</sub> (m)", "u<sub>y</sub> (m)"}, true);
    for (std::size_t p = 0; p < result.points.size(); ++p) {
      const Vec2 u = result.history.empty() ? Vec2{} : result.history.back().points[p];
      out += row({escape_xml(result.points[p].name), display(result.points[p].at.x), display(result.points[p].at.y),
                  display(u.x, 6), display(u.y, 6)});
    }
    out += "</table></div>\n</section>\n";
  }
  out += "<section><h2>Bodies</h2>\n" + bodies_table(result) + "</section>\n<section><h2>Solvers</h2>\n" +
         solver_bars(result) + "<div class=\"plots\"><div id=\"steps\"></div>" +
         (result.solvers.empty() ? "" : "<div id=\"iterations\"></div>") + "</div>\n" +
         "</section>\n<section><h2>What ran</h2>\n<div class=\"scroll\"><table>\n"
         "<tr><th>stage</th><th></th><th class=\"wide\">why</th></tr>\n";
  for (const scene::PlannedStage& stage : result.plan.stages) {
    out += "<tr><td>" + std::string{scene::name_of(stage.stage)} + "</td><td>" + (stage.run ? "run" : "left out") +
           "</td><td class=\"wide\">" + escape_xml(stage.why) + "</td></tr>\n";
  }
  out += "</table></div>\n<p>" + display(result.cost.wall_s, 3) + " s, " + display(result.cost.peak_rss_mb, 3) +
         " MB, " + std::to_string(result.cost.threads) + " threads.</p>\n";
  out += "</section>\n</main>\n<script type=\"application/json\" id=\"data\">" + page_data(result) +
         "</script>\n<script>\n";
  for (const std::string_view piece : assets::contact()) out += piece;
  out += "</script>\n</body>\n</html>\n";
  return out;
}

}  // namespace cleave::report
