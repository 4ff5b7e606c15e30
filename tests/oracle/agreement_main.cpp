/// The fast cutter against the oracle on as many random small scenes as one likes:
///
///     oracle_agreement [COUNT [SEED]]        (default 20000 scenes, seed 1)
///
/// A third of the scenes have few joints, a third many, a third excavations. Prints how many of the hard ones there
/// were; a difference is printed as a scene with as few joints as still show it, and the program ends with 1.

#include <cstdint>
#include <cstdio>

#include "agreement.hpp"
#include "block_summary.hpp"
#include "cleave/core/rng.hpp"
#include "scene_to_toml.hpp"

int main(int argc, char** argv) {
  using namespace cleave::testing;
  const auto arguments = cleave::support::agreement_arguments(argc, argv, "oracle_agreement", 20000);
  if (!arguments) return 2;
  const auto& [count, seed, word] = *arguments;
  std::uint64_t joints = 0;
  std::uint64_t excavated = 0;
  std::uint64_t crowded = 0;
  for (std::uint64_t trial = 0; trial < count; ++trial) {
    SceneLimits limits{.max_joints = 4, .max_excavations = 0};
    if (trial % 3 == 1) limits = {.max_joints = 10, .max_excavations = 0};
    if (trial % 3 == 2) limits = {.max_joints = 6, .max_excavations = 2};
    cleave::Rng rng{{.seed = seed, .realization = 0, .purpose = 7, .index = static_cast<std::uint32_t>(trial)}};
    const IntegerScene scene = make_integer_scene(
        [&](std::int32_t lo, std::int32_t hi) { return static_cast<std::int32_t>(rng.between(lo, hi)); }, limits);
    joints += scene.joints.size();
    if (!scene.excavations.empty()) ++excavated;
    if (scene.joints.size() >= 6) ++crowded;
    if (!difference_from_oracle(scene).empty()) {
      const IntegerScene small =
          minimised(scene, [](const IntegerScene& s) { return !difference_from_oracle(s).empty(); });
      std::printf("seed %llu, trial %llu\n%s", static_cast<unsigned long long>(seed),
                  static_cast<unsigned long long>(trial), scene_to_toml(small, difference_from_oracle(small)).c_str());
      return 1;
    }
    if (trial % 1000 == 999) {
      std::printf("%llu scenes agree\n", static_cast<unsigned long long>(trial + 1));
      std::fflush(stdout);
    }
  }
  std::printf(
      "%llu scenes of seed %llu agree with the oracle: %llu joints in all, %llu scenes of six joints and more, "
      "%llu with excavations\n",
      static_cast<unsigned long long>(count), static_cast<unsigned long long>(seed),
      static_cast<unsigned long long>(joints), static_cast<unsigned long long>(crowded),
      static_cast<unsigned long long>(excavated));
  return 0;
}
