#pragma once

#include <array>
#include <cstddef>
#include <expected>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "cleave/bem/problem.hpp"

namespace cleave::bem {

/// A dense matrix by columns, for values that cross the module's border; the arithmetic happens inside.
struct DenseMatrix {
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::vector<double> values;

  [[nodiscard]] double operator()(std::size_t row, std::size_t column) const { return values[column * rows + row]; }
};

struct BlockOptions {
  MeshSize mesh;
  /// Gauss points of the outer integral on an element. 12: symmetric to 1e-7; 28: to rounding.
  std::size_t outer_points = 12;
  /// Inner motions: of body forces that are polynomials of degree below this.
  std::optional<std::size_t> bubbles = {};
  bool mass = true;  ///< false: stiffness only
  double integration = 1e-11;
  unsigned threads = 1;
};

struct BlockFailed {
  std::string check;  ///< which of the checks of a build did not hold
  double value;
};
struct BlockNeedsDensity {};
using BlockError = std::variant<OutlineError, BlockFailed, BlockNeedsDensity>;
[[nodiscard]] std::string describe(const BlockError& error);

/// Inner motions of a body of any shape: the answer of the plane to a polynomial body force, less the static extension
/// of its boundary values. They vanish on the boundary, their stress is in equilibrium with the force, and they take no
/// energy together with static extensions. Weight, spin and angular acceleration are among the forces, so their stress
/// is exact from degree 2 on.
struct Bubbles {
  struct Field {
    std::vector<double> force;                        ///< coefficients; field 2 k pushes along x, 2 k + 1 along y
    std::array<std::vector<double>, 2> displacement;  ///< shear modulus 1, lengths over `size`
    std::array<std::vector<double>, 4> slope;         ///< of component k along axis a at 2 k + a
  };
  struct Value {
    Vec2 displacement;
    Sym2 stress;  ///< Pa, for an amplitude of 1 m
  };
  std::vector<Field> fields;
  std::size_t degree = 0;  ///< of the forces: below this
  double size = 0;         ///< m
  /// Displacement of the nodes and element-wise traction (Pa) of the answers of the plane, rows as of the operator.
  DenseMatrix on_nodes, on_elements;
  [[nodiscard]] std::size_t count() const noexcept { return fields.size(); }
  /// The answers of the plane at a point of the body's frame.
  void evaluate(Vec2 at, const Material& material, std::vector<Value>& out) const;
  /// Of a field, times shear modulus over size^2: the force per area, along the field's axis.
  [[nodiscard]] double force(std::size_t field, Vec2 at) const;
};

/// Stiffness and mass of one elastic body in its own frame, symmetric by construction.
///
/// Stiffness: symmetric Galerkin boundary elements (Sirtori 1979; Bonnet, Maier and Polizzotto 1998), K = D + B^T V^-1
/// B with displacement continuous and traction broken between elements, then made exact on rigid motions, constant
/// strain and pure bending. Mass: of the static extension of the boundary displacement into the body, plus bubbles.
/// Eigenvalues are real and not negative, so every time step of every usual scheme is stable.
///
/// Freedoms: x, y of each boundary node, then the bubbles'. Frame: origin at the centroid, axes as given.
class BlockOperator final {
 public:
  /// Loops are checked (and turned) first. All of K R = 0, K U = F, the three zero eigenvalues, mass and inertia are
  /// verified before an operator is returned.
  [[nodiscard]] static std::expected<BlockOperator, BlockError> make(const std::vector<Loop>& loops,
                                                                     const Material& material,
                                                                     const BlockOptions& options);

  /// The operator of this body in the shape that `freedoms` give it: stiffness of the deformed outline, mass and
  /// bubbles of the material as they were, inertia of the new places. Same nodes and elements.
  [[nodiscard]] std::expected<BlockOperator, BlockError> deformed(const std::vector<double>& freedoms,
                                                                  const BlockOptions& options) const;

