#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "attitude_keys.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/io/joint_csv.hpp"
#include "context.hpp"
#include "joint_models.hpp"

/// The orientation law of a [[joint_set]].
namespace cleave::scene {
namespace {

using std::string_view;

constexpr NumberRule bingham_rule{-1e9, false, 0, false, ""};
constexpr NumberRule correlation_rule{-1, false, 1, false, ""};
constexpr std::array<string_view, 6> orientation_laws{"fisher",   "uniform",   "normal",
                                                      "constant", "bootstrap", "bingham"};

}  // namespace

const KeyTable& orientation_keys() {
  static const KeyTable keys = [] {
    KeyTable table{.name = "orientation", .keys = attitude_keys(false)};
    for (Key& key : std::vector<Key>{
             {"distribution", key::word(orientation_laws), "\"constant\"",
              "`\"fisher\"` with `kappa`; `\"uniform\"` with `dip_range`, `dip_direction_range`; `\"normal\"` with "
              "`dip_std`, `dip_direction_std`; `\"bingham\"` with `k1`, `k2`, `axis`; `\"constant\"`: all parallel; or "
              "`\"bootstrap\"` with `file`, `set` and `jitter`"},
             {"kappa",
              key::number(rule::kappa.usually(
                  2, 1e6, "the larger the closer together: 20 deviates by 18 degrees, 1 has next to no direction")),
              "", "concentration of the Fisher law"},
             {"dip_range", key::number(rule::dip), "", "degrees, plus or minus"},
             {"dip_direction_range", key::number(rule::half_turn), "", "degrees, plus or minus"},
             {"dip_std", key::number(rule::dip), "", "degrees"},
             {"dip_direction_std", key::number(rule::half_turn), "", "degrees"},
             {"correlation", key::number(correlation_rule), "0", "of dip and dip direction (`normal`)"},
             {"k1", key::number(bingham_rule), "",
              "of Bingham's law: the density goes with exp(k1 x^2 + k2 y^2), x and y the parts of a joint's normal "
              "along two axes in the mean plane"},
             {"k2", key::number(bingham_rule), "", "the same of the second axis; near 0: a girdle"},
             {"axis", key::number(rule::turn), "0",
              "degrees in the mean plane from its strike to the axis of `k1`, counter-clockwise seen from above"},
             {"file", key::text(), "", "a table of orientations, drawn with replacement"},
             {"set", key::text(), "", "only the rows of this set"},
             {"jitter", key::number(rule::kappa), "", "kappa of a Fisher rotation of each draw"}}) {
      table.keys.push_back(std::move(key));
    }
    return table;
  }();
  return keys;
}

namespace {

/// Normals of a table of orientations, drawn with replacement.
std::optional<dfn::OrientationLaw> parse_bootstrap(Context& context, const TableReader& table) {
  for (const string_view key : {"dip", "dip_direction", "trend", "plunge", "kappa", "dip_range", "dip_direction_range",
                                "dip_std", "dip_direction_std", "correlation", "k1", "k2", "axis"}) {
    if (table.has(key)) table.error(key, "has no meaning for the distribution \"bootstrap\"", "remove it");
  }
  const auto jitter = table.number("jitter");
  const auto only = table.text("set");
  if (!table.has("file")) {
    table.missing("file", "add file = \"poles.csv\" with columns dip and dip_direction");
    return std::nullopt;
  }
  const auto file = context.file(table, "file");
  if (!file) return std::nullopt;
  const auto joints = io::parse_joint_csv(file->bytes, file->shown, {.wrap = false, .need_position = false});
  if (!joints) {
    for (const io::ReadError& e : joints.error()) {
      context.problems.error_in(e.file, e.line.value_or(1), "file", e.what, e.remedy);
    }
    return std::nullopt;
  }
  std::vector<geometry::Vec3> normals;
  for (const io::JointRow& row : joints->rows) {
    if (only && row.set != *only) continue;
    normals.push_back(geometry::upward_normal({row.plane.dip, context.turned(row.plane.direction.degrees())}));
  }
  if (normals.empty()) {
    table.error("file", only ? fmt::format("holds no joint of the set \"{}\"", only->substr(0, 60)) : "holds no joints",
                "name a table with at least one row");
    return std::nullopt;
  }
  std::vector<double> weights(normals.size(), 1.0);
  return dfn::BootstrapOrientation::make(std::move(normals), std::move(weights), jitter);
}

}  // namespace

std::optional<dfn::OrientationLaw> parse_orientation(Context& context, const TableReader& set) {
  if (!set.has("orientation")) {
    set.missing("orientation",
                "add orientation = { dip = 30, dip_direction = 30, distribution = \"fisher\", kappa = 40 }");
    return std::nullopt;
  }
  const auto found = set.sub("orientation");
  if (!found) return std::nullopt;
  const TableReader& table = *found;
  if (const auto* word = table.find("distribution")) {
    const auto* text = std::get_if<std::string>(&word->node.value);
    if (text != nullptr && *text == "bootstrap") return parse_bootstrap(context, table);
  }
  for (const string_view key : {"file", "jitter", "set"}) {
    if (table.has(key)) {
      table.error(key, "has a meaning only for the distribution \"bootstrap\"",
                  "remove it, or set distribution = \"bootstrap\"");
    }
  }
  const auto mean = parse_attitude(context, table);
  const auto law = table.has("distribution") ? table.choice("distribution") : std::optional<std::size_t>{3};
  if (!law) return std::nullopt;

  constexpr std::array<std::pair<string_view, std::size_t>, 9> own{{{"kappa", 0},
                                                                    {"dip_range", 1},
                                                                    {"dip_direction_range", 1},
                                                                    {"dip_std", 2},
                                                                    {"dip_direction_std", 2},
                                                                    {"correlation", 2},
                                                                    {"k1", 5},
                                                                    {"k2", 5},
                                                                    {"axis", 5}}};
  for (const auto& [key, owner] : own) {
    if (owner == *law || !table.has(key)) continue;
    table.error(key, fmt::format("has no meaning for the distribution \"{}\"", orientation_laws[*law]),
                fmt::format("remove it, or set distribution = \"{}\"", orientation_laws[owner]));
  }
  static_assert(orientation_laws.size() == 6, "each law but the constant one has its case here");
  switch (*law) {
    case 0: {
      const auto kappa = table.need_number("kappa");
      if (!mean || !kappa) return std::nullopt;
      return dfn::FisherOrientation{mean->dip, mean->direction, *kappa};
    }
    case 1: {
      const auto a = table.need_number("dip_range");
      const auto b = table.need_number("dip_direction_range");
      if (!mean || !a || !b) return std::nullopt;
      return dfn::UniformOrientation{mean->dip, mean->direction, Dip::degrees(*a), DipDirection::degrees(*b)};
    }
    case 2: {
      const auto a = table.need_number("dip_std");
      const auto b = table.need_number("dip_direction_std");
      if (!mean || !a || !b) return std::nullopt;
      return dfn::NormalOrientation{mean->dip, mean->direction, Dip::degrees(*a), DipDirection::degrees(*b),
                                    table.value("correlation")};
    }
    case 5: {
      const auto k1 = table.need_number("k1"), k2 = table.need_number("k2");
      if (!mean || !k1 || !k2) return std::nullopt;
      return dfn::BinghamOrientation::make(mean->dip, mean->direction, *k1, *k2,
                                           dfn::Rotation::degrees(table.value("axis")));
    }
    default: break;
  }
  if (!mean) return std::nullopt;
  return dfn::UniformOrientation{mean->dip, mean->direction, Dip::degrees(0), DipDirection::degrees(0)};
}

}  // namespace cleave::scene
