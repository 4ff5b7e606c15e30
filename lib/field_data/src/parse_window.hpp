#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "cleave/scene/common_keys.hpp"
#include "cleave/scene/file_input.hpp"
#include "cleave/scene/table_reader.hpp"
#include "cleave/survey/analyse.hpp"

/// [[window]] of a survey: maps of traces.
namespace cleave::scene {

[[nodiscard]] const KeyTable& window_keys();
void parse_window(InputContext& context, const TableReader& table, survey::SurveyInput& input);

/// [[a, b], ...], three at least.
[[nodiscard]] std::optional<std::vector<std::array<double, 2>>> three_pairs(const TableReader& table,
                                                                            std::string_view key);

}  // namespace cleave::scene
