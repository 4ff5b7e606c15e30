/// Saved worlds, damaged on purpose with the right sum before them: each is refused and nothing changed, or is a world
/// that is saved as the same bytes again.

#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "byte_source.hpp"
#include "cleave/core/archive.hpp"
#include "cleave/dbem/world.hpp"
#include "fuzz_target.hpp"

namespace {

using namespace cleave;

dbem::World pile() {
  std::vector<dbem::Body> bodies;
  const auto box = [](double x, double y, double width) {
    return std::vector<dbem::Vec2>{{x, y}, {x + width, y}, {x + width, y + 1}, {x, y + 1}};
  };
  bodies.push_back({.name = "floor", .outline = box(-3, -1, 6), .held = {true, true, true}});
  bodies.push_back({.name = "a", .outline = box(-0.5, 0, 1), .density = 2600});
  bodies.push_back({.name = "b", .outline = box(-0.3, 1, 1), .density = 2600});
  dbem::Laws laws;
  laws.otherwise = {.friction = 0.6, .cohesion = 1e3, .tension = 1e3, .residual_cohesion = 5e2};
  auto made = dbem::World::make(std::move(bodies), laws, {.step = 5e-3});
  if (!made) std::abort();
  return *std::move(made);
}

}  // namespace

CLEAVE_FUZZ_TARGET(input) {
  support::ByteSource bytes{input};
  dbem::World world = pile();
  for (std::size_t k = bytes.up_to(20); k > 0; --k) {
    if (!world.step()) std::abort();
  }
  const std::string saved = world.saved();
  std::string inside{unsealed("cleave-world", 3, saved).value()};
  for (std::size_t k = bytes.up_to(7); k > 0; --k) {
    const std::size_t at = bytes.u64() % inside.size();
    inside[at] = static_cast<char>(bytes.byte());
  }
  if (bytes.up_to(7) == 0) inside.resize(bytes.u64() % inside.size());
  const std::string forged = sealed("cleave-world", 3, inside);
  dbem::World other = pile();
  const bool raw = bytes.up_to(7) == 0;
  if (!other.restore(raw ? std::string{inside} : forged)) {
    if (other.saved() != pile().saved()) std::abort();
    return;
  }
  dbem::World again = pile();  // the first step of the options is this world's own
  if (!again.restore(other.saved()) || again.saved() != other.saved()) {
    std::fprintf(stderr, "what was restored is saved as something else\n");
    std::abort();
  }
}
