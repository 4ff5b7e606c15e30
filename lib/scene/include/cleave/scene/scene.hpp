#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "cleave/core/id.hpp"
#include "cleave/core/quantity.hpp"
#include "cleave/geometry/solid.hpp"
#include "cleave/geometry/vec3.hpp"
#include "cleave/topology/cut_input.hpp"

/// A validated scene: what `scene::parse` makes of a TOML file and the files it names. Past this border nothing is re-checked.
/// Units: metres, degrees (in their own types), Pa, kg/m3, m/s2. Dip directions are already turned by `north`, so
/// they count clockwise from +y.
namespace cleave::scene {

using SetId = Id<struct JointSetTag>;  ///< a joint set by name; index into Scene::sets

/// A law of one number, given in the unit of the key that holds it (degrees for friction, metres for sizes).
/// `mean` and `std` are those of the law before it is cut to [min, max].
struct Distribution {
  enum class Kind : std::uint8_t { constant, uniform, normal, exponential, lognormal, gamma, power };
  Kind kind = Kind::constant;
  double mean = 0;      ///< constant: the value; not used by uniform and power
  double std = 0;       ///< normal, lognormal, gamma
  double exponent = 0;  ///< power: N(> x) ~ x^-exponent
  std::optional<double> min = std::nullopt;  ///< cut off below; lower end of uniform
  std::optional<double> max = std::nullopt;
};

/// Properties of the joints of one set ([joints.NAME], or [joints.default]).
struct JointProperties {
  Distribution friction{.kind = Distribution::Kind::constant, .mean = 30.0};  ///< degrees in [0, 90); one value drawn per joint
  Stress cohesion;
  Stress tension;
};

struct NamedSet {
  std::string name;  ///< "default" for joints without a set
  JointProperties properties;
};

/// The strength that a row of a joint file states for itself (CSV columns friction, cohesion).
struct OwnStrength {
  std::optional<FrictionAngle> friction;
  std::optional<Stress> cohesion;
};

/// A joint that is given, not drawn.
struct MeasuredJoint {
  std::variant<topology::Joint, topology::PersistentJoint> geometry;
  SetId set;
  OwnStrength own;
  std::string source;  ///< where it stands: "joints.obj:120" or "scene.toml:14"
};

struct FisherOrientation {
  Dip dip;
  DipDirection dip_direction;
  double kappa;
};
struct UniformOrientation {  ///< mean plus or minus the half range, both independent
  Dip dip;
  DipDirection dip_direction;
  Dip half_dip;
  DipDirection half_dip_direction;
};
struct NormalOrientation {
  Dip dip;
  DipDirection dip_direction;
  Dip dip_std;
  DipDirection dip_direction_std;
};
using OrientationLaw = std::variant<FisherOrientation, UniformOrientation, NormalOrientation>;

enum class JointShape : std::uint8_t { rectangle, square, disc, ellipse, polygon };

struct Count {
  std::uint64_t joints;
};
struct P32 {
  double per_metre;
};
struct P30 {
  double per_cubic_metre;
};
struct P10 {  ///< along the set's mean normal
  double per_metre;
};
struct Spacing {
  Length mean;
};
using Intensity = std::variant<Count, P32, P30, P10, Spacing>;

struct Persistent {};  ///< size = "persistent": planes through the whole domain

/// A [[joint_set]] (model "baecher"): joints drawn at random.
struct RandomSet {
  SetId set;
  OrientationLaw orientation;
  JointShape shape = JointShape::rectangle;
  std::uint32_t sides = 32;                        ///< of discs and ellipses as polygons, and of `polygon`
  std::variant<Persistent, Distribution> size;     ///< m: side, or diameter
  std::optional<Distribution> size_2;              ///< m: second side or axis
  std::optional<double> aspect;                    ///< first over second; neither this nor size_2: see the contract
  Distribution rotation;                           ///< degrees from strike, in the joint's plane
  Intensity intensity;
  std::uint32_t line;                              ///< in the scene file
};

struct Excavation {
  std::string name;
  std::uint32_t stage = 1;
  geometry::Solid solid;
};

struct Rock {
  Density density = kilograms_per_cubic_metre(2700);
};

struct StabilitySettings {
  geometry::Vec3 gravity{0, 0, -9.81};  ///< m/s2
  geometry::Vec3 seismic{0, 0, 0};      ///< force / weight, in the direction the rock is pushed
  bool force_transfer = true;
  std::uint32_t max_batches = 50;
};

struct OutputSettings {
  bool vtu = true;     ///< blocks.vtu
  bool csv = true;     ///< key_blocks.csv
  bool report = true;  ///< report.html
};

/// A file that the scene names, as read.
struct InputFile {
  std::string name;  ///< as written in the scene
  std::string sha256;
  std::uint64_t bytes;
};

struct Scene {
  std::string title;
  std::uint64_t seed = 1;
  Length snap;
  double north = 0;  ///< degrees from y to true north, clockwise; only for display: orientations are turned already

  geometry::Solid domain;
  std::vector<std::uint32_t> free_domain_tags;  ///< tag indices of `domain` that are free
  IdVector<SetId, NamedSet> sets;               ///< in order of first mention; [0] is "default"
  std::vector<MeasuredJoint> joints;            ///< in scene order; they get the first JointIds
  std::vector<RandomSet> joint_sets;            ///< in scene order; their joints follow
  Rock rock;
  std::vector<Excavation> excavations;          ///< in scene order
  std::optional<StabilitySettings> stability;   ///< empty: the scene has no [stability] and no free face
  OutputSettings output;

  std::string file_name;  ///< the scene file's name without its folder
  std::string sha256;     ///< of the scene file's bytes
  std::vector<InputFile> files;
};

}  // namespace cleave::scene
