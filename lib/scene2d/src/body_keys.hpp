#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/bem/problem.hpp"
#include "cleave/core/sha256.hpp"
#include "cleave/scene/common_keys.hpp"
#include "cleave/scene/table_reader.hpp"
#include "cleave/scene/time_course_keys.hpp"
#include "cleave/scene2d/bodies.hpp"

/// What scenes of bodies and scenes of contact read alike.
namespace cleave::scene {

inline constexpr NumberRule poisson_rule{-1, true, 0.5, true, ""};
inline constexpr NumberRule young_rule = NumberRule{0, true, 1e15, false, " Pa"}.usually(1e5, 1e13);
inline constexpr NumberRule pressure_rule{-1e18, false, 1e18, false, " Pa"};
inline constexpr NumberRule force_per_metre_rule{-1e18, false, 1e18, false, " N/m"};
inline constexpr NumberRule speed_rule{-1e18, false, 1e18, false, " m/s"};
inline constexpr NumberRule angular_velocity_rule{-1e18, false, 1e18, false, " rad/s"};
inline constexpr NumberRule body_density_rule{0, false, 1e5, false, " kg/m3"};

inline constexpr std::array<std::string_view, 1> all_sides{"all"};

[[nodiscard]] const KeyTable& elastic_keys();
/// side and sides of a support or load.
[[nodiscard]] std::vector<Key> side_keys();
/// What a load is.
[[nodiscard]] std::vector<Key> body_load_keys();
/// name, points and body of a history.
[[nodiscard]] std::vector<Key> history_keys();
/// schema, title, project, seed, rock and output.
[[nodiscard]] std::vector<Key> head_keys();
/// young, poisson and density of a body.
[[nodiscard]] std::vector<Key> material_keys();

/// [x, y]; empty when wrong (reported).
[[nodiscard]] std::optional<bem::Vec2> pair_of(const TableReader& table, const TomlNode& node, const std::string& path,
                                               const NumberRule& rule);
/// The same of a key; empty when absent (no report) or wrong (reported).
[[nodiscard]] std::optional<bem::Vec2> pair(const TableReader& table, std::string_view key);
/// [[x, y], [x, y], ...], at least two.
[[nodiscard]] std::optional<std::vector<bem::Vec2>> corners_of(const TableReader& table, const TomlNode& node,
                                                               const std::string& path);

/// Stress before loading: `{ stress, level, gradient }`.
[[nodiscard]] const KeyTable& in_situ_keys();
[[nodiscard]] bem::InSitu parse_in_situ(const TableReader& table);

/// [rock] of a scene in two dimensions.
struct RockDefaults {
  std::optional<double> young, poisson;
  double density = 2700;
  bool young_given = false, poisson_given = false;  ///< rightly or wrongly (then reported there)
  bool of_rock = true;                              ///< sizes unlike those of rock are noted
};
/// With a note on a density that is unusual by `density`.
[[nodiscard]] RockDefaults parse_rock_defaults(const TableReader& root, const NumberRule& density = body_density_rule);

/// Keys schema, title, seed and [output], and where the scene comes from.
template <class PlaneScene>
void parse_plane_head(const TableReader& root, std::string_view text, const std::string& shown, PlaneScene& scene) {
  scene.shown = shown;
  scene.file_name = file_name_of(shown);
  scene.sha256 = sha256_hex(text);
  if (const auto schema = root.integer("schema"); root.has("schema") && !schema) {
    root.note("schema", "is not a version that this program knows", "write schema = 1");
  }
  scene.title = root.text("title").value_or(scene.file_name);
  scene.project = parse_project(root);
  scene.seed = static_cast<std::uint64_t>(root.count("seed"));
  scene.output = parse_output(root);
}

}  // namespace cleave::scene
