#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <ctime>
#include <memory>
#include <ranges>
#include <string_view>
#include <vector>

#include "contact_families.hpp"

// contact_scenes COUNT FIRST_SEED [LONGER [FAMILY...]]: random scenes of each family, LONGER times as long; what they
// came to. Fails when a run that went on has an overlap above 10^-6 of the smaller body's size, when energy came, when
// a gas lost more than a twentieth of its energy, or when more than 1 % of a family were stopped.

namespace cleave::testing {
namespace {

struct Row {
  std::uint64_t scenes = 0, refused = 0, stopped = 0, wrong = 0, steps = 0;
  double overlap = 0, gain = 0, left = 1, cpu = 0;
};

Row run_family(ContactFamily family, std::uint64_t count, std::uint64_t first, std::uint64_t longer) {
  Row row;
  const std::clock_t start = std::clock();
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    ContactScene scene = make_contact_scene(family, seed);
    scene.until *= static_cast<double>(longer);
    const ContactOutcome outcome = run_contact_scene(scene);
    ++row.scenes;
    row.steps += outcome.steps;
    if (!outcome.made) ++row.refused;
    if (outcome.stopped) ++row.stopped;
    row.overlap = std::max(row.overlap, outcome.overlap);
    row.gain = std::max(row.gain, outcome.energy_gain);
    if (scene.closed && !outcome.stopped) row.left = std::min(row.left, outcome.energy_left);
    const bool lost = scene.closed && !outcome.stopped && outcome.energy_left < 0.95;
    if (outcome.overlap > 1e-6 || outcome.energy_gain > scene.gain || lost) {
      ++row.wrong;
      fmt::print("wrong: {} seed {}: overlap {:.2g}, gain {:.2g}, left {:.4f}\n",
                 contact_family_names[static_cast<std::size_t>(family)], seed, outcome.overlap, outcome.energy_gain,
                 outcome.energy_left);
    }
    if (outcome.stopped) {
      fmt::print("stopped: {} seed {} at {:.4g} s: {}\n", contact_family_names[static_cast<std::size_t>(family)], seed,
                 outcome.time, outcome.why);
    }
  }
  row.cpu = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  return row;
}

std::uint64_t number(std::string_view text, std::uint64_t otherwise) {
  (void)std::from_chars(text.data(), std::to_address(text.end()), otherwise);
  return otherwise;
}

int run(const std::vector<std::string_view>& arguments) {
  const auto given = [&](std::size_t k, std::uint64_t otherwise) {
    return k < arguments.size() ? number(arguments[k], otherwise) : otherwise;
  };
  const std::uint64_t count = given(1, 20), first = given(2, 1), longer = std::max<std::uint64_t>(1, given(3, 1));
  bool good = true;
  fmt::print("family    scenes refused stopped  wrong     steps  overlap     gain   left   CPU s\n");
  for (std::size_t f = 0; f < contact_family_names.size(); ++f) {
    const bool named = std::ranges::find(arguments | std::views::drop(4), contact_family_names[f]) !=
                       std::ranges::end(arguments | std::views::drop(4));
    if (arguments.size() > 4 && !named) continue;
    const Row r = run_family(static_cast<ContactFamily>(f), count, first, longer);
    fmt::print("{:9} {:6} {:7} {:7} {:6} {:9} {:8.1g} {:8.1g} {:6.3f} {:7.1f}\n", contact_family_names[f], r.scenes,
               r.refused, r.stopped, r.wrong, r.steps, r.overlap, r.gain, r.left, r.cpu);
    good = good && r.wrong == 0 && 100 * r.stopped <= std::max<std::uint64_t>(r.scenes, 100);
  }
  return good ? 0 : 1;
}

}  // namespace
}  // namespace cleave::testing

int main(int count, char** values) {
#ifdef __clang__
#pragma clang unsafe_buffer_usage begin
#endif
  const std::vector<std::string_view> arguments(values, values + count);
#ifdef __clang__
#pragma clang unsafe_buffer_usage end
#endif
  return cleave::testing::run(arguments);
}
