#include "cleave/survey/analyse.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "cleave/core/rng.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/survey/comparison.hpp"
#include "line.hpp"
#include "lines_and_windows.hpp"
#include "over_poles.hpp"
#include "set_laws.hpp"
#include "trace_sets.hpp"
#include "unoriented.hpp"

namespace cleave::survey {

using geometry::Vec3;

namespace {

constexpr double degrees = 180 / std::numbers::pi;

class Analysis final {
 public:
  explicit Analysis(const SurveyInput& input) : in_{input} {}

  SurveyResult run() {
    weigh();
    assign();
    for (std::size_t k = 0; k < out_.sets.size(); ++k) orient(k);
    assign_traces();
    assign_on_lines();
    for (std::size_t k = 0; k < out_.sets.size(); ++k) {
      if (const SetRule* rule = rule_of(out_.sets[k])) out_.sets[k].shape = rule->shape;
      lines(k);
      windows(k);
      caution_of_windows(out_.sets[k], truncation_of_windows(k));
      line_lengths(k);
      choose(k);
    }
    whole();
    return std::move(out_);
  }

 private:
  void weigh() {
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

  std::size_t set_named(const std::string& name) {
    const auto it = std::ranges::find(out_.sets, name, &SetResult::name);
    if (it != out_.sets.end()) return static_cast<std::size_t>(it - out_.sets.begin());
    out_.sets.emplace_back();
    out_.sets.back().name = name;
    out_.sets.back().north = in_.north.degrees();
    return out_.sets.size() - 1;
  }

  void assign() {
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

  [[nodiscard]] const SetRule* rule_of(const SetResult& set) const {
    const auto it = std::ranges::find(in_.rules, set.name, &SetRule::name);
    return it == in_.rules.end() ? nullptr : &*it;
  }

  /// The lines and outcrops that the joints of a set were met on.
  [[nodiscard]] std::vector<Sampling> ways_met(std::size_t k) const {
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

  void orient(std::size_t k) {
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
        set.notes.emplace_back("Fisher's law is refused for these poles: sets.toml draws from the measured ones");
      }
      if (rule != nullptr && rule->dip) set.notes.push_back(measured_note(set, *rule));
    }
  }

  /// So many joints measured take the place of an orientation that is stated: Fisher's law can be tested with them.
  static constexpr std::size_t joints_of_a_law = 5;

  static double apart(Vec3 one, Vec3 other) { return std::acos(std::min(1.0, std::abs(dot(one, other)))) * degrees; }

  [[nodiscard]] static std::string plane_of(Vec3 normal, double north) {
    const geometry::Attitude plane = compass_attitude(normal, north);
    return fmt::format("{:.0f}/{:03.0f}", plane.dip.degrees(), plane.direction.degrees());
  }

  /// Of few joints measured beside a stated orientation.
  [[nodiscard]] static std::string stands_note(const SetResult& set) {
    const Vec3 mean = fit_fisher(set.normals, set.weights).mean;
    return fmt::format(
        "the orientation stated, {}, stands: {} measured (mean {}, {:.0f} degrees off it), and {} or more take its "
        "place",
        plane_of(set.orientation.mean, set.north),
        set.joints == 1 ? "one joint was" : fmt::format("{} joints were", set.joints), plane_of(mean, set.north),
        apart(mean, set.orientation.mean), joints_of_a_law);
  }

  /// Of joints enough to take the place of what is stated.
  [[nodiscard]] std::string measured_note(const SetResult& set, const SetRule& rule) const {
    std::string note = fmt::format("the orientation is that of the {} joints measured, {}", set.joints,
                                   plane_of(set.orientation.mean, set.north));
    if (!rule.dip_direction) {
      return note + fmt::format("; the dip stated, {:.0f} degrees, is not used", rule.dip->degrees());
    }
    const Vec3 stated = geometry::upward_normal({*rule.dip, *rule.dip_direction});
    return note + fmt::format("; the one stated, {}, {:.0f} degrees off it, is not used", plane_of(stated, set.north),
                              apart(stated, set.orientation.mean));
  }

  /// The dip is stated; direction and concentration too, or they are those of the traces.
  void state(SetResult& set, const SetRule& rule) const {
    double direction = rule.dip_direction.value_or(DipDirection{}).degrees(), kappa = rule.kappa.value_or(30);
    if (rule.azimuth && !(rule.dip_direction && rule.kappa)) {
      const std::vector<detail::TracesOfFace> faces = traces_within(*rule.azimuth);
      const auto traced = detail::traced_direction(faces, *rule.dip, in_.confidence);
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
          set.notes.push_back(
              fmt::format("planes of dip {0} that dip to {1:05.1f} or to {2:05.1f} leave the same traces: the first is "
                          "taken; state "
                          "dip_direction = {2:.1f} if it is the other",
                          rule.dip->degrees(), *set.direction->value,
                          geometry::wrap_degrees(*traced->other - in_.north.degrees())));
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
    set.orientation.mean =
        geometry::upward_normal({*rule.dip, DipDirection::degrees(geometry::wrap_degrees(direction))});
    set.orientation.kappa = kappa;
    set.notes.push_back(fmt::format("dip {} degrees is stated, not measured", rule.dip->degrees()));
  }

  /// A direction from the y axis as one from true north.
  void turn_to_north(Estimate& direction) const {
    const double turn = geometry::wrap_degrees(*direction.value - in_.north.degrees()) - *direction.value;
    for (double* angle : {&*direction.value, &direction.low, &direction.high}) *angle += turn;
  }
  static bool within(double azimuth, std::pair<double, double> range) {
    const double width = geometry::wrap_degrees(range.second - range.first);
    return geometry::wrap_degrees(azimuth - range.first) <= width ||
           geometry::wrap_degrees(azimuth + 180 - range.first) <= width;
  }
  [[nodiscard]] std::string no_trace_of(std::pair<double, double> azimuth) const {
    if (!in_.windows.empty() && std::ranges::none_of(in_.windows, detail::tells_azimuths)) {
      return "on vertical windows all traces have one azimuth: the set has no dip direction; state dip_direction, and "
             "leave azimuth out";
    }
    return fmt::format("no trace seen has an azimuth of {} to {}: the set has no dip direction", azimuth.first,
                       azimuth.second);
  }
  /// The traces within these azimuths, by length, of windows that lie alike together.
  [[nodiscard]] std::vector<detail::TracesOfFace> traces_within(std::pair<double, double> range) const {
    std::vector<detail::TracesOfFace> faces;
    for (const WindowSurvey& window : in_.windows) {
      if (!detail::tells_azimuths(window)) continue;
      std::vector<WeightedAxis> angles;
      for (const SeenTrace& t : seen_through(window.window, window.traces, window.border.si())) {
        if (!within(detail::azimuth_of(window, t.direction), range)) continue;
        angles.push_back({std::atan2(t.direction.y, t.direction.x), t.length});
      }
      if (angles.empty()) continue;
      const auto alike = std::ranges::find_if(faces, [&](const detail::TracesOfFace& face) {
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

  [[nodiscard]] Estimate over_orientations(const SetResult& set,
                                           const std::function<double(Vec3, double)>& figure) const {
    return detail::over_orientations(set.orientation, figure, in_.confidence);
  }

  /// Each trace to the set by whose azimuths it goes, else to the one that leaves such traces most likely.
  void assign_traces() {
    for (const WindowSurvey& window : in_.windows) {
      seen_.push_back(seen_through(window.window, window.traces, window.border.si()));
      auto& sets = trace_set_.emplace_back(seen_.back().size());
      std::vector<std::pair<std::size_t, detail::TracesOfSet>> laws;
      std::vector<std::pair<std::size_t, std::pair<double, double>>> azimuths;
      for (std::size_t k = 0; k < out_.sets.size(); ++k) {
        const SetRule* rule = rule_of(out_.sets[k]);
        if (rule != nullptr && rule->azimuth && detail::tells_azimuths(window)) {
          azimuths.emplace_back(k, *rule->azimuth);
        } else if (has_mean(out_.sets[k])) {
          laws.emplace_back(k, detail::TracesOfSet{out_.sets[k].orientation, window});
        }
      }
      double doubtful = 0;  // traces of another set than the likeliest, as many as are to be expected
      for (std::size_t i = 0; i < sets.size(); ++i) {
        const MapPoint direction = seen_.back()[i].direction;
        const double azimuth = detail::azimuth_of(window, direction);
        const auto own = std::ranges::find_if(azimuths, [&](const auto& a) { return within(azimuth, a.second); });
        if (own != azimuths.end()) {
          sets[i] = own->first;
          continue;
        }
        double best = -1, sum = 0;
        for (auto& [k, law] : laws) {
          if (out_.sets.size() > 1 && !law.may_hold(direction)) continue;
          const double density = law.density(direction);
          sum += density;
          if (!(density > best)) continue;
          best = density;
          sets[i] = k;
        }
        if (sum > 0) doubtful += 1 - best / sum;
      }
      if (auto note = detail::doubtful_note(window, doubtful, sets.size())) out_.notes.push_back(*std::move(note));
    }
  }

  /// Joints on lines to sets: by their orientation, else by the set that is stated of them, else by what there is.
  void assign_on_lines() {
    const std::size_t none = out_.sets.size();
    const bool one = none == 1 && out_.unassigned == 0;
    const auto stated = [&](const std::string& name) -> std::optional<std::size_t> {
      if (one || in_.clusters || name.empty()) return one ? std::optional<std::size_t>{0} : std::nullopt;
      return static_cast<std::size_t>(std::ranges::find(out_.sets, name, &SetResult::name) - out_.sets.begin());
    };
    std::vector<std::vector<double>> lengths(none + 1);
    for (const LineSurvey& line : in_.lines) {
      detail::SetsOnLine& sets = line_sets_.emplace_back();
      for (std::size_t i = 0; i < line.positions.size(); ++i) {
        if (i < line.joints.size() && line.joints[i]) {
          sets.push_back(out_.set_of[*line.joints[i]].value_or(none));
        } else {
          sets.push_back(stated(i < line.sets.size() ? line.sets[i] : ""));
        }
      }
      lengths[none].push_back(line.length());
    }
    for (std::size_t k = 0; k < none; ++k) {
      for (const LineSurvey& line : in_.lines) {
        lengths[k].push_back(has_mean(out_.sets[k]) ? length_met(out_.sets[k], line) : 0);
      }
    }
    shared_ = detail::share_out(line_sets_, lengths);
  }

  static bool has_mean(const SetResult& set) { return set.joints > 0 || set.orientation_stated; }
  /// Of Fisher's law where it holds, else of the poles as they were measured.
  static bool by_poles(const SetResult& set) {
    return !set.orientation.fisher && !set.orientation_stated && !set.normals.empty();
  }
  static double length_along(Vec3 normal, const LineSurvey& line) {
    double sum = 0;
    for (const auto& [direction, length] : line.pieces) sum += length * std::abs(dot(normal, direction));
    return sum;
  }
  static double length_by_law(Vec3 mean, double kappa, const LineSurvey& line) {
    double sum = 0;
    for (const auto& [direction, length] : line.pieces) sum += length * mean_line_cosine(mean, kappa, direction);
    return sum;
  }
  /// Length of a line times E|n.l| of a set.
  static double length_met(const SetResult& set, const LineSurvey& line) {
    if (!by_poles(set)) return length_by_law(set.orientation.mean, set.orientation.kappa, line);
    return detail::mean_over_poles(set.normals, set.weights, [&](Vec3 n) { return length_along(n, line); });
  }
  /// Of all lines, with its interval; `along_normal`: over E|n.n0|, which makes joints per metre along the mean normal
  /// n0 of the joints met.
  [[nodiscard]] Estimate length_of_lines(const SetResult& set, bool along_normal) const {
    if (by_poles(set)) {
      return detail::over_poles(
          set.normals, set.weights,
          [&](Vec3 n) {
            double sum = 0;
            for (const LineSurvey& line : in_.lines) sum += length_along(n, line);
            return sum;
          },
          [&](Vec3 n) { return along_normal ? std::abs(dot(n, set.orientation.mean)) : 1; }, in_.confidence);
    }
    return over_orientations(set, [&](Vec3 mean, double kappa) {
      double sum = 0;
      for (const LineSurvey& line : in_.lines) sum += length_by_law(mean, kappa, line);
      return along_normal ? sum / mean_line_cosine(mean, kappa, mean) : sum;
    });
  }

  void lines(std::size_t k) {
    SetResult& set = out_.sets[k];
    if (!has_mean(set)) return;
    for (std::size_t l = 0; l < in_.lines.size(); ++l) {
      const LineSurvey& line = in_.lines[l];
      std::vector<double> positions;
      for (std::size_t i = 0; i < line.positions.size(); ++i) {
        if (line_sets_[l][i] == k) positions.push_back(line.positions[i]);
      }
      const std::vector<double> gaps = detail::gaps_across(line, std::move(positions), set.orientation.mean);
      set.gaps.insert(set.gaps.end(), gaps.begin(), gaps.end());
    }
    const Estimate normal_length = length_of_lines(set, true), area_length = length_of_lines(set, false);
    const std::size_t known = shared_.known[k];
    if (known == 0 || !(*area_length.value > 0)) return;
    const double joints = static_cast<double>(known) + shared_.shared[k];
    const Estimate met = detail::counted(joints, shared_.effective(k), in_.confidence);
    if (shared_.shared[k] > 0) {
      set.notes.push_back(
          fmt::format("{} joints on lines are known to be of this set; {:.1f} of the {} that have neither orientation "
                      "nor set are counted for its P10 and P32, as each line meets the sets; spacings leave them out "
                      "and are too long, {:.2g} times if they lack by chance",
                      known, shared_.shared[k], shared_.unknown, joints / static_cast<double>(known)));
    }
    set.p10_normal = over(met, normal_length, "P10 along the mean normal",
                          "sum N E|n.n0| / sum(L E|n.l|), exact Poisson interval with the error of the orientation");
    set.p32_lines = over(met, area_length, "P32",
                         "sum N / sum(L E|n.l|), exact Poisson interval with the error of the orientation");
    if (auto note = detail::unlike_lines_note(in_.lines, met_on_lines(k))) set.notes.push_back(*std::move(note));
    for (const Family family : {Family::exponential, Family::lognormal, Family::gamma}) {
      if (auto fit = fit_complete(set.gaps, family, set.gaps.size() <= 500 ? 199 : 0, in_.seed)) {
        set.spacings.push_back(*std::move(fit));
      }
    }
    std::ranges::stable_sort(set.spacings, {}, &Fit::aic);
    if (set.spacings.empty()) return;
    if (auto note = detail::short_lines_note(in_.lines, known, set.spacings.front().moment(1))) {
      set.notes.push_back(*std::move(note));
    }
  }

  /// Joints of a set on each line, and what the line offers them to be met; of lines of which each joint's set is
  /// known.
  [[nodiscard]] std::vector<detail::MetOnLine> met_on_lines(std::size_t k) const {
    std::vector<detail::MetOnLine> met;
    for (std::size_t l = 0; l < in_.lines.size(); ++l) {
      if (std::ranges::any_of(line_sets_[l], [](const auto& set) { return !set; })) continue;
      met.push_back({l, static_cast<double>(std::ranges::count(line_sets_[l], std::optional{k})),
                     length_met(out_.sets[k], in_.lines[l])});
    }
    return met;
  }

  /// From the strike to the set's traces in the joints' plane, degrees counter-clockwise seen from above.
  static double trace_angle(const SetResult& set, const WindowSurvey& window) {
    const Vec3 normal = set.orientation.mean, trace = cross(normal, window.normal);
    const double steep = std::hypot(normal.x, normal.y);
    if (norm(trace) < 1e-9 || steep < 1e-9) return 0;
    const Vec3 strike = Vec3{-normal.y, normal.x, 0} / steep;
    return std::atan2(dot(trace, cross(normal, strike)), dot(trace, strike)) * degrees;
  }

  /// E sin V of a set on each window; 1 where its orientation is not known.
  [[nodiscard]] std::vector<double> sines_of(const SetResult& set) const {
    std::vector<double> sines;
    for (const WindowSurvey& window : in_.windows) {
      sines.push_back(has_mean(set) ? mean_plane_sine(set.orientation.mean, set.orientation.kappa, window.normal) : 1);
    }
    return sines;
  }

  void windows(std::size_t k) {
    SetResult& set = out_.sets[k];
    std::vector<WindowCounts> counts;
    std::vector<SeenLength> lengths;
    std::vector<WholeTrace> whole;
    double truncation = 0;
    Chords sum{0, 0, shape_area(set.shape), 0};
    for (std::size_t w = 0; w < in_.windows.size(); ++w) {
      std::vector<SeenTrace> own;
      for (std::size_t i = 0; i < seen_[w].size(); ++i) {
        if (trace_set_[w][i] != k) continue;
        own.push_back(seen_[w][i]);
        lengths.push_back({seen_[w][i].length, std::min(seen_[w][i].ends, 2U)});
        set.seen_lengths.push_back(seen_[w][i].length);
        const SeenTrace& trace = seen_[w][i];
        if (trace.ends != 2 || trace.crossings > 0) continue;
        const Polyline& line = in_.windows[w].traces[trace.trace];
        const MapPoint middle{(line.front().x + line.back().x) / 2, (line.front().y + line.back().y) / 2};
        if (!holds(in_.windows[w].window, middle)) continue;  // a bent one
        whole.push_back({trace.length, chord_through(in_.windows[w].window, middle, trace.direction)});
      }
      const auto traces = static_cast<double>(own.size());
      const Chords chords = chords_of(set.shape, trace_angle(set, in_.windows[w]));
      sum.first += traces * chords.first;
      sum.second += traces * chords.second;
      if (chords.disc) *sum.disc += traces * *chords.disc;
      if (!own.empty()) truncation = std::max(truncation, in_.windows[w].truncation.si());
      counts.push_back(count(in_.windows[w].window, own));
      if (own.empty() && counts.back().width == 0) counts.back().width = width_across(in_.windows[w].window, {1, 0});
    }
    set.traces = lengths.size();
    if (lengths.empty()) return;
    const auto n = static_cast<double>(lengths.size());
    set.chords = {sum.first / n, sum.second / n, sum.area, std::nullopt};
    if (set.shape.shape != JointShape::rectangle) set.chords.disc = *sum.disc / n;
    if (truncation > 0) {
      set.notes.push_back(fmt::format(
          "traces below {} m were not mapped: the laws of lengths and sizes allow for it; figures from counts and sums "
          "are those of the longer ones",
          truncation));
    }
    const WindowCounts all = pooled(counts);
    Estimate sine{"", 1, 1, 1, "", ""};
    if (has_mean(set)) {
      sine = over_orientations(set, [&](Vec3 mean, double kappa) {
        double weighed = 0;
        for (std::size_t w = 0; w < counts.size(); ++w) {
          weighed += counts[w].area * mean_plane_sine(mean, kappa, in_.windows[w].normal);
        }
        return weighed / all.area;
      });
    }
    if (auto note = detail::unlike_windows_note(in_.windows, counts, sines_of(set))) set.notes.push_back(*note);
    set.p20 = p20(all, in_.confidence);
    set.p21 = p21(all, in_.confidence);
    set.mean_length = mean_length(all, in_.confidence);
    set.mean_length_counts = mean_length_by_counts(all, in_.confidence);
    set.p32_windows = over(*set.p21, sine, "P32", fmt::format("P21 / E sin V, E sin V = {:.4f}", *sine.value));
    detail::fit_laws(set, lengths, {all.area, all.width, truncation}, set.mean_length, in_.confidence);
    for (FittedLaw& law : set.lengths) law.test = test_lengths(whole, truncation, law.fit.family, in_.seed);
    set.comparisons = spread_as_measured(lengths, set.chords, in_.confidence);
    if (!set.lengths.empty()) {
      set.comparisons.push_back(p20_by_midpoints(lengths, set.lengths.front().fit, all.area, in_.confidence));
    }
    if (!set.size) return;
    const double width = set.chords.width();
    if (!set.sizes.empty()) {
      // Given how many were seen the laws are fitted to their lengths alone: both errors are independent.
      const auto mapped = static_cast<std::size_t>(
          std::ranges::count_if(lengths, [&](const SeenLength& l) { return l.length > 0 && l.length >= truncation; }));
      const Estimate& offered = *set.offered;
      set.p30 = over(over(frequency(mapped, 1, in_.confidence), detail::scaled(offered, "", width, ""), "", ""), sine,
                     "P30", "traces / E[(A + b l) width across the traces] E sin V under the law of sizes");
    } else if (set.p20->value) {
      // P20 over the mean size, itself from 2S/m: m^2/(S A) but for factors.
      const auto m = static_cast<double>(all.ends()), squares = static_cast<double>(4 * all.n2 + all.n1);
      const double variance = 4 * squares / (m * m) - 4 * all.sum_length_ends / (m * all.length) +
                              all.sum_length2 / (all.length * all.length);
      const double half = std::exp(normal_quantile(0.5 + in_.confidence / 2) * std::sqrt(std::max(0.0, variance)));
      const double p30 = *set.p20->value / (set.size->mean * width);
      set.p30 =
          over({"", p30, p30 / half, p30 * half, "", ""}, sine, "P30", "P20 / (E[width across the traces] E sin V)");
    }
  }

  [[nodiscard]] double truncation_of_windows(std::size_t k) const {
    double truncation = 0;
    for (std::size_t w = 0; w < in_.windows.size(); ++w) {
      if (std::ranges::count(trace_set_[w], std::optional{k}) > 0) {
        truncation = std::max(truncation, in_.windows[w].truncation.si());
      }
    }
    return truncation;
  }

  /// Of windows with a truncation: what stands beside P32 and the law of sizes.
  void caution_of_windows(SetResult& set, double truncation) {
    if (!(truncation > 0)) return;
    std::string caution =
        fmt::format("P32 is that of joints with traces of {} m and more, the size that of all", truncation);
    if (set.size && set.p30 && set.p30->value) {
      set.p32_of_all = *set.p30->value * shape_area(set.shape) * size_moment(*set.size, 2);
      caution += fmt::format("; of all joints of this law it is {:.4g}", *set.p32_of_all);
    }
    set.cautions.push_back(std::move(caution));
  }

  /// Traces met by lines, where no window was mapped.
  void line_lengths(std::size_t k) {
    SetResult& set = out_.sets[k];
    if (set.traces > 0) return;
    std::vector<SeenLength> lengths;
    double truncation = 0;
    for (std::size_t l = 0; l < in_.lines.size(); ++l) {
      const LineSurvey& line = in_.lines[l];
      for (std::size_t i = 0; i < line.lengths.size(); ++i) {
        if (line.lengths[i] && line_sets_[l][i] == k) lengths.push_back(*line.lengths[i]);
      }
      if (!line.lengths.empty()) truncation = std::max(truncation, line.truncation.si());
    }
    if (lengths.empty()) return;
    for (const SeenLength& l : lengths) set.seen_lengths.push_back(l.length);
    set.traces_on_lines = lengths.size();
    std::vector<detail::RecordedOn> recorded;
    for (const LineSurvey& line : in_.lines) {
      if (truncation > 0) recorded.push_back({has_mean(set) ? length_met(set, line) : 0, line.truncation.si()});
    }
    const bool met = std::ranges::any_of(recorded, [](const auto& line) { return line.length > 0; });
    if (!met) recorded.clear();
    set.chords = chords_of(set.shape, 0);
    if (set.shape.shape != JointShape::disc) {
      set.notes.emplace_back("traces on lines are taken as on a level outcrop: along the strike");
    }
    // Seen from the line both parts of a trace are drawn alike: S/m is the mean of an exponential law.
    detail::fit_laws(set, lengths, {0, 1, truncation}, detail::length_per_end(lengths, in_.confidence), in_.confidence,
                     recorded);
    if (!set.size || !set.p32_lines || !set.p32_lines->value) return;
    if (!set.sizes.empty()) {
      set.p30 =
          over(*set.p32_lines, detail::scaled(*set.offered, "", shape_area(set.shape), ""), "P30", "P32 / E area");
    } else {
      const double area = shape_area(set.shape) * size_moment(*set.size, 2);
      const double low = set.size_mean->low / set.size->mean, high = set.size_mean->high / set.size->mean;
      set.p30 = over(*set.p32_lines, {"", area, area * low * low, area * high * high, "", ""}, "P30", "P32 / E area");
    }
  }

  /// Area of the shape of size 1.
  static double shape_area(const ShapeRule& shape) { return chords_of(shape, 0).area; }

  /// Joints below the truncation of their line are missing: by the law of sizes, else it is said.
  void recorded_on_lines(SetResult& set) const {
    double truncation = 0;
    for (const LineSurvey& line : in_.lines) truncation = std::max(truncation, line.truncation.si());
    if (!(truncation > 0) || !set.p32_lines || !set.p32_lines->value) return;
    const std::string missing =
        fmt::format("joints whose traces are below {} m were not recorded on lines: ", truncation);
    if (set.recorded && set.recorded->value && bounded(*set.recorded)) {
      const Estimate& share = *set.recorded;
      set.notes.push_back(missing + fmt::format("under the law of sizes {:.0f} % of those met were ({:.0f} to {:.0f} "
                                                "%); P10 along the normal, P32 and P30 are those of all, spacings and "
                                                "frequencies those of the longer ones",
                                                100 * *share.value, 100 * share.low, 100 * share.high));
      for (auto* e : {&set.p10_normal, &set.p32_lines}) {
        if (*e) *e = over(**e, share, (*e)->name, (*e)->method + ", over the share that is recorded");
      }
      return;
    }
    set.notes.push_back(missing +
                        "P10, P32 and spacings of lines are those of the longer ones, as no law of sizes "
                        "from lines says how many are missing");
    if (!set.p32_windows || !set.p32_windows->value) set.cautions.push_back(set.notes.back());
  }

  void choose(std::size_t k) {
    SetResult& set = out_.sets[k];
    recorded_on_lines(set);
    if (set.size_mean && set.size_mean->value && !bounded(*set.size_mean)) {
      set.notes.push_back("size: " + (set.size_mean->note.empty() ? "no interval" : set.size_mean->note));
    }
    set.p32 = set.p32_windows && set.p32_windows->value ? set.p32_windows : set.p32_lines;
    if (set.p32_lines && set.p32_windows && set.p32_windows->value &&
        (set.p32_lines->low > set.p32_windows->high || set.p32_windows->low > set.p32_lines->high)) {
      set.notes.emplace_back(
          "P32 of lines and of windows disagree beyond their intervals: the disc model or the sets do "
          "not fit");
    }
    if (set.mean_length && set.mean_length->value && set.size_mean && set.size_mean->value) {
      const double traces = *set.mean_length->value, sizes = *set.size_mean->value;
      constexpr double far = 5;
      if (traces > far * sizes || sizes > far * traces) {
        set.notes.push_back(fmt::format(
            "the mean trace, {:.3g} m, and the mean size under the {} law, {:.3g} m, disagree {:.0f} times: most "
            "joints "
            "of that law are too small to be seen here, so mean size and P30 hang on the law alone; E L^2/E L does not",
            traces, name_of(set.size->family), sizes, std::max(traces / sizes, sizes / traces)));
      }
    }
    if (set.p32) return;
    set.notes.emplace_back(
        in_.lines.empty() && in_.windows.empty()
            ? "no [[scanline]], [[borehole]] or [[window]]: the intensity is not known"
        : shared_.known[k] > 0
            ? "the lines run along the joints of this set (|n.l| = 0): they meet none but by chance, and the intensity "
              "is not known"
        : has_mean(set) ? "no joint on a line and no trace in a window is of this set: the intensity is not known"
                        : "its orientation is not known, so the intensity is not");
  }

  void whole() {
    for (std::size_t l = 0; l < in_.lines.size(); ++l) {
      out_.lines.push_back(detail::result_of(in_.lines[l], in_.confidence));
      if (out_.sets.empty()) continue;
      if (auto note = detail::unoriented_note(in_.lines[l], line_sets_[l], shared_)) {
        out_.notes.push_back(*std::move(note));
      }
    }
    for (std::size_t w = 0; w < in_.windows.size(); ++w) {
      out_.windows.push_back(detail::result_of(in_.windows[w], seen_[w], in_.confidence));
      std::optional<std::string> of_no_set;
      if (!out_.sets.empty()) of_no_set = detail::no_set_note(in_.windows[w], seen_[w], trace_set_[w]);
      for (auto note :
           {detail::outside_note(in_.windows[w], seen_[w].size()), of_no_set, detail::border_note(in_.windows[w])}) {
        if (note) out_.notes.push_back(*std::move(note));
      }
    }
  }

  const SurveyInput& in_;
  SurveyResult out_;
  std::vector<detail::SetsOnLine> line_sets_;
  detail::SharedOut shared_;
  std::vector<Vec3> normals_;
  std::vector<double> weights_;
  std::vector<std::vector<SeenTrace>> seen_;
  std::vector<std::vector<std::optional<std::size_t>>> trace_set_;
};

}  // namespace

SurveyResult analyse(const SurveyInput& input) { return Analysis{input}.run(); }

}  // namespace cleave::survey
