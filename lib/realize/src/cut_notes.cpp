#include "cut_notes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace cleave::scene {
namespace {

/// A length a little above, in two digits.
double rounded_up(double length) {
  const double unit = std::pow(10.0, std::floor(std::log10(length)) - 1);
  return std::ceil(1.05 * length / unit) * unit;
}

/// A length a little below, in two digits.
double rounded_down(double length) {
  const double unit = std::pow(10.0, std::floor(std::log10(length)) - 1);
  return std::floor(0.95 * length / unit) * unit;
}

/// "joint crown (scene.toml:14)", "joint 7 (scene.toml:14)", "joint 7 (A #3)".
std::string name_of(topology::JointId id, const Scene& scene, const Realization& made) {
  const bool named = id.index() < scene.joints.size() && !scene.joints[id.index()].name.empty();
  return fmt::format("joint {} ({})", named ? scene.joints[id.index()].name : std::to_string(id.value()),
                     from_scene(scene, made.joints[id].source));
}

/// What removes rock never lies outside by 100 %.
std::string percent_outside(double share) {
  return share > 0.9995 && share < 1 ? fmt::format("all but {:.2g} %", 100 * (1 - share))
                                     : fmt::format("{:.3g} %", 100 * share);
}

/// Joints that lie on one another and differ in strength: a fault given twice, or measured twice and merged by `snap`.
void add_overlap_note(const Scene& scene, const Realization& made, std::vector<std::string>& notes) {
  std::vector<std::pair<topology::JointId, topology::JointId>> unlike;
  for (const auto& [one, other] : made.cut.overlapping) {
    if (made.joints[one].strength != made.joints[other].strength) unlike.emplace_back(one, other);
  }
  if (unlike.empty()) return;
  const auto& [one, other] = unlike.front();
  notes.push_back(fmt::format(
      "{} lie on one another and have other strengths ({} and {}): where they do, the one counts that bears less shear "
      "under {:g} kPa",
      unlike.size() == 1 ? "two joints" : fmt::format("{} pairs of joints", unlike.size()), name_of(one, scene, made),
      name_of(other, scene, made), normal_stress_on_overlaps.si() / 1e3));
}

/// Joints that end inside the rock. Of drawn ones many always do: no matter, until nearly all do.
void add_dangling_notes(const Scene& scene, const Realization& made, std::vector<std::string>& notes) {
  const auto drawn = [&](const JointInfo& joint) { return joint.origin == JointOrigin::drawn; };
  const auto all_drawn = static_cast<std::size_t>(std::ranges::count_if(made.joints, drawn));
  std::vector<topology::JointId> given = made.cut.dangling;
  std::erase_if(given, [&](topology::JointId id) { return drawn(made.joints[id]); });
  const auto say = [&](std::size_t count, std::size_t of, std::string_view kind, const std::string& which) {
    notes.push_back(fmt::format("{} of {} {}joints {} inside the rock and {} nothing{}", count, of, kind,
                                count == 1 ? "ends" : "end", count == 1 ? "separates" : "separate", which));
  };
  if (!given.empty()) {
    constexpr std::size_t named = 8;
    std::string which;
    for (std::size_t i = 0; i < given.size() && given.size() <= named; ++i) {
      which += (i == 0 ? ": " : ", ") + name_of(given[i], scene, made);
    }
    say(given.size(), made.joints.size() - all_drawn, all_drawn == 0 ? "" : "given ", which);
  }
  const std::size_t of_drawn = made.cut.dangling.size() - given.size();
  if (of_drawn > 0 && 100 * of_drawn >= 99 * all_drawn) {
    say(of_drawn, all_drawn, "drawn ", ": check their size and intensity, in metres");
  }
}

}  // namespace

