#pragma once

#include <optional>
#include <string_view>

namespace cleave::cli {

/// The scene that `cleave init KIND` prints; empty for other kinds.
[[nodiscard]] std::optional<std::string_view> init_text(std::string_view kind) noexcept;

/// Those that show one thing: support, survey, bench, csv, water, motion.
[[nodiscard]] std::optional<std::string_view> special_init_text(std::string_view kind) noexcept;

}  // namespace cleave::cli
