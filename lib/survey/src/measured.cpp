#include "cleave/survey/analyse.hpp"

namespace cleave::survey {

double weight_of(const MeasuredOrientation& joint, double cap) {
  const double weight = joint.line     ? terzaghi_weight(joint.normal, *joint.line, cap)
                        : joint.window ? window_weight(joint.normal, *joint.window, 0, 1, 0, cap)
                                       : 1.0;
  return weight < cap || weight == 1 ? weight : (joint.line ? 2 : 1.5) * cap;
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
