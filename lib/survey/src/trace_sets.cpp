#include "trace_sets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "cleave/geometry/orientation.hpp"

namespace cleave::survey::detail {

using geometry::Vec3;

namespace {

constexpr double pi = std::numbers::pi, degrees = 180 / pi;
/// Directions of traces are not known better than that: three degrees.
constexpr double sharpest = 400;

Vec3 in_space(MapPoint d, Vec3 x, Vec3 y) { return d.x * x + d.y * y; }

}  // namespace

double azimuth_of(const WindowSurvey& window, MapPoint direction) {
  const Vec3 d = in_space(direction, window.x_axis, cross(window.normal, window.x_axis));
  const double a = std::remainder(std::atan2(d.x, d.y) * degrees - window.north, 180);
  return a < 0 ? a + 180 : a;
}

bool tells_azimuths(const WindowSurvey& window) {
  constexpr double vertical = 1e-3;
  return std::abs(window.normal.z) > vertical;
}

TracesOfSet::TracesOfSet(const FisherFit& orientation, const WindowSurvey& window)
    : mean_{orientation.mean},
      normal_{window.normal},
      x_{window.x_axis},
      y_{cross(window.normal, window.x_axis)},
      kappa_{std::clamp(orientation.kappa, 0.0, sharpest)},
      sine_{mean_plane_sine(orientation.mean, kappa_, window.normal)} {
  constexpr double one_in_a_thousand = 3.2905, least = 30 / degrees;
  farthest_ = std::max(least, one_in_a_thousand / std::sqrt(std::max(kappa_, 1.0)));
}

bool TracesOfSet::may_hold(MapPoint direction) const {
  return std::asin(std::min(1.0, std::abs(dot(mean_, in_space(direction, x_, y_))))) <= farthest_;
}

double TracesOfSet::density(MapPoint direction) {
  constexpr std::size_t turns = 720, steps = 180;
  if (known_.empty()) known_.assign(turns, -1);
  const double turn = (std::atan2(direction.y, direction.x) / pi + 1) * turns;
  double& known = known_[static_cast<std::size_t>(std::lround(turn)) % turns];
  if (known >= 0) return known;
  // Normals of the planes through the trace, from that of the face round to its opposite; met as sin V.
  const Vec3 across = in_space({-direction.y, direction.x}, x_, y_);
  double sum = 0;
  for (std::size_t i = 0; i < steps; ++i) {
    const double v = pi * static_cast<double>(i) / steps;
    const double c = std::abs(dot(mean_, std::cos(v) * normal_ + std::sin(v) * across));
    sum += std::exp(kappa_ * (c - 1)) * (1 + std::exp(-2 * kappa_ * c)) * std::sin(v) * std::sin(v);
  }
  const double of_law = kappa_ > 0 ? kappa_ / -std::expm1(-2 * kappa_) : 0.5;
  return known = sum / steps * of_law / sine_;
}

std::optional<std::string> doubtful_note(const WindowSurvey& window, double doubtful, std::size_t traces) {
  constexpr double few = 0.05;
  if (doubtful <= few * static_cast<double>(traces)) return std::nullopt;
  return fmt::format(
      "window {}: sets leave traces of like directions: each trace is of the likeliest set, and about {:.2g} of {} are "
      "of another; intervals of P21, P32 and sizes do not have that in them",
      window.name, doubtful, traces);
}

std::optional<std::string> no_set_note(const WindowSurvey& window, std::span<const SeenTrace> seen,
                                       std::span<const std::optional<std::size_t>> sets) {
  double length = 0;
  std::size_t traces = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (sets[i]) continue;
    ++traces;
    length += seen[i].length;
  }
  if (traces == 0) return std::nullopt;
  return fmt::format("window {}: {} of {} traces belong to no set; their P21, {:.3g} 1/m, is in no P32", window.name,
                     traces, seen.size(), length / area_of(window.window));
}

