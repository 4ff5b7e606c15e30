#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string_view>

#include "cleave/scene/time_course_keys.hpp"
#include "cleave/scene3d/key_tables.hpp"
#include "context.hpp"

namespace cleave::scene {
namespace {

constexpr NumberRule duration_rule{0, true, 1e4, false, " s"};
constexpr NumberRule step_rule{1e-6, false, 1, false, " s"};
constexpr NumberRule drains_rule{0, true, 1e3, false, " m"};
constexpr std::array<std::string_view, 1> until_rest{"rest"};
/// s; accelerograms have steps of 0.001 to 0.05 s.
constexpr double longest_record_step = 1;

const KeyTable& moving_ground_record_keys() {
  static const KeyTable keys{.name = "motion.ground.record",
                             .keys = record_keys({{"x", "m/s2 along x, the first at 0 s; 0 after the last"},
                                                  {"y", "m/s2 along y, likewise"},
                                                  {"z", "m/s2 upwards, likewise"}})};
  return keys;
}

const KeyTable& moving_ground_keys() {
  static const KeyTable keys{
      .name = "motion.ground",
      .keys = {{"acceleration", key::vector(ground_rule), "", "`[x, y, z]` in m/s2, times `time`"},
               {"time", key::table(&time_function_keys), "constant", "`step`, `ramp`, `pulse` or `harmonic`"},
               {"record", key::table(&moving_ground_record_keys), "", "`{ step, x, y, z, scale }`: an accelerogram"}},
      .one_of = {{"acceleration", "record"}}};
  return keys;
}

/// [motion.ground], and notes where the run does not see all of it.
void parse_moving_ground(const TableReader& motion, MotionSettings& settings) {
  const auto found = motion.sub("ground");
  if (!found || found->one_of() == nullptr) return;
  settings.ground = parse_course(*found, found->vec3("acceleration").value_or(geometry::Vec3{}));
  const TimeCourse<geometry::Vec3>& ground = *settings.ground;
  const Time changes = ground.fastest(), end = ground.end();
  if (const auto record = found->sub("record"); record && ground.step.si() > longest_record_step) {
    record->note("step",
                 fmt::format("is {:g} s between two values: records of earthquakes have thousandths to hundredths of a "
                             "second",
                             ground.step.si()),
                 fmt::format("if it is in ms, set step = {:g}", ground.step.si() / 1000));
  }
  if (settings.step > 0.2 * changes) {
    motion.note("step",
                fmt::format("is {:g} s, long for ground that moves within {:.3g} s: only its mean over each step acts",
                            settings.step.si(), changes.si()),
                fmt::format("set motion.step = {:.2g}", changes.si() / 20));
  }
  if (std::isfinite(end.si()) && settings.duration < end) {
    motion.note("duration",
                fmt::format("is {:g} s, and the ground moves for {:g} s: the rest of that is left out",
                            settings.duration.si(), end.si()),
                fmt::format("set motion.duration = {:g} or more", end.si()));
  }
  if (settings.to_rest && !std::isfinite(end.si())) {
    motion.note("until", "is \"rest\", but the ground moves for ever: nothing comes to rest before `duration`",
                "remove until, or give the ground a pulse or a record");
  }
}

}  // namespace

const KeyTable& motion_keys() {
  static const KeyTable keys{
      .name = "motion",
      .keys = {
          {"release", key::word<Release>(), "\"batches\"",
           "which blocks are let go: those of the `\"batches\"` of key blocks; `\"all\"` that no side of the domain "
           "holds; those of the batches and of key `\"groups\"`; those that leave in a `\"stage\"` of `[sequence]`, "
           "one "
           "stage after the other. All others are walls"},
          {"duration", key::number(duration_rule), "10", "s"},
          {"until", key::word(until_rest), "", "`\"rest\"`: ends when all are at rest, after `duration` at the latest"},
          {"step", key::number(step_rule), "0.01", "s, the longest; steps are shortened where something moves far"},
          {"frame", key::number(duration_rule), "a fiftieth of `duration`", "s between two written states"},
          {"restitution", key::number(rule::probability), "0", "of the speed of approach, given back at an impact"},
          {"surface_friction", key::number(rule::friction), "35",
           "degrees, of faces that are no joints; of two faces the lesser counts"},
          {"support", key::flag(), "true",
           "the bolts of `[support]` hold what they tie, along their axes, until they break; false: blocks move "
           "without"},
          {"loads", key::flag(), "true",
           "water in joints, surcharges, point and line forces of `[stability]` act; false: gravity alone"},
          {"drains_at", key::number(drains_rule), "0.1",
           "m: a joint that has opened by more has drained, and so has one that has slid by more than that and its own "
           "size"},
          {"seismic", key::flag(), "false",
           "the static force of `seismic` of `[stability]` pushes for the whole run, to compare with the verdict; "
           "what an earthquake does is `ground`"},
          {"ground", key::table(&moving_ground_keys), "at rest",
           "motion of all that is fixed: `{ acceleration, time }` or `{ record }`, see below"},
          {"error", key::flag(), "true",
           "runs again with half and with twice the step and estimates the error of the steps"}}};
  return keys;
}

std::optional<MotionSettings> parse_motion(const TableReader& root, const std::optional<StabilitySettings>& stability,
                                           const std::optional<SequenceSettings>& sequence) {
  const auto found = root.sub("motion");
  if (!found) return std::nullopt;
  const TableReader& table = *found;
  MotionSettings settings;
  settings.line = table.line();
  settings.release = table.word<Release>("release");
  settings.duration = Time::from_si(table.value("duration"));
  settings.to_rest = table.choice("until").has_value();
  settings.step = Time::from_si(table.value("step"));
  if (const auto frame = table.number("frame")) settings.frame = Time::from_si(*frame);
  if (settings.frame && *settings.frame > settings.duration) {
    table.note("frame",
               fmt::format("is {:g} s, longer than the duration of {:g} s: the start and the end alone are written",
                           settings.frame->si(), settings.duration.si()),
               fmt::format("set motion.frame = {:g}", settings.duration.si() / 50));
  }
  if (table.has("step") && settings.step > settings.duration && settings.duration.si() > 0) {
    table.note("step",
               fmt::format("is {:g} s, longer than the duration of {:g} s: steps are no longer than from one written "
                           "state to the next",
                           settings.step.si(), settings.duration.si()),
               fmt::format("set motion.step = {:g} or a longer duration", settings.duration.si() / 100));
  }
  settings.restitution = table.value("restitution");
  settings.surface_friction = FrictionAngle::degrees(table.value("surface_friction"));
  settings.support = table.flag("support");
  settings.loads = table.flag("loads");
  settings.drains_at = metres(table.value("drains_at"));
  settings.seismic = table.flag("seismic");
  settings.error = table.flag("error");
  parse_moving_ground(table, settings);
  if (settings.seismic && settings.ground) {
    table.error("seismic", "is true, but the ground moves as well: the earthquake would act twice",
                "remove motion.seismic or motion.ground");
  }
  if (settings.seismic && stability && norm(stability->loads.body.seismic()) == 0) {
    table.note("seismic", "is true, but [stability] has no seismic force", "give stability.seismic, or remove it");
  }
  if (!stability && root.problems().errors() == 0) {
    root.error("motion", "lets blocks go, but nothing is free", "add an excavation or stability.free");
  }
  if (settings.release == Release::groups && stability && stability->groups == stability::GroupsCheck::off) {
    table.error("release", "is \"groups\", but stability.groups is \"off\"", "set stability.groups = \"note\"");
  }
  if (settings.release == Release::stage && !sequence && root.problems().errors() == 0) {
    table.error("release", "is \"stage\", but all excavations are of one stage",
                "give the excavations different `stage` numbers, or take \"batches\"");
  }
  return settings;
}

}  // namespace cleave::scene
