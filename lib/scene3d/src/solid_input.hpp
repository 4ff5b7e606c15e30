#pragma once

#include <optional>
#include <string_view>

#include "cleave/geometry/solid.hpp"
#include "context.hpp"

namespace cleave::scene {

/// box = { min = [..], max = [..] } of `owner`.
[[nodiscard]] std::optional<geometry::Solid> parse_box(const TableReader& owner);
/// corners = [8 points] of `owner`.
[[nodiscard]] std::optional<geometry::Solid> parse_corners(const Context& context, const TableReader& owner);
/// A closed surface in the file named under `key`: .stl .obj .ply .dxf .ts by its ending.
[[nodiscard]] std::optional<geometry::Solid> parse_mesh(Context& context, const TableReader& owner,
                                                        std::string_view key);

/// terrain = { file = "..", base = .. } of `owner`: the body below a ground surface.
[[nodiscard]] std::optional<geometry::Solid> parse_terrain(Context& context, const TableReader& owner);
/// All above a plane, a profile or a surface.
[[nodiscard]] std::optional<geometry::Solid> parse_slope(Context& context, const TableReader& slope,
                                                         const geometry::Solid& domain);
/// One solid a bench, the room above the first one before them where the domain reaches higher.
[[nodiscard]] std::optional<std::vector<geometry::Solid>> parse_benches(const TableReader& table,
                                                                        const geometry::Solid& domain);

}  // namespace cleave::scene
