#pragma once

/// Cases with known answers of the study "engines" (docs/dev/motion_checks.md has their numbers).

#include <functional>
#include <string>
#include <vector>

#include "engines.hpp"

namespace cleave::study::engines {

/// One run of a case.
struct Part {
  Scene scene;
  std::vector<double> times;                                       ///< s, when poses are wanted
  std::vector<std::function<double(const Outcome&)>> errors = {};  ///< relative, one for each measure of the case
};
/// Its errors are the worst of its parts.
struct Case {
  std::string name;
  std::vector<Part> parts;
  std::vector<double> steps;   ///< s; times are multiples
  std::vector<double> within;  ///< error that cleave has at its best, or less, by measure
  std::vector<std::string> measures = {""};
  bool large = false;  ///< a thousand blocks
};

/// Of a few blocks.
[[nodiscard]] std::vector<Case> small_cases();
/// Of `count` blocks in contact.
[[nodiscard]] std::vector<Case> large_cases(int count);

}  // namespace cleave::study::engines
