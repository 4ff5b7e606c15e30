#pragma once

#include <string_view>

/// The one place where the version stands: the build reads it from here.
#define CLEAVE_VERSION "0.1.0"

namespace cleave {
inline constexpr std::string_view version = CLEAVE_VERSION;
}  // namespace cleave
