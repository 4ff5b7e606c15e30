#pragma once

/// Random assemblies of the plane, extruded: scenes of rock one metre thick with free sides to the south and north, so
/// that a vertical section of its blocks is the whole problem.

#include <cstdint>
#include <string>

namespace cleave::testing {

struct RandomSection {
  std::string family;
  std::string scene;  ///< TOML; asks for a vertical section through its middle
};
/// One of eight families: slabs behind toes, cut layers, walls, columns, slices, slopes and mounds cut by random lines,
/// slots between steep sides. A pure function of its numbers. Tangents of friction and cohesions are multiplied by
/// `strength`.
[[nodiscard]] RandomSection random_section(std::uint64_t seed, std::uint32_t trial, double strength = 1);

}  // namespace cleave::testing
