// A plate with a hole, clamped on the left and pulled on the right: displacement and stress by boundary elements.
#include <fmt/format.h>

#include "cleave/bem/statics.hpp"

using namespace cleave;

int main() {
  const auto steel = bem::Material::make(pascals(210e9), 0.3, kilograms_per_cubic_metre(7850), bem::PlaneState::stress);
  bem::Loop outline = bem::polygon({{0, 0}, {2, 0}, {2, 1}, {0, 1}}, 0, 8);
  outline[1].condition = 2;  // right side
  outline[3].condition = 1;  // left side
  const bem::Problem problem{
      .regions = {{.name = "plate",
                   .material = *steel,
                   .loops = {outline, bem::circle({1, 0.5}, 0.2, true, 0, 24)},
                   .conditions = {bem::free_surface(), bem::clamped(), bem::traction(bem::Vec2{100e6, 0})}}}};
  const auto plate = bem::solve_to(problem, {}, 1e-3);
  if (!plate) return fmt::print(stderr, "{}\n", describe(plate.error())), 1;
  fmt::print("right side moves {:.1f} um, stress above the hole {:.0f} MPa, estimated error {:.0e}\n",
             1e6 * plate->solution.displacement(0, {2, 0.5}).value().x,
             1e-6 * plate->solution.stress(0, {1, 0.7}).value().xx, plate->error);
}
