#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "cleave/core/rng.hpp"
#include "cleave/stochastic/ensemble.hpp"

/// Realizations with heavy tails whose means are known, to count how often printed intervals hold them.
namespace cleave::support {

struct RockKind {
  std::string_view name;
  double mean, std;    ///< of the number of key blocks
  double sigma;        ///< of the logarithm of a block's volume
  double rare, often;  ///< shares of two kinds of blocks; each realization has its own, about them
};
inline constexpr std::array<RockKind, 4> rock_kinds{{{"many", 112, 126, 1.6, 1e-4, 0.3},
                                                     {"first_batch", 13, 6, 1.6, 1e-3, 0.3},
                                                     {"few", 3, 4, 2.0, 1e-2, 0.3},
                                                     {"scarce", 0.79, 1.2, 2.0, 2e-2, 0.3}}};

namespace detail {
inline double gamma_draw(Rng& rng, double shape) {  // Marsaglia & Tsang (2000)
  if (shape < 1) return gamma_draw(rng, shape + 1) * std::pow(rng.uniform(), 1 / shape);
  const double d = shape - 1.0 / 3, c = 1 / std::sqrt(9 * d);
  for (;;) {
    const double x = rng.normal(), v = std::pow(1 + c * x, 3);
    if (v > 0 && std::log(rng.uniform()) < 0.5 * x * x + d - d * v + d * std::log(v)) return d * v;
  }
}
inline std::uint64_t poisson_draw(Rng& rng, double mean) {
  std::uint64_t n = 0;
  for (double sum = -std::log(rng.uniform()); sum < mean; sum -= std::log(rng.uniform())) ++n;
  return n;
}
}  // namespace detail

/// A negative binomial number of blocks; volumes share a lognormal factor, kinds a common share.
inline stochastic::Record rock_record(const RockKind& rock, std::uint64_t sample, std::uint64_t k) {
  Rng rng{{.seed = 71, .realization = sample, .purpose = 1, .index = static_cast<std::uint32_t>(k)}};
  stochastic::Record r;
  r.realization = k;
  const double shape = rock.mean * rock.mean / (rock.std * rock.std - rock.mean);
  const std::uint64_t n = detail::poisson_draw(rng, detail::gamma_draw(rng, shape) * rock.mean / shape);
  const double factor = std::exp(0.5 * rng.normal()), tilt = 2 * rng.uniform();
  for (std::uint64_t i = 0; i < n; ++i) {
    const double v = factor * std::exp(1 + rock.sigma * rng.normal()), kind = rng.uniform();
    ++r.all.count;
    r.all.volume_m3 += v;
    r.all.largest_m3 = std::max(r.all.largest_m3, v);
    r.all.sizes.add(v);
    ++r.all.modes.at(kind < rock.often * tilt ? 2 : 0);
    ++r.all.shapes.at(rng.uniform() < rock.rare * tilt ? 4 : 0);
    r.all.support_n += 26e3 * v;
  }
  r.first = r.all;
  return r;
}

struct RockTruth {
  std::map<std::string, double> of;
};
/// Number and volume are independent but for their own factors, so all is a product of means.
inline RockTruth truth_of(const RockKind& rock) {
  const double volume = std::exp(1 + rock.sigma * rock.sigma / 2 + 0.125);
  return {{{"key_block_volume_m3", rock.mean * volume},
           {"key_block_count", rock.mean},
           {"support_force_n", 26e3 * rock.mean * volume},
           {"key_block_mean_volume_m3", volume},
           {"support_force_per_block_n", 26e3 * volume},
           {"share_sliding", rock.often},
           {"share_other", rock.rare}}};
}

struct EnsembleCoverage {
  std::map<std::string, int> counts;
  std::map<std::string, int> flagged;  ///< held or not: said to be optimistic
  std::map<std::string, int> held_flagged, bootstraps, held_by_bootstrap;
  void look(const RockKind& rock, const RockTruth& truth, std::uint64_t realizations, std::uint64_t sample) {
    stochastic::Ensemble ensemble{stochastic::EnsembleOptions{.volumes_m3 = {}, .tunnel_length_m = {}}};
    for (std::uint64_t k = 0; k < realizations; ++k) ensemble.add(rock_record(rock, sample, k), "");
    for (const stochastic::Estimate& e : ensemble.figures().estimates) {
      const auto found = truth.of.find(e.name);
      if (found == truth.of.end()) continue;
      const bool held = e.low <= found->second && found->second <= e.high;
      counts[e.name] += held ? 1 : 0;
      flagged[e.name] += e.optimistic ? 1 : 0;
      held_flagged[e.name] += held && e.optimistic ? 1 : 0;
      bootstraps[e.name] += e.bootstrap ? 1 : 0;
      held_by_bootstrap[e.name] +=
          e.bootstrap && e.bootstrap->low <= found->second && found->second <= e.bootstrap->high ? 1 : 0;
    }
  }
};

}  // namespace cleave::support
