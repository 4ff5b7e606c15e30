#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/geometry/vec3.hpp"

/// Joint sets, with laws of size, orientation and rotation as a scene states them: plain values, checked by the types
/// that hold them.
namespace cleave::dfn {

// ---- size -----------------------------------------------------------------------------------------------------------

enum class SizeDistribution : std::uint8_t { constant, normal, exponential, lognormal, power, gamma, uniform };

/// `mean` and `std` are those of the law before truncation to [min, max]. What a law does not use is left empty.
struct SizeSpec {
  SizeDistribution distribution = SizeDistribution::constant;
  std::optional<Length> mean;      ///< all but power and uniform
  std::optional<Length> std;       ///< normal, lognormal, gamma
  std::optional<double> exponent;  ///< power: N(> x) ~ x^-exponent; needs min, and max when exponent <= 2
  std::optional<Length> min;       ///< >= 0; a normal law is cut at 1e-6 of its mean if this is smaller
  std::optional<Length> max;       ///< uniform: needs it, and min
  /// What the law draws beyond min or max is taken as these, not drawn again: the limits then have probabilities of
  /// their own.
  bool clamp = false;
};

struct MissingParameter {
  std::string key;
};
struct BadParameter {  ///< not finite, or out of its range
  std::string key;
  double value;
  std::string remedy;
};
struct EmptyRange {  ///< min > max, or a law that has no probability (below 1e-12) between them
  Length min, max;
};
using SizeError = std::variant<MissingParameter, BadParameter, EmptyRange>;
[[nodiscard]] std::string describe(const SizeError& error);

/// A law of sizes > 0. Invariant: parameters are finite, and at least 1e-12 of the untruncated law lies within the
/// limits.
class SizeLaw final {
 public:
  [[nodiscard]] static std::expected<SizeLaw, SizeError> make(const SizeSpec& spec);
  [[nodiscard]] static SizeLaw constant(Length size);  ///< precondition: finite and > 0

  /// Inverse of the truncated (or clamped) distribution function: larger u, larger size. Precondition: 0 < u < 1.
  /// Computed in the tail that is the shorter one, so it is accurate far out as well.
  [[nodiscard]] Length quantile(double u) const noexcept;
  /// E[X^k], k = 1 or 2, of the truncated (or clamped) law (m^k); closed forms.
  [[nodiscard]] double moment(int k) const noexcept;
  /// Part of the untruncated law within the limits, (0, 1].
  [[nodiscard]] double kept_share() const noexcept;
  /// Upper limit; for laws without one the quantile 1 - 1e-6.
  [[nodiscard]] Length largest() const noexcept;
  [[nodiscard]] SizeDistribution distribution() const noexcept { return distribution_; }

 private:
  SizeLaw() = default;
  SizeDistribution distribution_ = SizeDistribution::constant;
  double a_ = 0, b_ = 0;            // parameters: constant value; mean, std; mean; mu, sigma; exponent; shape, scale
  double min_ = 0, max_ = 0;        // limits, max may be infinite
  double below_ = 0, above_ = 0;    // normal, lognormal: probability below min and above max
  double mass_ = 1;                 // probability between the limits
  double at_min_ = 0, at_max_ = 0;  // clamped laws: probabilities of the limits themselves

