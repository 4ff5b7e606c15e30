#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cleave/realize/monte_carlo.hpp"
#include "cleave/realize/run_result.hpp"

namespace cleave::report {

/// A Monte Carlo run as its writers need it.
struct MonteCarloPage : scene::ResultHead {
  scene::MonteCarloResult result;
  std::vector<scene::InputFile> files;
  std::vector<scene::ExcavationFigures> excavations = {};  ///< the same in all realizations
  std::optional<double> tunnel_length_m;
  std::optional<std::string> stop_quantity;        ///< empty: fixed number
  std::vector<std::vector<std::uint32_t>> orders;  ///< of the excavation stages, as in the figures
};

[[nodiscard]] MonteCarloPage monte_carlo_page(const scene::Scene& scene, const scene::RunCost& cost,
                                              scene::MonteCarloResult result);

/// summary.json with its section `monte_carlo`. That section is the same for any number of threads, shards and
/// interruptions.
[[nodiscard]] std::string monte_carlo_json(const MonteCarloPage& page);
/// block_sizes.csv; empty where sizes were not counted.
[[nodiscard]] std::string block_sizes_csv(const MonteCarloPage& page);
[[nodiscard]] std::string monte_carlo_html(const MonteCarloPage& page);

}  // namespace cleave::report
