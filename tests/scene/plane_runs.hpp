#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "cleave/core/cost.hpp"
#include "cleave/core/progress.hpp"
#include "cleave/scene2d/bodies.hpp"

namespace cleave::scene::plane_runs {

/// The result of a scene of bodies, which must be right and must run; on one thread, silently.
inline BodiesResult ran(const std::string& text) {
  const auto scene = parse_bodies(text, "s.toml");
  EXPECT_TRUE(scene.has_value()) << (scene ? "" : describe(scene.error().front()));
  StageTimer timer;
  Progress progress{ProgressStyle::quiet};
  auto result = run(*scene, 1, timer, progress);
  EXPECT_TRUE(result.has_value()) << (result ? "" : describe(result.error().front()));
  return *std::move(result);
}

}  // namespace cleave::scene::plane_runs
