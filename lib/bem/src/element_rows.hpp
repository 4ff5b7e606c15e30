#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "cleave/bem/problem.hpp"
#include "half_plane.hpp"
#include "kelvin.hpp"

namespace cleave::bem {

/// The medium whose fundamental solution is used.
struct Medium {
  Elastic elastic;
  std::optional<HalfPlane> surface = {};
};

/// Integrals over one element seen from one point: g of U N_a, h of T N_a (of T (N_a - N_a(y)) on the source's own).
struct ElementIntegrals {
  std::array<Mat2, 3> g;
  std::array<Mat2, 3> h;
};

/// A quadrature rule on an element for a source off it.
struct LocalPoint {
  double s;
  double w;
};

/// Integrals with an error target, from the exact place of the kernels' poles in the complex local coordinate: the
/// number of Gauss points follows from the Bernstein ellipse through the nearest one; when 20 are not enough the
/// interval is halved (Trefethen 2013, chapter 19).
class Integrator final {
 public:
  Integrator(const Mesh& mesh, Medium medium, double tolerance);

  /// `own`: local coordinate of the source when it lies on the element.
  void integrate(std::size_t element, Vec2 source, std::optional<double> own, ElementIntegrals& out) const;
  static constexpr std::size_t lanes = 4;
  /// The same from several sources at once, side by side in vector registers where all are off the element and far
  /// enough for a tabulated rule (that of the closest): twice as fast a point.
  void integrate(std::size_t element, const std::array<Vec2, lanes>& sources,
                 const std::array<std::optional<double>, lanes>& own, std::array<ElementIntegrals, lanes>& out) const;
  /// Rule on the element for any kernel of the source; `sharper` asks for a smaller error than the tolerance.
  void points_for(std::size_t element, Vec2 source, double sharper, std::vector<LocalPoint>& out) const;
  /// Integral of [-ln r delta_ij + g_i g_j] dN_a/ds ds (the integrated-by-parts hypersingular kernel).
  void log_slopes(std::size_t element, Vec2 source, std::optional<double> own, std::array<Mat2, 3>& out) const;
  /// Gauss points that `integrate` takes for a source off the element.
  [[nodiscard]] std::size_t points_of(std::size_t element, Vec2 source) const;
  [[nodiscard]] const Mesh& mesh() const noexcept { return *mesh_; }
  [[nodiscard]] const Medium& medium() const noexcept { return medium_; }

 private:
  struct TablePoint {
    Vec2 x;
    Vec2 n;    // outward normal times Jacobian and weight
    double w;  // Jacobian times weight
  };
  static constexpr std::array<std::size_t, 10> orders{3, 4, 5, 6, 8, 10, 12, 14, 16, 20};
  static constexpr std::size_t table_size = 98;  // sum of the orders

  // Index into orders, or their size.
  [[nodiscard]] std::size_t order_at(const Element& e, Vec2 source) const;
  [[nodiscard]] std::size_t order_by_distance(const Element& e, double distance2) const;  // from the middle
  void add_far(const Element& e, std::span<const TablePoint> points, std::span<const std::array<double, 3>> shapes,
               Vec2 source, ElementIntegrals& out) const;
  void add_far(std::span<const TablePoint> points, std::span<const std::array<double, 3>> shapes,
               const std::array<Vec2, lanes>& sources, std::array<ElementIntegrals, lanes>& out) const;
  void add_near(const Element& e, Vec2 source, ElementIntegrals& out) const;
  void own_straight(const Element& e, double s0, ElementIntegrals& out) const;
  void own_curved(const Element& e, double s0, ElementIntegrals& out) const;
  void add_surface(const Element& e, Vec2 source, std::optional<double> own, ElementIntegrals& out) const;

  const Mesh* mesh_;
  Medium medium_;
  double log_tolerance_;                     // ln(1/tolerance)
  std::array<double, 10> reach_straight_{};  // smallest |z|^2 at which orders[k] suffices, real-axis worst case
  std::array<double, 10> reach_curved_{};
  std::vector<TablePoint> table_;              // order by order, then element by element
  std::vector<std::array<double, 3>> shapes_;  // of the table's points
};

}  // namespace cleave::bem
