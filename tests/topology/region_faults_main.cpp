/// Faults of a regional model: triangulated surfaces in a box of 750 km by 750 km by 40 km.
///
///     region_faults [COUNT [SEED]]        (default 442 faults, seed 1)
///
/// Rough surfaces of 50 to 500 triangles, 10 to 100 km long. About a third are there twice: once more with a common rim
/// and 1 m to 1 um off elsewhere, which makes one flat block that floats. First each in a place of its own, so that the
/// number of blocks is known; then anywhere, across one another, the second surfaces with roughness of their own. Every
/// scene must be cut and pass its certificate; what does not is printed, and the program then ends with 1.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include "agreement.hpp"
#include "cleave/core/rng.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"

namespace {

using namespace cleave;
using geometry::Vec3;

constexpr double width = 750e3, depth = 40e3;

/// A rough grid of points on an inclined rectangle.
struct Surface {
  std::size_t along, down;  ///< cells
  Vec3 normal;
  std::vector<Vec3> points;

  Surface(Rng& rng, Vec3 centre, double length) : along{}, down{}, normal{}, points{} {
    const auto cells = [&](std::int64_t lo, std::int64_t hi) { return static_cast<std::size_t>(rng.between(lo, hi)); };
    along = cells(6, 25);
    down = cells(5, 10);
    const double strike = 2 * rng.uniform(), dip = 0.8 + 0.7 * rng.uniform(), rough = 20 + 300 * rng.uniform();
    const double phase = 6 * rng.uniform(), waves = 2 + 6 * rng.uniform();
    const Vec3 u{std::sin(strike), std::cos(strike), 0};
    const Vec3 v{std::cos(strike) * std::cos(dip), -std::sin(strike) * std::cos(dip), -std::sin(dip)};
    normal = cross(u, v);
    const double high = std::min(length, 12e3);
    for (std::size_t i = 0; i <= along; ++i) {
      for (std::size_t j = 0; j <= down; ++j) {
        const double s = static_cast<double>(i) / static_cast<double>(along) - 0.5;
        const double t = static_cast<double>(j) / static_cast<double>(down) - 0.5;
        const double off = rough * (std::sin(phase + waves * s) + 0.3 * rng.uniform());
        points.push_back(centre + length * s * u + high * t * v + off * normal);
      }
    }
  }
  [[nodiscard]] bool on_rim(std::size_t point) const {
    const std::size_t i = point / (down + 1), j = point % (down + 1);
    return i == 0 || i == along || j == 0 || j == down;
  }
  [[nodiscard]] topology::Joint joint() const {
    topology::Joint out;
    const auto triangle = [&](std::size_t a, std::size_t b, std::size_t c) {
      if (auto polygon = geometry::Polygon::make({points[a], points[b], points[c]})) {
        out.polygons.push_back(*std::move(polygon));
      }
    };
    for (std::size_t i = 0; i < along; ++i) {
      for (std::size_t j = 0; j < down; ++j) {
        const std::size_t a = i * (down + 1) + j, b = a + down + 1;
        triangle(a, b, b + 1);
        triangle(a, b + 1, a + 1);
      }
    }
    return out;
  }
};

struct Region {
  topology::CutInput input;
  std::size_t triangles = 0, floating = 0;
};

Region region(std::uint64_t count, std::uint64_t seed, bool apart) {
  const Vec3 origin = seed % 2 == 0 ? Vec3{5e6, -5e6, 0} : Vec3{};
  Region out{{.domain = geometry::make_box(origin, origin + Vec3{width, width, depth}).value()}};
  const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
  const double cell = width / static_cast<double>(side);
  for (std::size_t k = 0; k < count; ++k) {
    Rng rng{{.seed = seed, .realization = 0, .purpose = apart ? 9U : 10U, .index = static_cast<std::uint32_t>(k)}};
    const Vec3 place = apart ? Vec3{(static_cast<double>(k % side) + 0.5) * cell,
                                    (static_cast<double>(k / side) + 0.5) * cell, depth / 2}
                             : Vec3{width * rng.uniform(), width * rng.uniform(), depth * rng.uniform()};
    const double length = apart ? 0.6 * cell : 1e4 * std::pow(10, rng.uniform());
    Surface surface{rng, origin + place, length};
    const auto add = [&] {
      out.input.joints.emplace_back(surface.joint());
      out.triangles += 2 * surface.along * surface.down;
    };
    add();
    if (rng.uniform() > 0.35) continue;
    const double gap = std::pow(10, -6 * rng.uniform());
    for (std::size_t p = 0; p < surface.points.size(); ++p) {
      if (apart && surface.on_rim(p)) continue;
      surface.points[p] += gap * (apart ? 1 : 2 * rng.uniform() - 1) * surface.normal;
    }
    add();
    ++out.floating;
  }
  return out;
}

std::string fault_of(const Region& region, bool apart) {
  const std::clock_t start = std::clock();
  auto complex = topology::cut(region.input);
  if (!complex) return describe(complex.error());
  const auto audited = topology::audit(*std::move(complex));
  if (!audited) return "certificate: " + describe(audited.error());
  const std::size_t blocks = audited->complex().blocks().size();
  std::printf("%s: %zu surfaces, %zu triangles, %zu blocks, %.1f s\n", apart ? "apart" : "across",
              region.input.joints.size(), region.triangles, blocks,
              static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  if (apart && blocks != region.floating + 1) return std::to_string(region.floating + 1) + " blocks are right";
  return "";
}

}  // namespace

int main(int argc, char** argv) {
  const auto arguments = support::agreement_arguments(argc, argv, "region_faults", 442, "");
  if (!arguments) return 2;
  const auto& [count, seed, unused] = *arguments;
  int wrong = 0;
  for (const bool apart : {true, false}) {
    const std::string fault = fault_of(region(count, seed, apart), apart);
    if (fault.empty()) continue;
    ++wrong;
    std::printf("%s\n", fault.c_str());
  }
  return wrong;
}
