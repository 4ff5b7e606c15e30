#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "cleave/geometry/orientation.hpp"
#include "cleave/geometry/vec3.hpp"

namespace cleave::report {

using geometry::Net;
using geometry::NetPoint;

/// The great circle of the plane with this normal: `count` points on it, from rim to rim.
[[nodiscard]] std::vector<NetPoint> great_circle(geometry::Vec3 normal, Net net, std::size_t count);

struct Pole {
  geometry::Vec3 normal;  ///< of the joint, either sense
  std::uint32_t set;      ///< index into the sets
};

/// Mean of axes without sense: the eigenvector of the largest eigenvalue of the sum of n n^T (Watson 1966), upwards.
struct MeanPole {
  geometry::Vec3 normal;  ///< unit, z >= 0
  double dip_degrees, dip_direction_degrees;
  double kappa;  ///< Fisher's concentration (N - 1)/(N - R), axes turned to the mean's side; infinite for N = 1 or
                 ///< parallel ones
  std::size_t count;
};
/// `poles` must not be empty.
[[nodiscard]] MeanPole mean_of(std::span<const geometry::Vec3> poles);

struct NetSet {
  std::string name;
  std::uint64_t joints;
};

inline constexpr std::size_t max_plotted_poles = 1500;

/// An inline SVG: rim, grid, poles by set and great circles of the sets' means. Only every k-th pole is drawn when
/// there are more than max_plotted_poles. `north` (degrees from +y, clockwise) turns the north mark only.
[[nodiscard]] std::string stereonet_svg(std::span<const Pole> poles, std::span<const NetSet> sets, Net net,
                                        double north);

/// Colours of sets (in order; they repeat), chosen to differ for colour-blind readers; markers differ too.
[[nodiscard]] std::string set_colour(std::size_t set);
/// SVG of the set's marker at (x, y), `r` about its half width.
[[nodiscard]] std::string set_marker(std::size_t set, double x, double y, double r);

}  // namespace cleave::report
