#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "body_keys.hpp"
#include "contact_parts.hpp"

/// Bolts of scenes of contact: keys, and the bars they are between the bodies on their line.
namespace cleave::scene {
namespace {

using bem::Vec2;
using std::string_view;

constexpr NumberRule bolt_force_rule = NumberRule{0, false, 1e12, false, " N"}.usually(1e3, 1e8);
constexpr NumberRule grip_rule = NumberRule{0, false, 1e12, false, " N/m"}.usually(1e3, 1e9);
constexpr NumberRule ductility_rule{0, false, 1e9, false, " m"};
/// Less is no length between its ends beside the size of bodies.
constexpr NumberRule stretch_rule{1e-3, false, 1e9, false, " m"};
constexpr NumberRule install_rule{0, false, 1e12, false, " s"};

/// Part of a bolt's line in one body, m from its head.
struct Stretch {
  double from, to;
  std::size_t body;
};

/// Where a line from `a` on, of length `length`, lies in a body.
void add_stretches(const ContactBody& body, std::size_t index, Vec2 a, Vec2 along, double length,
                   std::vector<Stretch>& out) {
  std::vector<double> cuts{0, length};
  const std::size_t n = body.corners.size();
  for (std::size_t k = 0; k < n; ++k) {
    const Vec2 from = body.corners[k] - a, side = body.corners[(k + 1) % n] - body.corners[k];
    const double turned = cross(along, side);
    if (std::abs(turned) <= 1e-12 * norm(side)) continue;
    const double here = cross(from, side) / turned, there = cross(from, along) / turned;
    if (here > 0 && here < length && there >= -1e-9 && there <= 1 + 1e-9) cuts.push_back(here);
  }
  std::ranges::sort(cuts);
  for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
    if (cuts[k + 1] - cuts[k] <= 1e-9 * length) continue;
    if (!holds(body, a + 0.5 * (cuts[k] + cuts[k + 1]) * along)) continue;
    if (!out.empty() && out.back().body == index && cuts[k] - out.back().to <= 1e-9 * length) {
      out.back().to = cuts[k + 1];
    } else {
      out.push_back({cuts[k], cuts[k + 1], index});
    }
  }
}

std::vector<Stretch> stretches_of(const std::vector<ContactBody>& bodies, const ContactBolt& bolt) {
  const double length = norm(bolt.toe - bolt.head);
  const Vec2 along = (bolt.toe - bolt.head) / length;
  std::vector<Stretch> out;
  for (std::size_t b = 0; b < bodies.size(); ++b) add_stretches(bodies[b], b, bolt.head, along, length, out);
  std::ranges::stable_sort(out, {}, &Stretch::from);
  return out;
}

/// What lies between the head and where the bar is gripped is passed through, whatever body it is.
std::vector<Stretch> gripped(std::vector<Stretch> all, const ContactBolt& bolt, double length) {
  if (all.empty()) return all;
  if (bolt.kind == BarKind::mechanical) return {all.front(), all.back()};
  const double free = bolt.free_length.si();
  std::vector<Stretch> out{all.front()};
  for (std::size_t k = 1; k < all.size(); ++k) {
    if (all[k].to > free) out.push_back({std::max(all[k].from, std::min(free, length)), all[k].to, all[k].body});
  }
  return out;
}

/// What one bolt carries across a joint `before` and `behind` which it is gripped so far, N.
double capacity_of(const ContactBolt& bolt, double before, double behind) {
  const double tendon = bolt.tendon.si();
  if (bolt.kind == BarKind::mechanical) return std::min({tendon, bolt.plate.si(), bolt.anchor.si()});
  return std::min({tendon, bolt.plate.si() + bolt.bond.si() * before, bolt.bond.si() * behind});
}

}  // namespace

std::vector<BoltBar> bars_of(const std::vector<ContactBody>& bodies, const ContactBolt& bolt) {
  const double length = norm(bolt.toe - bolt.head), free = bolt.free_length.si();
  const Vec2 along = (bolt.toe - bolt.head) / length;
  const std::vector<Stretch> parts = gripped(stretches_of(bodies, bolt), bolt, length);
  const double area = std::numbers::pi / 4 * bolt.diameter.si() * bolt.diameter.si();
  const double half = 0.5 * bolt.stretch.si(), spacing = bolt.spacing.si();
  std::vector<BoltBar> out;
  for (std::size_t k = 0; k + 1 < parts.size(); ++k) {
    const Stretch &a = parts[k], &b = parts[k + 1];
    if (a.body == b.body || (bodies[a.body].fixed && bodies[b.body].fixed)) continue;
    double from = std::max(a.from, a.to - half), to = std::min(b.to, b.from + half);
    if (bolt.kind == BarKind::mechanical) {
      from = 0;
      to = length - bolt.anchorage.si();
    } else if (k == 0 && free > 0) {
      from = 0;  // from the plate on
    }
    const double before = std::max(0.0, a.to - free), behind = length - std::max(b.from, free);
    const double capacity = capacity_of(bolt, before, behind);
    BoltBar bar;
    bar.first = a.body;
    bar.second = b.body;
    bar.at_first = bolt.head + from * along;
    bar.at_second = bolt.head + to * along;
    bar.stiffness = Stress::from_si(bolt.young.si() * area / (to - from) / spacing);
    bar.capacity = ForcePerLength::from_si(capacity / spacing);
    out.push_back(bar);
  }
  return out;
}