  void clamp();
  [[nodiscard]] Length quantile_within(double u) const noexcept;
  [[nodiscard]] double moment_within(int k) const noexcept;
};

// ---- orientation ----------------------------------------------------------------------------------------------------

/// Dip and dip direction uniform and independent in mean - range .. mean + range; dips fold back into [0, 90].
struct UniformOrientation {
  Dip dip;
  DipDirection dip_direction;
  Dip dip_range;                     ///< plus or minus, 0..90
  DipDirection dip_direction_range;  ///< plus or minus, 0..180
};
/// Fisher's law about the mean normal; kappa = 0: uniform on the sphere.
struct FisherOrientation {
  Dip dip;
  DipDirection dip_direction;
  double kappa = 0;
};
/// Dip and dip direction of a bivariate normal law with this correlation; dips fold back into [0, 90].
struct NormalOrientation {
  Dip dip;
  DipDirection dip_direction;
  Dip dip_std;
  DipDirection dip_direction_std;
  double correlation = 0;  ///< -1 to 1
};
/// Measured normals drawn with replacement, each as often as its weight says, and turned by Fisher's law with `jitter`
/// (none: exactly as measured). Dip and dip direction are those of the weighted mean axis.
struct BootstrapOrientation {
  Dip dip;
  DipDirection dip_direction;
  std::vector<geometry::Vec3> normals;  ///< unit, z >= 0
  std::vector<double> cumulative;       ///< of the weights, the last one 1
  std::optional<double> jitter;
  /// Precondition: as many weights as normals, at least one, all > 0 and finite.
  [[nodiscard]] static BootstrapOrientation make(std::vector<geometry::Vec3> normals, std::vector<double> weights,
                                                 std::optional<double> jitter);
};
struct RotationKind;
/// From the strike (dip direction - 90) to the first side or axis, counter-clockwise seen from above.
using Rotation = Angle<RotationKind>;

/// Bingham's (1974) law of axes about the mean normal v3: density proportional to exp(k1 (n.v1)^2 + k2 (n.v2)^2), v1 in
/// the mean plane at `axis` from the strike, v2 across it. k1 = k2: the same spread all round; k2 = 0 and k1 far below
/// it: a girdle.
struct BinghamOrientation {
  Dip dip;
  DipDirection dip_direction;
  double k1 = 0, k2 = 0;           ///< -1e9 to 0
  Rotation axis;                   ///< of v1
  std::vector<double> density;     ///< of azimuths about v3 over a quarter turn, at equal steps of a stretched azimuth
  std::vector<double> cumulative;  ///< its integral up to each of them, the last one 1
  /// Precondition: k1 and k2 from -1e9 to 0.
  [[nodiscard]] static BinghamOrientation make(Dip dip, DipDirection direction, double k1, double k2, Rotation axis);
};
using OrientationLaw =
    std::variant<UniformOrientation, FisherOrientation, NormalOrientation, BootstrapOrientation, BinghamOrientation>;

// ---- rotation in the joint's plane ----------------------------------------------------------------------------------

struct FixedRotation {
  Rotation angle;
};
struct UniformRotation {
  Rotation from, to;
};
struct NormalRotation {
  Rotation mean, std;
};
using RotationLaw = std::variant<FixedRotation, UniformRotation, NormalRotation>;

// ---- Network models -------------------------------------------------------------------------------------------------

// Network models: how the joints of a set lie to each other and to those of earlier sets (Dershowitz & Einstein 1988;
// Fu 2014, ch. 2).

/// Centres, orientations and sizes independent of each other (Baecher, Lanney & Einstein 1977).
struct Baecher {};

/// As Baecher; where a joint meets one of the sets `terminate_at` (numbers of earlier sets) it ends with `probability`:
/// cut along the whole trace, the part with the centre stays; nearer meetings first (Geier, Lee & Dershowitz 1988).
struct EnhancedBaecher {
  std::vector<std::size_t> terminate_at;
  double probability = 1;
};

/// Poisson planes; on each an isotropic Poisson line process whose polygons have the mean area that shape and size of
/// the set have; each polygon is a joint with probability `share` (Veneziano 1978).
struct Veneziano {
  double share = 0.5;
};

/// Poisson planes, cut into polygons by all other planes of the set; each polygon is a joint with probability `share`
/// (Dershowitz 1984). Sizes follow from the intensity.
struct Dershowitz {
  double share = 0.5;
};

/// Faces of a Voronoi tessellation, each a joint with probability `share` (1: every cell a block).
struct Mosaic {
  enum class Seeds : std::uint8_t { poisson, grid, jittered };
  Seeds seeds = Seeds::poisson;
  double share = 1;
};

/// Planes of the set are cut into polygons by the joints of earlier sets (`terminate_at`), each extended to the
/// polygons it meets; a polygon is a joint with a probability that depends on how many of those joints bound it: none,
/// one, two or more (Lee, Veneziano & Einstein 1990).
struct Hierarchical {
  std::vector<std::size_t> terminate_at;
  std::array<double, 3> share{0.1, 0.5, 1};
};

/// A box and the probability that a polygon with its centroid in it stays.
struct Zone {
  geometry::Vec3 min, max;
  double probability = 1;
};

/// Veneziano's polygons, of which those of good shape stay, by zones; each is then shifted at random within a ball and
/// turned about its centroid by Fisher's law (Meyer & Einstein 2002).
struct Mit {
  double share = 0.5;
  std::uint32_t min_corners = 4;
  double min_angle = 60;        ///< degrees
  double max_elongation = 1.6;  ///< longest over shortest caliper
  std::vector<Zone> zones;      ///< the first that holds the centroid; none: probability 1
  double shift = 0;             ///< m
  std::optional<double> turn_kappa;
};

/// Parallel planes at random distances; unbounded, or laid with rectangles and bridges in rows (Snow 1965; Dershowitz &
/// Einstein 1988). Jitter of the normals by the set's orientation law.
struct Orthogonal {
  enum class Gaps : std::uint8_t { poisson, constant, lognormal };
  Gaps gaps = Gaps::poisson;
  double gap_variation = 0.5;     ///< standard deviation / mean of lognormal gaps
  std::optional<SizeLaw> bridge;  ///< intact rock between two joints of a row
  /// A point that one of the planes passes; none: the place of the first is random, too.
  std::optional<geometry::Vec3> through = {};
};

using Model = std::variant<Baecher, EnhancedBaecher, Veneziano, Dershowitz, Mosaic, Hierarchical, Mit, Orthogonal>;

/// Share of the area of an isotropic Poisson line tessellation that lies in polygons of good shape (Mit): needed to
/// give the joints the intensity that was asked for. Of the usual shapes known to 0.0001; of others by 32,768 cells,
/// always the same, with a standard error of at most 0.003; a tenth of a second.
[[nodiscard]] double good_shape_share(const Mit& model);

// ---- shape ----------------------------------------------------------------------------------------------------------

/// The second side or axis of a rectangle or ellipse.
struct IndependentSize {};  ///< an independent draw of the first one's law (the default)
struct AspectRatio {        ///< second = first / ratio
  double ratio = 1;
};
using SecondSize = std::variant<IndependentSize, AspectRatio, SizeLaw>;

struct Rectangle {
  SizeLaw size;  ///< side along the strike (before rotation)
  SecondSize second = IndependentSize{};
};
struct Square {
  SizeLaw size;  ///< side
};
/// A disc is cut as a regular polygon of the same area (so that P32 is kept): circumradius R sqrt(2 pi/(m sin(2
/// pi/m))).
struct Disc {
  SizeLaw size;  ///< diameter
  std::uint32_t sides = 16;
};
/// As a disc, stretched: polygon of the same area with its corners on a similar ellipse.
struct Ellipse {
  SizeLaw size;  ///< first axis (whole length), along the strike before rotation
  SecondSize second = IndependentSize{};
  std::uint32_t sides = 16;
};
/// Regular polygon; a corner lies in the direction of the strike before rotation.
struct RegularPolygon {
  SizeLaw size;  ///< diameter of the circle through the corners
  std::uint32_t sides = 6;
};
/// Planes without end.
struct Persistent {};
using Shape = std::variant<Rectangle, Square, Disc, Ellipse, RegularPolygon, Persistent>;

// ---- intensity ------------------------------------------------------------------------------------------------------

/// Exactly this many joints, centres uniform in the domain's box; in a larger box (`JointSetSpec::buffer`) as many more
/// as it is larger, so that the density stays, or so many in all of it (`in_buffer`).
struct Count {
  std::uint64_t joints = 0;
  bool in_buffer = false;
};
/// Joint area per volume (1/m). This and the next three draw a Poisson number of joints in the domain's box grown by
/// the largest half extent of a joint on all sides (planes: in the smallest ball around the box), so the domain has no
/// edge effect.
struct P32 {
  double value = 0;
};
/// Joint centres per volume (1/m3). Not for persistent joints.
struct P30 {
  double value = 0;
};
/// Joints per metre of a line along the set's mean normal (1/m).
struct P10 {
  double value = 0;
};
/// 1/P10 (m): mean distance along the set's mean normal.
struct Spacing {
  Length value;
};
using Intensity = std::variant<Count, P32, P30, P10, Spacing>;

// ---- the set --------------------------------------------------------------------------------------------------------

struct JointSetSpec {
  OrientationLaw orientation;
  Shape shape;
  RotationLaw rotation = FixedRotation{};
  Intensity intensity;
  Model model = Baecher{};
  /// Side of the box of centres over that of the domain's box, >= 1; none: the box of `Count`, or the grown box. Only
  /// for models that draw joints by their centres.
  std::optional<double> buffer = {};
};

/// The number of a key is not finite or out of its range. `key` is spelt as in the scene file ("orientation.kappa").
struct BadValue {
  std::string key;
  double value;
  std::string remedy;
};
/// Persistent joints have no centres per volume.
struct NoCentres {};
/// The model cannot be made with this shape, size or intensity.
struct ModelMismatch {
  std::string key;
  std::string what;
  std::string remedy;
};
using JointSetError = std::variant<BadValue, NoCentres, ModelMismatch>;
/// "what is wrong; what to do". Names the key.
[[nodiscard]] std::string describe(const JointSetError& error);

/// A validated set of random joints.
///
/// Invariant: every number is finite and in its range; dips in [0, 90], dip directions reduced to [0, 360).
class JointSet final {
 public:
  [[nodiscard]] static std::expected<JointSet, JointSetError> make(JointSetSpec spec);

