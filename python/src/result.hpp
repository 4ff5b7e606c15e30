#pragma once

#include <cstdint>
#include <expected>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "cleave/core/progress.hpp"
#include "cleave/load/load.hpp"
#include "cleave/realize/run_result.hpp"
#include "cleave/report/monte_carlo.hpp"
#include "cleave/report/write.hpp"
#include "cleave/scene2d/bodies.hpp"
#include "cleave/scene2d/contact.hpp"

namespace cleave::python {

/// Figures and records of a Monte Carlo run.
struct Ensemble {
  report::MonteCarloPage page;
  std::string records_csv;
};

using AnyResult = std::variant<scene::RunResult, Ensemble, scene::BodiesResult, scene::ContactResult>;

struct RunSettings {
  std::optional<std::uint64_t> seed;
  unsigned threads = 1;
};

/// Why a run gave nothing: what is wrong with the scene, or the machine.
using RunFailure = std::variant<std::vector<scene::Problem>, std::string>;

/// Throws Stopped after `progress.stop()`.
[[nodiscard]] std::expected<AnyResult, RunFailure> run(scene::AnyScene scene, const RunSettings& settings,
                                                       Progress& progress);

/// "blocks", "monte_carlo", "elastic", "contact".
[[nodiscard]] std::string_view kind_of(const AnyResult& result) noexcept;
[[nodiscard]] std::string summary_of(const AnyResult& result);
[[nodiscard]] std::vector<std::string> notes_of(const AnyResult& result);
/// Why the result is not to be used as it is: a certificate that did not pass, a solution that did not converge; empty
/// when all is well.
[[nodiscard]] std::string complaint_of(const AnyResult& result);

/// A file of the result by its name ("key_blocks.csv", "report.html"); empty when this result has none.
[[nodiscard]] std::optional<std::string> text_of(const AnyResult& result, std::string_view name);

/// All files that the program would write, but log.txt and scene.toml.
[[nodiscard]] std::expected<void, report::WriteError> write(const AnyResult& result,
                                                            const std::filesystem::path& folder);

}  // namespace cleave::python
