#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/geometry/vec3.hpp"
#include "cleave/survey/orientation.hpp"
#include "cleave/survey/traces.hpp"

/// A whole survey: from what was measured to joint sets with their laws.
namespace cleave::survey {

/// A rectangular outcrop, and the size of the joints seen on it.
struct OutcropSize {
  geometry::Vec3 along;  ///< unit, its side of `width`
  Length width, height;
  Length diameter;  ///< of the joints, as discs
  friend bool operator==(const OutcropSize&, const OutcropSize&) = default;
};

/// A joint whose orientation was measured.
struct MeasuredOrientation {
  geometry::Vec3 normal;                 ///< unit, z >= 0
  std::string set;                       ///< "" when not stated
  std::optional<geometry::Vec3> line;    ///< direction of the line it was met on
  std::optional<geometry::Vec3> window;  ///< normal of the outcrop it was seen on
  std::optional<OutcropSize> outcrop = {};
  friend bool operator==(const MeasuredOrientation&, const MeasuredOrientation&) = default;
};

/// Weight against the bias of how it was met: on lines 1/|n.l|, on outcrops 1/sin V, where the outcrop's size is known
/// that of `window_weight`. Joints beyond the cap (within 5.7 degrees of the line or outcrop for 10)
/// share the mean weight of their zone, so that the cap leaves no bias: where as many lie on either side of the line as
/// beyond it, 1/|n.l| has the mean 2 caps among those met, 1/sin V of an outcrop 1.5 caps.
[[nodiscard]] double weight_of(const MeasuredOrientation& joint, double cap);
/// How joints like this one are met, for the cone of their mean; no joints yet.
[[nodiscard]] Sampling sampling_of(MeasuredOrientation joint);

/// A scanline or borehole: straight pieces one after the other (a curved one has several).
struct LineSurvey {
  std::string name;
  std::vector<std::pair<geometry::Vec3, double>> pieces;  ///< unit direction, length (m)
  std::vector<double> positions;                          ///< along the line, m
  /// Numbers in SurveyInput::orientations, one a position, where any was measured.
  std::vector<std::optional<std::size_t>> joints = {};
  std::vector<std::string> sets = {};              ///< stated, "" where not; one a position, or empty
  std::vector<std::optional<SeenLength>> lengths;  ///< of the traces met, one a position where any was measured
  Length truncation = {};                          ///< shorter traces were not recorded
  [[nodiscard]] double length() const noexcept;
  /// Unit direction of the line at this many metres from its start; of its last piece beyond the end. Precondition: a
  /// piece.
  [[nodiscard]] geometry::Vec3 direction_at(double position) const;
};

struct WindowSurvey {
  std::string name;
  Window window;
  geometry::Vec3 normal{0, 0, 1};  ///< of the window's plane
  geometry::Vec3 x_axis{1, 0, 0};  ///< of the map, in space
  double north = 0;                ///< as in SurveyInput
  std::vector<Polyline> traces;
  Length border = {};      ///< ends so near to the window's border are taken as cut off by it
  Length truncation = {};  ///< shorter traces were not mapped
};

/// How joints are put into sets.
struct SetRule {
  std::string name;
  std::vector<geometry::Vec3> polygon;  ///< on the stereonet; empty: none
  /// Of traces, degrees from true north, when no orientations were measured.
  std::optional<std::pair<double, double>> azimuth;
  std::optional<Dip> dip;  ///< stated, when it cannot be measured
  std::optional<DipDirection> dip_direction;
  std::optional<double> kappa;
  ShapeRule shape;
};

/// As a compass shows it, of a normal in space.
[[nodiscard]] geometry::Attitude compass_attitude(geometry::Vec3 normal, double north);

struct SurveyInput {
  std::string title;
  double confidence = 0.95;
  std::uint64_t seed = 1;
  geometry::North north = {};  ///< from the y axis to true north, clockwise
  double weight_cap = 10;
  std::optional<std::size_t> clusters = {};  ///< empty: by rules or by the sets stated
  std::vector<MeasuredOrientation> orientations;
  std::vector<LineSurvey> lines;
  std::vector<WindowSurvey> windows;
  std::vector<SetRule> rules;
};

struct FittedLaw {
  Fit fit;
  std::optional<SizeOfJoints> sizes;  ///< by moments, when a law of sizes has these traces
  Estimate mean, std;                 ///< of the lengths
  std::optional<Estimate> size_mean, size_std;
  std::optional<LengthTest> test;  ///< of whole traces in windows
};

/// Of the joints, from the lengths as they were seen.
struct FittedSize {
  SizeOfJoints law;
  Estimate mean, std;
  std::optional<Estimate> exponent;  ///< of a power law
  /// What a joint offers to be met: in windows the area of the places its trace may have times its size, on lines the
  /// square of its size; means.
  Estimate offered;
  /// On lines with a truncation: the share of the joints met that is recorded.
  std::optional<Estimate> recorded = {};
  double aic = 0;
  std::string method;
};

struct SetResult {
  std::string name;
  double north = 0;                 ///< as in SurveyInput: normals are those in space
  std::size_t joints = 0;           ///< with a measured orientation
  std::size_t traces = 0;           ///< in windows
  std::size_t traces_on_lines = 0;  ///< with a length
  FisherFit orientation;
  std::optional<BinghamFit> bingham;  ///< when Fisher's law is refused
  bool orientation_stated = false;    ///< dip not measured: stated by the rule
  /// Dip direction from the traces, where only the dip was stated; degrees from true north.
  std::optional<Estimate> direction;
  std::vector<geometry::Vec3> normals;
  std::vector<double> weights;
  std::optional<Estimate> p10_normal;  ///< joints per metre along the mean normal, from lines
  std::optional<Estimate> p20, p21, mean_length, mean_length_counts;
  std::optional<Estimate> p32_lines, p32_windows, p30;
  std::optional<Estimate> p32;  ///< the one that sets.toml takes
  /// P30 times the mean area, where windows have a truncation and P32 is that of the longer joints.
  std::optional<double> p32_of_all = {};
  std::vector<FittedLaw> lengths;  ///< trace lengths, by AIC, best first
  ShapeRule shape;
  Chords chords;                     ///< of the shape along the set's traces, mean over the windows
  std::vector<FittedSize> sizes;     ///< by AIC, best first
  std::optional<SizeOfJoints> size;  ///< taken
  /// Of it, when it comes from a fitted law; the intervals are over all laws, as none is certain.
  std::optional<Estimate> size_mean, size_std;
  std::optional<Estimate> offered;  ///< as in FittedSize, of the law taken, over all laws
  std::optional<Estimate> recorded = {};
  std::optional<Estimate> m2, m3;  ///< E L^2/E L and E L^3/E L whatever the law (lengths: 2S/m; best fit)
  std::vector<Fit> spacings;       ///< along the lines, by AIC; `estimate_of` has their intervals
  std::vector<double> gaps, seen_lengths;
  std::vector<Estimate> comparisons;  ///< formulas of Fu (2014) that are biased: for comparison only
  std::vector<std::string> notes;
  /// Of them, what whoever takes P32 with the law of sizes must know.
  std::vector<std::string> cautions = {};
};

struct LineResult {
  std::string name;
  double length = 0;
  Estimate frequency;
  double rqd_measured = 0, rqd_of_frequency = 0;
  Estimate rqd, rqd_by_frequency;
  std::vector<Estimate> comparisons;  ///< biased or needing less: for comparison only
};

struct WindowResult {
  std::string name;
  WindowCounts counts;
  std::vector<Estimate> estimates;
  std::optional<Nodes> nodes;  ///< of at most 20,000 traces
};

struct SurveyResult {
  std::vector<SetResult> sets;
  std::vector<LineResult> lines;
  std::vector<WindowResult> windows;
  std::vector<std::pair<std::size_t, double>> silhouettes;  ///< by number of clusters
  OrientationTensor tensor{};
  std::array<std::array<double, 2>, 3> tensor_intervals{};
  std::size_t unassigned = 0;
  std::vector<std::optional<std::size_t>> set_of;  ///< of each orientation; empty: of no set
  std::vector<std::string> notes;
};

[[nodiscard]] SurveyResult analyse(const SurveyInput& input);

}  // namespace cleave::survey
