/// Needles and plates: boxes cut by pairs of planes that nearly coincide.
///
///     needle_agreement [COUNT [SEED]]        (default 1000 scenes, seed 1)
///
/// Two or three pairs of planes, each 1e-2 to 1e-13 of the box apart, parallel or tilted by as much, some as plane
/// joints and some as rectangles, at the origin and at 5e6 m. Every scene must be cut and pass its certificate, and a
/// pair must part at most as many blocks as distinct planes can. What does not is printed; the program then ends
/// with 1.

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

#include "agreement.hpp"
#include "cleave/core/rng.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"

namespace {

using namespace cleave;
using geometry::Vec3;

void add_plane(topology::CutInput& input, Vec3 through, Vec3 normal, double size, bool whole) {
  if (whole) {
    input.joints.emplace_back(topology::PersistentJoint{through, normal});
    return;
  }
  const Vec3 helper = std::abs(normal.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 u = 4 * size * geometry::normalized(cross(normal, helper)), v = cross(normal, u);
  auto polygon = geometry::Polygon::make({through - u - v, through + u - v, through + u + v, through - u + v});
  if (polygon) input.joints.emplace_back(topology::Joint{{*std::move(polygon)}});
}

std::string fault_of(const topology::CutInput& input) {
  auto complex = topology::cut(input);
  if (!complex) return describe(complex.error());
  const std::size_t blocks = complex->blocks().size(), planes = input.joints.size();
  const auto audited = topology::audit(*std::move(complex));
  if (!audited) return "certificate: " + describe(audited.error());
  // The most parts that so many planes can make.
  const std::size_t most = 1 + planes + planes * (planes - 1) / 2 + planes * (planes - 1) * (planes - 2) / 6;
  return blocks < 2 || blocks > most ? std::to_string(blocks) + " blocks" : "";
}

}  // namespace

int main(int argc, char** argv) {
  const auto arguments = support::agreement_arguments(argc, argv, "needle_agreement", 1000, "");
  if (!arguments) return 2;
  const auto& [count, seed, unused] = *arguments;
  std::uint64_t wrong = 0;
  for (std::uint64_t trial = 0; trial < count; ++trial) {
    Rng rng{{.seed = seed, .realization = 0, .purpose = 8, .index = static_cast<std::uint32_t>(trial)}};
    const auto uniform = [&] { return rng.uniform(); };
    const double size = std::pow(10, 4 * uniform() - 1), far = trial % 2 == 0 ? 0 : 5e6;
    const Vec3 lo{far, -far, 0}, extent{size, size, size};
    auto box = geometry::make_box(lo, lo + extent);
    if (!box) continue;
    topology::CutInput input{.domain = *std::move(box)};
    const int pairs = 2 + static_cast<int>(2 * uniform());
    for (int k = 0; k < pairs; ++k) {
      const Vec3 through = lo + size * Vec3{0.3 + 0.4 * uniform(), 0.3 + 0.4 * uniform(), 0.3 + 0.4 * uniform()};
      const Vec3 normal = geometry::normalized({uniform() - 0.5, uniform() - 0.5, uniform() - 0.5});
      const double gap = std::pow(10, -2 - 11 * uniform());
      const Vec3 tilt = uniform() < 0.5 ? Vec3{} : gap * Vec3{uniform(), uniform(), uniform()};
      const bool whole = uniform() < 0.5;
      add_plane(input, through, normal, size, whole);
      add_plane(input, through + gap * size * normal, geometry::normalized(normal + tilt), size, whole);
    }
    const std::string fault = fault_of(input);
    if (fault.empty()) continue;
    ++wrong;
    std::printf("%llu: %s\n", static_cast<unsigned long long>(trial), fault.c_str());
  }
  std::printf("%llu scenes, %llu wrong\n", static_cast<unsigned long long>(count),
              static_cast<unsigned long long>(wrong));
  return wrong == 0 ? 0 : 1;
}