  [[nodiscard]] const Mesh& mesh() const noexcept { return mesh_; }  ///< metres, in the body's frame
  [[nodiscard]] Vec2 centroid() const noexcept { return centroid_; }
  [[nodiscard]] double mass() const noexcept { return mass_; }        ///< kg/m
  [[nodiscard]] double inertia() const noexcept { return inertia_; }  ///< kg m, about the centroid
  [[nodiscard]] double area() const noexcept { return area_; }
  [[nodiscard]] std::size_t freedoms() const noexcept { return stiffness_.rows; }
  [[nodiscard]] std::size_t boundary_freedoms() const noexcept { return 2 * mesh_.nodes.size(); }
  [[nodiscard]] const DenseMatrix& stiffness() const noexcept { return stiffness_; }
  [[nodiscard]] const DenseMatrix& mass_matrix() const noexcept { return mass_matrix_; }
  /// Element-wise traction (Pa) of the freedoms: rows element, local node, component.
  [[nodiscard]] const DenseMatrix& traction_of() const noexcept { return traction_of_; }
  [[nodiscard]] const Bubbles& bubbles() const noexcept { return bubbles_; }
  [[nodiscard]] const Material& material() const noexcept { return material_; }
  /// Nodal forces (N/m) of element-wise tractions (Pa).
  [[nodiscard]] std::vector<double> forces_of(const std::vector<std::array<Vec2, 3>>& tractions) const;
  /// Nodal forces of a uniform acceleration field a (loads density * a): M times the rigid translation.
  [[nodiscard]] std::vector<double> forces_of_acceleration(Vec2 a) const;
  /// Nearest boundary point to x (body frame).
  [[nodiscard]] BoundaryPlace place(Vec2 x) const;
  /// Nodal forces of a point force.
  void add_point_force(BoundaryPlace at, Vec2 force, std::vector<double>& forces) const;
  [[nodiscard]] Vec2 displacement_at(BoundaryPlace at, const std::vector<double>& freedoms) const;

 private:
  explicit BlockOperator(Material material) : material_{material} {}
  void set_tractions(const DenseMatrix& of_boundary);
  Mesh mesh_;
  Vec2 centroid_;
  double mass_ = 0, inertia_ = 0, area_ = 0;
  Material material_;
  DenseMatrix stiffness_, mass_matrix_, traction_of_;
  Bubbles bubbles_;
};

/// Natural vibrations: phi^T M phi = 1, eigenvalues ascending, rad^2/s^2.
struct Modes {
  std::vector<double> eigenvalues;
  DenseMatrix shapes;  ///< freedoms x modes
};

/// Elastic modes of the free body, the three rigid motions left out; the lowest `most` or all.
[[nodiscard]] Modes free_modes(const BlockOperator& block, std::optional<std::size_t> most = {});

/// One linear constraint: freedoms of a boundary node along a direction held.
struct HeldFreedom {
  std::size_t node;
  Vec2 direction;
};
/// Springs on nodes, N/m per metre.
struct NodeSpring {
  std::size_t node;
  Vec2 direction;
  double stiffness;
};
/// Modes of the supported body (some may be rigid and zero when supports leave motions free); empty `held` and
/// `springs`: with the three rigid modes in front.
[[nodiscard]] Modes supported_modes(const BlockOperator& block, const std::vector<HeldFreedom>& held,
                                    const std::vector<NodeSpring>& springs = {});

/// Static displacement under nodal forces with held freedoms; free bodies get the part without rigid motion.
[[nodiscard]] std::vector<double> static_displacement(const BlockOperator& block, const std::vector<HeldFreedom>& held,
                                                      const std::vector<double>& forces,
                                                      const std::vector<NodeSpring>& springs = {});

// ---- Stress on its boundary -----------------------------------------------------------------------------------------

// Stress on the boundary of bodies that are followed by their block operator (in motion, in contact).

/// Element-wise tractions (Pa) of the static extension of the boundary's displacements. O(freedoms^2).
[[nodiscard]] std::vector<std::array<Vec2, 3>> tractions_of(const BlockOperator& block,
                                                            const std::vector<double>& freedoms);

/// Stress (Pa, body frame, tension positive) at a place of the boundary: from these tractions, and from the strain of
/// the displacements along the side by Hooke's law.
[[nodiscard]] Sym2 boundary_stress(const BlockOperator& block, BoundaryPlace at, const std::vector<double>& freedoms,
                                   const std::vector<std::array<Vec2, 3>>& tractions);

}  // namespace cleave::bem
