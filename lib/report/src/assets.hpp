#pragma once

#include <span>
#include <string_view>

/// Files embedded at build time: embed.cmake writes the sources.
namespace cleave::report::assets {

/// In pieces: compilers limit the length of one literal.
[[nodiscard]] std::span<const std::string_view> three();
[[nodiscard]] std::span<const std::string_view> orbit_controls();
[[nodiscard]] std::span<const std::string_view> style();
[[nodiscard]] std::span<const std::string_view> tables();
[[nodiscard]] std::span<const std::string_view> blocks3d();
[[nodiscard]] std::span<const std::string_view> caps3d();
[[nodiscard]] std::span<const std::string_view> camera3d();
[[nodiscard]] std::span<const std::string_view> pick3d();
[[nodiscard]] std::span<const std::string_view> view();
[[nodiscard]] std::span<const std::string_view> panel();
[[nodiscard]] std::span<const std::string_view> chart2d();
[[nodiscard]] std::span<const std::string_view> contact();
[[nodiscard]] std::span<const std::string_view> bodies();
[[nodiscard]] std::span<const std::string_view> scene2d();

}  // namespace cleave::report::assets
