#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "cleave/geometry/solid.hpp"
#include "cleave/scene/keys.hpp"

namespace cleave::scene {

/// The tag of a face of the domain by its name; what is wrong is said of `key`.
[[nodiscard]] std::optional<std::uint32_t> face_named(const TableReader& table, std::string_view key,
                                                      const std::string& name, const geometry::Solid& domain);

}  // namespace cleave::scene
