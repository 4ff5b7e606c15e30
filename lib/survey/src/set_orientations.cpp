#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis.hpp"
#include "cleave/geometry/orientation.hpp"

namespace cleave::survey::detail {

using geometry::Vec3;

namespace {

/// So many joints measured take the place of an orientation that is stated: Fisher's law can be tested with them.
constexpr std::size_t joints_of_a_law = 5;

double apart(Vec3 one, Vec3 other) { return std::acos(std::min(1.0, std::abs(dot(one, other)))) * degrees; }

std::string plane_of(Vec3 normal, double north) {
  const geometry::Attitude plane = compass_attitude(normal, north);
  return fmt::format("{:.0f}/{:03.0f}", plane.dip.degrees(), plane.direction.degrees());
}

/// Of few joints measured beside a stated orientation.
std::string stands_note(const SetResult& set) {
  const Vec3 mean = fit_fisher(set.normals, set.weights).mean;
  return fmt::format(
      "the orientation stated, {}, stands: {} measured (mean {}, {:.0f} degrees off it), and {} or more take its "
      "place",
      plane_of(set.orientation.mean, set.north),
      set.joints == 1 ? "one joint was" : fmt::format("{} joints were", set.joints), plane_of(mean, set.north),
      apart(mean, set.orientation.mean), joints_of_a_law);
}

}  // namespace

void Analysis::weigh() {
  for (const MeasuredOrientation& joint : in_.orientations) {
    normals_.push_back(joint.normal);
    weights_.push_back(weight_of(joint, in_.weight_cap));
  }
  if (normals_.empty()) {  // nothing was measured: no zeros
    out_.tensor.values.fill(NAN);
    for (auto& interval : out_.tensor_intervals) interval.fill(NAN);
    return;
  }
  out_.tensor = orientation_tensor(normals_, weights_);
  out_.tensor_intervals = tensor_intervals(out_.tensor, normals_, weights_, in_.confidence);
}

std::size_t Analysis::set_named(const std::string& name) {
  const auto it = std::ranges::find(out_.sets, name, &SetResult::name);
  if (it != out_.sets.end()) return static_cast<std::size_t>(it - out_.sets.begin());
  out_.sets.emplace_back();
  out_.sets.back().name = name;
  out_.sets.back().north = in_.north.degrees();
  return out_.sets.size() - 1;
}

void Analysis::assign() {
  out_.set_of.assign(normals_.size(), std::nullopt);
  for (const SetRule& rule : in_.rules) static_cast<void>(set_named(rule.name));
  if (in_.clusters && !normals_.empty()) {
    const Clustering found = cluster(normals_, weights_, *in_.clusters);
    for (std::size_t k = 0; k < found.centres.size(); ++k) static_cast<void>(set_named(fmt::format("set{}", k + 1)));
    const std::size_t first = out_.sets.size() - found.centres.size();
    for (std::size_t i = 0; i < normals_.size(); ++i) {
      if (found.set[i]) out_.set_of[i] = first + *found.set[i];
    }
  } else {
    for (std::size_t i = 0; i < normals_.size(); ++i) {
      for (std::size_t k = 0; k < in_.rules.size(); ++k) {
        if (!in_.rules[k].polygon.empty() && pole_inside(normals_[i], in_.rules[k].polygon)) {
          out_.set_of[i] = set_named(in_.rules[k].name);
          break;
        }
      }
      if (!out_.set_of[i] && !in_.orientations[i].set.empty()) {
        out_.set_of[i] = set_named(in_.orientations[i].set);
      }
    }
    if (in_.rules.empty() && !normals_.empty() &&
        std::ranges::all_of(out_.set_of, [](const auto& set) { return !set; })) {
      const std::size_t all = set_named("all");
      std::ranges::fill(out_.set_of, all);
      out_.notes.emplace_back(
          "no sets were named: all joints are taken as one; see the silhouettes, and state clusters "
          "or polygons");
    }
  }
  for (const auto& set : out_.set_of) out_.unassigned += set ? 0U : 1U;
  if (normals_.size() >= 10) {
    for (std::size_t k = 2; k <= 8; ++k) {
      out_.silhouettes.emplace_back(k, cluster(normals_, weights_, k, false).silhouette);
    }
  }
}

bool Analysis::within(double azimuth, std::pair<double, double> range) {
  const double width = geometry::wrap_degrees(range.second - range.first);
  return geometry::wrap_degrees(azimuth - range.first) <= width ||
         geometry::wrap_degrees(azimuth + 180 - range.first) <= width;
}

const SetRule* Analysis::rule_of(const SetResult& set) const {
  const auto it = std::ranges::find(in_.rules, set.name, &SetRule::name);
  return it == in_.rules.end() ? nullptr : &*it;
}

std::vector<Sampling> Analysis::ways_met(std::size_t k) const {
  std::vector<MeasuredOrientation> ways;
  std::vector<Sampling> met;
  for (std::size_t i = 0; i < normals_.size(); ++i) {
    if (out_.set_of[i] != k) continue;
    MeasuredOrientation way = in_.orientations[i];
    way.normal = {};
    way.set.clear();
    const auto at = static_cast<std::size_t>(std::ranges::find(ways, way) - ways.begin());
    if (at == ways.size()) {
      ways.push_back(way);
      met.push_back(sampling_of(std::move(way)));
    }
    ++met[at].joints;
  }
  return met;
}

void Analysis::orient(std::size_t k) {
  SetResult& set = out_.sets[k];
  for (std::size_t i = 0; i < normals_.size(); ++i) {
    if (out_.set_of[i] != k) continue;
    set.normals.push_back(normals_[i]);
    set.weights.push_back(weights_[i]);
  }
  set.joints = set.normals.size();
  const SetRule* rule = rule_of(set);
  if (rule != nullptr && rule->dip && set.joints < joints_of_a_law) {
    state(set, *rule);
    if (set.orientation_stated) {
      if (set.joints > 0) set.notes.push_back(stands_note(set));
      return;
    }
  }
  if (!set.normals.empty()) {
    set.orientation = fit_fisher(set.normals, set.weights, in_.confidence, in_.weight_cap, ways_met(k));
    if (std::isinf(set.orientation.kappa)) {
      set.notes.push_back(
          fmt::format("{}: no spread can be had from {}; the intervals of P10 and P32 leave out the "
                      "error of the orientation",
                      set.joints == 1 ? "one joint" : "all joints are parallel", set.joints == 1 ? "it" : "them"));
    }
    if (set.orientation.capped > 0) {
      set.notes.push_back(
          fmt::format("{} joints lie nearly along the line or outcrop: weights above {} are not taken one by one; "
                      "these share their mean",
                      set.orientation.capped, in_.weight_cap));
    }
    if (few_carry(set.orientation)) {
      set.notes.push_back(fmt::format(
          "joints of such a set weigh as few where they were met: the {} of them as {:.1f} equal ones, those "
          "seen here as {:.1f}; the cone of the mean is that of the fitted law",
          set.joints, set.orientation.expected_count, set.orientation.effective_count));
    }
    if (!set.orientation.fisher) {
      set.bingham = fit_bingham(set.normals, set.weights, in_.confidence);
      set.notes.emplace_back(
          "Fisher's law is refused for these poles: where sets.toml holds the set, it draws from the measured ones");
    }
    if (rule != nullptr && rule->dip) set.notes.push_back(measured_note(set, *rule));
  }
}

std::string Analysis::measured_note(const SetResult& set, const SetRule& rule) const {
  std::string note = fmt::format("the orientation is that of the {} joints measured, {}", set.joints,
                                 plane_of(set.orientation.mean, set.north));
  if (!rule.dip_direction) {
    return note + fmt::format("; the dip stated, {:.0f} degrees, is not used", rule.dip->degrees());
  }
  const Vec3 stated = geometry::upward_normal({*rule.dip, *rule.dip_direction});
  return note + fmt::format("; the one stated, {}, {:.0f} degrees off it, is not used", plane_of(stated, set.north),
                            apart(stated, set.orientation.mean));
}

void Analysis::state(SetResult& set, const SetRule& rule) const {
  double direction = rule.dip_direction.value_or(DipDirection{}).degrees(), kappa = rule.kappa.value_or(30);
  if (rule.azimuth && !(rule.dip_direction && rule.kappa)) {
    const std::vector<TracesOfFace> faces = traces_within(*rule.azimuth);
    const auto traced = traced_direction(faces, *rule.dip, in_.confidence);
    if (!rule.dip_direction) {
      if (!traced) {
        set.notes.push_back(
            faces.empty() ? no_trace_of(*rule.azimuth)
                          : fmt::format("the traces are steeper than planes of dip {}: the set has no dip direction",
                                        rule.dip->degrees()));
        return;
      }
      set.notes.insert(set.notes.end(), traced->notes.begin(), traced->notes.end());
      set.direction = traced->direction;
      direction = *set.direction->value;
      turn_to_north(*set.direction);
      if (traced->other) {
        set.notes.push_back(fmt::format(
            "planes of dip {0} that dip to {1:05.1f} or to {2:05.1f} leave the same traces: the first is "
            "taken; state "
            "dip_direction = {2:.1f} if it is the other",
            rule.dip->degrees(), *set.direction->value, geometry::wrap_degrees(*traced->other - in_.north.degrees())));
      }
    }
    if (!rule.kappa && traced && traced->kappa.value) {
      kappa = *traced->kappa.value;
      set.orientation.kappa_low = traced->kappa.low;
      set.orientation.kappa_high = traced->kappa.high;
    }
  } else if (!rule.kappa) {
    set.notes.push_back(fmt::format("kappa {} is assumed: neither stated nor to be had from traces", kappa));
  }
  set.orientation_stated = true;
  set.orientation.mean = geometry::upward_normal({*rule.dip, DipDirection::degrees(geometry::wrap_degrees(direction))});
  set.orientation.kappa = kappa;
  set.notes.push_back(fmt::format("dip {} degrees is stated, not measured", rule.dip->degrees()));
}

void Analysis::turn_to_north(Estimate& direction) const {
  const double turn = geometry::wrap_degrees(*direction.value - in_.north.degrees()) - *direction.value;
  for (double* angle : {&*direction.value, &direction.low, &direction.high}) *angle += turn;
}

std::string Analysis::no_trace_of(std::pair<double, double> azimuth) const {
  if (!in_.windows.empty() && std::ranges::none_of(in_.windows, tells_azimuths)) {
    return "on vertical windows all traces have one azimuth: the set has no dip direction; state dip_direction, and "
           "leave azimuth out";
  }
  return fmt::format("no trace seen has an azimuth of {} to {}: the set has no dip direction", azimuth.first,
                     azimuth.second);
}

std::vector<TracesOfFace> Analysis::traces_within(std::pair<double, double> range) const {
  std::vector<TracesOfFace> faces;
  for (const WindowSurvey& window : in_.windows) {
    if (!tells_azimuths(window)) continue;
    std::vector<WeightedAxis> angles;
    for (const SeenTrace& t : seen_through(window.window, window.traces, window.border.si())) {
      if (!within(azimuth_of(window, t.direction), range)) continue;
      angles.push_back({std::atan2(t.direction.y, t.direction.x), t.length});
    }
    if (angles.empty()) continue;
    const auto alike = std::ranges::find_if(faces, [&](const TracesOfFace& face) {
      return norm(face.normal - window.normal) + norm(face.x_axis - window.x_axis) < 1e-9;
    });
    if (alike == faces.end()) {
      faces.push_back({window.name, window.normal, window.x_axis, std::move(angles)});
    } else {
      alike->angles.insert(alike->angles.end(), angles.begin(), angles.end());
    }
  }
  return faces;
}

}  // namespace cleave::survey::detail
