#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "builder.hpp"
#include "cleave/assembly/groups.hpp"

// Blocks that move while all others are taken to stay, in assemblies that rest as a whole.
namespace cleave::assembly {
namespace {

using namespace test;

using Marks = std::vector<std::uint8_t>;

/// A load of 1 that hangs between two blocks on a smooth floor, each pressed against it with `press`: friction of 0.5
/// at both faces holds it from a press of 1 on.
Builder clamped(double press) {
  Builder b{Freedom::section_translation};
  b.block({0, 0, -1}, 1);
  for (const double side : {-1.0, 1.0}) {
    const std::uint32_t jaw = b.block({-side * press, 0, -1}, 1);
    b.contact(0, jaw, {-side, 0, 0}, 0.5);
    b.contact(jaw, rock, {0, 0, 1}, 0);
  }
  return b;
}

TEST(SmallGroups, WhatItsNeighboursClampMovesWithoutTheirPush) {
  const Assembly rests = clamped(2).made();
  EXPECT_TRUE(find_groups(rests).groups.empty());
  const std::vector<Group> small = find_small_groups(rests, Marks(3, 1), Marks(3, 0));
  ASSERT_EQ(small.size(), 1U);
  EXPECT_EQ(small[0].bodies, std::vector<std::uint32_t>{0});
  // Two parallel faces could hold anything.
  EXPECT_EQ(small[0].verdict, Verdict::unsafe);
  EXPECT_EQ(small[0].moving.factor, 0);
  ASSERT_EQ(small[0].motion.size(), 1U);
  EXPECT_NEAR(small[0].motion[0].velocity.z, -1, 1e-9);
  // With less press the assembly as a whole says so.
  ASSERT_EQ(find_groups(clamped(0.9).made()).groups.size(), 1U);
}

TEST(SmallGroups, AreLookedForWhereAsked) {
  const Assembly rests = clamped(2).made();
  EXPECT_TRUE(find_small_groups(rests, Marks{0, 1, 1}, Marks(3, 0)).empty());
  EXPECT_TRUE(find_small_groups(rests, Marks(3, 1), Marks{1, 0, 0}).empty());
  EXPECT_EQ(find_small_groups(rests, Marks(3, 1), Marks{0, 1, 1}).size(), 1U);
  EXPECT_EQ(find_small_groups(rests, Marks(3, 1), Marks(3, 0), Ask::factors, 3).size(), 1U);
  const auto among = [&](const Marks& asked) {
    return find_small_groups(rests, Marks(3, 1), Marks(3, 0), Ask::motion, 1, nullptr, asked).size();
  };
  EXPECT_EQ(among({1, 0, 0}), 1U);
  EXPECT_EQ(among({0, 0, 0}), 0U);
}

/// A load of 3 on 45 degrees pushes a toe of 1 on level rock, with a smooth face between them, all friction 0.3; each
/// is pressed from both sides with `press` by blocks of its own, friction 0.5. Without the sides the toe moves with 3
/// (1 - m) / (1 + m) - m > 0 to spare; each alone stays.
Builder slab_and_toe(double press) {
  Builder b{Freedom::translation};
  b.block({0, 0, -3}, 3);
  b.block({0, 0, -1}, 1);
  b.contact(0, rock, {1, 0, 1}, 0.3);
  b.contact(1, rock, {0, 0, 1}, 0.3);
  b.contact(1, 0, {1, 0, 0}, 0);
  for (const std::uint32_t held : {0U, 1U}) {
    for (const double side : {-1.0, 1.0}) {
      const std::uint32_t jaw = b.block({0, -side * press, -1}, 1);
      b.contact(held, jaw, {0, -side, 0}, 0.5);
      b.contact(jaw, rock, {0, 0, 1}, 0);
    }
  }
  return b;
}

TEST(SmallGroups, TwoThatMoveTogetherAlone) {
  const Assembly rests = slab_and_toe(10).made();
  EXPECT_TRUE(find_groups(rests).groups.empty());
  for (const Marks& open : {Marks(6, 1), Marks{0, 1, 0, 0, 0, 0}, Marks{1, 0, 0, 0, 0, 0}}) {
    const std::vector<Group> small = find_small_groups(rests, open, Marks(6, 0));
    ASSERT_EQ(small.size(), 1U);
    EXPECT_EQ(small[0].bodies, (std::vector<std::uint32_t>{0, 1}));
    EXPECT_EQ(small[0].verdict, Verdict::unsafe);
    // The slab's push over 0.3, less the toe's friction; masses 3 and 1, of which the first goes down 45 degrees.
    const double m = 0.3, push_at_rest = 3 * (1 - m) / (1 + m);
    const double acceleration = (push_at_rest - m) / (1 + 3 * (1 + (1 - m) / (1 + m)));
    EXPECT_NEAR(small[0].motion[1].velocity.x, acceleration, 1e-6);
    EXPECT_NEAR(small[0].motion[0].velocity.z, -acceleration, 1e-6);
  }
  EXPECT_TRUE(find_small_groups(rests, Marks{0, 0, 1, 1, 1, 1}, Marks(6, 0)).empty());
  EXPECT_TRUE(find_small_groups(rests, Marks(6, 1), Marks{0, 1, 0, 0, 0, 0}).empty());
}

/// The clamped load, hung from rock by a bolt.
Assembly hung(double press, double pull) {
  Builder b = clamped(press);
  b.contact(0, rock, {0, 0, -1}, 0, {}).bonds = {{.corners = {}, .cohesion = 0, .tension = pull}};
  return b.made();
}

TEST(SmallGroups, ABoltHoldsWhatItCan) {
  EXPECT_EQ(find_small_groups(hung(2, 0.9), Marks(3, 1), Marks(3, 0)).size(), 1U);
  EXPECT_TRUE(find_small_groups(hung(2, 1.1), Marks(3, 1), Marks(3, 0)).empty());
}

// What is known of sets without bolts is of these sets: others are asked.
TEST(SmallGroups, WhatIsKnownWithoutBoltsGoesFromPlanToPlan) {
  UntiedSets known;
  const auto moving = [&](const Assembly& assembly) {
    return find_small_groups(assembly, Marks(3, 1), Marks(3, 0), Ask::factors, 1, &known).size();
  };
  for (int again = 0; again < 2; ++again) {
    EXPECT_EQ(moving(hung(2, 0.9)), 1U);
    EXPECT_EQ(moving(hung(2, 1.1)), 0U);
    EXPECT_EQ(moving(hung(2, 0.5)), 1U);
  }
  Builder block{Freedom::translation};
  block.block({0, 0, -1}, 1);
  block.contact(0, rock, plane(31, 90), tan_deg(30));
  EXPECT_TRUE(known.may_move(block.made()));
  block.spec.contacts[0].friction = tan_deg(32);
  EXPECT_FALSE(known.may_move(block.made()));
  block.spec.bodies[0].force = {1, 0, -1};
  EXPECT_TRUE(known.may_move(block.made()));
}

}  // namespace
}  // namespace cleave::assembly
