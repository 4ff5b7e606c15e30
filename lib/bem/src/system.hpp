#pragma once

#include <array>
#include <cstdint>
#include <expected>
#include <optional>
#include <vector>

#include "cleave/bem/statics.hpp"
#include "element_rows.hpp"

namespace cleave::bem {

/// A vector that is linear in the unknowns: constant + sum of direction * unknown.
struct Affine {
  struct Term {
    std::uint32_t column;
    Vec2 direction;
  };
  Vec2 constant;
  std::array<Term, 4> terms{};
  std::uint32_t count = 0;

  void add(std::uint32_t column, Vec2 direction) { terms[count++] = {column, direction}; }
};

/// A collocation point: the equation at it, projected on directions, goes into rows.
struct Equation {
  Vec2 y;
  struct Own {
    std::uint32_t element;
    double s;
  };
  std::vector<Own> own;
  std::vector<std::pair<std::uint32_t, double>> at_point;  ///< node and shape function value
  struct Row {
    std::uint32_t row;
    Vec2 direction;
  };
  std::vector<Row> rows;
};

/// Equations that share rows: one thread's work.
struct EquationGroup {
  std::uint32_t region;
  std::vector<Equation> equations;
};

struct ScaledRegion {
  Mesh mesh;
  Elastic elastic;  ///< mu over the scale's
  Particular particular;
  std::vector<Vec2> u_particular;                  ///< nodes
  std::vector<std::array<Vec2, 3>> t_particular;   ///< elements: traction of the particular stress, in balance with
                                                   ///< its point forces, less `t_forces`
  std::vector<std::array<Vec2, 3>> t_forces;       ///< elements: tractions that stand for point forces
  std::vector<std::uint32_t> global;               ///< node to shared node
  std::vector<std::array<std::uint32_t, 3>> slot;  ///< element to traction
  std::vector<std::array<double, 3>> slot_sign;
};

/// The discrete problem in scaled lengths and stresses, before any integral is done.
struct System {
  Extent extent = Extent::bounded;
  Vec2 origin;
  double scale = 1;
  double mu = 1;
  std::optional<double> surface;
  std::vector<ScaledRegion> regions;
  std::vector<Affine> displacement;  ///< of shared nodes
  std::vector<Affine> traction;      ///< of slots
  std::uint32_t columns = 0;
  std::uint32_t rows = 0;
  bool free_body = false;
  std::vector<EquationGroup> groups;
};

[[nodiscard]] std::expected<System, SolveError> make_system(const Problem& problem, const Options& options);

}  // namespace cleave::bem
