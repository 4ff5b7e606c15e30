#include "cleave/realize/run.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include "cleave/core/assert.hpp"
#include "cleave/core/expected.hpp"
#include "cleave/topology/cut.hpp"
#include "cut_estimate.hpp"
#include "cut_notes.hpp"
#include "cut_problem.hpp"
#include "judge.hpp"
#include "realizer.hpp"
#include "run_notes.hpp"

namespace cleave::scene {
namespace {

/// A part of an opening's volume below which it is rounding.
constexpr double rounding = 1e-9;

/// The part [first, second] of the way from a to b that lies in a box; empty where first > second.
std::pair<double, double> part_in(const geometry::Box& box, geometry::Vec3 a, geometry::Vec3 b) {
  double first = 0, second = 1;
  const auto clip = [&](double from, double to, double low, double high) {
    if (from == to) {
      if (from < low || from > high) second = -1;
      return;
    }
    const double at_low = (low - from) / (to - from), at_high = (high - from) / (to - from);
    first = std::max(first, std::min(at_low, at_high));
    second = std::min(second, std::max(at_low, at_high));
  };
  clip(a.x, b.x, box.min.x, box.max.x);
  clip(a.y, b.y, box.min.y, box.max.y);
  clip(a.z, b.z, box.min.z, box.max.z);
  return {first, second};
}

/// Whether `outside` of an opening's `own` volume, m3, is that of the ends of its axis which go on beyond the domain,
/// each by its width at most.
bool ends_alone(const TunnelLine& tunnel, const geometry::Box& domain, double own, double outside) {
  const auto across = [](const std::array<double, 2>& corner) { return corner[0]; };
  const auto [left, right] = std::ranges::minmax_element(tunnel.outline, {}, across);
  const double width = across(*right) - across(*left);
  double length = 0, inside = 0, before = 0, after = 0;  // m of the axis
  for (std::size_t i = 0; i + 1 < tunnel.axis.size(); ++i) {
    const double leg = norm(tunnel.axis[i + 1] - tunnel.axis[i]);
    const auto [from, to] = part_in(domain, tunnel.axis[i], tunnel.axis[i + 1]);
    const bool meets = from < to;
    if (inside == 0) before += (meets ? from : 1) * leg;
    after = meets ? (1 - to) * leg : after + leg;
    length += leg;
    inside += meets ? (to - from) * leg : 0;
  }
  constexpr double slack = 1e-6;
  return inside > 0 && before <= width && after <= width && outside <= own * (1 - inside / length + slack);
}

/// What each opening takes of the rock, in order of the scene.
std::vector<ExcavationInfo> taken_by(const Scene& scene, const SampledScene& drawn,
                                     const std::vector<topology::ExcavatedVolume>& volumes) {
  CLEAVE_ASSERT(volumes.size() == scene.excavations.size());
  std::vector<ExcavationInfo> excavations;
  for (std::size_t e = 0; e < volumes.size(); ++e) {
    const Excavation& excavation = scene.excavations[e];
    ExcavationInfo& info = excavations.emplace_back(
        ExcavationInfo{excavation.name, excavation.stage, excavation.tunnel, volumes[e], {}, excavation.wall});
    const double own = drawn.input.excavations[e].volume().si();
    if (!excavation.own_shape() || !(own > 0)) continue;
    const double outside = 1 - volumes[e].inside.si() / own;
    info.outside_share = outside > rounding ? outside : 0;
    info.ends_only_outside =
        info.tunnel && ends_alone(*info.tunnel, box_of(drawn.input.domain.vertices()), own, outside * own);
  }
  return excavations;
}

/// The same of a run; where only a part of the rock was cut, the openings are cut alone.
std::expected<std::vector<ExcavationInfo>, std::vector<Problem>> taken_by(const Scene& scene, const Realization& made) {
  if (!made.window) return taken_by(scene, made, made.cut.excavated);
  const auto whole = topology::cut({.domain = made.input.domain, .excavations = made.input.excavations});
  if (!whole) return std::unexpected(std::vector{problem_of(whole.error(), scene, made)});
  return taken_by(scene, made, whole->report().excavated);
}

/// [[excavation]] tables whose openings all miss the rock.
std::vector<Problem> without_rock(const Scene& scene, const std::vector<ExcavationInfo>& excavations) {
  std::vector<Problem> problems;
  for (std::size_t first = 0, last = 0; first < scene.excavations.size(); first = last) {
    double inside = 0;
    for (last = first; last < scene.excavations.size() && scene.excavations[last].line == scene.excavations[first].line;
         ++last) {
      inside += excavations[last].taken.inside.si();
    }
    if (inside > 0) continue;  // zero, not small: it is a sum over the cells of the opening
    problems.push_back({scene.shown, scene.excavations[first].line, "excavation " + scene.excavations[first].name,
                        "removes no rock: it lies wholly outside the domain",
                        "move it into the domain, or enlarge the domain"});
  }
  return problems;
}

}  // namespace

std::vector<Problem> refusals(const Scene& scene, const RunOptions& options, TooLarge too_large) {
  const auto drawn = sample(scene);
  if (!drawn) return drawn.error();
  const auto cut = topology::cut({.domain = drawn->input.domain,
                                  .excavations = drawn->input.excavations,
                                  .free_domain_tags = drawn->input.free_domain_tags});
  if (!cut) return {problem_of(cut.error(), scene, *drawn)};
  std::vector<Problem> problems = without_rock(scene, taken_by(scene, *drawn, cut->report().excavated));
  if (scene.stability) std::ranges::move(misplaced_loads(scene, *drawn, *cut), std::back_inserter(problems));
  // Joints by the million are not looked through where no run would cut them.
  const bool known = !(scene.output.only_key_blocks && scene.stability && !scene.sequence) && !scene.monte_carlo;
  const auto large = options.memory_mb ? too_large_for(*options.memory_mb, scene, *drawn) : std::nullopt;
  if (!large) {
    if (const auto refused = topology::refusal_of(drawn->input)) return {problem_of(*refused, scene, *drawn)};
  } else if (known && too_large == TooLarge::refused && problems.empty()) {
    problems.push_back(*large);
  }
  return problems;
}

std::expected<Excavated, std::vector<Problem>> excavated(const Scene& scene) {
  Excavated out;
  if (scene.excavations.empty()) return out;
  CLEAVE_TRY(const SampledScene drawn, sample(scene));
  const auto cut = topology::cut({.domain = drawn.input.domain, .excavations = drawn.input.excavations});
  if (!cut) return std::unexpected(std::vector{problem_of(cut.error(), scene, drawn)});
  const std::vector<ExcavationInfo> taken = taken_by(scene, drawn, cut->report().excavated);
  if (auto missing = without_rock(scene, taken); !missing.empty()) return std::unexpected(missing);
  for (const ExcavationInfo& info : taken) out.openings.push_back({info.name, info.taken.removed, info.outside_share});
  add_excavation_notes(taken, out.notes);
  return out;
}

std::expected<RunResult, std::vector<Problem>> run(const Scene& scene, const RunOptions& options, StageTimer& timer,
                                                   Progress& progress) {
  Plan plan = plan_of_realization(scene);
  Realizer realizer{scene, options, Detail::shown, timer, progress};
  const auto done = realizer.execute(plan);
  progress.end();
  if (!done) return std::unexpected(done.error());
  const std::vector<std::string> later_notes = realizer.notes();
  RunResult result{std::move(realizer).take(), head_of(scene, std::move(plan))};
  if (result.complex) {
    CLEAVE_TRY(result.excavations, timer.run(name_of(Step::cut), [&] { return taken_by(scene, result); }));
    if (auto missing = without_rock(scene, result.excavations); !missing.empty()) return std::unexpected(missing);
  } else {  // no volume of such a cut is to be trusted
    for (const Excavation& excavation : scene.excavations) {
      result.excavations.push_back({.name = excavation.name, .stage = excavation.stage, .tunnel = excavation.tunnel});
    }
  }
  result.notes = notes_of(scene, result);
  std::ranges::copy(later_notes, std::back_inserter(result.notes));
  if (result.motion) std::ranges::copy(result.motion->notes, std::back_inserter(result.notes));
  if (result.flow) std::ranges::copy(result.flow->notes, std::back_inserter(result.notes));
  if (result.complex) add_excavation_notes(result.excavations, result.notes);
  std::ranges::move(notes_on_lines(scene), std::back_inserter(result.notes));
  result.files = scene.files;
  result.north = scene.north;
  result.cost = cost_of(timer, options.threads);
  result.rock = scene.rock;
  result.stability = scene.stability;
  result.micro_blocks = scene.micro_blocks;
  if (scene.support) result.bolt_groups = scene.support->groups;
  result.tunnel_length = tunnel_length(result.excavations);
  result.figures = count(result);
  result.figures.input.lines = count_lines(scene, result.input);
  return result;
}

}  // namespace cleave::scene
