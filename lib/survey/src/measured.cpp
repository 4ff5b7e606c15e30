#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "cleave/survey/analyse.hpp"

namespace cleave::survey {

double weight_of(const MeasuredOrientation& joint, double cap) {
  const double weight = joint.line     ? terzaghi_weight(joint.normal, *joint.line, cap)
                        : joint.window ? window_weight(joint.normal, *joint.window, 0, 1, 0, cap)
                                       : 1.0;
  const double capped = weight < cap || weight == 1 ? weight : (joint.line ? 2 : 1.5) * cap;
  if (joint.line || !joint.window || !joint.outcrop) return capped;
  // The longer the part of the border across the traces, the more of them are met beyond those with their centres in
  // the outcrop.
  const geometry::Vec3 trace = cross(joint.normal, *joint.window);
  if (!(norm(trace) > 0)) return capped;
  const OutcropSize& o = *joint.outcrop;
  const double cosine = std::min(1.0, std::abs(dot(trace, o.along)) / norm(trace));
  const double width = o.width.si(), height = o.height.si();
  const double across = width * std::sqrt(1 - cosine * cosine) + height * cosine;
  return capped / (1 + std::numbers::pi / 4 * o.diameter.si() * across / (width * height));
}

Sampling sampling_of(MeasuredOrientation joint) {
  return {[joint = std::move(joint)](geometry::Vec3 normal, double cap) mutable {
            joint.normal = normal;
            return weight_of(joint, cap);
          },
          0};
}

geometry::Attitude compass_attitude(geometry::Vec3 normal, double north) {
  geometry::Attitude attitude = geometry::attitude_of(normal);
  if (north != 0)
    attitude.direction = DipDirection::degrees(geometry::wrap_degrees(attitude.direction.degrees() - north));
  return attitude;
}

double LineSurvey::length() const noexcept {
  double sum = 0;
  for (const auto& [direction, piece] : pieces) sum += piece;
  return sum;
}

geometry::Vec3 LineSurvey::direction_at(double position) const {
  for (const auto& [direction, length] : pieces) {
    if (position <= length) return direction;
    position -= length;
  }
  return pieces.back().first;
}

}  // namespace cleave::survey
