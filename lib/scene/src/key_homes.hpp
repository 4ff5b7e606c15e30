#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>

namespace cleave::scene {

/// Where keys stand that are often written into another table.
inline std::optional<std::string_view> home_of(std::string_view key) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 12> homes{
      {{"gravity", "[stability] (of bodies: [elastic] or [contact])"},
       {"seismic", "[stability]"},
       {"target", "[stability]"},
       {"free", "[stability]"},
       {"groups", "[stability]"},
       {"water", "[stability]"},
       {"friction", "[joints.NAME], or [joints.default]"},
       {"cohesion", "[joints.NAME], or [joints.default]"},
       {"tension", "[joints.NAME], or [joints.default]"},
       {"density", "[rock]"},
       {"young", "[rock]"},
       {"realizations", "[monte_carlo]"}}};
  const auto at = std::ranges::find(homes, key, &std::pair<std::string_view, std::string_view>::first);
  return at == homes.end() ? std::nullopt : std::optional{at->second};
}

}  // namespace cleave::scene
