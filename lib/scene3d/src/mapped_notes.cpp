#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <string>

#include "cleave/scene3d/bounds.hpp"
#include "mapped.hpp"

namespace cleave::scene {
namespace {

using geometry::Vec3;

/// More traces than that are not compared with each other.
constexpr std::size_t most_compared = 5000;

/// A trace, of which joint, and the row it stands in.
struct Seen {
  const dfn::MappedTrace* trace;
  std::size_t joint;
  const MappedRow* row;
  [[nodiscard]] Vec3 middle() const { return 0.5 * (trace->ends[0] + trace->ends[1]); }
  [[nodiscard]] Vec3 along() const { return normalized(trace->ends[1] - trace->ends[0]); }
};

std::vector<Seen> traces_of(const MappedSettings& settings) {
  std::vector<Seen> all;
  for (std::size_t j = 0; j < settings.seen.joints.size(); ++j) {
    auto trace = settings.seen.joints[j].traces.begin();
    for (const MappedRow& row : settings.sources[j].rows) {
      if (!row.pick) all.push_back({&*trace++, j, &row});
    }
  }
  return all;
}

/// Planes of a set, within which nearly all of its joints lie.
struct Planes {
  Vec3 mean;
  double least;  ///< cosine to the mean normal
  double longest;
};

Planes planes_of(const dfn::JointSet& law, const MappedSettings& settings, bool mapped) {
  // The angle to the mean of 95 % of the joints of a law like Fisher's, over the mean square angle: 1.73.
  const double spread = 1.73 * std::acos(std::clamp(law.mean_cosine(), 0.0, 1.0)) + settings.seen.turn.radians();
  return {law.mean_normal(), std::cos(std::min(spread, 1.57)), mapped ? dfn::longest_trace(law).si() : 0};
}

class Comparison final {
 public:
  Comparison(const std::vector<RandomSet>& joint_sets, const MappedSettings& settings) : settings_{settings} {
    for (std::size_t i = 0; i < joint_sets.size(); ++i) {
      planes_.push_back(planes_of(joint_sets[i].law, settings, settings.sets[i] != 0));
    }
  }

  [[nodiscard]] bool may_be_one(const Seen& a, const Seen& b) const {
    if (a.joint == b.joint || a.trace->face == b.trace->face) return false;
    const auto &one = settings_.seen.joints[a.joint].set, &other = settings_.seen.joints[b.joint].set;
    if (one && other && *one != *other) return false;
    const auto set = one ? one : other;
    if (const auto normal = common_plane(a, b)) {
      const double reach = reach_of(a, b);
      for (std::size_t i = 0; i < planes_.size(); ++i) {
        if ((set && *set != i) || settings_.sets[i] == 0) continue;
        if (reach <= planes_[i].longest && std::abs(dot(*normal, planes_[i].mean)) >= planes_[i].least) return true;
      }
    }
    return false;
  }

 private:
  static double reach_of(const Seen& a, const Seen& b) {
    double reach = 0;
    for (const Vec3 p : a.trace->ends) {
      for (const Vec3 q : b.trace->ends) reach = std::max(reach, norm(p - q));
    }
    return reach;
  }

  /// The normal of a plane that both lie in, within the errors.
  [[nodiscard]] std::optional<Vec3> common_plane(const Seen& a, const Seen& b) const {
    const Vec3 u = a.along(), v = dot(a.along(), b.along()) < 0 ? -b.along() : b.along(), way = b.middle() - a.middle();
    for (const Vec3 n : {cross(u, v), cross(u + v, way)}) {
      if (!(norm(n) > 0.01)) continue;
      const Vec3 normal = normalized(n);
      const Vec3 middle = 0.5 * (a.middle() + b.middle());
      const auto lies_in = [&](const Seen& t) {
        const bool turned = std::abs(dot(normal, t.along())) > std::sin(settings_.seen.turn.radians());
        return !turned && std::ranges::all_of(t.trace->ends, [&](Vec3 p) {
          return std::abs(dot(normal, p - middle)) <= settings_.seen.error.si();
        });
      };
      if (lies_in(a) && lies_in(b)) return normal;
    }
    return std::nullopt;
  }

