#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "element_rows.hpp"

/// Fields of given boundary values, on the boundary and inside.
namespace cleave::bem {

struct Nearest {
  std::size_t element = 0;
  double s = 0;
  double distance = 1e300;
};
[[nodiscard]] Nearest nearest(const Mesh& mesh, Vec2 x);

struct Gradient {
  Vec2 displacement;
  Mat2 gradient;  // u_i,j
  Sym2 stress;
};

/// Derivative along the boundary of displacement, per unit of length of the frame the mesh is in.
[[nodiscard]] Vec2 slope_along(const Mesh& mesh, const std::vector<Vec2>& u, std::size_t element, double s);

/// Displacement, its gradient and stress at a boundary point from fields without initial stress, in the given material.
[[nodiscard]] Gradient on_boundary(const Mesh& mesh, const std::vector<Vec2>& u,
                                   const std::vector<std::array<Vec2, 3>>& t, std::size_t element, double s, double mu,
                                   double nu);

/// The rules on the elements of a mesh, made once for all points inside.
class InsideRules final {
 public:
  InsideRules(Mesh mesh, const Medium& medium, double tolerance)
      : mesh_{std::move(mesh)}, integrator_{mesh_, medium, tolerance} {}
  InsideRules(const InsideRules&) = delete;
  InsideRules& operator=(const InsideRules&) = delete;
  ~InsideRules() = default;
  [[nodiscard]] const Integrator& integrator() const noexcept { return integrator_; }

 private:
  Mesh mesh_;
  Integrator integrator_;  // points to the mesh
};

/// Displacement at a point that is not on the boundary. `outer`: of a region that goes on to infinity.
[[nodiscard]] Vec2 displacement_inside(const Integrator& integrator, const std::vector<Vec2>& u,
                                       const std::vector<std::array<Vec2, 3>>& t, Vec2 y, const Nearest& near,
                                       bool outer);
/// Stress there. Closer than an element the linear field of the nearest boundary point is taken out first.
[[nodiscard]] Sym2 stress_inside(const Integrator& integrator, const std::vector<Vec2>& u,
                                 const std::vector<std::array<Vec2, 3>>& t, Vec2 y, const Nearest& near, bool outer);

}  // namespace cleave::bem
