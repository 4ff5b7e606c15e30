#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/geometry/vec3.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::stability {

struct FrictionOutOfRange {
  FrictionAngle friction;  ///< not in [0, 90)
};
struct BadCohesion {
  Stress cohesion;  ///< negative or not finite
};
struct BadTension {
  Stress tension;  ///< negative or not finite
};
struct BadRoughness {
  double jrc;
  Stress jcs;
};
struct BadDensity {
  Density density;  ///< not > 0, or not finite
};
struct BadGravity {
  geometry::Vec3 gravity;  ///< not finite
};
struct BadSeismic {
  geometry::Vec3 coefficient;  ///< not finite
};
struct BadPartialFactor {
  std::string which;  ///< friction, cohesion or weight
  double value;       ///< not > 0, or not finite
};
using StrengthError = std::variant<FrictionOutOfRange, BadCohesion, BadTension, BadRoughness, BadDensity, BadGravity,
                                   BadSeismic, BadPartialFactor>;
/// "what is wrong; what to do", in words for an engineer.
[[nodiscard]] std::string describe(const StrengthError& error);

/// Roughness of a joint and strength of its walls, already at the scale of the block.
struct Roughness {
  double jrc;
  Stress jcs;
  friend bool operator==(const Roughness&, const Roughness&) = default;
};

/// Strength of a joint: Mohr-Coulomb, or the curved law of Barton and Bandis (1982),
///   tau = sigma_n tan(residual + JRC log10(JCS / sigma_n)),
/// with the angle kept between residual and 70 degrees (Barton and Choubey 1977: no extrapolation to low stress).
/// Tension is the strength of a joint that opens (cut-off). Invariant: friction in [0, 90) degrees; the rest >= 0,
/// finite.
class JointStrength final {
 public:
  [[nodiscard]] static std::expected<JointStrength, StrengthError> make(FrictionAngle friction,
                                                                        Stress cohesion = pascals(0),
                                                                        Stress tension = pascals(0));
  /// `jrc` in [0, 20] and `jcs` > 0 already at the scale of the block; no cohesion.
  [[nodiscard]] static std::expected<JointStrength, StrengthError> barton_bandis(FrictionAngle residual, double jrc,
                                                                                 Stress jcs,
                                                                                 Stress tension = pascals(0));
  /// No friction, no cohesion: of joints where there are none.
  [[nodiscard]] static JointStrength none() noexcept { return {FrictionAngle::degrees(0), pascals(0), pascals(0)}; }
  /// Of the straight law; the residual angle of the curved one.
  [[nodiscard]] FrictionAngle friction() const noexcept { return friction_; }
  [[nodiscard]] bool curved() const noexcept { return jrc_ > 0; }
  /// Secant of the law at an effective normal stress >= 0.
  [[nodiscard]] double tan_friction(Stress normal) const noexcept;
  [[nodiscard]] double tan_friction() const noexcept { return tan_friction_; }
  [[nodiscard]] Stress cohesion() const noexcept { return cohesion_; }
  [[nodiscard]] Stress tension() const noexcept { return tension_; }
  /// What the joint bears along itself at an effective normal stress >= 0.
  [[nodiscard]] Stress shear(Stress normal) const noexcept { return cohesion_ + tan_friction(normal) * normal; }
  /// Of the curved law.
  [[nodiscard]] std::optional<Roughness> roughness() const noexcept {
    return curved() ? std::optional{Roughness{jrc_, jcs_}} : std::nullopt;
  }
  friend bool operator==(const JointStrength&, const JointStrength&) = default;

 private:
  JointStrength(FrictionAngle friction, Stress cohesion, Stress tension) noexcept;
  FrictionAngle friction_;
  double tan_friction_;
  Stress cohesion_;
  Stress tension_;
  double jrc_ = 0;
  Stress jcs_ = {};
};

/// Stiffness of a joint against closing and against shear, both > 0.
struct JointStiffness {
  Stiffness normal, shear;
  friend bool operator==(const JointStiffness&, const JointStiffness&) = default;
};

/// The strength of every joint: one for all, and exceptions.
class StrengthTable final {
 public:
  explicit StrengthTable(JointStrength fallback) : fallback_{fallback} {}
  void set(topology::JointId joint, JointStrength strength);
  [[nodiscard]] const JointStrength& of(std::optional<topology::JointId> joint) const noexcept;
  /// The smallest of all strengths in the table, the one for all others included.
  [[nodiscard]] double least_tan_friction() const noexcept;

