#include "cleave/dfn/joint_set.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <optional>

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
  if (check.error()) return std::unexpected(*check.error());
  if (std::holds_alternative<Persistent>(spec.shape) && std::holds_alternative<P30>(spec.intensity)) {
    return std::unexpected(NoCentres{});
  }
  std::visit([](auto& law) { law.dip_direction = DipDirection::degrees(reduced(law.dip_direction.degrees())); },
             spec.orientation);
  return JointSet{std::move(spec)};
}

geometry::Vec3 JointSet::mean_normal() const noexcept { return detail::mean_frame(spec_.orientation).normal; }

double JointSet::mean_area() const noexcept { return detail::mean_area(spec_.shape); }

double JointSet::reach() const noexcept { return detail::reach(spec_.shape); }

double JointSet::mean_cosine() const noexcept {
  if (const auto* fisher = std::get_if<FisherOrientation>(&spec_.orientation)) {
    const double k = fisher->kappa;  // 1 - tanh(k/2)/k
    return k < 1e-3 ? 0.5 + k * k / 24 : 1 - std::tanh(k / 2) / k;
  }
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
                        [&](const Count& i) { return static_cast<double>(i.joints) * mean_area() / volume; },
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
          [](NoCentres) {
            return std::string{"intensity.p30: persistent joints have no centres; give p32, p10, spacing or count"};
          },
      },
      error);
}

}  // namespace cleave::dfn
