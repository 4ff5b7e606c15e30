#include "cleave/dfn/joint_set.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "bingham.hpp"
#include "cleave/core/overloaded.hpp"
#include "orientation.hpp"
#include "shape.hpp"

namespace cleave::dfn {
namespace {

/// Collects the first number out of range. "not (low <= v <= high)" is also true for NaN.
class Check final {
 public:
  void range(const char* key, double value, double low, double high, const char* remedy) {
    if (!error_ && !(value >= low && value <= high)) error_ = BadValue{key, value, remedy};
  }
  void positive(const char* key, double value, double high, const char* remedy) {
    if (!error_ && !(value > 0 && value <= high)) error_ = BadValue{key, value, remedy};
  }
  [[nodiscard]] const std::optional<BadValue>& error() const { return error_; }

 private:
  std::optional<BadValue> error_;
};

void check_mean(Check& check, Dip dip, DipDirection direction) {
  check.range("orientation.dip", dip.degrees(), 0, 90, "give 0 to 90 degrees from horizontal");
  check.range("orientation.dip_direction", direction.degrees(), -360, 360,
              "give 0 to 360 degrees clockwise from north");
}

void check_orientation(Check& check, const OrientationLaw& law) {
  std::visit(
      overloaded{
          [&](const UniformOrientation& l) {
            check_mean(check, l.dip, l.dip_direction);
            check.range("orientation.dip_range", l.dip_range.degrees(), 0, 90, "give 0 to 90 degrees (plus or minus)");
            check.range("orientation.dip_direction_range", l.dip_direction_range.degrees(), 0, 180,
                        "give 0 to 180 degrees (plus or minus)");
          },
          [&](const FisherOrientation& l) {
            check_mean(check, l.dip, l.dip_direction);
            check.range("orientation.kappa", l.kappa, 0, 1e12, "give 0 (no preferred direction) to 1e12 (parallel)");
          },
          [&](const NormalOrientation& l) {
            check_mean(check, l.dip, l.dip_direction);
            check.range("orientation.dip_std", l.dip_std.degrees(), 0, 90, "give 0 to 90 degrees");
            check.range("orientation.dip_direction_std", l.dip_direction_std.degrees(), 0, 360,
                        "give 0 to 360 degrees");
            check.range("orientation.correlation", l.correlation, -1, 1, "give -1 to 1");
          },
          [&](const BinghamOrientation& l) {
            check_mean(check, l.dip, l.dip_direction);
            check.range("orientation.k1", l.k1, -1e9, 0, "give -1e9 (one plane of normals) to 0 (even)");
            check.range("orientation.k2", l.k2, -1e9, 0, "give -1e9 (one plane of normals) to 0 (even)");
            check.range("orientation.axis", l.axis.degrees(), -360, 360, "give -360 to 360 degrees");
          },
          [&](const BootstrapOrientation& l) {
            if (l.jitter) check.range("orientation.jitter", *l.jitter, 0, 1e12, "give a kappa of 0 to 1e12");
          },
      },
      law);
}

void check_second(Check& check, const SecondSize& second) {
  if (const auto* aspect = std::get_if<AspectRatio>(&second)) {
    check.range("aspect", aspect->ratio, 1e-6, 1e6, "give the ratio first side : second side, 1e-6 to 1e6");
  }
}

void check_sides(Check& check, std::uint32_t sides) { check.range("sides", sides, 3, 1024, "give 3 to 1024 sides"); }

void check_shape(Check& check, const Shape& shape) {
  std::visit(overloaded{
                 [&](const Rectangle& s) { check_second(check, s.second); },
                 [](const Square&) {},
                 [&](const Disc& s) { check_sides(check, s.sides); },
                 [&](const Ellipse& s) {
                   check_second(check, s.second);
                   check_sides(check, s.sides);
                 },
                 [&](const RegularPolygon& s) { check_sides(check, s.sides); },
                 [](Persistent) {},
             },
             shape);
}

void check_rotation(Check& check, const RotationLaw& law) {
  const char* const remedy = "give -360 to 360 degrees";
  std::visit(overloaded{
                 [&](const FixedRotation& r) { check.range("rotation", r.angle.degrees(), -360, 360, remedy); },
                 [&](const UniformRotation& r) {
                   check.range("rotation.min", r.from.degrees(), -360, 360, remedy);
                   check.range("rotation.max", r.to.degrees(), r.from.degrees(), 360,
                               "give rotation.min to 360 degrees");
                 },
                 [&](const NormalRotation& r) {
                   check.range("rotation.mean", r.mean.degrees(), -360, 360, remedy);
                   check.range("rotation.std", r.std.degrees(), 0, 360, "give 0 to 360 degrees");
                 },
             },
             law);
}

void check_intensity(Check& check, const Intensity& intensity) {
  const char* const remedy = "give a number from 0 to 1e12";
  std::visit(overloaded{
                 [&](const Count& i) {
                   check.range("intensity.count", static_cast<double>(i.joints), 0, 4294967295.0,
                               "give a whole number below 2^32");
                 },
                 [&](const P32& i) { check.range("intensity.p32", i.value, 0, 1e12, remedy); },
                 [&](const P30& i) { check.range("intensity.p30", i.value, 0, 1e12, remedy); },
                 [&](const P10& i) { check.range("intensity.p10", i.value, 0, 1e12, remedy); },
                 [&](const Spacing& i) {
                   check.positive("intensity.spacing", i.value.si(), 1e9, "give a length above 0 m and at most 1e9 m");
                 },
             },
             intensity);
}

void check_share(Check& check, double share) {
  check.positive("share", share, 1, "give a probability above 0 and at most 1");
}

void check_model(Check& check, const Model& model) {
  std::visit(overloaded{
                 [](const Baecher&) {},
                 [&](const EnhancedBaecher& m) {
                   check.range("probability", m.probability, 0, 1, "give a probability from 0 to 1");
                 },
                 [&](const Veneziano& m) { check_share(check, m.share); },
                 [&](const Dershowitz& m) { check_share(check, m.share); },
                 [&](const Mosaic& m) { check_share(check, m.share); },
                 [&](const Hierarchical& m) {
                   for (const double f : m.share) check.range("share", f, 0, 1, "give probabilities from 0 to 1");
                 },
                 [&](const Mit& m) {
                   check_share(check, m.share);
                   check.range("min_angle", m.min_angle, 0, 60, "give 0 to 60 degrees");
                   check.range("max_elongation", m.max_elongation, 1.2, 1e6, "give a ratio from 1.2");
                   check.range("min_corners", m.min_corners, 3, 8, "give 3 to 8 corners");
                   check.range("shift", m.shift, 0, 1e9, "give a length from 0 m");
                   if (m.turn_kappa) check.range("turn_kappa", *m.turn_kappa, 0, 1e12, "give 0 to 1e12");
                   for (const Zone& z : m.zones) check.range("zones", z.probability, 0, 1, "give 0 to 1");
                 },
                 [&](const Orthogonal& m) {
                   check.positive("gap_variation", m.gap_variation, 10, "give a ratio above 0 and at most 10");
                 },
             },
             model);
}

/// A box of centres means something only for joints that have them.
std::optional<ModelMismatch> buffer_mismatch(const JointSetSpec& spec) {
  if (!spec.buffer) return std::nullopt;
  const bool centres =
      std::holds_alternative<Baecher>(spec.model) || std::holds_alternative<EnhancedBaecher>(spec.model);
  if (centres && !std::holds_alternative<Persistent>(spec.shape)) return std::nullopt;
  return ModelMismatch{"buffer", "has no meaning where joints are not drawn by their centres",
                       "remove it: planes are drawn throughout the domain"};
}

/// What a model cannot do together with the rest.
std::optional<ModelMismatch> mismatch(const JointSetSpec& spec) {
  const bool persistent = std::holds_alternative<Persistent>(spec.shape);
  const bool p30 = std::holds_alternative<P30>(spec.intensity);
  const auto wants_size = [&](const char* name) -> std::optional<ModelMismatch> {
    if (!persistent) return std::nullopt;
    return ModelMismatch{"size", std::string{"the model \""} + name + "\" needs joints of a size",
                         "give shape and size, or the model \"baecher\" for persistent joints"};
  };
  const auto wants_planes = [&](const char* name) -> std::optional<ModelMismatch> {
    if (!p30) return std::nullopt;
    return ModelMismatch{"intensity", std::string{"the model \""} + name + "\" has no centres per volume",
                         "give p32, p10, spacing or count (of planes)"};
  };
  return std::visit(
      overloaded{
          [](const Baecher&) { return std::optional<ModelMismatch>{}; },
          [&](const EnhancedBaecher&) { return wants_size("enhanced_baecher"); },
          [&](const Veneziano&) {
            auto e = wants_size("veneziano");
            return e ? e : wants_planes("veneziano");
          },
          [&](const Dershowitz&) { return wants_planes("dershowitz"); },
          [&](const Mosaic&) -> std::optional<ModelMismatch> {
            if (std::holds_alternative<P32>(spec.intensity) || std::holds_alternative<Count>(spec.intensity)) {
              return std::nullopt;
            }
            return ModelMismatch{"intensity", "the model \"mosaic\" has faces of all directions",
                                 "give p32, or count (of seeds in the domain)"};
          },
          [&](const Hierarchical&) { return wants_planes("hierarchical"); },
          [&](const Mit&) {
            auto e = wants_size("mit");
            return e ? e : wants_planes("mit");
          },
          [&](const Orthogonal& m) -> std::optional<ModelMismatch> {
            if (auto e = wants_planes("orthogonal")) return e;
            if (m.through && m.gaps != Orthogonal::Gaps::constant) {
              return ModelMismatch{"through", "fixes the place of planes whose distances are random",
                                   "write gaps = \"constant\", or remove it"};
            }
            if (!persistent && !std::holds_alternative<Rectangle>(spec.shape)) {
              return ModelMismatch{"shape", "the model \"orthogonal\" lays rectangles or whole planes",
                                   "write shape = \"rectangle\" with bridge, or size = \"persistent\""};
            }
            if (!persistent && !m.bridge) {
              return ModelMismatch{"bridge", "is missing: the rows of rectangles need gaps",
                                   "add bridge = 2 (metres) or a law, or size = \"persistent\""};
            }
            if (std::holds_alternative<Count>(spec.intensity)) {
              return ModelMismatch{"intensity", "the model \"orthogonal\" has a spacing, no count",
                                   "give spacing, p10 or p32"};
            }
            return std::nullopt;
          },
      },
      spec.model);
}

double share_of(const JointSetSpec& spec) {
  return std::visit(overloaded{
                        [](const Baecher&) { return 1.0; },
                        [](const EnhancedBaecher&) { return 1.0; },
                        [](const Veneziano& m) { return m.share; },
                        [](const Dershowitz& m) { return m.share; },
                        [](const Mosaic& m) { return m.share; },
                        [](const Hierarchical&) { return 1.0; },
                        [](const Mit& m) { return m.share * good_shape_share(m); },
                        [&](const Orthogonal& m) {
                          // Persistence along each in-plane axis: joint over joint and bridge.
                          const auto* shape = std::get_if<Rectangle>(&spec.shape);
                          if (shape == nullptr || !m.bridge) return 1.0;
                          const double side = shape->size.moment(1), gap = m.bridge->moment(1);
                          const double second = std::visit(overloaded{[&](IndependentSize) { return side; },
                                                                      [&](AspectRatio r) { return side / r.ratio; },
                                                                      [](const SizeLaw& law) { return law.moment(1); }},
                                                           shape->second);
                          return side / (side + gap) * second / (second + gap);
                        },
                    },
                    spec.model);
}

double reduced(double degrees) {
  const double r = std::fmod(degrees, 360);
  return r < 0 ? r + 360 : r;
}

}  // namespace

std::expected<JointSet, JointSetError> JointSet::make(JointSetSpec spec) {
  Check check;
  check_orientation(check, spec.orientation);
  check_shape(check, spec.shape);
  check_rotation(check, spec.rotation);
  check_intensity(check, spec.intensity);
  check_model(check, spec.model);
  if (spec.buffer) check.range("buffer", *spec.buffer, 1, 100, "give how many times the domain's box, 1 to 100");
  if (check.error()) return std::unexpected(*check.error());
  if (std::holds_alternative<Persistent>(spec.shape) && std::holds_alternative<P30>(spec.intensity)) {
    return std::unexpected(NoCentres{});
  }
  if (auto wrong = mismatch(spec)) return std::unexpected(*std::move(wrong));
  if (auto wrong = buffer_mismatch(spec)) return std::unexpected(*std::move(wrong));
  std::visit([](auto& law) { law.dip_direction = DipDirection::degrees(reduced(law.dip_direction.degrees())); },
             spec.orientation);
  const double share = share_of(spec);
  std::expected<JointSet, JointSetError> set{JointSet{std::move(spec)}};
  set->area_share_ = share;
  if (std::holds_alternative<P10>(set->spec_.intensity) || std::holds_alternative<Spacing>(set->spec_.intensity)) {
    set->mean_cosine_ = set->find_mean_cosine();
  }
  return set;
}

geometry::Vec3 JointSet::mean_normal() const noexcept { return detail::mean_frame(spec_.orientation).normal; }

double JointSet::mean_area() const noexcept { return detail::mean_area(spec_.shape); }

double JointSet::reach() const noexcept { return detail::reach(spec_.shape); }

double JointSet::mean_cosine() const noexcept { return mean_cosine_ ? *mean_cosine_ : find_mean_cosine(); }

double JointSet::find_mean_cosine() const noexcept {
  if (const auto* fisher = std::get_if<FisherOrientation>(&spec_.orientation)) {
    const double k = fisher->kappa;  // 1 - tanh(k/2)/k
    return k < 1e-3 ? 0.5 + k * k / 24 : 1 - std::tanh(k / 2) / k;
  }
  if (const auto* bingham = std::get_if<BinghamOrientation>(&spec_.orientation)) return detail::mean_cosine(*bingham);
  // Additive recurrence on the plastic number (Roberts 2018).
  constexpr int points = 1 << 16;
  const geometry::Vec3 axis = mean_normal();
  double sum = 0;
  for (int i = 0; i < points; ++i) {
    const double u = std::fmod(0.5 + 0.7548776662466927 * i, 1.0), v = std::fmod(0.5 + 0.5698402909980532 * i, 1.0);
    sum +=
        std::abs(dot(axis, detail::draw(spec_.orientation, u + (u == 0 ? 1e-17 : 0), v + (v == 0 ? 1e-17 : 0)).normal));
  }
  return sum / points;
}

double JointSet::expected_p32(double volume) const noexcept {
  return std::visit(overloaded{
                        [&](const Count& i) {
                          const double side = i.in_buffer ? spec_.buffer.value_or(1) : 1;
                          return static_cast<double>(i.joints) * mean_area() / (volume * side * side * side);
                        },
                        [](const P32& i) { return i.value; },
                        [&](const P30& i) { return i.value * mean_area(); },
                        [&](const P10& i) { return i.value / mean_cosine(); },
                        [&](const Spacing& i) { return 1 / (i.value.si() * mean_cosine()); },
                    },
                    spec_.intensity);
}

std::string describe(const JointSetError& error) {
  return std::visit(
      overloaded{
          [](const BadValue& e) { return fmt::format("{}: {} is out of range; {}", e.key, e.value, e.remedy); },
          [](const ModelMismatch& e) { return fmt::format("{}: {}; {}", e.key, e.what, e.remedy); },
          [](NoCentres) {
            return std::string{"intensity.p30: persistent joints have no centres; give p32, p10, spacing or count"};
          },
      },
      error);
}

}  // namespace cleave::dfn
