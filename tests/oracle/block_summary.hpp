#pragma once

/// What the fast cutter and the oracle are compared by: for every set of counts (V, E, F, L, S, G) the volumes.

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cleave/topology/block_complex.hpp"
#include "integer_scene.hpp"
#include "oracle.hpp"

namespace cleave::testing {

using Counts = std::array<std::uint32_t, 6>;
using BlockSummary = std::map<Counts, std::vector<double>>;

[[nodiscard]] BlockSummary summary_of(const topology::BlockComplex& complex);
[[nodiscard]] BlockSummary summary_of(const std::vector<oracle::OracleBlock>& blocks);
[[nodiscard]] std::string describe(const BlockSummary& summary);
/// Same counts, volumes equal to 1e-9 of themselves.
[[nodiscard]] bool agree(const BlockSummary& a, const BlockSummary& b);

/// Cuts with the fast cutter and audits. No rock left is an empty summary. `problem` says what went wrong otherwise.
struct FastCut {
  BlockSummary summary;
  std::string problem;
};
[[nodiscard]] FastCut fast_cut(const IntegerScene& scene);

/// What is wrong with the fast cut, in words; empty when it agrees with the oracle.
[[nodiscard]] std::string difference_from_oracle(const IntegerScene& scene);
/// Cuts the scene in ways that must not matter (order, repetition, translation, axes); empty when they do not.
[[nodiscard]] std::string broken_invariance(const IntegerScene& scene);

/// Cuts only what lies in some windows; empty when the blocks found whole there are those of the whole scene, and none
/// is missing.
[[nodiscard]] std::string broken_window(const IntegerScene& scene);
/// The joints cut along each other, in triangles, have the areas of the faces of blocks and of what dangles; what hangs
/// together has them, too.
[[nodiscard]] std::string broken_network(const IntegerScene& scene);

/// Drops joints and excavations one by one as long as `fails` stays true.
template <class Fails>
[[nodiscard]] IntegerScene minimised(IntegerScene scene, const Fails& fails) {
  const auto drop_from = [&](auto member) {
    for (std::size_t i = 0; i < (scene.*member).size();) {
      IntegerScene smaller = scene;
      (smaller.*member).erase((smaller.*member).begin() + static_cast<std::ptrdiff_t>(i));
      if (fails(smaller)) {
        scene = std::move(smaller);
      } else {
        ++i;
      }
    }
  };
  drop_from(&IntegerScene::joints);
  drop_from(&IntegerScene::excavations);
  drop_from(&IntegerScene::joints);
  return scene;
}

}  // namespace cleave::testing
