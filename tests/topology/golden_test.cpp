#include <gtest/gtest.h>

#include <fstream>
#include <map>

#include "cleave/geometry/tunnel.hpp"
#include "complexes.hpp"
#include "workloads.hpp"

// Hashes of block systems as they were when the file was made: the same for both compilers, every optimisation level
// and every number of threads. A change of the hash or of the rule that fixes a polygon's plane needs a new file: run
// this test with CLEAVE_GOLDEN=1 in the environment and say in the commit why the hashes changed.

namespace cleave::testing {
namespace {

std::map<std::string, std::string> current(unsigned threads) {
  const auto hash = [&](const topology::CutInput& input) {
    return canonical_hash(topology::cut(input, {.threads = threads}).value(), threads);
  };
  std::map<std::string, std::string> out;
  for (const char* name : {"deg-cavity", "deg-coplanar", "deg-fan12", "deg-fan12r", "deg-ring", "deg-sliver10-1e-06",
                           "deg-touch", "deg-utm7", "deg-vertex20r", "grid-6", "gridr-6", "persist-13", "rect-13"}) {
    out[name] = hash(support::cut_input(support::workload_named(name).value()));
  }
  auto tunnel = support::cut_input(support::workload_named("rect-13").value());
  tunnel.excavations.push_back(
      geometry::make_tunnel(geometry::HorseshoeSection{metres(10), metres(10)}, {{40, 0, 30}, {40, 80, 30}}).value());
  out["rect-13-tunnel"] = hash(tunnel);
  return out;
}

TEST(GoldenHashes, AreThoseOnFile) {
  const std::string path = std::string{CLEAVE_SOURCE_DIR} + "/tests/golden/hashes.txt";
  if (std::getenv("CLEAVE_GOLDEN") != nullptr) {
    std::ofstream file{path};
    for (const auto& [name, hash] : current(1)) file << name << ' ' << hash << '\n';
    GTEST_SKIP() << "wrote " << path;
  }
  std::map<std::string, std::string> stored;
  std::ifstream file{path};
  for (std::string name, hash; file >> name >> hash;) stored[name] = hash;
  for (const unsigned threads : {1U, 2U, 7U}) EXPECT_EQ(current(threads), stored) << threads << " threads";
}

}  // namespace
}  // namespace cleave::testing
