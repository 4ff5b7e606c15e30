#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string_view>
#include <vector>

#include "cleave/core/nearest.hpp"
#include "cleave/geometry/tunnel.hpp"
#include "cleave/scene3d/key_tables.hpp"
#include "context.hpp"

namespace cleave::scene {
namespace {

using std::string_view;

constexpr NumberRule stress_rule = NumberRule{-1e15, false, 1e15, false, " Pa"}.usually(5e4, 1e10);
constexpr NumberRule gradient_rule = NumberRule{-1e15, false, 1e15, false, " Pa/m"}.usually(1e3, 1e7);

std::array<double, 6> components(const TableReader& table, string_view key) {
  std::array<double, 6> out{};
  if (const auto values = table.numbers(key)) std::ranges::copy(*values, out.begin());
  return out;
}

double largest(const std::array<double, 6>& values) {
  double out = 0;
  for (const double v : values) out = std::max(out, std::abs(v));
  return out;
}

/// The tunnels that are named, or all straight ones, in the order of the excavations; what is wrong is said.
std::vector<std::uint32_t> parse_tunnels(const TableReader& table, const std::vector<Excavation>& excavations) {
  std::vector<string_view> tunnels;
  std::vector<std::uint32_t> straight;
  for (std::uint32_t i = 0; i < excavations.size(); ++i) {
    if (!excavations[i].tunnel) continue;
    tunnels.emplace_back(excavations[i].name);
    if (excavations[i].tunnel->axis.size() == 2) straight.push_back(i);
  }
  constexpr string_view one_section = "the stress is that of one section: it needs an axis of two points";
  if (!table.has("tunnel")) {
    if (straight.empty() && table.problems().all_read()) {
      table.error("tunnel", tunnels.empty() ? "there is no excavation of kind \"tunnel\"" : "is not straight",
                  tunnels.empty() ? "the stress is that around a tunnel's section: add one, or remove [field_stress]"
                                  : std::string{one_section});
    }
    return straight;
  }
  std::vector<std::string> names;
  if (std::holds_alternative<TomlArray>(table.find("tunnel")->node.value)) {
    names = table.texts("tunnel").value_or(std::vector<std::string>{});
  } else if (const auto name = table.text("tunnel")) {
    names.emplace_back(*name);
  }
  if (names.empty() && table.problems().errors() == 0) {
    table.error("tunnel", "names no tunnel", "name one, or leave the key out: then all straight ones are taken");
  }
  std::vector<std::uint32_t> chosen;
  for (const std::string& name : names) {
    const auto found =
        std::ranges::find_if(excavations, [&](const Excavation& e) { return e.tunnel.has_value() && e.name == name; });
    if (found == excavations.end()) {
      if (table.problems().is_unread(name)) continue;
      const auto guess = nearest(name, tunnels);
      table.error("tunnel", fmt::format("\"{}\" is no excavation of kind \"tunnel\"", name.substr(0, 60)),
                  guess             ? fmt::format("did you mean \"{}\"?", *guess)
                  : tunnels.empty() ? "the stress is that around a tunnel's section: add one, or remove [field_stress]"
                                    : "name one: tunnel = \"NAME\"");
    } else if (found->tunnel->axis.size() != 2) {
      table.error("tunnel", names.size() > 1 ? fmt::format("\"{}\" is not straight", name) : "is not straight",
                  std::string{one_section});
    } else {
      chosen.push_back(static_cast<std::uint32_t>(found - excavations.begin()));
    }
  }
  std::ranges::sort(chosen);
  if (const auto twice = std::ranges::adjacent_find(chosen); twice != chosen.end()) {
    table.error("tunnel", fmt::format("names \"{}\" twice", excavations[*twice].name), "name it once");
  }
  return chosen;
}

/// Stiffnesses belong to all sets that have joints (`used`) or to none.
void check_stiffness(const TableReader& table, const Context& context, const std::set<SetId>& used, bool ratio) {
  const auto stiff = [&](SetId set) { return context.sets[set].properties.stiffness.has_value(); };
  if (std::ranges::none_of(used, stiff)) return;
  for (const SetId set : used) {
    if (stiff(set)) continue;
    table.problems().error(table.line(), "joints." + context.sets[set].name + ".normal_stiffness",
                           "is missing, and other sets have it",
                           "[field_stress] needs normal_stiffness and shear_stiffness of every set, or of none");
  }
  if (ratio) {
    table.error("stiffness_ratio", "has no meaning beside normal_stiffness and shear_stiffness of [joints]",
                "remove one of them");
  }
}

/// A field that changes with depth, or ends at the surface, is one of a level tunnel below it.
void check_depth(const TableReader& table, const FieldStressSettings& settings, const TunnelLine& line) {
  const geometry::SectionFrame section = geometry::section_frames(line.axis, line.up).front();
  const geometry::Vec3 axis = section.along;
  const bool vertical_section =
      std::abs(axis.z) < 1e-9 && geometry::norm(geometry::cross(section.up, {0, 0, 1})) < 1e-9;
  const bool varies = largest(settings.gradient) > 0;
  if (!vertical_section && (varies || settings.surface)) {
    table.error(
        varies ? "gradient" : "surface", "needs a level tunnel with a vertical section",
        "the section of an inclined tunnel lies at many depths: give the stress at its middle, without this key");
  }
  // Shear along the axis that changes with depth is no field of a long tunnel.
  const auto along = [&](const std::array<double, 6>& s) {
    return geometry::Vec3{s[0] * axis.x + s[3] * axis.y + s[5] * axis.z, s[3] * axis.x + s[1] * axis.y + s[4] * axis.z,
                          s[5] * axis.x + s[4] * axis.y + s[2] * axis.z};
  };
  if (varies) {
    const geometry::Vec3 pull = along(settings.gradient);
    const geometry::Vec3 shear = pull - geometry::dot(pull, axis) * axis;
    if (geometry::norm(shear) > 1e-9 * largest(settings.gradient)) {
      table.error(
          "gradient", "makes the shear stress along the tunnel change with depth",
          "such a field is none of a long tunnel: turn the tunnel, or give the stress at its depth without gradient");
    }
  }
  if (settings.surface) {
    for (const auto& [u, v] : line.outline) {
      if (!(0.5 * (line.axis[0].z + line.axis[1].z) + v < *settings.surface)) {
        table.error("surface", "is not above the tunnel", "the tunnel must lie wholly below it");
        break;
      }
    }
  }
}

/// A vertical stress that does not grow downwards by the weight of the rock: a wrong sign, or another unit.
void note_gradient(const TableReader& table, double vertical, Density density) {
  const double weight = density.si() * 9.81;
  constexpr double usual = 1e3;  // what lies below it is noted as any number is
  if (std::abs(vertical) < usual || (vertical > 0.5 * weight && vertical < 2 * weight)) return;
  table.note("gradient",
             vertical < 0 ? fmt::format("has zz = {:.4g} Pa/m: the rock is pressed more the higher it lies", vertical)
                          : fmt::format("has zz = {:.4g} Pa/m, far from the weight of the rock", vertical),
             fmt::format("compression is negative and z points up: density * gravity is zz = {:.4g}", weight));
}

/// Rock that is pulled at the middle of a tunnel before it is there, though not at the level of `stress`.
void note_pull(const TableReader& table, const FieldStressSettings& settings, const Excavation& excavation) {
  const std::vector<geometry::Vec3>& axis = excavation.tunnel->axis;
  const double up = 0.5 * (axis[0].z + axis[1].z) - settings.level;
  const std::array<std::size_t, 3> normals{0, 1, 2};
  const auto pulls = [&](std::size_t i) { return settings.stress[i] + up * settings.gradient[i] > 0; };
  if (std::ranges::none_of(normals, pulls)) return;
  table.note("stress",
             fmt::format("pulls at the tunnel \"{}\", {:.4g} m above the level it is given at", excavation.name, up),
             "compression is negative here; turn the signs, or give the level of `stress`");
}

}  // namespace

const KeyTable& field_stress_keys() {
  static const KeyTable keys{
      .name = "field_stress",
      .keys = {
          {"tunnel", key::either({key::text(), key::texts()}), "all that are straight",
           "name of an excavation of kind tunnel with an axis of two points, or a list of names; each has a section of "
           "its own"},
          {"stress", key::array(key::number(stress_rule), 6, 6), required,
           "`[xx, yy, zz, xy, yz, zx]` of the undisturbed rock at `level`, Pa, compression negative"},
          {"gradient", key::array(key::number(gradient_rule), 6, 6), "0",
           "the same per metre upwards (weight of the rock: zz = density x gravity); level tunnels with a vertical "
           "section only"},
          {"level", key::number(rule::coordinate), "0", "z in m"},
          {"surface", key::number(rule::coordinate), "",
           "z of the free ground surface above (half plane); none: infinite rock"},
          {"stiffness_ratio", key::number({1e-3, false, 1e4, false, ""}), "",
           "normal over shear stiffness of all joints, from which forces follow as the block comes out; none: the "
           "stiffnesses of `[joints]`, or the least factor of the ratios 1, 10, 100 and 1000"},
          {"tolerance", key::number({1e-8, false, 0.1, false, ""}), "1e-3",
           "elements are doubled until displacements of the section change by less, relative; a note says when three "
           "doublings do not do"}}};
  return keys;
}

std::optional<FieldStressSettings> parse_field_stress(const TableReader& root, const Context& context,
                                                      const std::set<SetId>& used, const Rock& rock,
                                                      const std::vector<Excavation>& excavations) {
  const auto found = root.sub("field_stress");
  if (!found) return std::nullopt;
  const TableReader& table = *found;
  FieldStressSettings settings;
  settings.line = table.line();
  if (!table.has("stress")) {
    table.missing("stress", "write stress = [xx, yy, zz, xy, yz, zx] in Pa, compression negative");
  }
  settings.stress = components(table, "stress");
  const bool pulls = std::max({settings.stress[0], settings.stress[1], settings.stress[2]}) > 0;
  if (pulls) {
    table.note("stress", "pulls: normal stresses above 0 are tension", "compression is negative here; turn the signs");
  }
  settings.gradient = components(table, "gradient");
  note_gradient(table, settings.gradient[2], rock.mass.density());
  settings.level = table.value("level");
  settings.surface = table.number("surface");
  settings.stiffness_ratio = table.number("stiffness_ratio");
  settings.tolerance = table.value("tolerance");
  if (!rock.poisson) {
    root.problems().error(settings.line, "rock.poisson", "is missing",
                          "stress along the tunnel needs Poisson's ratio: give poisson in [rock], say 0.25");
  } else {
    settings.poisson = *rock.poisson;
  }
  check_stiffness(table, context, used, settings.stiffness_ratio.has_value());
  if (settings.surface) {
    const double up = *settings.surface - settings.level;
    double pull = 0;
    for (const std::size_t i : {2U, 4U, 5U}) {
      pull = std::max(pull, std::abs(settings.stress[i] + up * settings.gradient[i]));
    }
    if (pull > 1e-6 * std::max(largest(settings.stress), std::abs(up) * largest(settings.gradient))) {
      table.error("surface", fmt::format("carries a traction of {:.3g} Pa before anything is excavated", pull),
                  "zz, yz and zx must be 0 there: give a gradient such as zz = density * gravity");
    }
  }
  settings.tunnels = parse_tunnels(table, excavations);
  for (const std::uint32_t tunnel : settings.tunnels) {
    check_depth(table, settings, *excavations[tunnel].tunnel);
    if (!pulls) note_pull(table, settings, excavations[tunnel]);
  }
  return settings;
}

}  // namespace cleave::scene
