// One block judged as an assembly of one: its factor is that of key block theory.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <numbers>
#include <string>

#include "assembly_of.hpp"
#include "cleave/assembly/groups.hpp"
#include "cleave/core/id.hpp"
#include "contacts.hpp"
#include "near_scenes.hpp"
#include "verdict.hpp"

namespace cleave::stability::single_assembly_test {
namespace {

/// How the factors of one block compare.
struct Compared {
  std::size_t blocks = 0, free = 0, one_plane = 0, two_planes = 0, stable = 0, several = 0, wedging = 0,
              hardly_pressed = 0, beyond = 0;
  double worst = 0;
};

double cohesion_left_out(const Contacts& contacts, const Verdict& verdict, double load) {
  double sum = 0;
  for (const auto& [group, reaction] : verdict.resistance.pressing) {
    const double share = reaction / load / std::sin(std::numbers::pi / 180);
    if (share < 1) sum += (1 - share) * contacts.groups[group].cohesion;
  }
  return sum;
}

void compare(const topology::AuditedComplex& complex, const Settings& settings, std::size_t most, Compared& seen) {
  Settings first = settings;
  first.max_batches = 1;
  const Analysis alone = analyse(complex, first);
  Model model{complex.complex(), settings};
  for (const Judgement& j : alone.judgements) {
    // In the state before anything left.
    if (seen.blocks == most || (j.batch && *j.batch != 1) || !model.held(j.block, 1).exposed) continue;
    const Contacts contacts = model.contacts(j.block, 1);
    if (contacts.cone.dimension() == 0) continue;
    const Verdict verdict = judge(contacts, model.applied_forces(j.block, 1), settings);
    SCOPED_TRACE(j.block.value());
    const topology::BlockId id = j.block;
    const assembly::Assembly one = assembly_of(model, {&id, 1}, 1).with(assembly::Freedom::translation);
    const auto up = assembly::static_factor(one);
    const auto moving = assembly::moving_factor(one, up.factor);
    ++seen.blocks;
    if (!moves(verdict.mode)) {
      ++seen.stable;
      EXPECT_TRUE(std::isinf(moving.factor)) << moving.factor;
      continue;
    }
    seen.free += verdict.mode == Mode::falling || verdict.mode == Mode::lifting ? 1U : 0U;
    seen.one_plane += verdict.mode == Mode::sliding ? 1U : 0U;
    seen.two_planes += verdict.mode == Mode::wedge ? 1U : 0U;
    const double factor = verdict.factor_of_safety, spread = verdict.resistance.greatest / verdict.driving;
    EXPECT_GE(up.factor, moving.factor * (1 - 1e-6));
    seen.wedging += up.factor > 1.001 * moving.factor ? 1U : 0U;
    if (spread > factor * (1 + 1e-9)) {
      // More planes press than statics decides: any answer between the two is one.
      ++seen.several;
      EXPECT_GE(moving.factor, factor * (1 - 1e-6));
      EXPECT_LE(moving.factor, spread * (1 + 1e-6));
      continue;
    }
    // Key block theory here counts cohesion of a plane that is pressed at less than a degree in part, an assembly
    // whole.
    const double left_out = cohesion_left_out(contacts, verdict, norm(model.applied_forces(id, 1).newtons()));
    seen.hardly_pressed += left_out > 0 ? 1U : 0U;
    const double expected = factor + left_out / verdict.driving;
    // A search that begins at a thousandth of the strength ends there.
    if (expected > 1000) {
      ++seen.beyond;
      EXPECT_GE(moving.factor, 1000 * (1 - 1e-6));
      EXPECT_LE(moving.factor, expected * (1 + 1e-6));
      continue;
    }
    const double off = std::abs(moving.factor - expected) / std::max(expected, 1e-3);
    EXPECT_LT(off, 4e-6) << name(verdict.mode) << ' ' << expected << ' ' << moving.factor;
    seen.worst = std::max(seen.worst, off);
  }
}

TEST(SingleAssembly, IsKeyBlockTheory) {
  // CLEAVE_SINGLE_BLOCKS=1000 looks at that many.
  const char* asked = std::getenv("CLEAVE_SINGLE_BLOCKS");
  const std::size_t most = asked != nullptr ? std::stoul(asked) : 60;
  Compared seen;
  for (std::uint64_t seed = 1; seed < 10'000 && seen.blocks < most; ++seed) {
    SCOPED_TRACE(seed);
    const topology::CutInput input = near_scenes::network(seed, 70, 16, true);
    const auto complex = topology::audit(topology::cut(input).value());
    ASSERT_TRUE(complex.has_value());
    Settings with = near_scenes::weak_rock();
    // Half of them with cohesion.
    with.strengths = StrengthTable{statics::strength(15 + static_cast<double>(seed % 30), seed % 2 == 0 ? 0 : 2e3)};
    compare(*complex, with, most, seen);
  }
  EXPECT_EQ(seen.blocks, most);
  EXPECT_GT(seen.one_plane, most / 20);
  EXPECT_GT(seen.two_planes, most / 20);
  EXPECT_GT(seen.free, most / 30);
  if (asked != nullptr) {
    std::cout << seen.blocks << " blocks: " << seen.free << " free, " << seen.one_plane << " on one plane, "
              << seen.two_planes << " on two, " << seen.stable << " stable; " << seen.several << " several answers, "
              << seen.wedging << " may wedge, " << seen.hardly_pressed << " hardly pressed, " << seen.beyond
              << " beyond 1000; worst " << seen.worst << '\n';
  }
}

}  // namespace
}  // namespace cleave::stability::single_assembly_test
