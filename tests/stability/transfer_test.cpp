#include "handed_on.hpp"

namespace cleave::stability {
namespace {

using namespace handed_on;

// Two blocks in line get the net force of the union: fact 4.
TEST(TransferTest, BlocksInLineActAsOne) {
  Complex complex;
  const auto rock = complex.fixed_block();
  const auto lower = complex.block(50), upper = complex.block(100);
  complex.free_face(lower);
  complex.contact(lower, rock, upward(30, 90), 1, 0);
  complex.contact(upper, rock, upward(30, 90), 1, 0);
  complex.contact(lower, upper, dip_vector(30, 90), 1, 1);
  const Analysis a = analyse_complex(complex.build(), settings({strength(20), strength(30)}));
  ASSERT_EQ(a.batches.size(), 2U);
  EXPECT_NEAR(find(a, upper)->net.si(), 18.479253, 1e-6);
  EXPECT_NEAR(find(a, lower)->net.si(), 9.239627, 1e-6);
  EXPECT_NEAR(after(a, lower).net.si(), 27.718880, 1e-6);
  EXPECT_NEAR(after(a, upper).passed.si(), 18.479253, 1e-6);
  EXPECT_NEAR(after(a, upper).shear_ratio, 0, 1e-9);  // straight through the face
  EXPECT_NEAR(norm(after(a, lower).received - after(a, upper).passed.si() * dip_vector(30, 90)), 0, 1e-9);
  EXPECT_EQ(after(a, lower).passed.si(), 0);
  EXPECT_FALSE(after(a, lower).self_held);
}

// Fact 5: the block above slides the other way and clamps the lower one.
TEST(TransferTest, TransferCanStabilise) {
  Complex complex;
  const auto rock = complex.fixed_block();
  const auto lower = complex.block(100), upper = complex.block(60);
  complex.free_face(lower);
  complex.contact(lower, rock, upward(30, 90), 1, 0);
  complex.contact(upper, rock, upward(60, 270), 1, 1);
  complex.contact(upper, lower, -dip_vector(60, 270), 1, 2);  // held by the lower block while it is there
  const Analysis a = analyse_complex(complex.build(), settings({strength(25), strength(30), strength(0)}));
  ASSERT_EQ(a.batches.size(), 2U);
  EXPECT_NEAR(find(a, lower)->driving.si(), 50, 1e-9);
  EXPECT_NEAR(find(a, lower)->resistance.si(), 40.383428, 1e-6);
  EXPECT_NEAR(find(a, lower)->net.si(), 9.616572, 1e-6);
  EXPECT_NEAR(find(a, upper)->net.si(), 34.641016, 1e-6);
  EXPECT_NEAR(norm(find(a, upper)->direction - Vec3{-0.5, 0, -0.866025403784}), 0, 1e-9);
  const Transferred& t = after(a, lower);
  EXPECT_NEAR(t.driving.si(), 50, 1e-9);
  EXPECT_NEAR(t.resistance.si(), 56.536799, 1e-6);
  EXPECT_NEAR(t.factor_of_safety, 1.1307, 1e-4);
  EXPECT_FALSE(t.key);
  EXPECT_TRUE(find(a, lower)->key);  // before transfer
  EXPECT_EQ(find(a, lower)->batch, 1U);
}

// Fact 6: one falling block on two supports shares by projected area.
TEST(TransferTest, FallingBlockSharesByProjectedArea) {
  Complex complex;
  const auto rock = complex.fixed_block();
  const auto first = complex.block(80), second = complex.block(120), top = complex.block(100);
  complex.free_face(first);
  complex.free_face(second);
  complex.contact(first, rock, upward(40, 90), 1, 0);
  complex.contact(second, rock, upward(35, 270), 1, 1);
  complex.contact(top, first, {0, 0, 1}, 2, 2);
  complex.contact(top, second, upward(45, 0), 3, 2);
  const Analysis a = analyse_complex(complex.build(), settings({strength(30), strength(28), strength(20)}));
  ASSERT_EQ(a.batches.size(), 2U);
  EXPECT_EQ(find(a, top)->mode, Mode::falling);
  EXPECT_NEAR(after(a, top).passed.si(), 100, 1e-12);
  EXPECT_NEAR(norm(after(a, first).received - Vec3{0, 0, -48.528137}), 0, 1e-6);
  EXPECT_NEAR(norm(after(a, second).received - Vec3{0, 0, -51.471863}), 0, 1e-6);
  EXPECT_NEAR(find(a, first)->net.si(), 16.04093, 1e-5);
  EXPECT_NEAR(after(a, first).net.si(), 25.77139, 1e-5);
  EXPECT_NEAR(find(a, second)->net.si(), 16.56307, 1e-5);
  EXPECT_NEAR(after(a, second).net.si(), 23.66750, 1e-5);
  // The face at 45 degrees carries shear: tan 45 / tan 20.
  EXPECT_NEAR(after(a, top).shear_ratio, 1 / std::tan(radians(20)), 1e-9);
}

// Fact 7: slabs of 500 m3, density 2700, g 9.81.
TEST(TransferTest, ThreeSlabs) {
  Complex complex;
  const auto base = complex.fixed_block(1500);
  std::vector<topology::BlockId> slabs;
  for (int i = 0; i < 3; ++i) slabs.push_back(complex.block(500));
  for (const auto slab : slabs) {
    complex.contact(slab, base, upward(30, 90), 100, 0);
    complex.free_face(slab);
  }
  complex.contact(slabs[0], slabs[1], dip_vector(30, 90), 50, 1);
  complex.contact(slabs[1], slabs[2], dip_vector(30, 90), 50, 2);
  Settings with = settings({strength(20)});
  with.rock = RockMass::make(kilograms_per_cubic_metre(2700)).value();
  with.loads = Loads::make({0, 0, -9.81}).value();
  const Analysis a = analyse_complex(complex.build(), with);
  ASSERT_EQ(a.batches.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(find(a, slabs[k])->weight.si(), 13243500, 1e-6);
    EXPECT_NEAR(find(a, slabs[k])->net.si(), 2447299.883, 1e-2);
    EXPECT_NEAR(find(a, slabs[k])->factor_of_safety, 0.630415, 1e-6);
  }
  EXPECT_NEAR(after(a, slabs[0]).net.si(), 7341899.649, 1e-2);
  EXPECT_NEAR(after(a, slabs[1]).net.si(), 4894599.766, 1e-2);
  EXPECT_NEAR(after(a, slabs[2]).net.si(), 2447299.883, 1e-2);
  // All of it hangs on the first: each force counts once, where it ends.
  double to_be_held = 0;
  for (const auto slab : slabs) to_be_held += after(a, slab).to_be_held().si();
  EXPECT_NEAR(to_be_held, 7341899.649, 1e-2);
  EXPECT_NEAR(after(a, slabs[2]).to_be_held().si(), 0, 1e-6);
  EXPECT_LT(a.equilibrium_residual, 1e-12);
}

// Fact 3: it lost only a wall that was brushed; nothing is passed, whatever the last bits of the dip direction say.
TEST(TransferTest, BlockThatPushesNobodyIsSelfHeld) {
  for (const double dip_direction : {90.0, 7.0, 37.0, 111.0, 200.5, 359.0}) {
    for (const double side_sense : {1.0, -1.0}) {
      Complex complex;
      const auto rock = complex.fixed_block();
      const auto side = complex.block(1000), slab = complex.block(100);
      complex.free_face(side);
      complex.contact(side, rock, {0, 0, -1}, 1, 0);  // falls
      complex.contact(slab, rock, upward(30, dip_direction), 1, 0);
      const Vec3 strike = geometry::cross(upward(30, dip_direction), dip_vector(30, dip_direction));
      complex.contact(slab, side, side_sense * strike, 100, 1);  // brushed wall whose cohesion held the slab
      Settings with = settings({strength(20), strength(0, 1)});
      with.parallel_contact = true;
      const Analysis a = analyse_complex(complex.build(), with);
      ASSERT_EQ(a.batches.size(), 2U);
      EXPECT_EQ(find(a, slab)->batch, 2U);
      EXPECT_TRUE(after(a, slab).self_held);
      EXPECT_EQ(after(a, slab).passed.si(), 0);
      EXPECT_EQ(after(a, side).received, Vec3{});
      EXPECT_FALSE(after(a, side).self_held);
    }
  }
}

TEST(TransferTest, CanBeLeftOut) {
  Complex complex;
  const auto block = complex.block(1);
  complex.free_face(block);
  Settings with = settings({strength(20)});
  with.force_transfer = false;
  const Analysis a = analyse_complex(complex.build(), with);
  EXPECT_FALSE(a.force_transfer);
  EXPECT_FALSE(find(a, block)->transferred.has_value());
}

// Newton's third law over whole random systems: what is passed on is received, and only by blocks of earlier batches.
TEST(TransferTest, ForcesBalanceOnRandomSystems) {
  int passing = 0;
  int changed = 0;
  for (std::uint64_t seed = 100; seed < 160; ++seed) {
    const auto description = testing_complex::random(seed, 60);
    const Analysis a = analyse_complex(description.build(), testing_complex::random_settings(seed));
    Vec3 balance;
    double scale = 0;
    for (const Judgement& j : a.judgements) {
      ASSERT_EQ(j.transferred.has_value(), j.batch.has_value());
      if (!j.transferred) continue;
      const Transferred& t = *j.transferred;
      balance += t.received - t.passed.si() * t.direction;
      scale += t.passed.si();
      if (t.passed.si() > 0) {
        ++passing;
        EXPECT_EQ(t.passed, t.net);
        EXPECT_TRUE(t.key);
        EXPECT_GT(*j.batch, 1U);
      }
      changed += t.mode != j.mode;
      // Energy: the net force never exceeds what gravity and the received forces do along the motion.
      if (t.key) {
        EXPECT_LE(t.net.si(), j.weight.si() + norm(t.received) + 1e-9);
      }
      if (t.received == Vec3{}) {
        EXPECT_EQ(t.mode, j.mode);
        EXPECT_EQ(t.net, j.net);
      }
    }
    EXPECT_LT(norm(balance), 1e-12 * (1 + scale));
    EXPECT_LT(a.equilibrium_residual, 1e-12);
  }
  EXPECT_GT(passing, 200);
  EXPECT_GT(changed, 10);
}

}  // namespace
}  // namespace cleave::stability
