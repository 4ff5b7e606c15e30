/// Surfaces that are closed on paper, in rounded doubles, against how many parts they are known to make:
///
///     closed_agreement [COUNT [SEED [snap]]]        (default 1000 sets, seed 1)
///
/// Each set is turned, scaled by 1e-3 to 1e6, and for a third of them shifted by 5e6 m. Half of the scenes are cut out
/// of a box, half fill it to its sides or reach beyond. With `snap` all are cut with it too, and with a copy of the set
/// moved by less. A fourth of them is cut once more with some polygons given again in pieces. A count that is wrong and
/// a certificate that does not pass are printed; the program then ends with 1.

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

#include "agreement.hpp"
#include "cleave/core/rng.hpp"
#include "closed_check.hpp"

int main(int argc, char** argv) {
  using namespace cleave;
  const auto arguments = support::agreement_arguments(argc, argv, "closed_agreement", 1000, "snap");
  if (!arguments) return 2;
  const auto& [count, seed, snapping] = *arguments;
  std::uint64_t right = 0, not_valid = 0, wrong = 0;
  const auto add = [&](const std::string& what, const support::ClosedTrial& trial) {
    const auto fault = fault_of(trial);
    ++(!fault ? not_valid : fault->empty() ? right : wrong);
    if (fault && !fault->empty()) std::printf("%s, snap %g: %s\n", what.c_str(), trial.snap, fault->c_str());
  };
  for (std::uint64_t trial = 0; trial < count; ++trial) {
    Rng rng{{.seed = seed, .realization = 0, .purpose = 8, .index = static_cast<std::uint32_t>(trial)}};
    const auto uniform = [&] { return rng.uniform(); };
    const support::ClosedSet set = support::any_closed_set(uniform);
    support::Placement at{{6 * uniform(), 6 * uniform(), 6 * uniform()}, std::pow(10, 9 * uniform() - 3), {}};
    if (trial % 3 == 0) at.shift = {5e6, -3e6, 1e3};
    const std::string what = std::to_string(trial) + ": " + set.name + ", scale " + std::to_string(at.scale);
    support::ClosedTrial closed{.polygons = support::placed(set, at).polygons, .at = at, .expected = set.parts + 1};
    closed.convex = set.convex;
    add(what, closed);
    if (trial % 4 == 1) {
      support::ClosedTrial pieces = closed;
      pieces.polygons = support::some_again_in_pieces(closed.polygons, uniform);
      add(what + ", some again in pieces", pieces);
    }
    if (!snapping) continue;
    closed.convex = false;
    for (const double snap : {1e-9, 1e-6}) {
      closed.snap = snap * at.scale;
      add(what, closed);
    }
  }
  std::printf("%llu right, %llu wrong, %llu of no valid polygons\n", static_cast<unsigned long long>(right),
              static_cast<unsigned long long>(wrong), static_cast<unsigned long long>(not_valid));
  return wrong == 0 ? 0 : 1;
}
