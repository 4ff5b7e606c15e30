#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/dfn/joint_set.hpp"
#include "context.hpp"

namespace cleave::scene {

/// What the joints of a [[joint_set]] may end at.
struct OtherSets {
  std::vector<std::string> drawn = {};                   ///< names of all [[joint_set]]s, in the order of the scene
  std::map<std::string, SetId, std::less<>> given = {};  ///< sets that hold given joints
  std::size_t own = 0;                                   ///< the one that is read
};

/// The model of a [[joint_set]] with its own keys; those of other models are wrong. In `terminates_at` a number below
/// `others.drawn.size()` is that of a [[joint_set]], one beyond it that of a set of given joints.
[[nodiscard]] std::optional<dfn::Model> parse_model(const TableReader& set, const OtherSets& others);

/// Keys of `orientation`, and the law they state; clockwise from the scene's y axis.
[[nodiscard]] const KeyTable& orientation_keys();
[[nodiscard]] std::optional<dfn::OrientationLaw> parse_orientation(Context& context, const TableReader& set);

/// Whether the joints are endless: `size = "persistent"`.
[[nodiscard]] bool is_persistent(const TableReader& set);
/// A law of sizes under `key`.
[[nodiscard]] std::optional<dfn::SizeLaw> parse_size(const TableReader& set, std::string_view key);

/// Reports sets that end at one another in a circle.
void refuse_circles(std::span<const TableReader> sets, const std::vector<RandomSet>& joint_sets);

}  // namespace cleave::scene
