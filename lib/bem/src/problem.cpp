#include "cleave/bem/problem.hpp"

#include <utility>

namespace cleave::bem {

Condition free_surface() { return {}; }

Condition clamped() {
  Condition c;
  for (Component& component : c.component) component.given = Given::displacement;
  return c;
}

Condition roller() {
  Condition c;
  c.axes = Axes::normal;
  c.component[0].given = Given::displacement;
  return c;
}

Condition pressure(double pascals) {
  Condition c;
  c.axes = Axes::normal;
  c.component[0].value = [pascals](Vec2, Vec2) { return -pascals; };
  return c;
}

Condition traction(Vec2 pascals) {
  return traction([pascals](Vec2, Vec2) { return pascals; });
}

Condition traction(std::function<Vec2(Vec2 x, Vec2 n)> pascals) {
  Condition c;
  c.component[0].value = [pascals](Vec2 x, Vec2 n) { return pascals(x, n).x; };
  c.component[1].value = [pascals = std::move(pascals)](Vec2 x, Vec2 n) { return pascals(x, n).y; };
  return c;
}

Condition displacement(std::function<Vec2(Vec2 x)> metres) {
  Condition c = clamped();
  c.component[0].value = [metres](Vec2 x, Vec2) { return metres(x).x; };
  c.component[1].value = [metres = std::move(metres)](Vec2 x, Vec2) { return metres(x).y; };
  return c;
}

Condition springs(double normal, double along) {
  Condition c;
  c.axes = Axes::normal;
  c.component[0] = {.given = Given::spring, .value = {}, .stiffness = normal};
  c.component[1] = {.given = Given::spring, .value = {}, .stiffness = along};
  return c;
}

Condition bonded() {
  Condition c;
  c.bonded = true;
  return c;
}

}  // namespace cleave::bem