const KeyTable& contact_bolt_keys() {
  static const KeyTable keys{
      .name = "contact bolt",
      .keys = {
          {"name", key::text(), "`bolt N`", "in the results"},
          {"head", key::pair(rule::coordinate), required, "`[x, y]` in m, of the plate, at the start"},
          {"toe", key::pair(rule::coordinate), required, "`[x, y]` in m, likewise; it holds the bodies on the line"},
          {"spacing", key::number(rule::length), "1", "m between two such bolts, out of the plane"},
          {"tendon_capacity", key::number(bolt_force_rule), required, "N, of one bolt"},
          {"plate_capacity", key::number(bolt_force_rule), "0", "N, 0 = none"},
          {"kind", key::word<BarKind>(), "\"grouted\"",
           "`grouted` over its length; `friction` (split set, Swellex); `cable`; `mechanical`: held at its end over "
           "`anchorage`, free up to the plate"},
          {"bond_strength", key::number(grip_rule), "", "N/m of gripped length; needed but for mechanical"},
          {"anchor_capacity", key::number(bolt_force_rule), "", "N, of mechanical"},
          {"free_length", key::number(rule::length_or_zero), "0", "m from the head that grips nothing, of cables"},
          {"anchorage", key::number(rule::length), "", "m of the anchor at the end, of mechanical"},
          {"diameter", key::number(NumberRule{1e-4, false, 10, false, " m"}.usually(0.005, 0.2)), "0.025",
           "m, of the steel"},
          {"young", key::number(young_rule), "200e9", "Pa, of the steel"},
          {"stretch", key::number(stretch_rule), "0.5",
           "m of a gripped bar that lengthen where a joint opens, half on either side of it"},
          {"ductility", key::number(ductility_rule), "0",
           "m that it lengthens at its capacity before it breaks; 0: it breaks there"},
          {"pretension", key::number(bolt_force_rule), "0", "N, when it is installed"},
          {"installed", key::number(install_rule), "0", "s, when it is there"}}};
  return keys;
}

namespace {

/// Keys that mean nothing for a kind, and those it needs.
void check_kind(const TableReader& table, const ContactBolt& bolt) {
  const bool end = bolt.kind == BarKind::mechanical;
  const auto misused = [&](string_view key, bool has_meaning) {
    if (table.has(key) && !has_meaning) {
      table.error(key, fmt::format("has no meaning for kind = \"{}\"", enum_name(bolt.kind)), "remove this key");
    }
  };
  misused("bond_strength", !end);
  misused("stretch", !end);
  misused("anchor_capacity", end);
  misused("anchorage", end);
  misused("free_length", bolt.kind == BarKind::cable);
  if (!end && !table.has("bond_strength")) table.missing("bond_strength", "write what a metre of it grips, N/m");
  if (end && !table.has("anchor_capacity")) table.missing("anchor_capacity", "write what its anchor holds, N");
  if (end && !table.has("anchorage")) table.missing("anchorage", "write the length of its anchor, m");
  if (end && !table.has("plate_capacity")) table.missing("plate_capacity", "write what its plate holds, N");
}

/// What its line says about it.
void check_line(const TableReader& table, const std::vector<ContactBody>& bodies, const ContactBolt& bolt) {
  const double length = norm(bolt.toe - bolt.head);
  const std::vector<Stretch> on_line = length > 0 ? stretches_of(bodies, bolt) : std::vector<Stretch>{};
  const auto no_body = [&](string_view key) {
    table.error(key, "lies in no body", "move the end into one, or onto it");
  };
  if (on_line.empty() || on_line.front().from > 1e-6 * length) return no_body("head");
  if (on_line.back().to < length * (1 - 1e-6)) return no_body("toe");
  if (bolt.kind == BarKind::mechanical && length - bolt.anchorage.si() < on_line.back().from) {
    table.error("anchorage", "is longer than the bolt lies in the body at its toe",
                "make the bolt longer, or this less");
    return;
  }
  if (bolt.free_length.si() >= length) {
    table.error("free_length", "is as long as the bolt", "make the bolt longer, or this less");
    return;
  }
  const std::vector<BoltBar> bars = bars_of(bodies, bolt);
  if (bars.empty()) {
    table.error("toe", "lies in the body of the head, or both are fixed: the bolt holds nothing together",
                "let it cross a joint of a body that moves");
    return;
  }
  const double spacing = bolt.spacing.si();
  double least = std::numeric_limits<double>::infinity();
  for (const BoltBar& bar : bars) least = std::min(least, bar.capacity.si() * spacing);
  if (!(least > 0)) {
    table.error("plate_capacity", "leaves a joint that the bolt crosses with no capacity at all",
                "give it a plate, or grip on both sides of each joint");
  } else if (bolt.pretension.si() > least) {
    table.error("pretension", fmt::format("is more than its capacity of {:.6g} N", least), "make it less");
  }
}

}  // namespace

