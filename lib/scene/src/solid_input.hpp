#pragma once

#include <optional>
#include <string_view>

#include "cleave/geometry/solid.hpp"
#include "context.hpp"

namespace cleave::scene {

/// box = { min = [..], max = [..] } of `owner`.
[[nodiscard]] std::optional<geometry::Solid> parse_box(const TableReader& owner);
/// corners = [8 points] of `owner`.
[[nodiscard]] std::optional<geometry::Solid> parse_corners(const TableReader& owner);
/// A closed surface in the file named under `key`: .stl .obj .ply .dxf .ts by its ending.
[[nodiscard]] std::optional<geometry::Solid> parse_mesh(Context& context, const TableReader& owner,
                                                        std::string_view key);

}  // namespace cleave::scene