void add_cut_notes(const Scene& scene, const Realization& made, std::vector<std::string>& notes) {
  const topology::CutReport& report = made.cut;
  const std::size_t joints = made.joints.size();
  if (const topology::CoarseSnap& coarse = report.coarse_snap; coarse.polygons > 0) {
    notes.push_back(fmt::format(
        "snap is too coarse for {}: the shortest side, of {}, is {:.2g} m, and corners nearer than twice the snap "
        "become "
        "one or pass each other, so there may be other blocks than those meant; a snap of {:.2g} keeps them all",
        coarse.polygons == 1 ? "a polygon" : fmt::format("{} polygons", coarse.polygons),
        name_of(coarse.joint, scene, made), coarse.shortest.si(), rounded_down(coarse.shortest.si() / 2)));
  }
  if (const topology::NearMisses& near = report.near_misses; near.sides > 0) {
    notes.push_back(fmt::format(
        "{} of joints {} another polygon by less than 1e-6 of the domain without touching it all along, by {:.2g} m "
        "at most ({} and {}): the rock is not divided there; snap = {:.2g} would close that",
        near.sides == 1 ? "a side" : fmt::format("{} sides", near.sides), near.sides == 1 ? "misses" : "miss",
        near.largest.si(), name_of(near.joint, scene, made),
        near.other ? name_of(*near.other, scene, made) : std::string{"a side of the domain or an excavation"},
        rounded_up(near.largest.si())));
  }
  add_overlap_note(scene, made, notes);
  if (report.joints_outside > 0) {
    notes.push_back(fmt::format("{} of {} joints lie outside the rock and cut nothing", report.joints_outside, joints));
  }
  add_dangling_notes(scene, made, notes);
}

void add_micro_note(const topology::BlockComplex& complex, const MicroBlocks& limits, std::vector<std::string>& notes) {
  if (limits.policy == MicroBlockPolicy::keep) return;
  const auto found = micro_blocks(complex, limits);
  if (found.empty()) return;
  double volume = 0;
  for (const topology::BlockId b : found) volume += complex.blocks()[b].volume.si();
  notes.push_back(fmt::format("{} of {} blocks {} ({:.3g} m3 in all){}", found.size(), complex.blocks().size(),
                              found.size() == 1 ? "is a micro-block" : "are micro-blocks", volume,
                              limits.policy == MicroBlockPolicy::exclude ? ": left out of stability" : ""));
}

std::string note_on(const WindowInfo& window) {
  return fmt::format(
      "only key blocks were asked for: of the rock only the box from ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, "
      "{:.6g}) "
      "was cut; {} of its blocks go on outside it and are shown as far as it goes",
      window.min.x, window.min.y, window.min.z, window.max.x, window.max.y, window.max.z, window.truncated);
}

void add_excavation_notes(const std::vector<ExcavationInfo>& excavations, std::vector<std::string>& notes) {
  const auto lies_outside = [](const ExcavationInfo& info) {
    return info.outside_share.value_or(0) > 0 && !info.ends_only_outside;
  };
  const auto outside = std::ranges::count_if(excavations, lies_outside);
  if (outside == 1) {
    const auto info = std::ranges::find_if(excavations, lies_outside);
    notes.push_back(fmt::format("{}: {} of it lies outside the domain; it removes {:.6g} m3 of rock", info->name,
                                percent_outside(*info->outside_share), info->taken.removed.si()));
  } else if (outside > 1) {
    const auto share = [&](const ExcavationInfo& info) { return lies_outside(info) ? *info.outside_share : 0; };
    const auto most = std::ranges::max_element(excavations, {}, share);
    double removed = 0;
    for (const ExcavationInfo& info : excavations) removed += lies_outside(info) ? info.taken.removed.si() : 0;
    notes.push_back(
        fmt::format("{} openings lie partly outside the domain, up to {} of one ({}); they remove {:.6g} m3 of "
                    "rock: the list of excavations has the share of each",
                    outside, percent_outside(*most->outside_share), most->name, removed));
  }
  for (const ExcavationInfo& info : excavations) {
    if (info.taken.inside.si() > 0 && !(info.taken.removed.si() > 0)) {
      notes.push_back(fmt::format("{}: removes no rock that the openings before it have left", info.name));
    }
  }
}

}  // namespace cleave::scene
