#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "cleave/exact/fixed.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::topology::detail {

/// Measures of a block from the exact planes of the complex alone.
struct ExactBlock {
  double volume = 0;      ///< m3
  double reach = 0;       ///< sum over its faces of perimeter times distance from a common corner, m2
  bool all_exact = true;  ///< else some corner has no three planes in the complex and was taken as it is stored
  bool fits = true;       ///< every corner is stored where its planes meet, to the tolerance
};

/// Finds the planes through corners, and measures blocks with them: where doubles cannot judge. Several threads may ask
/// at once.
class ExactBlocks final {
 public:
  ExactBlocks(const BlockComplex& complex, double tolerance_m) noexcept
      : complex_{complex}, unit_{complex.report().lattice_pitch_m * 0x1p48}, tolerance_{tolerance_m} {}

  [[nodiscard]] ExactBlock measure(BlockId block) const;

 private:
  struct Corner {
    exact::FixedPoint at;
    bool exact;
    bool fits;
  };
  void find_planes() const;
  [[nodiscard]] std::span<const std::uint32_t> planes_of(VertexId vertex) const;
  [[nodiscard]] Corner corner(VertexId vertex) const;
  /// Three of the planes that meet in one point.
  [[nodiscard]] std::optional<exact::FixedPoint> meet(std::span<const std::uint32_t> planes) const;

  const BlockComplex& complex_;
  double unit_;  ///< m, 2^48 sites
  double tolerance_;
  mutable std::once_flag found_;
  mutable std::vector<std::uint32_t> begin_, planes_;  ///< planes of the faces at each vertex (CSR, each once)
};

}  // namespace cleave::topology::detail
