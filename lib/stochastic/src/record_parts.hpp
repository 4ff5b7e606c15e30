#pragma once

#include <optional>
#include <vector>

#include "cleave/stochastic/record.hpp"

/// Parts of a record as lists of numbers, and back. Counts below 2^53 are exact in a double.
namespace cleave::stochastic {

/// Empty for a part that is not there.
[[nodiscard]] std::vector<double> numbers_of(const std::optional<Supported>& part);
[[nodiscard]] std::vector<double> numbers_of(const std::vector<PartTally>& part);
[[nodiscard]] std::vector<double> numbers_of(const std::optional<Grouped>& part);
[[nodiscard]] std::vector<double> numbers_of(const std::optional<Clamped>& part);
[[nodiscard]] std::vector<double> numbers_of(const std::optional<Staying>& part);
[[nodiscard]] std::vector<double> numbers_of(const std::vector<OrderTally>& part);
[[nodiscard]] std::vector<double> numbers_of(const std::vector<CaseTally>& part);
[[nodiscard]] std::vector<double> numbers_of(const std::vector<SetTally>& part);
[[nodiscard]] std::vector<double> numbers_of(const std::vector<LineTally>& part);
[[nodiscard]] std::vector<double> numbers_of(const std::optional<FlowTally>& part);
[[nodiscard]] std::vector<double> numbers_of(const std::optional<WholeBlocks>& part);
[[nodiscard]] std::vector<double> numbers_of(const std::optional<SupportedStages>& part);
[[nodiscard]] std::vector<double> numbers_of(const std::optional<StayingAtTarget>& part);
/// Bin, number and volume of each.
[[nodiscard]] std::vector<float> bins_of(const std::optional<WholeBlocks>& part);

/// False where the numbers are not those of such a part.
[[nodiscard]] bool take(const std::vector<double>& numbers, std::optional<Supported>& part);
[[nodiscard]] bool take(const std::vector<double>& numbers, std::vector<PartTally>& part);
[[nodiscard]] bool take(const std::vector<double>& numbers, std::optional<Grouped>& part);
[[nodiscard]] bool take(const std::vector<double>& numbers, std::optional<Clamped>& part);
[[nodiscard]] bool take(const std::vector<double>& numbers, std::optional<Staying>& part);
[[nodiscard]] bool take(const std::vector<double>& numbers, std::vector<OrderTally>& part);
[[nodiscard]] bool take(const std::vector<double>& numbers, std::vector<CaseTally>& part);
[[nodiscard]] bool take(const std::vector<double>& numbers, std::vector<SetTally>& part);
[[nodiscard]] bool take(const std::vector<double>& numbers, std::vector<LineTally>& part);
[[nodiscard]] bool take(const std::vector<double>& numbers, std::optional<FlowTally>& part);
[[nodiscard]] bool take(const std::vector<double>& numbers, std::optional<SupportedStages>& part);
/// Of the base case and of each load case that the record has, one behind the other.
[[nodiscard]] bool take(const std::vector<double>& numbers, Record& record);
[[nodiscard]] bool take(const std::vector<double>& numbers, const std::vector<float>& bins,
                        std::optional<WholeBlocks>& part);

}  // namespace cleave::stochastic
