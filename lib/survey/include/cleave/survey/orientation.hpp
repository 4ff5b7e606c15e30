#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "cleave/geometry/vec3.hpp"

/// Orientations of joints: bias, means, sets, Fisher's law. Normals are axes: n and -n are the same joint.
namespace cleave::survey {

/// Weight of a joint met by a line of unit direction l (Terzaghi 1965): 1/|n.l|, at most `cap` (10: 84.26 degrees,
/// Priest 1993).
[[nodiscard]] double terzaghi_weight(geometry::Vec3 normal, geometry::Vec3 line, double cap = 10);
/// Weight of a disc of diameter `d` met by a flat convex window with area `area` and width `b` across the trace
/// (Kulatilake & Wu 1984): 1/(sin V (d area + pi/4 d^2 b)), V = angle of joint and window, normalised by 1/area; d = 0:
/// 1/sin V.
[[nodiscard]] double window_weight(geometry::Vec3 normal, geometry::Vec3 window_normal, double d, double area, double b,
                                   double cap = 10);

/// Eigenvalues (largest first, summing to 1) and unit eigenvectors of the weighted orientation tensor sum w n n^T.
struct OrientationTensor {
  std::array<double, 3> values;
  std::array<geometry::Vec3, 3> vectors;
};
[[nodiscard]] OrientationTensor orientation_tensor(std::span<const geometry::Vec3> normals,
                                                   std::span<const double> weights);

struct FisherFit {
  geometry::Vec3 mean;  ///< unit, z >= 0
  double kappa = 0;     ///< (N_e - 1)/(N_e - R_e); infinite for one joint or parallel ones
  double kappa_low = 0, kappa_high = 0;
  /// Half angle of the confidence cone of the mean: Fisher's (1953) for equal weights, else from the scatter of
  /// weighted joints that the fitted law has where they were met. The sample's own scatter (leaving out one joint after
  /// the other) is too small just where the heavy joints were not met; it is taken where it is not known how joints
  /// were met, and where it is the larger one and Fisher's law does not fit. Empty for one joint or parallel ones.
  std::optional<double> cone_degrees = {};
  double effective_count = 0;  ///< (sum w)^2/sum w^2
  double expected_count = 0;   ///< the same as the fitted law has it, whatever joints were met; else that of the sample
  std::size_t count = 0;
  std::size_t capped = 0;  ///< weights at the cap
  /// Fisher's law is not refused: fewer than five joints or all parallel ones (no `statistic`), or 1 - cos t
  /// exponential (Stephens' corrected Kolmogorov-Smirnov statistic below its 5 % point 1.094) and eigenvalues 2 and 3
  /// not apart by more than twice their standard error.
  bool fisher = true;
  std::optional<double> statistic = {};
};
/// Joints met in one way (on one line, on one outcrop): the weight that one of this normal has, at most about the cap;
/// the chance to be met is 1/weight without a cap.
struct Sampling {
  std::function<double(geometry::Vec3 normal, double cap)> weight;
  std::size_t joints = 0;
};
/// Weighted mean and concentration (Fisher 1953): axes are turned to the mean until none changes sides. Not empty.
/// `met`: how the joints were met, for the cone; empty: not known.
[[nodiscard]] FisherFit fit_fisher(std::span<const geometry::Vec3> normals, std::span<const double> weights,
                                   double confidence = 0.95, double cap = 10, std::span<const Sampling> met = {});

/// Whether few joints carry most of the weight of a law met so, and only few were met.
[[nodiscard]] inline bool few_carry(const FisherFit& fit) noexcept {
  return fit.count < 100 && fit.expected_count < 0.5 * static_cast<double>(fit.count);
}

/// Bingham's law exp(k1 (n.v1)^2 + k2 (n.v2)^2)/F about the two smaller axes of the tensor, k1 <= k2 <= 0: maximum
/// likelihood (Bingham 1974), the constant F by quadrature.
struct BinghamFit {
  double k1 = 0, k2 = 0;
  std::array<double, 2> first{-INFINITY, 0}, second{-INFINITY, 0};  ///< intervals of k1 and k2
};
[[nodiscard]] BinghamFit fit_bingham(const OrientationTensor& tensor);
/// With intervals by the delta method from the scatter of (n.v)^2 (moments of an exponential family; the axes are
/// asymptotically independent of k), on log(2.4 - k).
[[nodiscard]] BinghamFit fit_bingham(std::span<const geometry::Vec3> normals, std::span<const double> weights,
                                     double confidence = 0.95);

/// Low and high of the tensor's three eigenvalues, by the scatter of (n.v)^2, on the logarithm of the odds.
[[nodiscard]] std::array<std::array<double, 2>, 3> tensor_intervals(const OrientationTensor& tensor,
                                                                    std::span<const geometry::Vec3> normals,
                                                                    std::span<const double> weights,
                                                                    double confidence = 0.95);

/// Axial K-means (Hammah & Curran 1998): distance 1 - (n.v)^2, first centres by farthest point from the densest joint.
struct Clustering {
  std::vector<std::optional<std::size_t>> set;  ///< of each joint; empty for outliers
  std::vector<geometry::Vec3> centres;          ///< unit, z >= 0
  double silhouette = 0;                        ///< mean over joints (of at most 2,000 of them)
};
[[nodiscard]] Clustering cluster(std::span<const geometry::Vec3> normals, std::span<const double> weights,
                                 std::size_t sets, bool mark_outliers = true);

/// Whether the pole (downward normal) lies in the polygon, whose corners are unit vectors of the lower hemisphere, in
/// order; seen in equal-angle projection.
[[nodiscard]] bool pole_inside(geometry::Vec3 normal, std::span<const geometry::Vec3> polygon);

/// E|n.l| and E sqrt(1 - (n.m)^2) over joints of a Fisher law, by a fixed low-discrepancy sequence of 2^14 points.
[[nodiscard]] double mean_line_cosine(geometry::Vec3 mean, double kappa, geometry::Vec3 line);
[[nodiscard]] double mean_plane_sine(geometry::Vec3 mean, double kappa, geometry::Vec3 plane_normal);

}  // namespace cleave::survey
