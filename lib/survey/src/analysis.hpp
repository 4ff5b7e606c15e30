#pragma once

#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cleave/survey/analyse.hpp"
#include "lines_and_windows.hpp"
#include "trace_sets.hpp"
#include "unoriented.hpp"

namespace cleave::survey::detail {

/// In a radian.
inline constexpr double degrees = 180 / std::numbers::pi;

/// One survey on its way to its figures: sets and their orientations, then what lines and windows met of each.
class Analysis final {
 public:
  explicit Analysis(const SurveyInput& input) : in_{input} {}

  SurveyResult run();

 private:
  // Sets and their orientations (set_orientations.cpp).
  void weigh();
  void assign();
  std::size_t set_named(const std::string& name);
  [[nodiscard]] const SetRule* rule_of(const SetResult& set) const;
  void orient(std::size_t k);
  /// The lines and outcrops that the joints of a set were met on.
  [[nodiscard]] std::vector<Sampling> ways_met(std::size_t k) const;
  /// Of joints enough to take the place of what is stated.
  [[nodiscard]] std::string measured_note(const SetResult& set, const SetRule& rule) const;
  /// The dip is stated; direction and concentration too, or they are those of the traces.
  void state(SetResult& set, const SetRule& rule) const;
  static bool within(double azimuth, std::pair<double, double> range);
  [[nodiscard]] std::string no_trace_of(std::pair<double, double> azimuth) const;
  /// The traces within these azimuths, by length, of windows that lie alike together.
  [[nodiscard]] std::vector<TracesOfFace> traces_within(std::pair<double, double> range) const;
  /// A direction from the y axis as one from true north.
  void turn_to_north(Estimate& direction) const;

  // On scanlines and boreholes (sets_on_lines.cpp).
  /// Joints on lines to sets: by their orientation, else by the set that is stated of them, else by what there is.
  void assign_on_lines();
  void lines(std::size_t k);
  /// Length of a line times E|n.l| of a set.
  static double length_met(const SetResult& set, const LineSurvey& line);
  /// Of all lines, with its interval; `along_normal`: over E|n.n0|, which makes joints per metre along the mean normal
  /// n0 of the joints met.
  [[nodiscard]] Estimate length_of_lines(const SetResult& set, bool along_normal) const;
  /// Joints of a set on each line, and what the line offers them to be met; of lines of which each joint's set is
  /// known.
  [[nodiscard]] std::vector<MetOnLine> met_on_lines(std::size_t k) const;
  /// Traces met by lines, where no window was mapped.
  void line_lengths(std::size_t k);
  /// Joints below the truncation of their line are missing: by the law of sizes, else it is said.
  void recorded_on_lines(SetResult& set) const;

  // In windows (sets_in_windows.cpp).
  /// Each trace to the set by whose azimuths it goes, else to the one that leaves such traces most likely.
  void assign_traces();
  void windows(std::size_t k);
  /// What windows show of one set.
  struct SeenOfSet {
    std::vector<WindowCounts> counts = {};  ///< by window
    std::vector<SeenLength> lengths = {};
    std::vector<WholeTrace> whole = {};
    double truncation = 0;  ///< m, the largest of windows with such traces
    Chords sum = {};        ///< of the chords of its shape, by trace
  };
  [[nodiscard]] SeenOfSet seen_of(std::size_t k) const;
  /// E sin V of a set over all windows, with the error of its orientation; 1 where that is not known.
  [[nodiscard]] Estimate sine_of(const SetResult& set, const std::vector<WindowCounts>& counts,
                                 const WindowCounts& all) const;
  /// Joints a cubic metre, from the law of sizes or from their mean.
  [[nodiscard]] std::optional<Estimate> volume_frequency(const SetResult& set, const SeenOfSet& seen,
                                                         const WindowCounts& all, const Estimate& sine) const;
  /// E sin V of a set on each window; 1 where its orientation is not known.
  [[nodiscard]] std::vector<double> sines_of(const SetResult& set) const;
  [[nodiscard]] double truncation_of_windows(std::size_t k) const;
  /// Of windows with a truncation: what stands beside P32 and the law of sizes.
  void caution_of_windows(SetResult& set, double truncation);

  void choose(std::size_t k);
  void whole();
  [[nodiscard]] Estimate over_orientations(const SetResult& set,
                                           const std::function<double(geometry::Vec3, double)>& figure) const;

  static bool has_mean(const SetResult& set) { return set.joints > 0 || set.orientation_stated; }
  /// Area of the shape of size 1.
  static double shape_area(const ShapeRule& shape) { return chords_of(shape, 0).area; }

  const SurveyInput& in_;
  SurveyResult out_;
  std::vector<SetsOnLine> line_sets_;
  SharedOut shared_;
  std::vector<geometry::Vec3> normals_;
  std::vector<double> weights_;
  std::vector<std::vector<SeenTrace>> seen_;
  std::vector<std::vector<std::optional<std::size_t>>> trace_set_;
};

}  // namespace cleave::survey::detail