void parse_bolts(const TableReader& root, ContactScene& scene) {
  for (const TableReader& table : root.each("bolt")) {
    ContactBolt bolt;
    bolt.line = table.line();
    bolt.name = table.text("name").value_or(fmt::format("bolt {}", scene.bolts.size() + 1));
    if (std::ranges::find(scene.bolts, bolt.name, &ContactBolt::name) != scene.bolts.end()) {
      table.error("name", fmt::format("\"{}\" is the name of another bolt, too", bolt.name),
                  "give each bolt a name of its own");
    }
    for (const string_view key : {"head", "toe"}) {
      if (!table.has(key)) table.missing(key, fmt::format("write where it is: {} = [x, y]", key));
    }
    const auto head = pair(table, "head"), toe = pair(table, "toe");
    bolt.kind = table.word<BarKind>("kind");
    bolt.spacing = Length::from_si(table.value("spacing"));
    bolt.tendon = Force::from_si(table.need_number("tendon_capacity").value_or(1));
    bolt.plate = Force::from_si(table.value("plate_capacity"));
    bolt.bond = ForcePerLength::from_si(table.number("bond_strength").value_or(0));
    bolt.anchor = Force::from_si(table.number("anchor_capacity").value_or(0));
    bolt.free_length = Length::from_si(table.value("free_length"));
    bolt.anchorage = Length::from_si(table.number("anchorage").value_or(0));
    bolt.diameter = Length::from_si(table.value("diameter"));
    bolt.young = Stress::from_si(table.value("young"));
    bolt.stretch = Length::from_si(table.value("stretch"));
    bolt.ductility = Length::from_si(table.value("ductility"));
    bolt.pretension = Force::from_si(table.value("pretension"));
    bolt.installed = Time::from_si(table.value("installed"));
    check_kind(table, bolt);
    if (scene.settings.to_rest && bolt.installed > Time{}) {
      table.error("installed", "is later, but static = true knows no time", "remove it, or static = true");
    }
    if (!head || !toe || table.problems().errors() != 0) continue;
    bolt.head = *head;
    bolt.toe = *toe;
    check_line(table, scene.bodies, bolt);
    scene.bolts.push_back(std::move(bolt));
  }
}

std::vector<dbem::Tie> ties_of(const ContactScene& scene) {
  std::vector<dbem::Tie> out;
  for (const ContactBolt& bolt : scene.bolts) {
    for (const BoltBar& bar : bars_of(scene.bodies, bolt)) {
      out.push_back({.name = bolt.name,
                     .first = bar.first,
                     .second = bar.second,
                     .at_first = bar.at_first - scene.bodies[bar.first].corners.front(),
                     .at_second = bar.at_second - scene.bodies[bar.second].corners.front(),
                     .stiffness = bar.stiffness,
                     .capacity = bar.capacity,
                     .ductility = bolt.ductility,
                     .pretension = ForcePerLength::from_si(bolt.pretension.si() / bolt.spacing.si()),
                     .installed = bolt.installed});
    }
  }
  return out;
}

std::optional<BoltSwing> fastest_swing(const ContactScene& scene, const dbem::World& world) {
  const auto inverse_mass = [&](std::size_t body) { return scene.bodies[body].fixed ? 0 : 1 / world.mass(body); };
  std::optional<BoltSwing> out;
  for (const dbem::Tie& tie : ties_of(scene)) {
    const double inverse = inverse_mass(tie.first) + inverse_mass(tie.second);
    if (!(inverse > 0) || !(tie.stiffness.si() > 0)) continue;
    const double period = 2 * std::numbers::pi / std::sqrt(tie.stiffness.si() * inverse);
    if (!out || period < out->period) out = BoltSwing{tie.name, period};
  }
  return out;
}

}  // namespace cleave::scene
