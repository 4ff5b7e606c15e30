#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "cleave/scene/keys.hpp"

namespace cleave::cli {

/// What `cleave init KIND` prints, with what the declarations of its keys say.
struct InitText {
  std::string_view kind, text;
  const scene::KeyTable& (*keys)();  ///< null: no TOML
};
[[nodiscard]] std::vector<InitText> init_texts();
/// Those that show one thing.
[[nodiscard]] std::span<const InitText> special_init_texts() noexcept;
/// Surveys, with the tables that they read.
[[nodiscard]] std::span<const InitText> survey_init_texts() noexcept;

}  // namespace cleave::cli
