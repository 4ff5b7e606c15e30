#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "cleave/realize/run_result.hpp"

namespace cleave::scene {

/// Where a block is.
struct BlockPlace {
  geometry::Vec3 centroid = {};  ///< m
  /// `location_of` at a tunnel; "slope" or "bench" of a cut; "face": any other free face; empty: there is none.
  std::string_view location = {};
  std::optional<double> chainage = {};  ///< m along the axis of the tunnel that it has most free area at
  /// Hours on the face of a clock, looking along the axis: 12 at the crown, 3 on the right; in (0, 12].
  std::optional<double> clock = {};
  Area free_area = {};
  Length depth = {};             ///< of its corners the one farthest from its free faces; 0 without a free face
  Length extent = {};            ///< between the two corners farthest apart
  std::vector<SetId> sets = {};  ///< of its joints, ascending
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

/// "roof", "floor", "left wall", "right wall" (looking along the axis): what lies to the right and up by so much.
[[nodiscard]] std::string_view location_of(double right, double up);

/// Hours on the face of a clock of what lies to the right and up by so much: in (0, 12].
[[nodiscard]] double clock_of(double right, double up);

/// Numbers of the joints that bound a block, ascending.
[[nodiscard]] std::vector<topology::JointId> joints_of(const topology::BlockComplex& complex, topology::BlockId block);

}  // namespace cleave::scene
