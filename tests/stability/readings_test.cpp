// The readings of the force transfer: worked examples, and what holds of all of them on random systems.

#include "handed_on.hpp"

namespace cleave::stability::readings_test {
namespace {

using namespace handed_on;
using Readings = TransferReadings;

/// Upper block (100 N, batch 2) behind a lower one (50 N, batch 1) on a plane 30/090 of 20 degrees; `m` into the lower.
struct InLine {
  Complex complex;
  topology::BlockId lower, upper;
  explicit InLine(Vec3 m) : lower{complex.block(50)}, upper{complex.block(100)} {
    const auto rock = complex.fixed_block();
    complex.free_face(lower);
    complex.contact(lower, rock, upward(30, 90), 1, 0);
    complex.contact(upper, rock, upward(30, 90), 1, 0);
    complex.contact(lower, upper, m, 1, 1);
  }
  [[nodiscard]] Analysis run(Readings readings) const {
    Settings with = settings({strength(20), strength(30)});
    with.transfer = readings;
    return analyse_complex(complex.build(), with);
  }
};

TEST(ReadingsTest, NormalForcesAcrossATiltedFace) {
  const Vec3 s = dip_vector(30, 90), n = upward(30, 90);
  const Vec3 m = std::cos(radians(20)) * s + std::sin(radians(20)) * n;
  const InLine blocks{m};
  const Analysis a = blocks.run({.along = Readings::Along::normals});
  ASSERT_EQ(a.batches.size(), 2U);
  const Transferred& t = after(a, blocks.upper);
  EXPECT_NEAR(t.net.si(), 18.479253, 1e-6);
  ASSERT_EQ(t.passes.size(), 1U);
  EXPECT_NEAR(norm(t.passes[0].force - 19.665210 * m), 0, 1e-6);
  ASSERT_EQ(t.added.size(), 1U);
  EXPECT_NEAR(t.added[0].reaction.si(), 6.725898, 1e-6);
  EXPECT_EQ(t.lost, 0);
  // Straight through the face both readings are one.
  const InLine straight{s};
  EXPECT_NEAR(after(straight.run({.along = Readings::Along::normals}), straight.lower).net.si(),
              after(straight.run({}), straight.lower).net.si(), 1e-9);
}

TEST(ReadingsTest, DrivingForceIsTheUpperBound) {
  const InLine blocks{dip_vector(30, 90)};
  const Analysis a = blocks.run({.force = Readings::Force::driving});
  EXPECT_NEAR(after(a, blocks.upper).passed.si(), 50, 1e-9);  // W sin 30
  EXPECT_NEAR(after(a, blocks.lower).net.si(), 9.239627 + 50, 1e-6);
}

// The last of three in line leans on the second and, over as large a face, on the first.
TEST(ReadingsTest, AdjacentBatchOnlyLosesTheRest) {
  Complex complex;
  const auto rock = complex.fixed_block();
  const auto first = complex.block(50), second = complex.block(50), third = complex.block(100);
  complex.free_face(first);
  for (const auto id : {first, second, third}) complex.contact(id, rock, upward(30, 90), 1, 0);
  complex.contact(first, second, dip_vector(30, 90), 1, 0);
  complex.contact(second, third, dip_vector(30, 90), 1, 0);
  complex.contact(first, third, dip_vector(30, 90), 1, 0);
  Settings with = settings({strength(20)});
  const double unit = 50 * (std::sin(radians(30)) - std::cos(radians(30)) * std::tan(radians(20)));
  const Analysis any = analyse_complex(complex.build(), with);
  ASSERT_EQ(any.batches.size(), 3U);
  EXPECT_NEAR(after(any, first).net.si(), 4 * unit, 1e-9);
  EXPECT_EQ(after(any, third).lost, 0);
  with.transfer.reach = Readings::Reach::adjacent;
  const Analysis adjacent = analyse_complex(complex.build(), with);
  EXPECT_NEAR(after(adjacent, third).lost, unit, 1e-9);
  EXPECT_NEAR(after(adjacent, second).net.si(), 2 * unit, 1e-9);
  EXPECT_NEAR(after(adjacent, first).net.si(), 3 * unit, 1e-9);
}

TEST(ReadingsTest, AFaceCarriesNoMoreShearThanItsStrength) {
  Complex complex;
  const auto rock = complex.fixed_block();
  const auto first = complex.block(80), second = complex.block(120), top = complex.block(100);
  complex.free_face(first);
  complex.free_face(second);
  complex.contact(first, rock, upward(40, 90), 1, 0);
  complex.contact(second, rock, upward(35, 270), 1, 1);
  complex.contact(top, first, {0, 0, 1}, 2, 2);
  complex.contact(top, second, upward(45, 0), 3, 2);
  Settings with = settings({strength(30), strength(28), strength(20)});
  with.transfer.interface = Readings::Interface::strength;
  const Analysis a = analyse_complex(complex.build(), with);
  const double part = 51.471863 * std::cos(radians(45)), most = part * std::tan(radians(20));
  EXPECT_NEAR(norm(after(a, first).received - Vec3{0, 0, -48.528137}), 0, 1e-6);
  EXPECT_NEAR(dot(after(a, second).received, -upward(45, 0)), part, 1e-5);
  EXPECT_NEAR(norm(after(a, second).received), std::hypot(part, most), 1e-5);
  EXPECT_NEAR(after(a, top).lost, part - most, 1e-5);
  // Enough cohesion on the face, and nothing is lost.
  with.strengths.set(topology::JointId{2U}, strength(20, 100));
  EXPECT_EQ(after(analyse_complex(complex.build(), with), top).lost, 0);
}

// The upper block clamps the lower one, which then holds its place; so the upper one never leaves.
TEST(ReadingsTest, StabilisedBlocksMayHoldTheirPlace) {
  Complex complex;
  const auto rock = complex.fixed_block();
  const auto lower = complex.block(100), upper = complex.block(60);
  complex.free_face(lower);
  complex.contact(lower, rock, upward(30, 90), 1, 0);
  complex.contact(upper, rock, upward(60, 270), 1, 1);
  complex.contact(upper, lower, -dip_vector(60, 270), 1, 2);
  Settings with = settings({strength(25), strength(30), strength(0)});
  with.transfer.stabilised = Readings::Stabilised::batches_anew;
  const Analysis a = analyse_complex(complex.build(), with);
  EXPECT_TRUE(a.batches.empty());
  ASSERT_NE(find(a, lower), nullptr);
  EXPECT_TRUE(find(a, lower)->key);
  EXPECT_FALSE(find(a, lower)->batch.has_value());
  ASSERT_TRUE(find(a, lower)->transferred.has_value());
  EXPECT_FALSE(after(a, lower).key);
}

TEST(ReadingsTest, KeptModesAreKept) {
  std::size_t changed = 0, kept = 0;
  for (std::uint64_t seed = 300; seed < 340; ++seed) {
    const auto complex = testing_complex::random(seed, 60).build();
    Settings with = testing_complex::random_settings(seed);
    const Analysis anew = analyse_complex(complex, with);
    with.transfer.receiver = Readings::Receiver::keeps_mode;
    const Analysis a = analyse_complex(complex, with);
    ASSERT_EQ(a.batches.size(), anew.batches.size());
    for (const Judgement& j : a.judgements) {
      if (!j.transferred || j.transferred->received == Vec3{}) continue;
      EXPECT_EQ(j.transferred->mode, j.mode);
      ++kept;
      const Judgement* other = find(anew, j.block);
      if (other->transferred->mode != j.mode) ++changed;
      // The same forces and the same mode: the same answer.
      if (norm(other->transferred->received - j.transferred->received) < 1e-12 && other->transferred->mode == j.mode &&
          other->transferred->pressing.size() == j.transferred->pressing.size() &&
          std::ranges::equal(other->transferred->pressing, j.pressing, {}, &Pressing::face, &Pressing::face)) {
        EXPECT_NEAR(other->transferred->net.si(), j.transferred->net.si(), 1e-9);
      }
    }
  }
  EXPECT_GT(kept, 100U);
  EXPECT_GT(changed, 5U);
}

// Action and reaction, and the balance of every block that passes something on, in every reading.
TEST(ReadingsTest, ForcesBalanceInEveryReading) {
  for (unsigned bits = 0; bits < 32; ++bits) {
    std::size_t passing = 0;
    for (std::uint64_t seed = 400; seed < 406; ++seed) {
      const auto complex = testing_complex::random(seed, 60).build();
      Settings with = testing_complex::random_settings(seed);
      if ((bits & 1U) != 0) with.transfer.reach = Readings::Reach::adjacent;
      if ((bits & 2U) != 0) with.transfer.force = Readings::Force::driving;
      if ((bits & 4U) != 0) with.transfer.along = Readings::Along::normals;
      if ((bits & 8U) != 0) with.transfer.interface = Readings::Interface::strength;
      if ((bits & 16U) != 0) with.transfer.receiver = Readings::Receiver::keeps_mode;
      const Analysis a = analyse_complex(complex, with);
      Vec3 balance;
      double scale = 1;
      for (const Judgement& j : a.judgements) {
        if (!j.transferred) continue;
        const Transferred& t = *j.transferred;
        EXPECT_TRUE(geometry::is_finite(t.received));
        balance += t.received;
        Vec3 left = t.passed.si() * t.direction;
        for (const Passed& p : t.passes) {
          balance -= p.force;
          left -= p.force;
          scale += norm(p.force);
          ++passing;
          EXPECT_LT(*find(a, p.onto)->batch, *j.batch);
        }
        for (const Pressing& p : t.added) {
          const topology::Face& face = complex.faces()[p.face];
          left += p.reaction.si() * -face.outward;
          EXPECT_GT(p.reaction.si(), 0);
        }
        EXPECT_LE(norm(left), t.lost + 1e-9 * (1 + t.passed.si()));
        if (bits == 0) {
          EXPECT_LE(norm(left), 1e-12 * (1 + t.passed.si()));
        }
      }
      EXPECT_LT(norm(balance), 1e-12 * scale);
    }
    EXPECT_GT(passing, 10U) << bits;
  }
}

}  // namespace
}  // namespace cleave::stability::readings_test
