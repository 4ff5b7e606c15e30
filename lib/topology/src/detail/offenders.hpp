#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "cleave/topology/audit.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::topology::detail {

/// Of the patches between two blocks in one plane: their areas from the one side less those from the other, the sum of
/// all, and how many they are.
[[nodiscard]] inline bool unmatched(double area, double size, std::size_t patches) {
  return std::abs(area) > 1e-9 * size || patches < 2;
}
/// The blocks on both sides of contacts that are not matched.
[[nodiscard]] std::vector<BlockId> unpaired_blocks(const BlockComplex& complex);

/// The blocks at fault, each once, and the misfits, for a certificate that does not pass.
class Offenders final {
 public:
  explicit Offenders(std::size_t blocks) : blocks_{blocks} {}
  /// A number that no block has is left out.
  void add(BlockId block);
  void add(std::span<const Misfit> misfits);
  /// The first of each.
  void give(Certificate& certificate);

 private:
  std::size_t blocks_;
  std::vector<BlockId> offenders_;
  std::vector<Misfit> misfits_;
};

}  // namespace cleave::topology::detail
