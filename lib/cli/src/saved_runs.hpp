#pragma once

#include <cstdint>
#include <expected>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/scene/plan.hpp"
#include "cleave/scene/problem.hpp"

namespace cleave::cli {

/// Which state a run goes on from by itself.
struct StateSought {
  std::string_view file;     ///< "contact.state"
  std::string_view section;  ///< of summary.json
  std::string sha256;        ///< of the scene
  std::string title;
  std::optional<std::uint64_t> seed = {};  ///< where the run depends on it
};
using FoundState = std::expected<std::optional<scene::SavedRun>, std::vector<scene::Problem>>;

/// What a run goes on from: what --resume names, else an interrupted run of the same scene in OUT; else nothing.
[[nodiscard]] FoundState find_state(const std::string& resume, const std::string& out, const StateSought& sought);

class InterruptWatch;
/// What is before the first step is left at once; from then on a run ends after its step and keeps what is done.
[[nodiscard]] std::function<bool()> stop_between_steps(InterruptWatch& interrupts);

/// To an interrupt while bodies move.
inline constexpr std::string_view stops_after_this_step =
    "stops after this step and writes what is done; interrupt again to leave without it";
/// Said when an interrupted run has ended.
void say_interrupted(const std::string& why, const std::string& out);

}  // namespace cleave::cli
