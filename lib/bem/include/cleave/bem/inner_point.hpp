#pragma once

#include <vector>

#include "cleave/bem/block.hpp"

/// Points inside bodies that are followed by their block operator. Nothing of it is built or kept unless asked for.
namespace cleave::bem {

/// A material point: where it was in the first shape and where in the shape of the newest operator, body's frame.
struct InnerPoint {
  Vec2 reference;
  Vec2 at;
};

struct InnerState {
  Vec2 displacement;  ///< m
  Sym2 stress;        ///< Pa, body's frame, tension positive
};

/// Field of these freedoms at a point inside: static extension of the boundary's values (accurate up to the boundary,
/// as of `Solution::stress`) and the bubbles. O(elements) once the tractions are known, O(freedoms^2) for them.
[[nodiscard]] InnerState inner_state(const BlockOperator& block, const InnerPoint& point,
                                     const std::vector<double>& freedoms);

}  // namespace cleave::bem
