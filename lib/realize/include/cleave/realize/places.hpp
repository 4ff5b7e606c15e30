#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "cleave/geometry/orientation.hpp"
#include "cleave/geometry/tunnel.hpp"
#include "cleave/realize/run_result.hpp"
#include "cleave/stochastic/record.hpp"

namespace cleave::scene {

/// Where a block's free faces are.
struct OpenPlace {
  /// `location_of` at a tunnel or a shaft; elsewhere "slope" or "bench" of a cut, "crest" with level ground above such
  /// a face, "floor" or "ground" (of the domain) where it is level, "roof" where it overhangs; "face": any other free
  /// face; empty: there is none.
  std::string_view location = {};
  std::optional<double> chainage = {};  ///< m along the axis of the tunnel that it has most free area at
  /// Hours on the face of a clock, looking along the axis: 12 at the crown, 3 on the right; in (0, 12].
  std::optional<double> clock = {};
  Area free_area = {};
};
[[nodiscard]] OpenPlace open_place_of(const Scene& scene, const topology::BlockComplex& complex,
                                      topology::BlockId block);
/// Each free face that a block comes out through, by itself; of a block that comes out through none, each that it has.
[[nodiscard]] std::vector<OpenPlace> pressed_places(const Scene& scene, const topology::BlockComplex& complex,
                                                    const stability::SupportedBlock& block);
[[nodiscard]] std::vector<OpenPlace> pressed_places(const RunResult& result, const topology::BlockComplex& complex,
                                                    const stability::SupportedBlock& block);
/// Each face on a wall of an excavation, by itself.
[[nodiscard]] std::vector<OpenPlace> walls_of_openings(const RunResult& result, const topology::BlockComplex& complex);

/// Roof, walls and floor of tunnels and shafts; all other faces are one part. Empty where no face is free.
[[nodiscard]] std::optional<stochastic::Part> part_of(const OpenPlace& place);

/// Where a block is.
struct BlockPlace : OpenPlace {
  geometry::Vec3 centroid = {};      ///< m
  std::optional<Length> depth = {};  ///< `Depth`; empty without a free face
  Length extent = {};                ///< between the two corners farthest apart
  std::vector<SetId> sets = {};      ///< of its joints, ascending
};
/// `joints`: of the block, see `joints_of`.
[[nodiscard]] BlockPlace place_of(const RunResult& result, const topology::BlockComplex& complex,
                                  topology::BlockId block, const std::vector<topology::JointId>& joints);

/// Where a group of blocks is.
struct GroupPlace {
  geometry::Vec3 centroid = {};    ///< m, of all its blocks by volume
  std::string_view location = {};  ///< with chainage and clock: of its block with most free area; empty: none has any
  std::optional<Length> chainage = {};
  std::optional<double> clock = {};  ///< hours
  Area free_area = {};               ///< sum
  std::vector<SetId> sets = {};      ///< of the joints of its blocks, ascending
};
[[nodiscard]] GroupPlace place_of(const RunResult& result, const topology::BlockComplex& complex,
                                  const std::vector<topology::BlockId>& group);

/// Whether an axis plunges so steeply (70 degrees or more) that what it carries is a shaft.
[[nodiscard]] bool at_shaft(const geometry::SectionFrame& section);
/// What lies this way from the axis: "roof", "floor", "left wall", "right wall", looking along it; at a shaft "north
/// wall", "east wall", "south wall", "west wall".
[[nodiscard]] std::string_view location_of(const geometry::SectionFrame& section, geometry::Vec3 away,
                                           geometry::North north = geometry::North::degrees(0));
/// The same in eighths: "roof", "upper right", "right", ...; "north", "northeast", ...
[[nodiscard]] std::string_view position_of(const geometry::SectionFrame& section, geometry::Vec3 away,
                                           geometry::North north = geometry::North::degrees(0));
/// Hours on the face of a clock: in (0, 12], 12 in the direction of the section's `up`, 3 on the right.
[[nodiscard]] double clock_of(const geometry::SectionFrame& section, geometry::Vec3 away);

/// All that `location` may say, in the order of tables.
[[nodiscard]] std::span<const std::string_view> all_locations();

/// Numbers of the joints that bound a block, ascending.
[[nodiscard]] std::vector<topology::JointId> joints_of(const topology::BlockComplex& complex, topology::BlockId block);

}  // namespace cleave::scene
