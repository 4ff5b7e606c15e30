#pragma once

#include <array>
#include <cstdint>

#include "detail/rational_point.hpp"

namespace cleave::topology::detail {

/// A ray by rationals: for pieces of surface that lie too close together for doubles.
class ExactRay final {
 public:
  /// From the part `share` of the way between two vertices.
  ExactRay(const Prepared& prepared, const Graph& graph, const Arrangement& arrangement, const Meet& a, const Meet& b,
           double share, std::array<std::int64_t, 3> direction);

  struct Hit {
    enum class Kind : std::uint8_t { missed, met, unclear } kind;  ///< unclear: it passes through the face's rim
    Rational at = 0;  ///< not negative, but where the ray lies in its plane
    bool from_positive = false;
  };
  [[nodiscard]] Hit shoot(Index face) const;

 private:
  [[nodiscard]] Hit::Kind inside(const PlaneFace& face, const RationalPoint& p) const;

  const Prepared& prepared_;
  const Graph& graph_;
  const Arrangement& arrangement_;
  RationalPoint from_;
  std::array<std::int64_t, 3> direction_;
};

}  // namespace cleave::topology::detail
