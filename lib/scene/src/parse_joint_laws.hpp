#pragma once

/// What a [[joint_set]] says of its joints one by one: orientation, shape, size, rotation; and how many there are.

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "cleave/dfn/joint_set.hpp"
#include "context.hpp"

namespace cleave::scene {

/// The words a key `distribution` may hold, and those that a later version will take.
[[nodiscard]] std::optional<std::size_t> distribution_of(const TableReader& table,
                                                         std::span<const std::string_view> now,
                                                         std::span<const std::string_view> later = {});
[[nodiscard]] std::optional<dfn::OrientationLaw> parse_orientation(Context& context, const TableReader& set);
[[nodiscard]] std::optional<dfn::SizeLaw> parse_size(const TableReader& set, std::string_view key);
[[nodiscard]] std::optional<dfn::RotationLaw> parse_rotation(const TableReader& set);
[[nodiscard]] std::optional<dfn::Intensity> parse_intensity(const TableReader& set);
[[nodiscard]] std::optional<dfn::Shape> parse_shape(const TableReader& set);

}  // namespace cleave::scene