  const MappedSettings& settings_;
  std::vector<Planes> planes_;
};

/// Traces of one joint on two faces are two joints where nobody says so.
void note_pairs(Context& context, const std::vector<RandomSet>& joint_sets, const MappedSettings& settings) {
  const std::vector<Seen> all = traces_of(settings);
  if (all.size() > most_compared) {
    context.problems.note(settings.line, "mapped",
                          fmt::format("has {} traces, which are too many to be compared", all.size()),
                          "traces of one joint on several faces need the same `joint`");
    return;
  }
  const Comparison pairs{joint_sets, settings};
  const auto named = [&](const Seen& t) {
    const MappedSettings::Source& source = settings.sources[t.joint];
    return source.name != fmt::format("{}:{}", source.rows.front().file, source.rows.front().line);
  };
  std::size_t count = 0;
  std::array<const Seen*, 2> first{};
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t k = i + 1; k < all.size(); ++k) {
      if ((named(all[i]) && named(all[k])) || !pairs.may_be_one(all[i], all[k])) continue;
      if (count++ == 0) first = {&all[i], &all[k]};
    }
  }
  if (count == 0) return;
  context.problems.note_in(first[0]->row->file, first[0]->row->line, "joint",
                           fmt::format("{} of traces on different faces may be of one joint: this one and line {}{}",
                                       count == 1 ? "1 pair" : fmt::format("{} pairs", count), first[1]->row->line,
                                       count == 1 ? "" : " are the first"),
                           "where they are, give them the same `joint`; otherwise they are drawn as two");
}

/// Measured planes that their set has hardly: joints are drawn in them all the same.
void note_planes(Context& context, const std::vector<RandomSet>& joint_sets, const MappedSettings& settings) {
  std::size_t count = 0;
  double widest = 0, usual = 0;
  const MappedRow* at = nullptr;
  std::string set;
  for (std::size_t j = 0; j < settings.seen.joints.size(); ++j) {
    const dfn::MappedJoint& joint = settings.seen.joints[j];
    if (!joint.set) continue;
    const Planes planes = planes_of(joint_sets[*joint.set].law, settings, true);
    auto pick = joint.picks.begin();
    for (const MappedRow& row : settings.sources[j].rows) {
      if (!row.pick) continue;
      const auto& normal = (pick++)->normal;
      if (!normal) continue;
      const double cosine = std::abs(dot(*normal, planes.mean));
      if (cosine >= planes.least) continue;
      ++count;
      const double angle = std::acos(std::min(cosine, 1.0));
      if (angle <= widest) continue;
      widest = angle;
      usual = std::acos(planes.least);
      at = &row;
      set = context.sets[joint_sets[*joint.set].set].name;
    }
  }
  if (count == 0) return;
  constexpr double degrees = 180 / std::numbers::pi;
  context.problems.note_in(
      at->file, at->line, "dip",
      fmt::format("{} of picks {} further off the mean plane of {} set than nearly all of its joints; the furthest: "
                  "this one, {:.0f} degrees off that of \"{}\", of which 95 % are within {:.0f}",
                  count == 1 ? "1 plane" : fmt::format("{} planes", count), count == 1 ? "lies" : "lie",
                  count == 1 ? "its" : "their", widest * degrees, set, usual * degrees),
      "joints are drawn in these planes all the same; check the plane, its set and the declination");
}

/// Faces and holes where nothing was seen, or outside of the rock.
void note_places(Context& context, const std::optional<geometry::Solid>& domain, const MappedSettings& settings) {
  const auto note = [&](std::string_view kind, const std::string& name, std::string what, std::string remedy) {
    context.problems.note(settings.line, fmt::format("mapped.{}", kind), fmt::format("\"{}\" {}", name, what),
                          std::move(remedy));
  };
  const auto look = [&](std::string_view kind, const std::string& name, const Box& box, bool seen) {
    if (domain && !box.overlaps(box_of(*domain))) {
      note(kind, name, "lies wholly outside of the domain", "check its coordinates");
    } else if (!seen) {
      note(kind, name, "shows no joint: none is drawn that would meet it", "where it was not mapped, remove it");
    }
  };
  for (std::size_t f = 0; f < settings.faces.size(); ++f) {
    const bool seen = std::ranges::any_of(settings.seen.joints, [&](const dfn::MappedJoint& joint) {
      return std::ranges::find(joint.traces, f, &dfn::MappedTrace::face) != joint.traces.end();
    });
    look("face", settings.faces[f], box_of(settings.seen.faces[f].outline.corners()), seen);
  }
  for (std::size_t h = 0; h < settings.holes.size(); ++h) {
    const bool seen = std::ranges::any_of(settings.seen.joints, [&](const dfn::MappedJoint& joint) {
      return std::ranges::find(joint.picks, h, &dfn::MappedPick::hole) != joint.picks.end();
    });
    const dfn::MappedHole& hole = settings.seen.holes[h];
    look("hole", settings.holes[h], box_of(std::array{hole.from, hole.to}), seen);
  }
}

}  // namespace

void note_mapped(Context& context, const std::vector<RandomSet>& joint_sets,
                 const std::optional<geometry::Solid>& domain, const MappedSettings& settings) {
  note_places(context, domain, settings);
  note_pairs(context, joint_sets, settings);
  note_planes(context, joint_sets, settings);
}

}  // namespace cleave::scene
