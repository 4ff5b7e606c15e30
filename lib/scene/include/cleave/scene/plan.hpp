#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/core/cost.hpp"
#include "cleave/core/fields.hpp"
#include "cleave/core/quantity.hpp"
#include "cleave/core/version.hpp"
#include "cleave/scene/output.hpp"

namespace cleave::scene {

/// The steps of a run, in order; names as in summary.json.
enum class Step : std::uint8_t {
  read,
  draw,
  cut,
  audit,
  flow,  ///< only in plans of scenes with [flow]
  stability,
  support,
  monte_carlo,
  elastic,
  contact,
  write,
  report
};

inline constexpr std::array all_steps{Step::read,    Step::draw,      Step::cut,     Step::audit,
                                      Step::flow,    Step::stability, Step::support, Step::monte_carlo,
                                      Step::elastic, Step::contact,   Step::write,   Step::report};

/// "read", "draw", ... as in summary.json: the enumerators.
[[nodiscard]] std::string_view name_of(Step step) noexcept;

struct PlannedStep {
  Step step;
  bool run;
  std::string why;                       ///< one sentence part without a full stop: "no excavation and no free face"
  std::vector<std::string> inputs = {};  ///< tables of the scene that it takes
  double seconds = 0;                    ///< of CPU, expected
};

/// Rough figures for people, from the scene alone; never used to decide anything.
struct SizeEstimate {
  double joints = 0;      ///< expected number
  double blocks_low = 1;  ///< blocks: a bracket
  double blocks_high = 1;
  double memory_mb = 0;
  double seconds = 0;  ///< of CPU, but for `together`
  /// Of CPU, at most in most scenes: blocks judged together. How many lie near free faces and how they hold each other
  /// only the cut tells, and scenes of one size differ by a thousand.
  Time together = {};
  double most_together = 0;  ///< nothing where more blocks than these are near free faces; 0: there are fewer
};

/// What a run of a scene does and leaves out, one entry a step in the order of `all_steps` (but
/// for those that are not listed where nothing asks for them): the run executes those
/// entries and nothing else.
struct Plan {
  std::vector<PlannedStep> steps;
  SizeEstimate estimate;

  [[nodiscard]] bool runs(Step step) const noexcept;
};

/// A line for each step: its name, whether it runs, and why; with `inputs` also what it takes and what it may cost.
[[nodiscard]] std::string describe(const Plan& plan, bool inputs = false);

/// What one step cost. CPU time is that of all threads; the peak is the process's high-water mark at the step's end.
struct StepCost {
  Step step = Step::read;
  double wall_s = 0;
  double cpu_s = 0;
  double peak_rss_mb = 0;
};
template <class V>
void fields(V& v, const StepCost& x) {
  v("stage", name_of(x.step));
  v("wall_s", x.wall_s);
  v("cpu_s", x.cpu_s);
  v("peak_rss_mb", x.peak_rss_mb, "high-water mark of the process at the end of the stage");
}

/// What the run cost so far. `steps` holds only steps that ran, in order.
struct RunCost {
  double wall_s = 0;
  double cpu_s = 0;
  double peak_rss_mb = 0;
  unsigned threads = 1;
  std::vector<StepCost> steps;
};
template <class V>
void fields(V& v, const RunCost& x) {
  v("wall_s", x.wall_s);
  v("cpu_s", x.cpu_s, "of all threads");
  v("peak_rss_mb", x.peak_rss_mb);
  v("threads", x.threads);
  v("stages", x.steps);
}
template <class V>
void fields(V& v, const PlannedStep& x) {
  v("stage", one_of(x.step));
  v("run", x.run);
  v("why", x.why);
}

struct InputFigures {
  std::uint64_t joints = 0;
  double lattice_pitch_m = 0;
  double largest_snap_m = 0;
  std::uint64_t merged_planes = 0;
};
template <class V>
void fields(V& v, const InputFigures& x) {
  v("joints", x.joints, "measured and drawn");
  v("lattice_pitch_m", x.lattice_pitch_m, "distance of the lattice's sites, a power of two");
  v("largest_snap_m", x.largest_snap_m, "largest shift of an input point onto the lattice");
  v("merged_planes", x.merged_planes, "near-coincident planes merged because of the scene's `snap`");
}

/// What the result of every kind of scene begins with.
struct ResultHead {
  std::string title = {};
  Project project = {};
  std::uint64_t seed = 1;
  std::string scene_file = {};    ///< name without folder
  std::string scene_sha256 = {};  ///< of the scene file's bytes, hex
  Plan plan = {};
  RunCost cost = {};
  OutputSettings output = {};
  std::vector<std::string> notes = {};  ///< what a user should know: joints outside the domain, what was left out
};
/// A file's name, from the folder of the scene on where it lies there: so the same scene has the same notes anywhere.
[[nodiscard]] std::string from_scene(const SceneHead& scene, std::string file);
/// What was said of a scene as it was read.
[[nodiscard]] std::vector<std::string> notes_of(const SceneHead& scene);
/// Of a scene before it runs: without cost, and with the notes on the scene alone.
[[nodiscard]] ResultHead head_of(const SceneHead& scene, Plan plan);

/// What every summary.json begins with.
template <class V>
void head_fields(V& v, const ResultHead& x) {
  v("cleave", version, "version of the program");
  v("schema", 1U, "version of this schema");
  v("title", x.title);
  v("project", when(!x.project.empty(), x.project), "[project] of the scene; nothing is computed from it");
  v("seed", x.seed);
  v("scene_sha256", x.scene_sha256, "of the scene file's bytes, hexadecimal");
  v("plan", x.plan.steps);
  v("cost", x.cost);
  v("notes", x.notes,
    "what the user should know, as in the terminal, log.txt and the report; files are named from the scene's folder");
}

/// The timer's bookings as they stand in a result.
[[nodiscard]] RunCost cost_of(const StageTimer& timer, unsigned threads);

/// The state of an earlier run.
struct SavedRun {
  std::string name;  ///< of its file, for messages
  std::string bytes;
};

/// How a run of moving bodies begins and ends, beside what its scene says.
struct MovingRun {
  /// Goes on from there: every file of the result is that of a run that was not stopped, to the last byte. What moves,
  /// its laws and its loads must be the same, or it is a problem; lengths of steps and of the run, and what else says
  /// how it is solved, may differ. Empty: from the start.
  std::optional<SavedRun> from = {};
  /// Asked between steps; true ends the run, as one that did not come to its end.
  std::function<bool()> stop = {};
};

}  // namespace cleave::scene
