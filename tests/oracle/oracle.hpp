#pragma once

/// The slow, independent block cutter: what the fast one is compared with. Shares no code with lib/.
///
/// Method: all planes of joints and solids cut the domain's box into convex cells with exact rational vertices; cells
/// are joined across every cell face that the joints do not cover wholly; what lies outside the domain or in an
/// excavation is dropped. A block is a set of cells; its boundary is walked from cell to cell.

#include <compare>
#include <cstdint>
#include <ostream>
#include <string>
#include <tuple>
#include <vector>

#include "arrangement.hpp"
#include "integer_scene.hpp"

namespace cleave::oracle {

struct OracleBlock {
  Rational volume;
  std::uint32_t vertices = 0, edges = 0, faces = 0, loops = 0, shells = 0, genus = 0;

  [[nodiscard]] auto counts() const { return std::tuple{vertices, edges, faces, loops, shells, genus}; }
  friend bool operator==(const OracleBlock& a, const OracleBlock& b) {
    return a.volume == b.volume && a.counts() == b.counts();
  }
  friend std::strong_ordering operator<=>(const OracleBlock& a, const OracleBlock& b) {
    const int volumes = a.volume.compare(b.volume);
    return volumes != 0 ? volumes <=> 0 : a.counts() <=> b.counts();
  }
};
[[nodiscard]] std::string describe(const OracleBlock& block);
inline std::ostream& operator<<(std::ostream& out, const OracleBlock& block) { return out << describe(block); }
[[nodiscard]] std::string describe(const std::vector<OracleBlock>& blocks);

/// Which coplanar neighbours on a block make one face.
enum class FaceRule : std::uint8_t {
  role,           ///< same role: joints on one plane are one facet set
  role_and_joint  ///< same role and same joint (the first in scene order where several overlap)
};

struct OracleOptions {
  FaceRule rule = FaceRule::role;
  /// Adds the planes through all polygon edges to the partition, so that no cell face is partly covered. Many more
  /// cells, same blocks: the oracle's check of itself.
  bool outlines_cut_cells = false;
};

/// Sorted by volume, then counts. Counts are those of theory: pieces with one block on both sides dropped, coplanar
/// pieces merged by the rule, collinear chains merged, an edge or vertex counted once a fan.
[[nodiscard]] std::vector<OracleBlock> oracle_blocks(const testing::IntegerScene& scene,
                                                     const OracleOptions& options = {});

}  // namespace cleave::oracle
