#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "cleave/survey/analyse.hpp"

/// Joints that lines met without an orientation: they count all the same.
namespace cleave::survey::detail {

/// The set of each joint on a line: its number, the number of sets for a joint of no set, empty where it is not known.
using SetsOnLine = std::vector<std::optional<std::size_t>>;

/// Joints of the sets on all lines, the one of no set last.
struct SharedOut {
  std::vector<std::size_t> known;
  std::vector<double> shared;  ///< of the joints whose set is not known
  std::size_t unknown = 0;     ///< all of these
  double left = 0;             ///< of these, on lines that none of the known sets can be met by

  /// How many joints of certain set say as much of the number of joints of this one: the number of all joints on the
  /// lines is Poisson's, the part of the set is known from those of known set alone.
  [[nodiscard]] double effective(std::size_t set) const;
};

/// Shares the joints of unknown set out among the sets as these are met by each line: the most likely intensities where
/// the orientation is missing by chance. `length`: of each set and of no set, the length of each line times E|n.l|.
[[nodiscard]] SharedOut share_out(const std::vector<SetsOnLine>& lines, const std::vector<std::vector<double>>& length);

/// Of a line whose joints lack orientations in a survey that has sets.
[[nodiscard]] std::optional<std::string> unoriented_note(const LineSurvey& line, const SetsOnLine& sets,
                                                         const SharedOut& shared);

/// So many joints, with the exact Poisson interval of `effective` joints scaled to it.
[[nodiscard]] Estimate counted(double joints, double effective, double confidence);

}  // namespace cleave::survey::detail
