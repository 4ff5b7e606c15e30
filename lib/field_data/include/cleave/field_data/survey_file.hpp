#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/scene/problem.hpp"
#include "cleave/survey/analyse.hpp"

namespace cleave::scene {

struct KeyTable;

/// A survey file (DATA.toml) with all that it names, validated.
struct SurveyScene {
  survey::SurveyInput input;
  std::string file_name, sha256;
  std::vector<InputFile> files;
  std::vector<Problem> notes;
};

[[nodiscard]] const KeyTable& survey_keys();
[[nodiscard]] std::expected<SurveyScene, std::vector<Problem>> parse_survey(std::string_view text,
                                                                            const std::string& shown,
                                                                            const ReadFile& read_file);

/// The joint sets of a survey as a part of a scene (sets.toml) with the files it names (measured poles for sets that
/// are drawn from them). A scene takes it with include = ["sets.toml"].
struct SetsFile {
  std::string toml;
  std::vector<std::pair<std::string, std::string>> files;  ///< name, content
};
/// Whether the set has all that a network needs but sizes: others are left out.
[[nodiscard]] bool usable(const survey::SetResult& set);
[[nodiscard]] SetsFile sets_file(const SurveyScene& survey, const survey::SurveyResult& result);

/// Traces that a network of the fitted sets leaves on a window of the survey, one realization: to lie beside the
/// measured map. Empty when a set lacks its laws.
[[nodiscard]] std::optional<std::vector<survey::Polyline>> simulated_traces(const SurveyScene& survey,
                                                                            const survey::SurveyResult& result,
                                                                            std::size_t window,
                                                                            std::uint64_t realization);

/// What a trace map shows as a whole, to lay maps beside one another.
struct MapFigures {
  double traces = 0;       ///< that meet the window
  double p20 = 0;          ///< 1/m2
  double p21 = 0;          ///< 1/m
  double mean_length = 0;  ///< m, corrected for the window
  double connections = 0;  ///< per trace; 0 beyond 20,000 traces
  double direction = 0;    ///< axial mean of the traces by length, degrees from north, [0, 180)
  double alignment = 0;    ///< of the directions: 1 all parallel, 0 none preferred
  /// p20, p21, mean length, connections, direction and alignment with their intervals (of the measured map; P20 and so
  /// on for simulated ones, too).
  std::vector<survey::Estimate> estimates;
};
[[nodiscard]] MapFigures map_figures(const survey::WindowSurvey& map, const std::vector<survey::Polyline>& traces,
                                     double border, double confidence = 0.95);
/// 19 maps: a figure of the measured map lies outside all of them by chance once in ten.
inline constexpr std::uint64_t simulated_maps = 19;

/// A measured map, the simulated ones to lie beside it, and the traces of the first of these.
struct SimulatedTraceMaps {
  MapFigures measured;
  std::vector<MapFigures> simulated;
  std::optional<std::vector<survey::Polyline>> first;
};
/// Of every window; one simulated map where more than 20,000 traces were measured, else 19.
[[nodiscard]] std::vector<SimulatedTraceMaps> simulated_trace_maps(const SurveyScene& survey,
                                                                   const survey::SurveyResult& result);
/// Old name.
[[nodiscard]] inline std::vector<SimulatedTraceMaps> maps_beside(const SurveyScene& survey,
                                                                 const survey::SurveyResult& result) {
  return simulated_trace_maps(survey, result);
}

}  // namespace cleave::scene
