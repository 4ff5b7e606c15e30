#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cleave/survey/analyse.hpp"

/// From traces on outcrops to sets, and from traces and a dip to dip directions.
namespace cleave::survey::detail {

/// Azimuth of a trace on the window, degrees in [0, 180) from true north.
[[nodiscard]] double azimuth_of(const WindowSurvey& window, MapPoint direction);
/// Whether azimuths tell traces on this window apart: on a vertical face all have that of its strike.
[[nodiscard]] bool tells_azimuths(const WindowSurvey& window);

/// How likely joints of a set (Fisher's law) leave traces of a direction on a window.
class TracesOfSet {
 public:
  TracesOfSet(const FisherFit& orientation, const WindowSurvey& window);
  /// Whether the trace lies so near to the set's mean plane as only one in a thousand does not, or within 30 degrees.
  [[nodiscard]] bool may_hold(MapPoint direction) const;
  /// Density of the traces' directions in the face, times a constant that is the same for all sets.
  [[nodiscard]] double density(MapPoint direction);

 private:
  geometry::Vec3 mean_, normal_, x_, y_;
  double kappa_, sine_, farthest_;
  std::vector<double> known_;  ///< by the direction, in quarters of a degree; negative where not worked out yet
};

/// Of so many traces to which sets were given, those that are of another than the likeliest set, where they are many.
[[nodiscard]] std::optional<std::string> doubtful_note(const WindowSurvey& window, double doubtful, std::size_t traces);
/// Of the traces seen on a window those that belong to no set; `sets`: of each the set, where it has one.
[[nodiscard]] std::optional<std::string> no_set_note(const WindowSurvey& window, std::span<const SeenTrace> seen,
                                                     std::span<const std::optional<std::size_t>> sets);

/// Traces on faces that all lie alike.
struct TracesOfFace {
  std::string window;                ///< name of the first of them
  geometry::Vec3 normal, x_axis;     ///< of the face and of the map's x axis
  std::vector<WeightedAxis> angles;  ///< from the x axis to the traces, by length
};
/// Dip direction of planes of a stated dip from their traces.
struct TracedDirection {
  Estimate direction;           ///< degrees from the y axis
  std::optional<double> other;  ///< the one that is as good
  Estimate kappa;
  std::vector<std::string> notes;
};
/// Planes of this dip that hold the mean trace of a face: two, mirrored at the vertical plane through it. Of faces that
/// lie otherwise, those that agree; else the one that makes the larger angle with the face, as such joints are met more
/// often; on level ground the one to the east. Empty where no such plane holds the traces.
[[nodiscard]] std::optional<TracedDirection> traced_direction(std::span<const TracesOfFace> faces, Dip dip,
                                                              double confidence);

}  // namespace cleave::survey::detail
