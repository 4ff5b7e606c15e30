#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "cleave/scene/nearest.hpp"
#include "cleave/scene3d/key_tables.hpp"
#include "context.hpp"

namespace cleave::scene {
namespace {

using std::string_view;

constexpr NumberRule stress_rule{-1e15, false, 1e15, false, " Pa"};
constexpr NumberRule gradient_rule{-1e15, false, 1e15, false, " Pa/m"};

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

}  // namespace

const KeyTable& field_stress_keys() {
  static const KeyTable keys{
      .name = "field_stress",
      .keys = {
          {"tunnel", key::text(), "the only one", "name of an excavation of kind tunnel with an axis of two points"},
          {"stress", key::array(key::number(stress_rule), 6, 6), required,
           "`[xx, yy, zz, xy, yz, zx]` of the undisturbed rock at `level`, Pa, compression negative"},
          {"gradient", key::array(key::number(gradient_rule), 6, 6), "0",
           "the same per metre upwards (weight of the rock: zz = density x gravity); level tunnels with a vertical "
           "section only"},
          {"level", key::number(rule::coordinate), "0", "z in m"},
          {"surface", key::number(rule::coordinate), "",
           "z of the free ground surface above (half plane); none: infinite rock"},
          {"stiffness_ratio", key::number({1e-3, false, 1e4, false, ""}), "",
           "normal over shear stiffness of the joints, from which forces follow as the block comes out; none: the "
           "least factor of the ratios 1, 10, 100 and 1000"},
          {"tolerance", key::number({1e-8, false, 0.1, false, ""}), "1e-3",
           "elements are doubled until displacements of the section change by less, relative; a note says when three "
           "doublings do not do"}}};
  return keys;
}

std::optional<FieldStressSettings> parse_field_stress(const TableReader& root, const Rock& rock,
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
  settings.gradient = components(table, "gradient");
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
  if (root.has("monte_carlo")) {
    table.error("stress", "is part of single runs only: ensembles judge blocks without it",
                "remove [field_stress] or [monte_carlo]");
  }

  std::vector<string_view> tunnels;
  for (const Excavation& e : excavations) {
    if (e.tunnel) tunnels.emplace_back(e.name);
  }
  const auto name = table.text("tunnel");
  const Excavation* tunnel = nullptr;
  for (std::uint32_t i = 0; i < excavations.size() && tunnel == nullptr; ++i) {
    if (!excavations[i].tunnel || (name && excavations[i].name != *name)) continue;
    tunnel = &excavations[i];
    settings.excavation = i;
  }
  if (tunnel == nullptr || (!name && tunnels.size() > 1)) {
    const auto guess = name ? nearest(*name, tunnels) : std::nullopt;
    table.error("tunnel",
                name              ? fmt::format("\"{}\" is no excavation of kind \"tunnel\"", name->substr(0, 60))
                : tunnels.empty() ? "there is no excavation of kind \"tunnel\""
                                  : fmt::format("is missing, and there are {} tunnels", tunnels.size()),
                guess             ? fmt::format("did you mean \"{}\"?", *guess)
                : tunnels.empty() ? "the stress is that around a tunnel's section: add one, or remove [field_stress]"
                                  : "name one: tunnel = \"NAME\"");
    return std::nullopt;
  }
  const TunnelLine& line = *tunnel->tunnel;
  if (line.axis.size() != 2) {
    table.error("tunnel", "is not straight", "the stress is that of one section: it needs an axis of two points");
    return settings;
  }
  const geometry::Vec3 axis = geometry::normalized(line.axis[1] - line.axis[0]);
  const bool vertical_section = std::abs(axis.z) < 1e-9 && geometry::norm(geometry::cross(line.up, {0, 0, 1})) < 1e-9;
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
    const double up = *settings.surface - settings.level;
    double pull = 0;
    for (const std::size_t i : {2U, 4U, 5U}) {
      pull = std::max(pull, std::abs(settings.stress[i] + up * settings.gradient[i]));
    }
    if (pull > 1e-6 * std::max(largest(settings.stress), std::abs(up) * largest(settings.gradient))) {
      table.error("surface", fmt::format("carries a traction of {:.3g} Pa before anything is excavated", pull),
                  "zz, yz and zx must be 0 there: give a gradient such as zz = density * gravity");
    }
    for (const auto& [u, v] : line.outline) {
      if (!(0.5 * (line.axis[0].z + line.axis[1].z) + v < *settings.surface)) {
        table.error("surface", "is not above the tunnel", "the tunnel must lie wholly below it");
        break;
      }
    }
  }
  return settings;
}

}  // namespace cleave::scene
