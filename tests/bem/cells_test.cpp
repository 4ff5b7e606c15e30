// The cells of Fu (2014) for initial stress, as a comparison: what they integrate over the domain is a boundary
// integral.

#include <gtest/gtest.h>

#include <functional>

#include "initial_stress.hpp"
#include "kelvin.hpp"
#include "shapes.hpp"

namespace cleave::bem {
namespace {

constexpr Elastic rock{1, 0.3};

constexpr std::array<double, 8> gauss_s{-0.960289856497536, -0.796666477413627, -0.525532409916329, -0.183434642495650,
                                        0.183434642495650,  0.525532409916329,  0.796666477413627,  0.960289856497536};
constexpr std::array<double, 8> gauss_w{0.101228536290376, 0.222381034453374, 0.313706645877887, 0.362683783378362,
                                        0.362683783378362, 0.313706645877887, 0.222381034453374, 0.101228536290376};

/// Row i of dU_ij/dx_k sigma_jk: the strain of the fundamental solution times a stress.
Vec2 strain_times(Vec2 d, Sym2 s) {
  constexpr double h = 1e-5;
  const double step = h * norm(d);
  const auto row = [&](Vec2 along) {
    return (1 / (2 * step)) *
           (kelvin_displacement(d + step * along, rock) - kelvin_displacement(d - step * along, rock));
  };
  const Mat2 x = row({1, 0}), y = row({0, 1});
  return {x.xx * s.xx + (x.xy + y.xx) * s.xy + y.xy * s.yy, x.yx * s.xx + (x.yy + y.yx) * s.xy + y.yy * s.yy};
}

/// Cells: triangles from the source to each side of a polygon, with Duffy's coordinates (Duffy 1982).
Vec2 by_cells(const std::vector<Vec2>& corners, Vec2 y, const std::function<Sym2(Vec2)>& stress) {
  Vec2 sum;
  constexpr int parts = 12;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    for (int p = 0; p < parts; ++p) {
      const Vec2 side = corners[(c + 1) % corners.size()] - corners[c];
      const Vec2 a = corners[c] + (static_cast<double>(p) / parts) * side, b = a + (1.0 / parts) * side;
      const double area = cross(a - y, b - y);
      for (std::size_t i = 0; i < 8; ++i) {
        for (std::size_t j = 0; j < 8; ++j) {
          const double u = 0.5 * (1 + gauss_s[i]), v = 0.5 * (1 + gauss_s[j]);
          const Vec2 d = u * ((1 - v) * (a - y) + v * (b - y));
          sum += (0.25 * gauss_w[i] * gauss_w[j] * area * u) * strain_times(d, stress(y + d));
        }
      }
    }
  }
  return sum;
}

TEST(InitialStress, CellsOfTheSourceGiveWhatTheBoundaryDoes) {
  const std::vector<Vec2> block{{0, 0}, {2, 0.2}, {1.7, 1.4}, {0.3, 1}};
  const Mesh mesh = make_mesh({polygon(block, 0, 2)}, {});
  const auto uniform = [](Vec2) { return Sym2{-3, 0.7, -1}; };
  // Linear and without divergence: xx = 2x + y, xy = x - 2y, yy = 3x - y.
  const auto linear = [](Vec2 x) { return Sym2{2 * x.x + x.y, x.x - 2 * x.y, 3 * x.x - x.y}; };
  for (const Vec2 y : {Vec2{0.9, 0.6}, Vec2{1, 0.1}, Vec2{0.3, 1}}) {  // inside, on a side, at a corner
    for (const std::function<Sym2(Vec2)>& stress : {std::function<Sym2(Vec2)>{uniform}, {linear}}) {
      // Cells by hand with differences of the kernel, the library's cells, and the library without cells.
      const Vec2 by_hand = by_cells(block, y, stress);
      const Vec2 boundary = initial_stress_by_boundary(mesh, y, rock, stress, 1e-13);
      EXPECT_LT(norm(by_hand - boundary), 2e-4 * norm(boundary)) << y.x << " " << y.y;
      EXPECT_LT(norm(initial_stress_by_cells(mesh, y, rock, stress, 12) - boundary), 1e-10 * norm(boundary))
          << y.x << " " << y.y;
    }
  }
}

TEST(InitialStress, CellsHoldAlsoWhatHasADivergence) {
  // xx = x only: divergence (1, 0), so that B = integral of U sigma n less integral of U e_x over the body. The latter
  // by the fundamental solution's own potential: a uniform body force b has the particular stress -(b.x) I, whose B
  // without divergence is known: take xx = x + x, yy = x (divergence (2, 0) = that of 2 x I) against 2 x I itself.
  const std::vector<Vec2> block{{0, 0}, {2, 0.2}, {1.7, 1.4}, {0.3, 1}};
  const Mesh mesh = make_mesh({polygon(block, 0, 4)}, {});
  const auto some = [](Vec2 x) { return Sym2{2 * x.x, 0.3, x.x}; };
  const auto pressure = [](Vec2 x) { return Sym2{2 * x.x, 0, 2 * x.x}; };
  const auto difference = [](Vec2 x) { return Sym2{0, 0.3, -x.x}; };  // without divergence
  for (const Vec2 y : {Vec2{0.9, 0.6}, Vec2{1, 0.1}, Vec2{2, 0.2}}) {
    const Vec2 all = initial_stress_by_cells(mesh, y, rock, some, 12);
    const Vec2 parts = initial_stress_by_cells(mesh, y, rock, pressure, 12) +
                       initial_stress_by_boundary(mesh, y, rock, difference, 1e-13);
    EXPECT_LT(norm(all - parts), 1e-10 * norm(all));
    // Without cells that stress is not the same: what is missing is the integral of its divergence.
    EXPECT_GT(norm(all - initial_stress_by_boundary(mesh, y, rock, some, 1e-13)), 1e-2 * norm(all));
  }
}

TEST(InitialStress, CurvedOutlines) {
  const Mesh mesh = make_mesh({circle({0, 0}, 1, false, 0, 8), circle({0.2, 0}, 0.3, true, 0, 6)}, {});
  const auto uniform = [](Vec2) { return Sym2{-3, 0.7, -1}; };
  for (const Vec2 y : {Vec2{-0.5, 0.1}, mesh.nodes[0].x, mesh.nodes[3].x}) {
    const Vec2 cells = initial_stress_by_cells(mesh, y, rock, uniform, 14);
    // sigma n on curved elements is no polynomial: the boundary's own interpolation is what differs.
    EXPECT_LT(norm(cells - initial_stress_by_boundary(mesh, y, rock, uniform, 1e-13)), 2e-3 * norm(cells));
  }
}

}  // namespace
}  // namespace cleave::bem