  [[nodiscard]] const JointSetSpec& spec() const noexcept { return spec_; }
  /// Upward unit normal of the mean orientation.
  [[nodiscard]] geometry::Vec3 mean_normal() const noexcept;
  /// E[area] (m2) of the joints as drawn; 0 for persistent ones.
  [[nodiscard]] double mean_area() const noexcept;
  /// Largest half extent from the centre (m): what the box is grown by; 0 for persistent joints. Sizes without an upper
  /// limit count up to their quantile 1 - 1e-6.
  [[nodiscard]] double reach() const noexcept;
  /// E |n . mean normal|: turns P10 into P32. Closed form for Fisher's law, else the mean over 2^16 points of a fixed
  /// low-discrepancy sequence (error below 1e-4; some milliseconds, but for intensities along a line once a set).
  [[nodiscard]] double mean_cosine() const noexcept;
  /// Joint area per volume that the intensity asks for (1/m); for Count joints in `volume` (m3).
  [[nodiscard]] double expected_p32(double volume) const noexcept;
  /// Part of the area of the model's planes (or faces) that become joints; 1 for models that draw joints themselves.
  /// Hierarchical: 1, its intensity is that of the planes.
  [[nodiscard]] double area_share() const noexcept { return area_share_; }
  /// What joints that end at others keep of their area, (0, 1]: found by trial draws, as it depends on the other sets.
  void set_area_share(double share) noexcept { area_share_ = share; }

 private:
  explicit JointSet(JointSetSpec spec) : spec_{std::move(spec)} {}
  [[nodiscard]] double find_mean_cosine() const noexcept;
  JointSetSpec spec_;
  double area_share_ = 1;
  std::optional<double> mean_cosine_;  ///< of intensities along a line, which need it in every draw
};

}  // namespace cleave::dfn
