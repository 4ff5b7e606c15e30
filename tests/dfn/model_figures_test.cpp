#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "networks.hpp"

// Counts, sizes and orientations of every network model by exact expectations at 4.5 standard errors over realizations
// (false alarm 7e-6 a figure; 27 figures here, 2e-4 in all). Seeds are fixed. P32 of the models: models_test.cpp.

namespace cleave::dfn {
namespace {

using namespace networks;

bool in_box(Vec3 p) {
  return p.x > box.min.x && p.y > box.min.y && p.z > box.min.z && p.x < box.max.x && p.y < box.max.y && p.z < box.max.z;
}
double area_of(const Polygon& polygon) {
  const auto c = polygon.corners();
  Vec3 sum{0, 0, 0};
  for (std::size_t i = 2; i < c.size(); ++i) sum += 0.5 * cross(c[i - 1] - c[0], c[i] - c[0]);
  return norm(sum);
}
Vec3 lowest(const Polygon& polygon) {
  return *std::ranges::min_element(polygon.corners(), {}, [](Vec3 p) { return p.z; });
}

using Older = std::span<const std::span<const SampledJoint>>;

/// Polygons per volume, counted by their lowest corners in the box (one a polygon, far from its ends at the border).
Mean density_of(const JointSet& set, std::uint64_t realizations, Older older = {}) {
  Mean number;
  for (std::uint64_t k = 0; k < realizations; ++k) {
    double inside = 0;
    for (const SampledJoint& joint : draws(set, 1, 17, k, older)) {
      inside += in_box(lowest(std::get<Polygon>(joint.shape))) ? 1 : 0;
    }
    number.add(inside / volume);
  }
  return number;
}

// Area in the box, weighted by the cosine to the mean normal: P32 times E cos of the orientation law, whatever the
// model does to the outlines.
TEST(ModelFiguresTest, OrientationsAreThoseOfTheLaw) {
  const FisherOrientation law{Dip::degrees(50), DipDirection::degrees(200), 6};
  const auto around = draws(set_of(Baecher{}, Persistent{}, P32{0.4}), 0, 9, 0);
  const std::vector<std::span<const SampledJoint>> sets{around};
  const auto expect = [&](const std::string& name, Model model, Shape shape, std::uint64_t realizations) {
    const JointSet set = set_of(std::move(model), std::move(shape), P32{0.5}, law);
    Mean excess;  // of sum area (cos - E cos): mean 0
    double area = 0;
    for (std::uint64_t k = 0; k < realizations; ++k) {
      double sum = 0;
      for (const SampledJoint& joint : draws(set, 1, 23, k, sets)) {
        const double inside = area_inside(std::get<Polygon>(joint.shape));
        sum += inside * (std::abs(dot(joint.normal, set.mean_normal())) - set.mean_cosine());
        area += inside;
      }
      excess.add(sum / volume);
    }
    EXPECT_NEAR(excess.mean, 0, 4.5 * excess.error() + 1e-4) << name;
    EXPECT_GT(area, 0) << name;
    EXPECT_LT(excess.error(), 0.02) << name;  // E cos = 0.83: a uniform law would be off by 0.17
  };
  expect("baecher", Baecher{}, Square{side(3)}, 60);
  expect("veneziano", Veneziano{0.5}, Square{side(3)}, 120);
  expect("dershowitz", Dershowitz{0.5}, Persistent{}, 120);
  expect("hierarchical", Hierarchical{{0}, {1, 1, 1}}, Persistent{}, 120);
  expect("mit", mit(0.5, true), Square{side(3)}, 120);
}

// Rows of rectangles on parallel planes, jittered by the law: normals about the mean with E cos of Fisher's law.
TEST(ModelFiguresTest, OrthogonalPlanesHaveTheirNormalsAndRectangles) {
  const FisherOrientation law{Dip::degrees(30), DipDirection::degrees(70), 400};
  const JointSet planes =
      set_of(Orthogonal{Orthogonal::Gaps::poisson, 0.5, {}}, Persistent{}, Spacing{metres(0.8)}, law);
  Mean cosine;
  for (std::uint64_t k = 0; k < 100; ++k) {
    for (const SampledJoint& joint : draws(planes, 1, 3, k)) cosine.add(dot(joint.normal, planes.mean_normal()));
  }
  EXPECT_MEAN(cosine, 1 / std::tanh(400.0) - 1 / 400.0);
  const UniformOrientation exact{Dip::degrees(30), DipDirection::degrees(70), Dip::degrees(0),
                                 DipDirection::degrees(0)};
  const JointSet rows = set_of(Orthogonal{Orthogonal::Gaps::poisson, 0.5, side(1)},
                               Rectangle{side(3), AspectRatio{1.5}}, P32{0.5}, exact);
  Mean number;
  int whole = 0;
  for (std::uint64_t k = 0; k < 150; ++k) {
    double inside = 0;
    for (const SampledJoint& joint : draws(rows, 1, 5, k)) {
      const auto& polygon = std::get<Polygon>(joint.shape);
      if (std::ranges::all_of(polygon.corners(), in_box)) {  // those beside the box are cut off there
        EXPECT_NEAR(area_of(polygon), 6, 5e-3);              // corners lie on a fine grid
        ++whole;
      }
      inside += in_box(lowest(polygon)) ? 1 : 0;
    }
    number.add(inside / volume);
  }
  EXPECT_MEAN(number, 0.5 / 6);
  EXPECT_GT(whole, 1000);
}

// Isotropic planes of area S per volume leave lines of length pi S/4 per area on each other: cells of mean area
// 16/(pi S^2), S of all planes, of which a share are joints.
TEST(ModelFiguresTest, DershowitzPolygonsHaveTheirNumberAndMeanArea) {
  const double share = 0.4, s = 0.36 / share;
  const Mean number = density_of(set_of(Dershowitz{share}, Persistent{}, P32{0.36}), 100);
  EXPECT_MEAN(number, share * s * pi * s * s / 16);
  EXPECT_LT(number.error(), 0.15 * number.mean);
}

TEST(ModelFiguresTest, HierarchicalPolygonsHaveTheirNumberAndMeanArea) {
  constexpr double older_s = 0.8;
  const JointSet set = set_of(Hierarchical{{0}, {1, 1, 1}}, Persistent{}, P32{0.3});
  const JointSet first = set_of(Baecher{}, Persistent{}, P32{older_s});
  Mean number;
  for (std::uint64_t k = 0; k < 150; ++k) {
    const auto older = draws(first, 0, 29, k);
    const std::vector<std::span<const SampledJoint>> sets{older};
    double inside = 0;
    for (const SampledJoint& joint : draws(set, 1, 31, k, sets)) {
      inside += in_box(lowest(std::get<Polygon>(joint.shape))) ? 1 : 0;
    }
    number.add(inside / volume);
  }
  EXPECT_MEAN(number, 0.3 * pi * older_s * older_s / 16);
}

TEST(ModelFiguresTest, MitPolygonsOfAnyShapeAreVenezianos) {
  EXPECT_MEAN(density_of(set_of(mit(1, true), Square{side(1.5)}, P32{0.5}), 100), 0.5 / 2.25);
}

// Poisson-Voronoi cells have 2 + 48 pi^2/35 = 15.54 faces (Meijering 1953), each shared by two.
TEST(ModelFiguresTest, MosaicHasItsNumberOfFaces) {
  Mean number;
  const JointSet set = set_of(Mosaic{Mosaic::Seeds::poisson, 0.5}, Persistent{}, Count{80});
  for (std::uint64_t k = 0; k < 60; ++k) {
    double inside = 0;
    for (const SampledJoint& joint : draws(set, 0, 37, k)) {
      Vec3 low{0, 0, 1e9};
      for (const Polygon& p : std::get<std::vector<Polygon>>(joint.shape)) {
        const Vec3 own = lowest(p);
        if (own.z < low.z) low = own;
      }
      inside += in_box(low) ? 1 : 0;
    }
    number.add(inside / volume);
  }
  EXPECT_MEAN(number, 0.5 * (80 / volume) * (2 + 48 * pi * pi / 35) / 2);
}

// A point of a joint at distance r from its centre is kept where none of the older planes it ends at parts the two:
// with probability exp(-p S r/2) for isotropic planes of area S per volume and terminations of probability p.
TEST(ModelFiguresTest, EnhancedBaecherKeepsItsAreaBetweenPlanes) {
  constexpr double s = 0.9, width = 3;
  // Older planes wherever a joint centred in the box can reach.
  const DomainBox wide{box.min - Vec3{3, 3, 3}, box.max + Vec3{3, 3, 3}};
  for (const double p : {0.4, 1.0}) {
    double expected = 0;
    constexpr int steps = 600;
    for (int i = 0; i < steps; ++i) {
      for (int j = 0; j < steps; ++j) {
        const double x = width * ((i + 0.5) / steps - 0.5), y = width * ((j + 0.5) / steps - 0.5);
        expected += std::exp(-p * s / 2 * std::hypot(x, y)) * width * width / steps / steps;
      }
    }
    const JointSet set = set_of(EnhancedBaecher{{0}, p}, Square{side(width)}, Count{40});
    const JointSet first = set_of(Baecher{}, Persistent{}, P32{s});
    Mean area;  // a realization shares its older planes: it is the sample unit
    for (std::uint64_t k = 0; k < 250; ++k) {
      const auto older = draws(first, 0, 41, k, {}, wide);
      const std::vector<std::span<const SampledJoint>> sets{older};
      double sum = 0;
      const auto joints = draws(set, 1, 43, k, sets);
      ASSERT_EQ(joints.size(), 40U);
      for (const SampledJoint& joint : joints) sum += area_of(std::get<Polygon>(joint.shape));
      area.add(sum / 40);
    }
    EXPECT_MEAN(area, expected);
    EXPECT_LT(area.error(), 0.03 * expected);
  }
}

// What is drawn in the region grown by the joints fills the box to its border: the outer tenth has the density of the
// whole. Joints with centres in the box alone would leave it a third too thin.
TEST(ModelFiguresTest, EdgeEffectsVanishWithTheGrownRegion) {
  const JointSet set = set_of(Baecher{}, Square{side(5)}, P32{0.4});
  const auto inner = [](const Polygon& polygon) {
    // The box without its outer part, by scaling the polygon about the middle.
    const Vec3 middle = (box.min + box.max) / 2;
    std::vector<Vec3> corners;
    for (const Vec3 c : polygon.corners()) corners.push_back(middle + (c - middle) / 0.8);
    return area_inside(*Polygon::make(std::move(corners))) * 0.64;
  };
  Mean border, without;
  const double outer = volume * (1 - 0.512);
  for (std::uint64_t k = 0; k < 200; ++k) {
    double all = 0, own = 0;
    for (const SampledJoint& joint : draws(set, 0, 47, k)) {
      const auto& polygon = std::get<Polygon>(joint.shape);
      const double part = area_inside(polygon) - inner(polygon);
      all += part;
      if (in_box(joint.centre)) own += part;
    }
    border.add(all / outer);
    without.add(own / outer);
  }
  EXPECT_MEAN(border, 0.4);
  EXPECT_LT(border.error(), 0.01);
  EXPECT_LT(without.mean, 0.75 * 0.4);
}

}  // namespace
}  // namespace cleave::dfn