namespace {

/// Of the mean trace of a face: both dip directions (degrees), how they turn with its angle, sin V.
struct FaceDirections {
  const TracesOfFace* face = nullptr;
  double angle = 0;   ///< of the mean trace, radians
  double length = 0;  ///< of all traces
  std::array<double, 2> direction{}, slope{}, sine{};
};

/// The two dip directions of planes that hold the trace at this angle; empty when it is much steeper than their dip.
std::optional<std::array<double, 2>> both_directions(const TracesOfFace& face, double angle, Dip dip) {
  const Vec3 t = in_space({std::cos(angle), std::sin(angle)}, face.x_axis, cross(face.normal, face.x_axis));
  constexpr double few_degrees = 5;
  const double level = std::hypot(t.x, t.y), sine = geometry::sin_degrees(dip.degrees());
  const double plunge = std::atan2(std::abs(t.z), level) * degrees;
  if (plunge > dip.degrees() + few_degrees) return std::nullopt;
  const double rise = -t.z * geometry::cos_degrees(dip.degrees());
  const double cosine = std::abs(rise) < 1e-12 ? 0 : std::clamp(rise / std::max(level * sine, 1e-12), -1.0, 1.0);
  const double azimuth = std::atan2(t.x, t.y) * degrees, off = std::acos(cosine) * degrees;
  std::array<double, 2> both{geometry::wrap_degrees(azimuth + off), geometry::wrap_degrees(azimuth - off)};
  // On level ground the first is the one in (0, 180].
  if (both[0] == 0 || both[0] > 180) std::swap(both[0], both[1]);
  return both;
}

std::optional<FaceDirections> directions_of(const TracesOfFace& face, Dip dip, double confidence) {
  FaceDirections of{&face, mean_axis(face.angles, confidence).axis / degrees};
  const auto both = both_directions(face, of.angle, dip);
  if (!both) return std::nullopt;
  of.direction = *both;
  for (const WeightedAxis& trace : face.angles) of.length += trace.weight;
  constexpr double step = 1e-4, most = 10;
  for (std::size_t k = 0; k < 2; ++k) {
    of.sine.at(k) = norm(cross(geometry::upward_normal({dip, DipDirection::degrees(both->at(k))}), face.normal));
    double moved = 0;
    for (const double side : {-1.0, 1.0}) {
      const auto beside = both_directions(face, of.angle + side * step, dip);
      if (!beside) continue;
      double nearest = 360;
      for (const double direction : *beside) {
        const double off = std::remainder(direction - both->at(k), 360);
        if (std::abs(off) < std::abs(nearest)) nearest = off;
      }
      moved += side * nearest / (2 * step * degrees);
    }
    of.slope.at(k) = std::clamp(moved, -most, most);
  }
  return of;
}

/// Which of both directions each face takes if they are to lie near this one, and how well they agree (1: wholly).
std::pair<std::vector<std::size_t>, double> nearest(std::span<const FaceDirections> faces, double reference,
                                                    bool other) {
  std::vector<std::size_t> taken;
  double sine = 0, cosine = 0, length = 0;
  for (const FaceDirections& face : faces) {
    const auto off = [&](std::size_t k) { return std::abs(std::remainder(face.direction.at(k) - reference, 360)); };
    const std::size_t k = (off(1) < off(0)) != other ? 1 : 0;
    taken.push_back(k);
    sine += face.length * geometry::sin_degrees(face.direction.at(k));
    cosine += face.length * geometry::cos_degrees(face.direction.at(k));
    length += face.length;
  }
  return {std::move(taken), std::hypot(sine, cosine) / length};
}

double mean_direction(std::span<const FaceDirections> faces, std::span<const std::size_t> taken) {
  double sine = 0, cosine = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    sine += faces[f].length * geometry::sin_degrees(faces[f].direction.at(taken[f]));
    cosine += faces[f].length * geometry::cos_degrees(faces[f].direction.at(taken[f]));
  }
  return geometry::wrap_degrees(std::atan2(sine, cosine) * degrees);
}

/// The directions that agree best, and the others where these agree about as well.
std::pair<std::vector<std::size_t>, std::optional<double>> chosen(std::span<const FaceDirections> faces) {
  constexpr double as_well = 0.97;
  std::pair<std::vector<std::size_t>, double> best;
  double reference = 0;
  for (const FaceDirections& face : faces) {
    for (const double direction : face.direction) {
      auto found = nearest(faces, direction, false);
      if (found.second <= best.second + 1e-9) continue;
      best = std::move(found);
      reference = direction;
    }
  }
  auto [others, agreement] = nearest(faces, reference, true);
  if (agreement < as_well * best.second) return {best.first, std::nullopt};
  const auto met = [&](std::span<const std::size_t> taken) {
    double sum = 0;
    for (std::size_t f = 0; f < faces.size(); ++f) sum += faces[f].length * faces[f].sine.at(taken[f]);
    return sum;
  };
  const double one = mean_direction(faces, best.first), other = mean_direction(faces, others);
  const double difference = met(others) - met(best.first), all = met(others) + met(best.first);
  const bool level = std::abs(difference) < 1e-6 * all;
  if (level ? one == 0 || one > 180 : difference > 0) return {std::move(others), one};
  return {std::move(best.first), other};
}

}  // namespace

std::optional<TracedDirection> traced_direction(std::span<const TracesOfFace> faces, Dip dip, double confidence) {
  TracedDirection out;
  std::vector<FaceDirections> known;
  for (const TracesOfFace& face : faces) {
    if (auto of = directions_of(face, dip, confidence)) {
      known.push_back(*of);
    } else {
      out.notes.push_back(fmt::format("no plane of dip {} holds the mean trace on window {}, which is steeper",
                                      dip.degrees(), face.window));
    }
  }
  if (known.empty()) return std::nullopt;
  auto [taken, other] = chosen(known);
  if (dip.degrees() < 90 && dip.degrees() > 0) out.other = other;
  std::vector<WeightedAxis> strikes, scatter;
  for (std::size_t f = 0; f < known.size(); ++f) {
    const FaceDirections& face = known[f];
    const std::size_t k = taken[f];
    for (const WeightedAxis& trace : face.face->angles) {
      const double off = std::remainder(trace.angle - face.angle, pi);
      strikes.push_back({(face.direction.at(k) - 90) / degrees + face.slope.at(k) * off, trace.weight});
      scatter.push_back({off * face.sine.at(k), trace.weight});
    }
  }
  const MeanAxis mean = mean_axis(strikes, confidence);
  out.direction = mean.direction;
  out.direction.name = "dip direction";
  if (!mean.direction.value) return std::nullopt;
  const double near = mean_direction(known, taken);
  double direction = mean.axis + 90;
  if (std::abs(std::remainder(direction - near, 360)) > 90) direction += 180;
  const double turn = geometry::wrap_degrees(direction) - *mean.direction.value;
  for (double* angle : {&*out.direction.value, &out.direction.low, &out.direction.high}) *angle += turn;
  out.kappa = mean_axis(scatter, confidence).kappa;
  return out;
}

}  // namespace cleave::survey::detail
