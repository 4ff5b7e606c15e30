#pragma once

#include <string>
#include <string_view>

#include "cleave/scene/keys.hpp"

namespace cleave::cli {

/// A scene with what the declarations say of its keys as comments: of each key once, where it has no comment yet.
[[nodiscard]] std::string annotated(std::string_view scene, const scene::KeyTable& keys);

}  // namespace cleave::cli
