#include "cleave/realize/run.hpp"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "cleave/core/expected.hpp"
#include "judge.hpp"
#include "realizer.hpp"
#include "run_notes.hpp"

namespace cleave::scene {
std::expected<RunResult, std::vector<Problem>> run(const Scene& scene, const RunOptions& options, StageTimer& timer,
                                                   Progress& progress) {
  Plan plan = make_plan(scene);
  Realizer realizer{scene, options, Detail::shown, timer, progress};
  const auto done = realizer.execute(plan);
  progress.end();
  if (!done) return std::unexpected(done.error());
  RunResult result{std::move(realizer).take()};
  result.notes = notes_of(scene, result);
  result.title = scene.title;
  result.seed = scene.seed;
  result.scene_file = scene.file_name;
  result.scene_sha256 = scene.sha256;
  result.files = scene.files;
  result.north = scene.north;
  result.plan = std::move(plan);
  result.cost = cost_of(timer, options.threads);
  result.output = scene.output;
  result.rock = scene.rock;
  result.stability = scene.stability;
  for (const Excavation& excavation : scene.excavations) {
    result.excavations.push_back({excavation.name, excavation.stage, excavation.tunnel});
  }
  result.micro_blocks = scene.micro_blocks;
  if (scene.support) result.bolt_groups = scene.support->groups;
  result.tunnel_length = tunnel_length(scene);
  result.figures = count(result);
  return result;
}

}  // namespace cleave::scene
