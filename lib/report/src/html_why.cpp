#include "html_why.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "cleave/exchange/text.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/realize/places.hpp"
#include "drawings.hpp"
#include "html_key_blocks.hpp"
#include "html_parts.hpp"
#include "html_table.hpp"
#include "stereonet.hpp"
#include "svg.hpp"
#include "tables.hpp"

namespace cleave::report {
namespace {

using detail::fact, detail::fixed;
using geometry::Vec3;

constexpr double radius = 120, centre = 132;

std::string at(NetPoint p) { return fixed(centre + radius * p.x) + ',' + fixed(centre - radius * p.y); }

std::string circle_path(const std::vector<NetPoint>& points, std::string_view attributes) {
  std::string out = "<path fill=\"none\" d=\"M";
  for (std::size_t i = 0; i < points.size(); ++i) out += (i == 0 ? "" : "L") + at(points[i]);
  out += "\" ";
  out += attributes;
  return out + "/>";
}

/// Cone of half angle `degrees` about a line: the part of it in the lower hemisphere, as polylines.
std::string small_circle(Vec3 axis, double degrees, Net net, std::string_view attributes) {
  const Vec3 n = geometry::normalized(axis);
  const Vec3 u = geometry::normalized(std::abs(n.z) < 0.9 ? cross(n, {0, 0, 1}) : cross(n, {1, 0, 0}));
  const Vec3 v = cross(n, u);
  const double a = degrees * std::numbers::pi / 180;
  std::string out;
  std::vector<NetPoint> run;
  for (int i = 0; i <= 120; ++i) {
    const double t = 2 * std::numbers::pi * i / 120;
    Vec3 line = std::cos(a) * n + std::sin(a) * (std::cos(t) * u + std::sin(t) * v);
    if (line.z > 1e-9) {
      if (run.size() > 1) out += circle_path(run, attributes);
      run.clear();
      continue;
    }
    line.z = std::min(line.z, -1e-12);  // a circle that touches the rim stays on this side of the net
    run.push_back(project(line, net));
  }
  if (run.size() > 1) out += circle_path(run, attributes);
  return out;
}

/// Beside a mark, on the side that lies in the net.
std::string net_label(NetPoint p, const std::string& text) {
  return "<text x=\"" + fixed(centre + radius * p.x + (p.x > 0.6 ? -6 : 6)) + "\" y=\"" +
         fixed(centre - radius * p.y - 5) + (p.x > 0.6 ? "\" text-anchor=\"end\">" : "\">") + text + "</text>";
}

/// Joint planes (great circles), free surfaces (dashed), friction circle about the pole of each pressing plane's
/// downward normal with the joint's number, direction of motion.
std::string block_net(const Page& page, const stability::Judgement& j, Net net) {
  const topology::BlockComplex& complex = *page.complex;
  std::string out =
      "<svg viewBox=\"-6 -10 276 284\" role=\"img\" aria-label=\"Stereonet of the block\"><circle cx=\"132\" "
      "cy=\"132\" "
      "r=\"120\" class=\"net-rim\"/><g class=\"net-mark\"><text x=\"132\" y=\"6\">N</text><text x=\"262\" "
      "y=\"137\">E</text><text x=\"132\" y=\"269\">S</text><text x=\"2\" y=\"137\">W</text></g>";
  std::string labels;
  for (const topology::FaceId id : complex.blocks()[j.block].faces) {
    const topology::Face& face = complex.faces()[id];
    const bool free = face.role == topology::Role::free;
    out += circle_path(great_circle(face.outward, net, 61),
                       free ? "stroke=\"#888\" stroke-width=\"1.2\" stroke-dasharray=\"4 3\""
                            : "stroke=\"#0072B2\" stroke-width=\"1.4\"");
  }
  for (const stability::Pressing& pressing : j.pressing) {
    const topology::Face& face = complex.faces()[pressing.face];
    const double tangent = face.joint ? page.tan_friction(*face.joint) : 0;
    const Vec3 pole = face.outward.z > 0 ? -face.outward : face.outward;
    out +=
        small_circle(pole, std::atan(tangent) * 180 / std::numbers::pi, net, "stroke=\"#D55E00\" stroke-width=\"1.4\"");
    out += "<circle r=\"3\" fill=\"#D55E00\" cx=\"" + fixed(centre + radius * project(pole, net).x) + "\" cy=\"" +
           fixed(centre - radius * project(pole, net).y) + "\"/>";
    if (face.joint) labels += net_label(project(pole, net), std::to_string(face.joint->value()));
  }
  if (norm(j.direction) > 0) {
    const NetPoint p = project(j.direction, net);
    const double x = centre + radius * p.x, y = centre - radius * p.y;
    out += "<path d=\"M" + fixed(x - 6) + ',' + fixed(y) + 'h' + fixed(12) + 'M' + fixed(x) + ',' + fixed(y - 6) + 'v' +
           fixed(12) + "\" stroke=\"#009E73\" stroke-width=\"3\"/>";
  }
  return out + labels + "</svg>";
}

std::string vector_text(Vec3 v) {
  return "(" + display(v.x, 3) + ", " + display(v.y, 3) + ", " + display(v.z, 3) + ")";
}

/// Neither falls, slides nor turns by itself: where it would slide, the factor is below that of its own resistance.
bool moves_only_in_group(const stability::Judgement& j) {
  if (!j.key || (j.rotation && j.rotation->turns)) return false;
  const bool of_group = j.resistance >= j.driving && j.factor_of_safety * j.driving < (1 - 1e-9) * j.resistance;
  return !stability::moves(j.mode) || of_group;
}

std::string sentence_of_group(const Page& page, const stability::Judgement& j) {
  std::size_t blocks = 0;
  if (page.result.key_groups) {
    for (const stability::KeyGroup& group : page.result.key_groups->groups) {
      const bool moves = group.verdict != assembly::Verdict::in_doubt;
      if (moves && std::ranges::binary_search(group.blocks, j.block)) blocks = group.blocks.size();
    }
  }
  return "Block " + std::to_string(j.block.value()) + " does not move by itself; it moves in a group of " +
         display_count(blocks) + " blocks, direction " + vector_text(j.direction) + ", out of balance by " +
         display(j.net.si() / 1000) + " kN. Factor of safety of the group " + display(j.factor_of_safety, 3) + ".";
}

std::string sentence(const Page& page, const stability::Judgement& j) {
  if (moves_only_in_group(j)) return sentence_of_group(page, j);
  const topology::BlockComplex& complex = *page.complex;
  std::string out = "Block " + std::to_string(j.block.value()) + " can leave its place in ";
  out += j.cone_dimension == 3   ? "a solid cone of directions"
         : j.cone_dimension == 2 ? "a plane of directions only"
                                 : "one line of directions only";
  out += ". Its load drives it ";
  switch (j.mode) {
    case stability::Mode::falling: out += "off all its joints: it falls"; break;
    case stability::Mode::lifting: out += "off all its joints, against gravity"; break;
    case stability::Mode::sliding: out += "along one joint plane"; break;
    case stability::Mode::wedge: out += "along the line of two joint planes"; break;
    case stability::Mode::stable: out += "against its joints: it stays"; break;
    case stability::Mode::tapered: out += "nowhere"; break;
  }
  out += ", direction " + vector_text(j.direction) + ". Driving force " + display(j.driving.si() / 1000) +
         " kN, resistance " + display(j.resistance.si() / 1000) + " kN";
  if (!j.pressing.empty()) {
    for (const stability::Pressing& p : j.pressing) {
      const topology::Face& face = complex.faces()[p.face];
      out += &p == &j.pressing.front() ? " from joint " : " and joint ";
      out += (face.joint ? std::to_string(face.joint->value()) : std::string{"?"}) + " (pressed with " +
             display(p.reaction.si() / 1000) + " kN over " + display(face.area.si(), 3) + " m²)";
    }
  }
  out += ": factor of safety " + display(j.factor_of_safety, 3) + ".";
  if (j.resistance_max) out += " Three or more planes share the load; the least resistance is given.";
  if (j.tie) out += " Two modes coincide to rounding.";
  if (j.rotation && j.rotation->turns) {
    out += " It cannot slide, but no forces at its contacts balance its moments: it turns about the axis " +
           vector_text(j.rotation->axis) + " through its centroid.";
  }
  if (j.transferred && norm(j.transferred->received) > 0) {
    out += " Later batches push on it with " + vector_text(j.transferred->received / 1000) + " kN: " +
           (j.transferred->key ? "net force " + display(j.transferred->net.si() / 1000) + " kN, factor " +
                                     display(j.transferred->factor_of_safety, 3)
                               : std::string{"it is stable then"}) +
           ".";
  }
  return out;
}

/// "joint 3, block 5, 7": what lies behind a face.
std::string behind(const topology::BlockComplex& complex, const topology::Face& face) {
  switch (face.role) {
    case topology::Role::joint: break;
    case topology::Role::fixed: return "rock that stays";
    case topology::Role::free: return "air";
    case topology::Role::window: return "not cut";
  }
  std::vector<std::uint32_t> neighbours;
  for (const topology::Patch& patch : complex.patches(face)) {
    if (patch.neighbour) neighbours.push_back(patch.neighbour->value());
  }
  std::ranges::sort(neighbours);
  const auto repeated = std::ranges::unique(neighbours);
  neighbours.erase(repeated.begin(), repeated.end());
  std::string out = "joint " + (face.joint ? std::to_string(face.joint->value()) : std::string{"?"}) + ", block";
  for (std::size_t k = 0; k < std::min<std::size_t>(neighbours.size(), 6); ++k) {
    out += (k == 0 ? " " : ", ") + std::to_string(neighbours[k]);
  }
  return neighbours.size() > 6 ? out + ", …" : out;
}

/// A face of a block that moves.
struct FaceRow {
  const Page& page;
  const stability::Judgement& j;
  topology::FaceId id;
  std::size_t number = 0;
};
template <class V>
void fields(V& v, const FaceRow& x) {
  constexpr double to_degrees = 180 / std::numbers::pi;
  const topology::Face& face = x.page.complex->faces()[x.id];
  const Vec3 up = face.outward.z < 0 ? -face.outward : face.outward;
  const geometry::Attitude attitude = geometry::attitude_of(up);
  const auto pressed = std::ranges::find(x.j.pressing, x.id, &stability::Pressing::face);
  const bool presses = pressed != x.j.pressing.end(), joint = face.role == topology::Role::joint;
  const double along = -dot(face.outward, x.j.direction);
  const double friction = joint && face.joint ? std::atan(x.page.tan_friction(*face.joint)) * to_degrees : 0;
  v("face", x.number);
  v("behind_it", behind(*x.page.complex, face));
  v("attitude",
    Html{std::to_string(std::lround(attitude.dip.degrees())) + "° / " + x.page.azimuth(attitude.direction.degrees())});
  v("area_m2", face.area);
  v("friction_deg", joint ? std::optional{friction} : std::nullopt);
  v("pressed_with_n", presses ? std::optional{pressed->reaction} : std::nullopt);
  v("shear_n", presses ? std::optional{pressed->shear} : std::nullopt);
  v("in_motion", Html{!joint                       ? "–"
                      : presses                    ? "slides on it"
                      : !(norm(x.j.direction) > 0) ? "–"
                      : std::abs(along) < 1e-9     ? "brushes it"
                      : along > 0                  ? "opens"
                                                   : "leans on what has left"});
}

std::string face_table(const Page& page, const stability::Judgement& j) {
  const auto& faces = page.complex->blocks()[j.block].faces;
  HtmlTable table{{{"face"},
                   {"behind_it"},
                   {"attitude", "Dip / dip direction"},
                   {"area_m2", {}, 3},
                   {"friction_deg", {}, 3},
                   {"pressed_with_n"},
                   {"shear_n"},
                   {"in_motion"}},
                  FaceRow{page, j, faces.front()},
                  "class=\"faces\""};
  for (std::size_t number = 0; const topology::FaceId id : faces) table.add(FaceRow{page, j, id, ++number});
  return std::move(table).html();
}

/// Forces in the plane of gravity and of the motion, to one scale, gravity downwards on the page: weight, reactions,
/// resistance, driving force, and all other loads (water, earthquake, surcharge) summed up, from W + Q + sum N = T.
std::string force_arrows(const Page& page, const stability::Judgement& j) {
  const Vec3 gravity = page.result.stability ? page.result.stability->loads.body.gravity() : Vec3{0, 0, -9.81};
  const Vec3 up = norm(gravity) > 0 ? geometry::normalized(-gravity) : Vec3{0, 0, 1};
  Vec3 h = j.direction - dot(j.direction, up) * up;
  if (!(norm(h) > 1e-9)) h = geometry::cross(up, std::abs(up.y) < 0.9 ? Vec3{0, 1, 0} : Vec3{1, 0, 0});
  h = geometry::normalized(h);
  struct Arrow {
    Vec3 force;
    std::string colour, label;
  };
  std::vector<Arrow> arrows{{-j.weight.si() * up, "#555", "W"}};
  Vec3 other = j.driving.si() * j.direction - arrows.front().force;
  for (const stability::Pressing& p : j.pressing) {
    const topology::Face& face = page.complex->faces()[p.face];
    arrows.push_back({-p.reaction.si() * face.outward, "#0072B2",
                      face.joint
                          ? "N<tspan dy=\"3\" font-size=\"10\">" + std::to_string(face.joint->value()) + "</tspan>"
                          : std::string{"N"}});
    other -= arrows.back().force;
  }
  if (norm(other) > 1e-6 * j.weight.si()) arrows.push_back({other, "#CC79A7", "Q"});
  arrows.push_back({-j.resistance.si() * j.direction, "#D55E00", "R"});
  arrows.push_back({j.driving.si() * j.direction, "#009E73", "T"});
  double largest = 0;
  for (const Arrow& a : arrows) largest = std::max(largest, norm(a.force));
  if (!(largest > 0)) return {};
  std::vector<std::pair<double, double>> placed;
  std::string out = "<svg viewBox=\"-6 -10 276 284\" role=\"img\" aria-label=\"Forces on the block\">";
  for (const Arrow& a : arrows) {
    const double x = 110 * dot(a.force, h) / largest, y = -110 * dot(a.force, up) / largest;
    const double length = std::hypot(x, y);
    if (length < 3) continue;
    const double ux = x / length, uy = y / length;
    // Letters stand beside the tip, on the side away from arrows that end nearby.
    double tx = 132 + x + 8 * ux, ty = 132 + y + 8 * uy + 5;
    for (const auto& [px, py] : placed) {
      if (std::abs(tx - px) < 16 && std::abs(ty - py) < 14) ty = py + (ty >= py ? 15 : -15);
    }
    placed.emplace_back(tx, ty);
    out += "<path d=\"M132,132L" + fixed(132 + x) + ',' + fixed(132 + y) + "\" stroke=\"" + a.colour +
           "\" stroke-width=\"3\"/><path d=\"M" + fixed(132 + x) + ',' + fixed(132 + y) + "l" +
           fixed(-9 * ux - 4 * uy) + ',' + fixed(-9 * uy + 4 * ux) + "l" + fixed(8 * uy) + ',' + fixed(-8 * ux) +
           "z\" fill=\"" + a.colour + "\"/><text x=\"" + fixed(tx) + "\" y=\"" + fixed(ty) +
           "\" text-anchor=\"middle\">" + a.label + "</text>";
  }
  return out + "</svg>";
}

std::string tornado(const stability::Sensitivity& s) {
  struct Bar {
    std::string_view name;
    double low, high;
  };
  const auto ends = [](const std::array<double, 2>& v) {
    return std::pair{std::min(v[0], v[1]), std::max(v[0], v[1])};
  };
  std::vector<Bar> bars;
  for (const auto& [name, values] : {std::pair<std::string_view, std::array<double, 2>>{"friction", s.friction},
                                     {"cohesion", s.cohesion},
                                     {"water", s.water}}) {
    const auto [low, high] = ends(values);
    if (std::isfinite(low) && std::isfinite(high)) bars.push_back({name, low, high});
  }
  std::ranges::stable_sort(bars, [](const Bar& a, const Bar& b) { return a.high - a.low > b.high - b.low; });
  double from = s.base, to = s.base;
  for (const Bar& b : bars) {
    from = std::min(from, b.low);
    to = std::max(to, b.high);
  }
  if (!(to > from)) return {};
  const auto x = [&](double f) { return 90 + 300 * (f - from) / (to - from); };
  std::string out = "<svg viewBox=\"0 0 480 " + fixed(26.0 * static_cast<double>(bars.size()) + 34) +
                    "\" role=\"img\" aria-label=\"Sensitivity of the factor of safety\">";
  double y = 6;
  for (const Bar& b : bars) {
    out += "<text x=\"82\" y=\"" + fixed(y + 15) + "\" text-anchor=\"end\">" + std::string{b.name} +
           "</text><rect x=\"" + fixed(x(b.low)) + "\" y=\"" + fixed(y) + "\" width=\"" +
           fixed(std::max(1.0, x(b.high) - x(b.low))) + "\" height=\"18\" fill=\"#0072B2\"/>";
    y += 26;
  }
  out += "<path d=\"M" + fixed(x(s.base)) + ",0V" + fixed(y) + "\" stroke=\"#D55E00\" stroke-width=\"2\"/>";
  out += "<text x=\"90\" y=\"" + fixed(y + 18) + "\">" + display(from, 3) + "</text><text x=\"390\" y=\"" +
         fixed(y + 18) + "\" text-anchor=\"end\">" + display(to, 3) + "</text>";
  if (x(s.base) > 150 && x(s.base) < 330) {  // clear of the ends' figures
    out += "<text x=\"" + fixed(x(s.base)) + "\" y=\"" + fixed(y + 18) + "\" text-anchor=\"middle\">" +
           display(s.base, 3) + "</text>";
  }
  return out + "</svg>";
}

/// Where it is and what its figures are.
std::string facts_of(const Page& page, const stability::Judgement& j) {
  const KeyBlockRow row = key_block_row(*page.complex, page.result, j);
  std::string out = facts({{"location", "Where"}, {"clock", "Clock position"}, {"chainage_m"}}, row);
  out += fact("Centroid", vector_text(row.place.centroid) + " m");
  out += facts({{"volume_m3"},
                {"weight_n"},
                {"free_area_m2", {}, 3},
                {"depth_m", {}, 3},
                {"extent_m", "Largest extent", 3},
                {"sets", "Joint sets"}},
               row);
  if (!moves_only_in_group(j)) {
    out += fact("Driving force", display(j.driving.si() / 1000, 4) + " kN");
    out += fact("Resistance", display(j.resistance.si() / 1000, 4) + " kN");
  }
  out += facts({{"factor_of_safety", {}, 3}}, row);
  if (row.supported != nullptr) {
    out += facts({{"factor_with_support", "With support", 3}, {"target", {}, 3}, {"held_by"}},
                 SupportBlockRow{"", *row.supported});
    if (row.supported->missing_force > 0)
      out += facts({{"missing_force_n", "Missing"}}, SupportBlockRow{"", *row.supported});
  }
  if (row.group_supported) out += fact("Its group, with support", std::string{*row.group_supported});
  return detail::facts_table(out);
}

constexpr std::string_view basis =
    "Rigid block, limit equilibrium of its translation in the state after the batches before it; joints are flat. The "
    "inputs and limits of the whole report hold.";

constexpr std::size_t most_explained = 300;

}  // namespace

std::string why_section(const Page& page) {
  if (!page.result.analysis || page.complex == nullptr) return {};
  std::vector<const stability::Judgement*> keys = by_severity(*page.result.analysis);
  std::erase_if(keys, [](const stability::Judgement* j) { return !j->key; });
  if (keys.empty()) return {};
  std::string out =
      "<section id=\"why\"><h2>Why they move</h2>\n<p class=\"small\">Click a block. Forces in the plane of gravity "
      "and motion: W weight, Q other loads (water, earthquake, loads on free faces), N reactions of the joints "
      "numbered, R "
      "resistance, T driving force. Nets of the lower hemisphere: joints of the block blue, free surfaces dashed, "
      "poles "
      "of pressed joints and their friction circles orange, direction of motion a green cross.</p>\n";
  for (std::size_t i = 0; i < std::min(keys.size(), most_explained); ++i) {
    const stability::Judgement& j = *keys[i];
    const std::string number = std::to_string(j.block.value());
    out += "<details id=\"why-" + number + "\"><summary>Block " + number +
           (j.batch ? ", batch " + std::to_string(*j.batch) : "") + ": " +
           (moves_only_in_group(j) ? "in a group" : std::string{stability::name(j.mode)}) + ", factor " +
           display(j.factor_of_safety, 3) + ", " + display(page.complex->blocks()[j.block].volume.si(), 3) +
           " m³</summary>\n<p>" + sentence(page, j) + "</p>\n<div class=\"columns\">" + facts_of(page, j) +
           "<figure class=\"one-block\">" + block_picture(*page.complex, j) +
           "<figcaption>from the side of its free faces (grey); green: the way it moves</figcaption></figure></div>\n" +
           "<div class=\"columns three\">" +
           // Of forces between the blocks of a group none is shown.
           (moves_only_in_group(j) ? std::string{}
                                   : "<figure>" + force_arrows(page, j) + "<figcaption>forces</figcaption></figure>") +
           "<figure>" + block_net(page, j, Net::equal_area) + "<figcaption>equal area</figcaption></figure><figure>" +
           block_net(page, j, Net::equal_angle) + "<figcaption>equal angle</figcaption></figure></div>\n" +
           face_table(page, j);
    const auto row = std::ranges::find(page.result.sensitivity, j.block, &stability::Sensitivity::block);
    if (row != page.result.sensitivity.end()) {
      const std::string drawing = tornado(*row);
      if (!drawing.empty()) {
        out += "<figure class=\"half\">" + drawing + "<figcaption>Factor of safety when one input is " +
               display(100 * row->share, 2) + " % lower or higher (orange: as given).</figcaption></figure>\n";
      }
    }
    out += "<p class=\"small\">" + std::string{basis} + " <a class=\"to-sheet\" href=\"#sheet-" + number +
           "\">Sheet to print</a><a class=\"to-report\" href=\"#why-" + number + "\">Back to the report</a></p>\n";
    out += "</details>\n";
  }
  if (keys.size() > most_explained) {
    out += "<p class=\"note\">The first " + std::to_string(most_explained) + " of " + display_count(keys.size()) +
           " key blocks are explained here; all are in key_blocks.csv.</p>\n";
  }
  return out + "</section>\n";
}

}  // namespace cleave::report
