#include "contact_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "contact_parts.hpp"

namespace cleave::scene {
namespace {

using bem::Vec2;

/// Each run has steps so many times as long as the one before. No whole number: steps that end together with those of
/// the run before meet an impact at the same place of a step, and agree however wrong they are.
constexpr double longer_by = 1.87;
/// Fewer steps make no series: the longest are 6.5 times as long.
constexpr std::uint64_t fewest_steps = 32;
/// Steps a period of the slowest vibration takes at least when a run is said to follow it.
constexpr double steps_a_period = 10;

struct LongRun {
  std::vector<std::vector<Vec2>> outlines;  // at the end; empty: it stopped
  std::uint64_t steps = 0;
  bool something_hit = false;
  bool interrupted = false;
};

LongRun run_with(const ContactScene& scene, const WithLongerSteps& with, double longer,
                 const std::function<bool()>& stop) {
  LongRun out;
  std::optional<dbem::World> world = with(longer);
  if (!world) return out;
  const double duration = scene.settings.duration;
  double next = longer * scene.settings.step;
  while (world->time() < duration * (1 - 1e-12)) {
    out.interrupted = stop && stop();
    if (out.interrupted) return out;
    const double left = duration - world->time();
    auto report = world->step(left < next * (1 + 1e-9) ? left : left < 2 * next ? left / 2 : left);
    if (!report) return out;
    ++out.steps;
    out.something_hit = out.something_hit || report->impact || report->slip_turned;
    if (report->cuts == 0 && report->shortened == 0) next = std::max(next, report->step);
  }
  for (std::size_t b = 0; b < world->size(); ++b) out.outlines.push_back(world->outline(b));
  return out;
}

double largest_change(const std::vector<std::vector<Vec2>>& a, const std::vector<std::vector<Vec2>>& b) {
  double out = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    for (std::size_t c = 0; c < a[k].size(); ++c) out = std::max(out, norm(a[k][c] - b[k][c]));
  }
  return out;
}

/// Why longer steps say nothing of shorter ones: vibrations that no step of these follows. Empty: they do.
std::string not_followed(const ContactScene& scene, const dbem::World& world) {
  for (std::size_t b = 0; b < world.size(); ++b) {
    const auto& modes = world.body(b).modes;
    if (!modes || modes->omega.empty() || modes->damping >= 1) continue;
    const double period = 2 * std::numbers::pi / modes->omega.front();
    if (std::max(scene.settings.step, scene.settings.max_step) * steps_a_period > period) {
      return fmt::format("\"{}\" vibrates with a period of {:.2g} s, which no steps above {:.2g} s follow",
                         scene.bodies[b].name, period, period / steps_a_period);
    }
  }
  const std::optional<BoltSwing> swing = fastest_swing(scene, world);
  if (swing && std::max(scene.settings.step, scene.settings.max_step) * steps_a_period > swing->period) {
    return fmt::format("what bolt \"{}\" holds swings with a period of {:.2g} s, which no steps above {:.2g} s follow",
                       swing->bolt, swing->period, swing->period / steps_a_period);
  }
  return "";
}

}  // namespace

ErrorEstimate estimate_of_steps(std::array<double, 3> changes, int order) {
  constexpr double rounding = 1e-8;  // below it changes are no series
  constexpr double too_much = 0.3;
  constexpr double slowest = 0.85;                // ratios of a series that are believed
  const double fastest = order == 1 ? 0.6 : 0.4;  // where something hits no two changes are alike
  if (!std::ranges::all_of(changes, [](double c) { return std::isfinite(c); })) {
    return {std::nullopt, "runs with longer steps differ without bound"};
  }
  const double falls = std::pow(longer_by, -order);
  const double first = std::max(changes[1], falls * changes[2]), last = std::max(changes[0], falls * first);
  if (first <= rounding) return {std::max(0.01 * first, last), ""};
  if (last > slowest * first) {
    return {std::nullopt, fmt::format("{0} times the step changes it by {1:.2g}, {0} times that by {2:.2g} more, and "
                                      "again {3:.2g}: this does not fall as in a series",
                                      longer_by, changes[0], changes[1], changes[2])};
  }
  const double share = std::max(last / first, fastest);
  const double error = last * share / (1 - share);
  if (error > too_much) {
    return {std::nullopt,
            fmt::format("{} times the step changes it by {:.2g}: too coarse for an estimate", longer_by, changes[0])};
  }
  return {error, ""};
}

bool estimate_steps(const ContactScene& scene, const WithLongerSteps& with, const dbem::World& end, bool something_hit,
                    const std::function<bool()>& stop, ContactResult& result) {
  if (!scene.settings.estimate) {
    result.no_estimate = "not asked for: contact.estimate";
    return true;
  }
  if (!result.converged || scene.settings.to_rest || !(result.largest_displacement > 0)) {
    result.no_estimate = "the run has no steps in time to its end";
    return true;
  }
  result.no_estimate = not_followed(scene, end);
  if (!result.no_estimate.empty()) return true;
  if (result.steps < fewest_steps) {
    result.no_estimate = fmt::format("fewer than {} steps", fewest_steps);
    return true;
  }
  LongRun before{.outlines = {}, .steps = result.steps, .something_hit = something_hit};
  for (std::size_t b = 0; b < end.size(); ++b) before.outlines.push_back(end.outline(b));
  std::array<double, 3> changes{};
  bool hit = something_hit;
  double longer = 1;
  for (double& change : changes) {
    longer *= longer_by;
    LongRun now = run_with(scene, with, longer, stop);
    if (now.interrupted) return false;
    if (now.outlines.empty()) {
      result.no_estimate = "a run with longer steps stops";
      return true;
    }
    if (4 * now.steps > 3 * before.steps) {
      result.no_estimate = "steps are cut whatever their length: runs with longer ones are nearly the same run";
      return true;
    }
    change = largest_change(before.outlines, now.outlines) / result.largest_displacement;
    hit = hit || now.something_hit;
    before = std::move(now);
  }
  const ErrorEstimate estimate = estimate_of_steps(changes, hit ? 1 : 2);
  result.error = estimate.error;
  result.no_estimate = estimate.why_not;
  return true;
}

}  // namespace cleave::scene