 private:
  JointStrength fallback_;
  std::vector<std::optional<JointStrength>> by_joint_;
};

/// Intact rock as far as statics needs it. Invariant: density > 0 and finite.
class RockMass final {
 public:
  [[nodiscard]] static std::expected<RockMass, StrengthError> make(Density density);
  /// Of 2700 kg/m3.
  [[nodiscard]] static RockMass usual() noexcept { return RockMass{kilograms_per_cubic_metre(2700)}; }
  [[nodiscard]] Density density() const noexcept { return density_; }

 private:
  explicit RockMass(Density density) noexcept : density_{density} {}
  Density density_;
};

/// Body forces. Invariant: finite.
class Loads final {
 public:
  /// `gravity` in m/s2 as a vector (default of scenes: (0, 0, -9.81)); `seismic` is force / weight in the direction it
  /// acts (the sign of D'Alembert is already in it).
  [[nodiscard]] static std::expected<Loads, StrengthError> make(geometry::Vec3 gravity, geometry::Vec3 seismic = {});
  /// Gravity of 9.81 m/s2 straight down.
  [[nodiscard]] static Loads usual() noexcept { return {{0, 0, -9.81}, {}}; }
  [[nodiscard]] geometry::Vec3 gravity() const noexcept { return gravity_; }
  [[nodiscard]] geometry::Vec3 seismic() const noexcept { return seismic_; }
  /// Precondition: the factor is finite.
  [[nodiscard]] Loads with_seismic_times(double factor) const noexcept { return {gravity_, factor * seismic_}; }

 private:
  Loads(geometry::Vec3 gravity, geometry::Vec3 seismic) noexcept : gravity_{gravity}, seismic_{seismic} {}
  geometry::Vec3 gravity_;
  geometry::Vec3 seismic_;
};

/// Partial factors of a design standard: tan(friction) and cohesion (and tension) are divided, weight is multiplied.
class PartialFactors final {
 public:
  PartialFactors() = default;
  [[nodiscard]] static std::expected<PartialFactors, StrengthError> make(double friction, double cohesion,
                                                                         double weight);
  [[nodiscard]] double friction() const noexcept { return friction_; }
  [[nodiscard]] double cohesion() const noexcept { return cohesion_; }
  [[nodiscard]] double weight() const noexcept { return weight_; }

 private:
  double friction_ = 1;
  double cohesion_ = 1;
  double weight_ = 1;
};

// ---- Clamped blocks -------------------------------------------------------------------------------------------------

// A block between joints that a stress field presses on: equilibrium under the pair of normal and shear forces.

/// A joint face of a block with the force that the field puts across it before the block moves.
struct ClampedContact {
  geometry::Vec3 inward;      ///< unit, into the block
  double area = 0;            ///< m2, in contact
  double normal = 0;          ///< N along `inward`, > 0 in compression
  geometry::Vec3 shear = {};  ///< N in the plane of the face, of the rock on the block
  /// Strengths and the areas that they stand for.
  std::vector<std::pair<const JointStrength*, double>> strengths = {};
  /// All contacts of a block have one or none has.
  std::optional<JointStiffness> stiffness = {};
};

/// The block moves as a rigid body by u: across each face normal force falls by k_n A u.n (no tension), shear turns
/// towards -u by k_s A and is cut off at the strength, N tan(friction) + c A where N > 0 and nothing where the face
/// opens. Whether there is a u where these forces and `applied` balance, all strengths divided by `factor`. Forces
/// scale with u, so only the ratios of stiffnesses matter: those of the contacts, or `stiffness_ratio` = k_n / k_s of
/// all where the contacts have none. `false` also where the search does not settle.
[[nodiscard]] bool clamped_balances(std::span<const ClampedContact> contacts, geometry::Vec3 applied,
                                    double stiffness_ratio, double factor, const PartialFactors& partial = {});

/// The factor of safety: the largest factor on all strengths at which the block still balances, found by doubling and
/// bisection; the least over the ratios 1, 10, 100 and 1000 where no stiffness is given. 0: at no strength up to 1e9
/// times the given one; infinite: at 1e-9 of it too. For a prism in a roof with contacts that share a height: Crawford
/// and Bray (1983) with friction reduced until their pull-out force is the weight.
[[nodiscard]] double clamped_factor(std::span<const ClampedContact> contacts, geometry::Vec3 applied,
                                    std::optional<double> stiffness_ratio, const PartialFactors& partial = {});

}  // namespace cleave::stability
