#include "cleave/exact/plane.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace cleave::exact {
namespace {

TEST(Lattice, PitchIsAPowerOfTwoThatResolvesTheHalfExtentTo46Bits) {
  for (const double half : {1e-3, 0.5, 1.0, 1.5, 40.0, 1e6, 3.7e11}) {
    const Lattice lattice = Lattice::covering({-half, -half / 2, 0}, {half, half / 2, half});
    int exponent = 0;
    EXPECT_EQ(std::frexp(lattice.pitch(), &exponent), 0.5);
    EXPECT_LE(half / lattice.pitch(), 0x1p46);
    EXPECT_GE(half / lattice.pitch(), 0x1p45);
  }
}

TEST(Lattice, KeepsTheSymmetryOfTheScene) {
  const Lattice lattice = Lattice::covering({-40, -40, -30}, {40, 40, 30});
  EXPECT_EQ(lattice.origin(), (std::array<double, 3>{0, 0, 0}));
  for (const double x : {0.1, 1.0 / 3, 39.99999, 1e-11}) {
    const LatticePoint a = lattice.snap(x, -x, 2 * x / 3), b = lattice.snap(-x, x, -2 * x / 3);
    EXPECT_EQ(a.x, -b.x);
    EXPECT_EQ(a.y, -b.y);
    EXPECT_EQ(a.z, -b.z);
  }
}

TEST(Lattice, SnapsToTheNearestSiteTiesToEven) {
  const Lattice lattice = Lattice::covering({-1, -1, -1}, {1, 1, 1});
  const double h = lattice.pitch();
  EXPECT_EQ(lattice.snap(0.4 * h, 0.6 * h, -0.4 * h), (LatticePoint{0, 1, 0}));
  EXPECT_EQ(lattice.snap(0.5 * h, 1.5 * h, 2.5 * h), (LatticePoint{0, 2, 2}));
}

TEST(Lattice, IsExactFarFromTheOrigin) {
  // National grid coordinates: differences of doubles there are kept exactly.
  const std::array<double, 3> lo{455'000.125, 6'780'000.5, 120.0}, hi{455'080.125, 6'780'080.5, 180.0};
  const Lattice lattice = Lattice::covering(lo, hi);
  for (double x = lo[0]; x <= hi[0]; x += 0.37) {
    const double y = lo[1] + (x - lo[0]), z = lo[2] + 0.7 * (x - lo[0]);
    const LatticePoint p = lattice.snap(x, y, z);
    const auto position = lattice.position(p);
    EXPECT_EQ(position[0], x);
    EXPECT_EQ(position[1], y);
    EXPECT_NEAR(position[2], z, lattice.pitch());
    EXPECT_EQ(lattice.relative(p)[0], x - lattice.origin()[0]);
  }
}

TEST(Lattice, NeighbouringDoublesAtGridCoordinatesStayApart) {
  const double x = 6'780'000.5, next = std::nextafter(x, 1e9);
  const Lattice lattice = Lattice::covering({x - 40, 0, 0}, {x + 40, 80, 60});
  EXPECT_NE(lattice.snap(x, 0, 0), lattice.snap(next, 0, 0));
}

TEST(Lattice, OfASinglePoint) {
  const Lattice lattice = Lattice::covering({7, 8, 9}, {7, 8, 9});
  EXPECT_EQ(lattice.position(lattice.snap(7, 8, 9)), (std::array<double, 3>{7, 8, 9}));
}

}  // namespace
}  // namespace cleave::exact
