#include "cleave/scene2d/contact.hpp"

namespace cleave::scene {

bem::Vec2 SupportMotion::velocity(Time at) const {
  const double t = at.si();
  if (is_velocity) return course.at(t);
  return t > 0 ? t * course.mean(0, t) : bem::Vec2{};
}

}  // namespace cleave::scene
