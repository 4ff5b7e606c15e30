#pragma once

#include "cleave/scene/keys.hpp"

/// Declarations of the tables of scenes of blocks; each stands beside the parser of its table.
namespace cleave::scene {

[[nodiscard]] const KeyTable& scene_keys();
[[nodiscard]] const KeyTable& domain_keys();
[[nodiscard]] const KeyTable& joint_keys();
[[nodiscard]] const KeyTable& joint_set_keys();
[[nodiscard]] const KeyTable& excavation_keys();
[[nodiscard]] const KeyTable& monte_carlo_keys();
[[nodiscard]] const KeyTable& sequence_keys();
[[nodiscard]] const KeyTable& micro_blocks_keys();
[[nodiscard]] const KeyTable& stability_keys();
[[nodiscard]] const KeyTable& load_keys();
[[nodiscard]] const KeyTable& support_keys();
[[nodiscard]] const KeyTable& strength_keys();  ///< [joints.NAME]
[[nodiscard]] const KeyTable& rock_keys();
[[nodiscard]] const KeyTable& field_stress_keys();
[[nodiscard]] const KeyTable& flow_keys();
[[nodiscard]] const KeyTable& mapped_keys();
[[nodiscard]] const KeyTable& motion_keys();
[[nodiscard]] const KeyTable& scanline_keys();

/// seismic, water, surcharge, point and line: of [stability] and of [[load]].
[[nodiscard]] std::vector<Key> load_set_keys();
/// min and max, of a box.
[[nodiscard]] const KeyTable& box_keys();

/// through, dip and dip_direction.
[[nodiscard]] const KeyTable& plane_keys();
/// A height grid or a mesh; of `terrain` with its base.
[[nodiscard]] const KeyTable& ground_keys();
[[nodiscard]] const KeyTable& terrain_keys();
/// What one kind of [[excavation]] takes.
[[nodiscard]] std::vector<Key> tunnel_keys();
[[nodiscard]] std::vector<Key> slope_keys();
[[nodiscard]] std::vector<Key> bench_keys();
/// The law of a size: a number, a law, or "persistent".
[[nodiscard]] KeyType size_type();
/// Keys of single models of [[joint_set]].
[[nodiscard]] std::vector<Key> model_keys();

/// A law of numbers that `Rule` accepts.
[[nodiscard]] KeyTable make_law_keys(const NumberRule& rule);
template <const NumberRule& Rule>
[[nodiscard]] const KeyTable& law_keys() {
  static const KeyTable keys = make_law_keys(Rule);
  return keys;
}
/// A number or a law.
template <const NumberRule& Rule>
[[nodiscard]] KeyType number_or_law() {
  return key::either({key::number(Rule), key::table(&law_keys<Rule>)});
}

}  // namespace cleave::scene
