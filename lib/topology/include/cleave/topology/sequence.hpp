#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <memory>
#include <optional>
#include <vector>

#include "cleave/core/id.hpp"
#include "cleave/facets/cut_input.hpp"
#include "cleave/topology/block_complex.hpp"
#include "cleave/topology/cut.hpp"

namespace cleave::topology {

/// A smallest part of the scene: what all joints and the surfaces of all excavations, done or not, leave connected.
using CellId = Id<struct CellTag>;

/// How far the work has come: which excavations are out, and which cells have left by themselves.
struct WorkState {
  std::vector<std::uint8_t> excavated;  ///< one a CutInput::excavations; 0: still rock
  std::vector<CellId> fallen = {};      ///< parts of blocks that have fallen; their room is void
};

/// The blocks of one state of the work.
struct StageBlocks {
  BlockComplex complex;
  std::vector<std::optional<BlockId>> block_of_cell;  ///< by cell; none where there is no rock
};

/// A scene cut once with the surfaces of all its excavations; the blocks of any state of the work follow without
/// cutting again. A surface of an excavation that is not yet out parts nothing: the rock on its two sides is one block
/// unless a joint lies on it (role "construction" of the theory). So the blocks are those that `cut` finds with the
/// excavations done so far, and the same cells tell which block of a later state was part of which earlier one.
///
/// Faces on the room of fallen cells are free and have no excavation and no tag.
class SequentialCut final {
 public:
  [[nodiscard]] static std::expected<SequentialCut, CutError> make(CutInput input, const CutOptions& options = {});
  SequentialCut(SequentialCut&&) noexcept;
  SequentialCut& operator=(SequentialCut&&) noexcept;
  SequentialCut(const SequentialCut&) = delete;
  SequentialCut& operator=(const SequentialCut&) = delete;
  ~SequentialCut();

  [[nodiscard]] std::size_t cells() const noexcept;
  /// DomainSwallowed when no rock is left. `excavated` has as many entries as there are excavations.
  [[nodiscard]] std::expected<StageBlocks, CutError> blocks(const WorkState& state) const;

 private:
  struct Parts;
  explicit SequentialCut(std::unique_ptr<const Parts> parts);
  std::unique_ptr<const Parts> parts_;
};

}  // namespace cleave::topology
