#pragma once

#include <expected>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/scene/parse.hpp"
#include "cleave/scene/problem.hpp"
#include "cleave/scene/scene.hpp"
#include "cleave/survey/analyse.hpp"

namespace cleave::scene {

/// A survey file (DATA.toml) with all that it names, validated.
struct SurveyScene {
  survey::SurveyInput input;
  std::string file_name, sha256;
  std::vector<InputFile> files;
  std::vector<Problem> notes;
};
[[nodiscard]] std::expected<SurveyScene, std::vector<Problem>> parse_survey(std::string_view text,
                                                                            const std::string& shown,
                                                                            const ReadFile& read_file);
[[nodiscard]] std::expected<SurveyScene, std::vector<Problem>> load_survey(const std::string& path);

/// The joint sets of a survey as a part of a scene (sets.toml) with the files it names (measured poles for sets that
/// are drawn from them). A scene takes it with include = ["sets.toml"].
struct SetsFile {
  std::string toml;
  std::vector<std::pair<std::string, std::string>> files;  ///< name, content
};
[[nodiscard]] SetsFile sets_file(const SurveyScene& survey, const survey::SurveyResult& result);

/// Traces that a network of the fitted sets leaves on a window of the survey, one realization: to lie beside the
/// measured map. Empty when a set lacks its laws.
[[nodiscard]] std::optional<std::vector<survey::Polyline>> simulated_traces(const SurveyScene& survey,
                                                                            const survey::SurveyResult& result,
                                                                            std::size_t window,
                                                                            std::uint64_t realization);

}  // namespace cleave::scene
