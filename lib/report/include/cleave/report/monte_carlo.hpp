#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cleave/report/html.hpp"
#include "cleave/report/summary.hpp"
#include "cleave/scene/monte_carlo.hpp"
#include "cleave/scene/run_result.hpp"

namespace cleave::report {

/// A Monte Carlo run as its writers need it. `summary` gives title, seed, plan and cost; its blocks stay empty: no one
/// block system stands for the run.
struct MonteCarloPage {
  Summary summary;
  scene::MonteCarloResult result;
  std::string scene_file;
  std::vector<FileRow> files;
  std::vector<std::string> notes;
  std::optional<double> tunnel_length_m;
  std::string stop_quantity;                       ///< empty: fixed number
  std::vector<std::vector<std::uint32_t>> orders;  ///< of the excavation stages, as in the figures
};

[[nodiscard]] Summary monte_carlo_summary(const scene::Scene& scene, const scene::RunCost& cost);
[[nodiscard]] MonteCarloPage monte_carlo_page(const scene::Scene& scene, const scene::RunCost& cost,
                                              scene::MonteCarloResult result);

/// summary.json with its section `monte_carlo`. That section is the same for any number of threads, shards and
/// interruptions.
[[nodiscard]] std::string monte_carlo_json(const MonteCarloPage& page);
[[nodiscard]] std::string monte_carlo_html(const MonteCarloPage& page);

}  // namespace cleave::report
