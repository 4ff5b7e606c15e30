#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "complexes.hpp"

// Rock thinner than doubles can measure passes its certificate, with the right volumes: needles between planes close
// together, plates and shells as domains, surfaces that nearly coincide.

namespace cleave::testing::thin_test {
namespace {

constexpr double unit_of_float = 0x1p-32;

/// Numbers for one scene.
class Draw {
 public:
  explicit Draw(std::uint64_t key) : state_{key * 0x9E3779B97F4A7C15U + 1} {}
  double operator()(double from, double to) {
    state_ = (state_ ^ (state_ >> 31U)) * 0xBF58476D1CE4E5B9U + 0x94D049BB133111EBU;
    return from + (to - from) * static_cast<double>(state_ >> 32U) * unit_of_float;
  }
  Vec3 direction() {
    for (;;) {
      const Vec3 v{(*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1)};
      if (const double n = geometry::norm(v); n < 1 && n > 0.1) return v / n;
    }
  }

 private:
  std::uint64_t state_;
};

/// A box of some metres with two or three pairs of planes 1e-2 to 1e-13 m apart, at the origin or at 5e6 m.
topology::CutInput needles(std::uint64_t key) {
  Draw draw{key};
  const double far = key % 2 == 0 ? 0 : 5e6, size = std::pow(10, draw(-1, 2));
  const Vec3 centre{far, 0.9 * far, far / 1e4}, half{size / 2, size / 2, size / 2};
  topology::CutInput input = scene(box(centre - half, centre + half));
  for (int pair = 0; pair < 2 + static_cast<int>(key % 3 == 0); ++pair) {
    const Vec3 n = draw.direction(), u = geometry::normalized(geometry::cross(n, draw.direction()));
    const Vec3 v = geometry::cross(n, u), at = centre + 0.3 * size * draw(0, 1) * draw.direction();
    const double gap = std::pow(10, draw(-13, -2)), reach = (key % 5 == 0 ? draw(0.2, 0.8) : 2) * size;
    input.joints.emplace_back(parallelogram(at, reach * u, reach * v));
    const double tilt = key % 7 == 0 ? 0.3 * gap / reach : 0;
    const Vec3 turned = u + (tilt * draw(-1, 1)) * n;
    input.joints.emplace_back(parallelogram(at + gap * n, reach * turned, reach * v));
  }
  return input;
}

TEST(Thin, NeedlesPassTheirCertificate) {
  std::size_t blocks = 0;
  for (std::uint64_t key = 1; key <= 600; ++key) {
    const auto audited = topology::audit(topology::cut(needles(key)).value());
    ASSERT_TRUE(audited) << "scene " << key << ": " << audited.error().misfits << " misfits, volume off by "
                         << audited.error().volume_relative_error;
    blocks += audited->complex().blocks().size();
  }
  EXPECT_GT(blocks, 600U * 4);
}

TEST(Thin, NeedlesHaveTheirVolume) {
  for (const double gap : {0x1p-10, 0x1p-20, 0x1p-26, 0x1p-32, 0x1p-38}) {
    topology::CutInput input = scene(box({-8, -8, -8}, {8, 8, 8}));
    for (const double at : {1.0, 1.0 + gap}) {
      input.joints.emplace_back(rectangle(0, at, {-9, -9}, {9, 9}));
      // Turned by 45 degrees, and a whole number of lattice steps apart.
      input.joints.emplace_back(joint({{-9, -9 + at, -9}, {9, 9 + at, -9}, {9, 9 + at, 9}, {-9, -9 + at, 9}}));
    }
    const auto all = volumes(input);
    ASSERT_EQ(all.size(), 9U);
    // A parallelogram of sides gap and gap sqrt(2), 16 m long.
    EXPECT_NEAR(all.front() / (gap * gap * 16), 1, 1e-9) << gap;
  }
}

// A plane across a needle shares it out to the last digits that its gap has.
TEST(Thin, PartsOfANeedleAddUp) {
  for (std::uint64_t key = 1; key <= 60; ++key) {
    Draw draw{key};
    const double gap = std::pow(10, draw(-12, -6));
    topology::CutInput input = scene(box({-5, -5, -5}, {5, 5, 5}));
    const Vec3 along = draw.direction();
    for (int pair = 0; pair < 2; ++pair) {
      const Vec3 n = geometry::normalized(geometry::cross(along, draw.direction())), v = geometry::cross(n, along);
      for (const double at : {0.0, gap}) input.joints.emplace_back(parallelogram(at * n, 20 * along, 20 * v));
    }
    const auto whole = volumes(input);
    const Vec3 u = geometry::normalized(geometry::cross(along, draw.direction()));
    input.joints.emplace_back(parallelogram(draw(-1, 1) * along, 20 * u, 20 * geometry::cross(along, u)));
    const auto parts = volumes(input);
    ASSERT_EQ(whole.size(), 9U);
    ASSERT_EQ(parts.size(), 18U);
    EXPECT_NEAR((parts[0] + parts[1]) / whole[0], 1, 1e-9) << key << ", " << gap;
  }
}

/// Outside and inside of a box with walls of `thickness` as one surface, turned.
geometry::Solid shell(double half, double thickness) {
  std::vector<Vec3> vertices;
  std::vector<geometry::SolidFace> faces;
  constexpr std::array<std::array<std::uint32_t, 4>, 6> sides{
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  const Vec3 u = Vec3{2, 3, 6} / 7.0, v = Vec3{3, -6, 2} / 7.0, w = geometry::cross(u, v);
  for (const bool inner : {false, true}) {
    const auto base = static_cast<std::uint32_t>(vertices.size());
    const double r = inner ? half - thickness : half;
    for (unsigned k = 0; k < 8; ++k) {
      vertices.push_back(((k & 1U) != 0 ? r : -r) * u + ((k & 2U) != 0 ? r : -r) * v + ((k & 4U) != 0 ? r : -r) * w);
    }
    for (const auto& [a, b, c, d] : sides) {
      for (auto corners : {std::vector{a, b, c}, std::vector{a, c, d}}) {
        if (inner) std::swap(corners[1], corners[2]);
        for (std::uint32_t& corner : corners) corner += base;
        faces.push_back({.corners = std::move(corners), .tag = 0});
      }
    }
  }
  return geometry::Solid::make(std::move(vertices), std::move(faces), {"wall"}).value();
}

TEST(Thin, ShellsPassTheirCertificate) {
  for (const double thickness : {1e-1, 1e-3, 1e-5, 1e-7, 1e-9}) {
    topology::CutInput as_domain = scene(shell(5, thickness));
    topology::CutInput as_excavation = scene(box({-5, -5, -5}, {5, 5, 5}));
    as_excavation.excavations.push_back(
        box(Vec3{-5, -5, -5} + thickness * Vec3{1, 1, 1}, Vec3{5, 5, 5} - thickness * Vec3{1, 1, 1}));
    for (topology::CutInput* input : {&as_domain, &as_excavation}) {
      for (std::uint64_t k = 1; k < 5; ++k) {
        Draw draw{k};
        const Vec3 n = draw.direction(), u = geometry::normalized(geometry::cross(n, draw.direction()));
        input->joints.emplace_back(parallelogram(0.3 * n, 20 * u, 20 * geometry::cross(n, u)));
      }
      const auto audited = topology::audit(topology::cut(*input).value());
      ASSERT_TRUE(audited) << thickness << ": " << audited.error().misfits << " misfits, volume off by "
                           << audited.error().volume_relative_error;
      const double wall = 1000 - 8 * std::pow(5 - thickness, 3);
      EXPECT_NEAR(audited->certificate().volume.si() / wall, 1, 1e-3) << thickness;
    }
  }
}

// A rough surface and a copy of it that differs inside its rim only: they float in the domain and enclose many thin
// blocks, however large the domain is.
TEST(Thin, SurfacesThatNearlyCoincideFloatInAnyDomain) {
  constexpr int n = 8;
  const auto blocks_in = [&](double extent) {
    topology::CutInput input = scene(box({-extent, -extent, -extent}, {extent, extent, extent}));
    for (const double noise : {0.0, 1e-3}) {
      Draw draw{11};
      std::vector<std::vector<Vec3>> at(n + 1, std::vector<Vec3>(n + 1));
      for (int i = 0; i <= n; ++i) {
        for (int j = 0; j <= n; ++j) {
          const bool rim = i == 0 || j == 0 || i == n || j == n;
          const double rough = draw(-20, 20), off = draw(-1, 1);
          at[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = {100.0 * i, 100.0 * j,
                                                                          rough + (rim ? 0 : noise * off)};
        }
      }
      topology::Joint surface;
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) {
          for (const auto& [b, c] :
               {std::pair{at[i + 1][j], at[i + 1][j + 1]}, std::pair{at[i + 1][j + 1], at[i][j + 1]}}) {
            surface.polygons.push_back(geometry::Polygon::make({at[i][j], b, c}).value());
          }
        }
      }
      input.joints.emplace_back(std::move(surface));
    }
    return count_blocks(input);
  };
  const std::size_t blocks = blocks_in(1e3);
  EXPECT_GT(blocks, 5U);
  EXPECT_EQ(blocks_in(1e6), blocks);
}

/// Slivers that lead round: their faces are small beside what their edges add to two faces each.
TEST(Thin, RingsOfSlivers) {
  for (const double thin : {1e-2, 1e-4, 1e-5, 1e-6}) {
    Draw draw{11};
    const Vec3 w = draw.direction(), u = geometry::normalized(geometry::cross(w, draw.direction()));
    const Vec3 v = geometry::cross(w, u);
    constexpr std::size_t around = 24, across = 3;
    const auto point = [&](std::size_t i, std::size_t j) {
      const double a = 2 * std::numbers::pi * static_cast<double>(i % around) / around;
      const double b = 2 * std::numbers::pi * static_cast<double>(j % across) / across;
      const double out = 50 + thin * std::cos(b);
      return out * std::cos(a) * u + out * std::sin(a) * v + thin * std::sin(b) * w;
    };
    auto input = scene(box({-100, -100, -100}, {100, 100, 100}));
    for (std::size_t i = 0; i < around; ++i) {
      for (std::size_t j = 0; j < across; ++j) {
        input.joints.emplace_back(joint({point(i, j), point(i + 1, j), point(i + 1, j + 1)}));
        input.joints.emplace_back(joint({point(i, j), point(i + 1, j + 1), point(i, j + 1)}));
      }
    }
    const auto audited = certified(input);
    ASSERT_EQ(audited.complex().blocks().size(), 2U) << thin;
    for (const topology::Block& block : audited.complex().blocks()) EXPECT_EQ(block.counts.genus, 1U);
  }
}

/// Corners in 2^-45 m, which are sites of the lattice of a box of 2 m.
using Site = std::array<std::int64_t, 3>;
Vec3 position(const Site& site) {
  const auto metres = [](std::int64_t n) { return static_cast<double>(n) * 0x1p-45; };
  return {metres(site[0]), metres(site[1]), metres(site[2])};
}
geometry::Solid void_of(const std::vector<Site>& corners,
                        std::initializer_list<std::array<std::uint32_t, 3>> triangles) {
  std::vector<Vec3> vertices;
  std::vector<geometry::SolidFace> faces;
  for (const Site& corner : corners) vertices.push_back(position(corner));
  for (const auto& [a, b, c] : triangles) faces.push_back({.corners = {a, b, c}});
  return geometry::Solid::make(std::move(vertices), std::move(faces)).value();
}

// The faces of a slot about its edge a b are 1e-16 apart, beside a wedge on the same edge: the rock touches itself
// along a b, and which of its four faces follows which is more than doubles can tell.
TEST(Thin, ASlotThinnerThanAnglesInDoublesBesideAWedgeOnItsEdge) {
  struct Corners {
    Site a, b, c, above_c;  ///< the slot
    Site g, h;              ///< with b and c: the room it leads to
    Site d, e;              ///< with a and b: the wedge
  };
  const std::array scenes{
      Corners{{-3049598621701, 2077147508120, -7235585368024},
              {8440999973080, 6353224627990, -4626178241009},
              {982065726708, -5060914081000, 5771876830453},
              {982065726708, -5060914080995, 5771876830446},
              {6601443525108, 1037317839901, 3501511962207},
              {7478301057636, -603602633686, 2329247424884},
              {4684213531614, 14041042030993, -17633640439478},
              {4409335624670, 12941530403217, -16534128811702}},
      Corners{{-2091970803485, 266546763856, -1180276313665},
              {-3401573368166, 4398940714172, 1781526068841},
              {121010659088, -1704842078681, -1753380288361},
              {121010659084, -1704842078682, -1753380288364},
              {-1909706420923, 994028208797, 1138141470525},
              {-1099842618787, 2348371959026, -393386167702},
              {-5339676923794, 6920085370597, 2354630043537},
              {-5614554830738, 5820573742821, 3454141671313}},
      Corners{{1424326778065, -318060863967, -39311424506},
              {-402829542342, -7824124774473, 4702298768861},
              {8040107599293, -3697814377008, -6461422241895},
              {8040107599286, -3697814377005, -6461422241888},
              {3728357629366, -7641024428024, -1834511719264},
              {5345507777830, -7146659950519, -428761940977},
              {-6743732456627, -3894615447544, 11124409586249},
              {-7018610363571, -4994127075320, 12223921214025}},
  };
  for (const auto& [a, b, c, above_c, g, h, d, e] : scenes) {
    const auto slot = void_of({a, b, c, above_c, g, h},
                              {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 4}, {1, 5, 3}, {1, 4, 5}, {2, 5, 4}, {2, 3, 5}});
    const double sense = dot(position(e) - position(a), cross(position(b) - position(a), position(d) - position(a)));
    const auto wedge =
        void_of({a, b, sense > 0 ? d : e, sense > 0 ? e : d}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}});
    const auto cut = certified(scene(box({-1, -1, -1}, {1, 1, 1}), {}, {slot, wedge}));
    ASSERT_EQ(cut.complex().blocks().size(), 1U);
    const topology::EulerCounts right{
        .vertices = 8 + 6 + 4 - 2, .edges = 12 + 12 + 6, .faces = 18, .loops = 18, .shells = 2, .genus = 0};
    EXPECT_EQ(cut.complex().blocks()[topology::BlockId{0U}].counts, right);
  }
}

}  // namespace
}  // namespace cleave::testing::thin_test
