#include "motion_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cleave::scene {
namespace {

using topology::BlockComplex;

/// How far two runs come apart, frame by frame, until a block is further apart than a quarter of its size.
struct Apart {
  double most = 0;                ///< m, before that
  std::optional<Time> lost = {};  ///< the last frame before that; empty: it never is
};
Apart apart(const MotionResult& result, const MotionResult& other, const BlockComplex& complex, Time until) {
  Apart out;
  for (std::size_t f = 0; f < std::min(other.frames.size(), result.frames.size()); ++f) {
    if (result.frames[f].time > until) break;
    double now = 0;
    for (std::size_t k = 0; k < result.blocks.size(); ++k) {
      const MotionFrame::Place &a = result.frames[f].places[k], &b = other.frames[f].places[k];
      const double size = std::cbrt(complex.blocks()[result.blocks[k].block].volume.si());
      const motion::Turn between = motion::Turn{a.turn.w, -a.turn.x, -a.turn.y, -a.turn.z} * b.turn;
      const double own = norm(a.shift - b.shift) + size * angle_of(between);
      if (own > 0.25 * size) {
        out.lost = result.frames[f == 0 ? 0 : f - 1].time;
        return out;
      }
      now = std::max(now, own);
    }
    out.most = std::max(out.most, now);
  }
  return out;
}

/// The same with bounds of a step so many times as large; empty: it could not be made.
std::optional<MotionResult> with_steps(double times, const Scene& scene, const BlockComplex& complex,
                                       const MotionCast& cast, motion::WorldOptions options,
                                       const std::function<bool()>& stop) {
  // Steps end where states are written: longer ones are none.
  options.step = times * std::min(options.step, MotionRecorder::between_frames(*scene.motion));
  options.displacement *= times;
  options.rotation *= times;
  auto world = motion::World::make(cast.scene, options);
  if (!world) return std::nullopt;
  MotionRecorder recorder{scene, complex, cast, *std::move(world)};
  recorder.follow(stop);
  return recorder.close();
}

}  // namespace

void estimate_error(const Scene& scene, const BlockComplex& complex, const MotionCast& cast,
                    const motion::WorldOptions& options, const std::function<bool()>& stop, MotionResult& result) {
  const auto fine = with_steps(0.5, scene, complex, cast, options, stop);
  const bool known = fine && fine->converged;
  const auto coarse = known ? with_steps(2, scene, complex, cast, options, stop) : std::nullopt;
  if ((fine && fine->interrupted) || (coarse && coarse->interrupted)) {
    result.interrupted = true;
    result.converged = false;
    result.stopped_why = fmt::format("interrupted at {:.6g} s", result.end.si()) + ", before its error was known";
    return;
  }
  if (!known) return;
  const Apart finer = apart(result, *fine, complex, result.end);
  result.determined = finer.lost.value_or(result.end);
  // Where things hit, errors fall as the step, and not evenly: two runs may agree by chance where a third does not.
  double error = 2 * finer.most;
  if (coarse && coarse->converged) {
    error = std::max(error, apart(result, *coarse, complex, *result.determined).most);
  }
  result.error = metres(error);
  if (finer.lost) {
    result.notes.push_back(
        fmt::format("motion: from {:.3g} s on a run with half the step goes another way, as impacts are chaotic: what "
                    "comes then is one outcome of many, and estimated_error_m says nothing of it",
                    finer.lost->si()));
  }
}

}  // namespace cleave::scene
