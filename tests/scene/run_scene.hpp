#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <expected>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cleave/core/cost.hpp"
#include "cleave/core/progress.hpp"
#include "cleave/realize/run.hpp"
#include "parse_support.hpp"

namespace cleave::scene::test {

inline std::expected<RunResult, std::vector<Problem>> try_run(const std::string& text, const Files& files = {}) {
  const Scene scene = scene_of(text, files);
  StageTimer timer;
  Progress progress{ProgressStyle::quiet};
  return run(scene, {.threads = 1}, timer, progress);
}

/// Of a scene that runs.
inline RunResult run_of(const std::string& text, const Files& files = {}) {
  auto result = try_run(text, files);
  if (!result) {
    for (const Problem& problem : result.error()) ADD_FAILURE() << describe(problem);
  }
  return std::move(result).value();
}

/// Notes of a run that have these words.
inline std::size_t notes_with(const RunResult& result, std::string_view words) {
  return static_cast<std::size_t>(
      std::ranges::count_if(result.notes, [&](const std::string& note) { return note.contains(words); }));
}

}  // namespace cleave::scene::test
