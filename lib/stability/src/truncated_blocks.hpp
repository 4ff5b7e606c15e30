#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "contacts.hpp"

namespace cleave::stability {

/// What a part of a block tells of the whole of it (blocks that a window cuts through; docs/decisions/0066).
///
/// Of such a block these are known: all its free faces and all faces that batches have opened, for no free face lies
/// outside the window; and some of its joint faces. Not known: its other joint faces, its volume, and which other parts
/// in the window belong to it. A joint between two parts may end outside, and hold nothing.
class TruncatedBlocks final {
 public:
  /// Outlives neither.
  explicit TruncatedBlocks(Model& model);

  /// Whether the block that `part` belongs to stays, with this factor of safety at least, whatever is not known of it.
  /// False says nothing.
  [[nodiscard]] bool stays(topology::BlockId part, std::uint32_t batch, double factor);

 private:
  using Parts = std::vector<topology::BlockId>;
  [[nodiscard]] bool stays(const Parts& same, const Parts& apart, std::uint32_t batch, double factor);
  [[nodiscard]] bool held(const Cone& cone, const Parts& same, const Parts& apart, std::uint32_t batch, double factor);
  [[nodiscard]] std::vector<Resultant> own_loads(const Parts& same, std::uint32_t batch);
  [[nodiscard]] const std::vector<std::pair<topology::BlockId, Resultant>>& exposed(std::uint32_t batch);

  Model* model_;
  bool only_weight_ = true;                    ///< what acts on a block has one direction, whatever its volume
  bool stated_water_ = false;                  ///< pressures in joints that are not known
  double least_tan_ = 0;                       ///< of all joints, partial factors applied
  std::vector<topology::BlockId> open_parts_;  ///< not whole, not fixed
  std::vector<std::pair<topology::BlockId, Resultant>> exposed_;
  std::uint32_t exposed_in_ = 0;  ///< the batch `exposed_` is of
  int budget_ = 0;
};

}  // namespace cleave::stability
