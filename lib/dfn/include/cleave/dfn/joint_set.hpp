#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "cleave/dfn/laws.hpp"
#include "cleave/geometry/vec3.hpp"

namespace cleave::dfn {

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
