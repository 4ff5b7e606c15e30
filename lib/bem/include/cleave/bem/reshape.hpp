#pragma once

#include <expected>
#include <vector>

#include "cleave/bem/block.hpp"

/// Bodies that deform so much that the operator of their first shape is no longer theirs.
namespace cleave::bem {

/// Largest change of the boundary's tangent, |du/ds| (no unit): stretch of the boundary and local turn against the
/// body's frame together. What says whether an operator is still good.
[[nodiscard]] double steepest(const BlockOperator& block, const std::vector<double>& freedoms);

/// The stress that a body carries from one shape to the next, without cells. Every build starts a linear step about the
/// deformed outline (updated Lagrangian description; Bathe 1996, section 6.2). At points of the boundary stress is kept
/// as Cauchy stress: it turns with the material (polar decomposition of the boundary's displacement gradient) and
/// grows by Hooke's law of the logarithmic strain since the last build. In the new shape it is represented by the
/// boundary displacement whose stress is closest to it (least squares), so that its nodal forces are K times that.
/// Exact for uniform stress; elsewhere an error of second order in the strain between two builds.
class CarriedStress final {
 public:
  explicit CarriedStress(const BlockOperator& block);

  /// Operator of the shape that `freedoms` (since `now` was built) give, with the stress taken over. Mass stays with
  /// the material: mass matrix and bubbles are those of the first build, so momentum is kept.
  [[nodiscard]] std::expected<BlockOperator, BlockError> advance(const BlockOperator& now,
                                                                 const std::vector<double>& freedoms,
                                                                 const BlockOptions& options);
  /// Freedoms whose linear field on the newest operator carries the stress of the newest shape.
  [[nodiscard]] const std::vector<double>& strained() const noexcept { return strained_; }

 private:
  std::vector<Sym2> stress_;  // points of the boundary, body's frame
  std::vector<double> strained_;
};

}  // namespace cleave::bem
