// The source's cells for initial stress, as a comparison: what they integrate over the domain is a boundary integral.

#include <gtest/gtest.h>

#include <functional>

#include "cleave/bem/kelvin.hpp"
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

/// The same without cells: integral of U sigma n over the boundary less that of U div sigma over the domain, which
/// here is zero.
Vec2 by_boundary(const std::vector<Vec2>& corners, Vec2 y, const std::function<Sym2(Vec2)>& stress) {
  Vec2 sum;
  constexpr int parts = 400;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const Vec2 side = corners[(c + 1) % corners.size()] - corners[c];
    const Vec2 n = turned_right(side) / norm(side);
    for (int p = 0; p < parts; ++p) {
      for (std::size_t i = 0; i < 8; ++i) {
        const Vec2 x = corners[c] + ((p + 0.5 * (1 + gauss_s[i])) / parts) * side;
        sum += (0.5 * gauss_w[i] * norm(side) / parts) * (kelvin_displacement(x - y, rock) * (stress(x) * n));
      }
    }
  }
  return sum;
}

TEST(InitialStress, CellsOfTheSourceGiveWhatTheBoundaryDoes) {
  const std::vector<Vec2> block{{0, 0}, {2, 0.2}, {1.7, 1.4}, {0.3, 1}};
  const auto uniform = [](Vec2) { return Sym2{-3, 0.7, -1}; };
  // Linear and without divergence: xx = 2x + y, xy = x - 2y, yy = 3x - y.
  const auto linear = [](Vec2 x) { return Sym2{2 * x.x + x.y, x.x - 2 * x.y, 3 * x.x - x.y}; };
  for (const Vec2 y : {Vec2{0.9, 0.6}, Vec2{1, 0.1}, Vec2{0.3, 1}}) {  // inside, on a side, at a corner
    for (const std::function<Sym2(Vec2)>& stress : {std::function<Sym2(Vec2)>{uniform}, {linear}}) {
      const Vec2 cells = by_cells(block, y, stress), boundary = by_boundary(block, y, stress);
      EXPECT_LT(norm(cells - boundary), 2e-4 * norm(boundary)) << y.x << " " << y.y;
    }
  }
}

}  // namespace
}  // namespace cleave::bem
