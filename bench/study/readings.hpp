#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/stochastic/record.hpp"

/// How the text of Fu (2014) may be read where its numbers are lost, and what it prints.
namespace cleave::readings {

enum class Limits : std::uint8_t {
  redrawn,      ///< sizes beyond the limits are drawn again
  clamped,      ///< they become the limits
  none,         ///< the limits are not applied
  upper_alone,  ///< drawn again beyond the upper limit
};

struct Reading {
  double extent = 1;  ///< the law is that of the whole side or diameter (1), or of the half side or radius (2)
  double box = 1;     ///< side of the box of centres over the domain's
  Limits limits = Limits::redrawn;
  bool density = true;  ///< the stated number is that of the domain (more in a larger box); false: of the larger box
  [[nodiscard]] std::string label() const;
  friend bool operator==(const Reading&, const Reading&) = default;
};

/// One printed figure: its mean over `realizations`, and their standard deviation where it is printed.
struct Printed {
  std::string_view name;
  double (*of)(const stochastic::Record&);  ///< NaN: the realization has none
  double mean = 0;
  std::optional<double> std = {};
};

/// A section of the source: the scene that states what it says, and what it prints.
struct Section {
  std::string_view name, scene;
  std::uint32_t realizations = 1;
  /// The stated numbers of joints of the sets that have sizes; empty: lost, one for all sets, such that the printed
  /// number of blocks comes out, beginning with `start`.
  std::vector<double> joints;
  double start = 0;
  bool limited = false;  ///< the text states limits of the sizes
  std::vector<Printed> figures;
};
[[nodiscard]] const std::vector<Section>& sections();

/// The scene's text with sizes, numbers and boxes of this reading.
[[nodiscard]] std::string scene_text(const Section& section, const Reading& reading, const std::vector<double>& joints);

/// A figure of ours beside the printed one. Differences and errors are those of logarithms.
struct Compared {
  std::string section, name;
  double printed = 0, ours = 0, low = 0, high = 0;  ///< 95 % interval of ours
  double difference = 0, error = 0;                 ///< ln(printed/ours) and the standard error of it
};
[[nodiscard]] std::vector<Compared> compare(const Section& section, const std::vector<stochastic::Record>& records);

/// Likelihood of the differences as normal with their errors and one more, `apart`, for all that is lost (domain,
/// orientations, friction): its maximum over `apart`. Figures are taken as independent, which they are not.
struct Likelihood {
  double log = 0, apart = 0;
};
[[nodiscard]] Likelihood likelihood(const std::vector<Compared>& figures);

}  // namespace cleave::readings
