#include "cleave/assembly/groups.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "cases.hpp"
#include "chains.hpp"
#include "cleave/core/rng.hpp"
#include "lattice.hpp"
#include "sanitized.hpp"
#include "theory.hpp"

namespace cleave::assembly {
namespace {

using namespace test;

TEST(Verdicts, OfTheCases) {
  EXPECT_EQ(judge(toe(false).made()).verdict, Verdict::certain);
  // Held by locked-in forces between its sides alone.
  EXPECT_EQ(judge(toe(true).made()).verdict, Verdict::unsafe);
  EXPECT_EQ(judge(toe_section().made()).verdict, Verdict::certain);
  EXPECT_EQ(judge(interlocked().made()).verdict, Verdict::certain);
  EXPECT_EQ(judge(drawer(true).made()).verdict, Verdict::no_motion_found);
  EXPECT_EQ(judge(drawer(false).made()).verdict, Verdict::certain);
  EXPECT_EQ(judge(leaning(2).made()).verdict, Verdict::no_motion_found);
  EXPECT_EQ(judge(voussoirs().made()).verdict, Verdict::unsafe);
  EXPECT_EQ(judge(level_stack().made()).verdict, Verdict::no_motion_found);
  EXPECT_EQ(judge(ploughing(e3).made()).verdict, Verdict::certain);
  EXPECT_EQ(judge(single({{plane(60, 0), 0}, {plane(60, 120), 0}, {plane(60, 240), 0}}).made()).verdict,
            Verdict::stands);
}

/// A block of weight 1 and mass 1 on 31 degrees under 30 degrees of friction slides with this.
Vec3 down_the_slope() {
  const double acceleration = sin_deg(31) - cos_deg(31) * tan_deg(30);
  return {acceleration * cos_deg(31), 0, -acceleration * sin_deg(31)};
}

// The proof of what is certain opens joints as it slips; the motion told is that of Coulomb's law.
TEST(Verdicts, MotionIsThatFromRest) {
  const Judged found = judge(single({{plane(31, 90), tan_deg(30)}}).made());
  EXPECT_EQ(found.verdict, Verdict::certain);
  ASSERT_EQ(found.motion.size(), 1U);
  EXPECT_NEAR(norm(found.motion[0].velocity - down_the_slope()), 0, 1e-9);
  EXPECT_GT(norm(found.moves->motion()[0].velocity - down_the_slope()), 1e-3);
}

TEST(Verdicts, FactorsFarApartAreInDoubt) {
  const Judged columns = judge(toppling_columns(38.6598).made());
  EXPECT_EQ(columns.verdict, Verdict::in_doubt);
  EXPECT_EQ(judge(ploughing(e1).made()).verdict, Verdict::no_motion_found);
}

// Blocks and contacts in another order, seen from their other blocks, points and bonds in another order and all numbers
// with other roundings: the same assembly to the last bit.
TEST(CanonicalAssembly, NumbersAndRoundingsDoNotShow) {
  Rng rng{{.seed = 7, .realization = 0, .purpose = 1, .index = 0}};
  const auto any = [&] { return Vec3{20 * rng.uniform() + 5e5, 20 * rng.uniform(), 20 * rng.uniform()}; };
  AssemblySpec spec;
  for (int b = 0; b < 6; ++b) {
    spec.bodies.push_back({.centroid = any(),
                           .force = {0, 0, -1e5 * rng.uniform()},
                           .moment = {1e5 * rng.uniform(), 0, 1},
                           .mass = 1e4 * rng.uniform(),
                           .inertia = {3e4, 4e4 * (1 + rng.uniform()), 5e4, 100 * rng.uniform(), 7, 9}});
  }
  for (std::uint32_t c = 0; c < 12; ++c) {
    Contact contact{
        .body = c % 6, .normal = normalized(any() - Vec3{5e5, 9, 9}), .points = {any(), any(), any(), any()}};
    if (c % 4 != 0) contact.other = (c + 1 + c % 3) % 6;
    contact.friction = rng.uniform();
    const std::vector<Vec3>& p = contact.points;
    contact.bonds = {{.corners = {p[0], p[1], p[2]}, .cohesion = 1e5 * rng.uniform(), .tension = 1e4},
                     {.corners = {p[0], p[2], p[3]}, .cohesion = 1e5 * rng.uniform(), .tension = 2e4}};
    contact.most = 1e9 * rng.uniform();
    spec.contacts.push_back(contact);
  }
  AssemblySpec other = spec;
  const auto jitter = [&](double& x) { x *= 1 + 1e-15 * (rng.uniform() - 0.5); };
  const auto jitter_all = [&](Vec3& v) {
    v += 1e-13 * (any() - Vec3{5e5, 0, 0});  // of coordinates in the thousands of metres
    v -= 1e-12 * Vec3{1, 1, 1};
  };
  for (Body& body : other.bodies) {
    jitter_all(body.centroid);
    body.force += 1e-12 * Vec3{rng.uniform(), rng.uniform(), rng.uniform()};
    jitter(body.mass);
    for (double& i : body.inertia) i += 1e-11 * rng.uniform();
  }
  for (Contact& contact : other.contacts) {
    if (contact.other && rng.uniform() < 0.5) {
      std::swap(contact.body, *contact.other);
      contact.normal = -contact.normal;
      std::ranges::reverse(contact.points);
    }
    std::ranges::rotate(contact.points, contact.points.begin() + 2);
    std::ranges::reverse(contact.bonds);
    for (Vec3& p : contact.points) jitter_all(p);
    for (Bond& bond : contact.bonds) jitter(bond.cohesion);
    for (double* x : {&contact.friction, &contact.most}) jitter(*x);
  }
  std::ranges::reverse(other.contacts);
  std::ranges::reverse(other.bodies);
  const auto number = [](std::uint32_t b) { return 5 - b; };
  for (Contact& contact : other.contacts) {
    contact.body = number(contact.body);
    if (contact.other) contact.other = number(*contact.other);
  }
  const Assembly a = Assembly::make(spec).value().canonical(), b = Assembly::make(other).value().canonical();
  for (std::size_t k = 0; k < a.bodies().size(); ++k) {
    const Body &one = a.bodies()[k], &two = b.bodies()[5 - k];
    EXPECT_EQ(one.centroid, two.centroid);
    EXPECT_EQ(one.force, two.force);
    EXPECT_EQ(one.moment, two.moment);
    EXPECT_EQ(one.mass, two.mass);
    EXPECT_EQ(one.inertia, two.inertia);
    EXPECT_LT(norm(one.centroid - spec.bodies[k].centroid), 1e-8);
    EXPECT_NEAR(one.mass, spec.bodies[k].mass, 1e-9 * one.mass);
  }
  for (std::size_t k = 0; k < a.contacts().size(); ++k) {
    const Contact &one = a.contacts()[k], &two = b.contacts()[k];
    EXPECT_EQ(one.body, number(two.body));
    EXPECT_EQ(one.other, two.other.transform(number));
    EXPECT_EQ(one.normal, two.normal);
    EXPECT_EQ(one.points, two.points);
    EXPECT_EQ(one.friction, two.friction);
    EXPECT_EQ(one.most, two.most);
    ASSERT_EQ(one.bonds.size(), two.bonds.size());
    for (std::size_t i = 0; i < one.bonds.size(); ++i) EXPECT_EQ(one.bonds[i].cohesion, two.bonds[i].cohesion);
  }
}

TEST(CanonicalAssembly, NeedlesKeepTheirInertia) {
  const std::array<double, 6> needle{2, 2, 1e-11, 0, 0, 0};
  AssemblySpec spec;
  spec.bodies.push_back({.centroid = {}, .force = {0, 0, -1}, .moment = {}, .mass = 1, .inertia = needle});
  EXPECT_EQ(Assembly::make(spec).value().canonical().bodies()[0].inertia, needle);
}

TEST(KeyGroups, TellGroupsFromWhatHolds) {
  Builder b = toe(true);
  const std::uint32_t holds = b.block({0, 0, -50}, 50);
  b.contact(holds, rock, {sin_deg(20), 0, cos_deg(20)}, tan_deg(30));
  const std::uint32_t slides = b.block({0, 0, -50}, 50);
  b.contact(slides, rock, {sin_deg(31), 0, cos_deg(31)}, tan_deg(30));
  const std::uint32_t wedged = b.block({0, 0, -1}, 1);
  for (const Vec3 n : {plane(60, 0), plane(60, 120), plane(60, 240)}) b.contact(wedged, rock, n, 0);
  const Groups found = find_groups(b.made());
  ASSERT_EQ(found.groups.size(), 2U);
  EXPECT_EQ(found.groups[0].bodies, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(found.groups[0].verdict, Verdict::unsafe);
  EXPECT_NEAR(found.groups[0].moving.factor, 0.942790, 1e-6);
  EXPECT_EQ(found.groups[1].bodies, (std::vector<std::uint32_t>{slides}));
  EXPECT_EQ(found.groups[1].verdict, Verdict::certain);
  EXPECT_TRUE(found.groups[1].proof.has_value());
  EXPECT_NEAR(found.groups[1].up.factor, tan_deg(30) / tan_deg(31), 1e-7);
  // The proof opens the joint by 30 degrees; what moves slides along it.
  ASSERT_EQ(found.groups[1].motion.size(), 1U);
  EXPECT_NEAR(norm(found.groups[1].motion[0].velocity - down_the_slope()), 0, 1e-9);
  EXPECT_GT(norm(found.groups[1].proof->motion()[0].velocity - down_the_slope()), 1e-3);
  EXPECT_EQ(found.held, 1U);
}

TEST(KeyGroups, VerdictsAloneAreThoseOfTheWholeSearch) {
  Builder b = toe(true);
  const std::uint32_t slides = b.block({0, 0, -50}, 50);
  b.contact(slides, rock, {sin_deg(31), 0, cos_deg(31)}, tan_deg(30));
  const Groups whole = find_groups(b.made()), alone = find_groups(b.made(), Ask::verdicts);
  ASSERT_EQ(alone.groups.size(), whole.groups.size());
  for (std::size_t k = 0; k < whole.groups.size(); ++k) {
    EXPECT_EQ(alone.groups[k].bodies, whole.groups[k].bodies);
    EXPECT_EQ(alone.groups[k].verdict, whole.groups[k].verdict);
    EXPECT_EQ(alone.groups[k].proof.has_value(), whole.groups[k].proof.has_value());
    EXPECT_TRUE(whole.groups[k].factors);
    EXPECT_FALSE(alone.groups[k].factors);
  }
}

// A splinter between a wall and a block that falls: beside that its speed is next to nothing, but no force holds it.
// Forces locked in between the rough walls could hold both, so neither is proved to move.
TEST(KeyGroups, WhatNoForceHoldsIsNotAtRest) {
  Builder b{Freedom::translation};
  const std::uint32_t large = b.block({0, 0, -1}, 1);
  const std::uint32_t splinter = b.block({0, 0, -1e-14}, 1e-14);
  b.contact(large, rock, {0, 1, 0}, 0.2);
  b.contact(large, rock, {0, -1, 0}, 0.2);
  b.contact(splinter, rock, {1, 0, 0}, 0.5);
  b.contact(splinter, large, {-1, 0, 0}, 0.5);
  const Groups found = find_groups(b.made());
  std::vector<std::uint32_t> named;
  for (const Group& group : found.groups) named.insert(named.end(), group.bodies.begin(), group.bodies.end());
  std::ranges::sort(named);
  EXPECT_EQ(named, (std::vector<std::uint32_t>{large, splinter}));
}

// On 89.5 (89.8) degrees a block is pressed with sin(0.5) (sin(0.2)) of its weight: half (a fifth) of its cohesion
// counts.
TEST(KeyGroups, CohesionThatNextToNothingPressesIsNotReliedOn) {
  const auto groups_on = [](double dip, double cohesion) {
    Builder b{Freedom::translation};
    const std::uint32_t block = b.block({0, 0, -1}, 1);
    Contact& contact = b.contact(block, rock, {sin_deg(dip), 0, cos_deg(dip)}, 0);
    contact.bonds.push_back({.corners = {Vec3{}, Vec3{1, 0, 0}, Vec3{0, 1, 0}}, .cohesion = cohesion});
    return find_groups(b.made()).groups;
  };
  ASSERT_EQ(groups_on(89.5, 1.2).size(), 1U);
  EXPECT_EQ(groups_on(89.5, 1.2)[0].verdict, Verdict::in_doubt);
  EXPECT_TRUE(groups_on(89.5, 2.2).empty());  // half of it is enough
  ASSERT_EQ(groups_on(89.8, 4.5).size(), 1U);
  EXPECT_EQ(groups_on(89.8, 4.5)[0].verdict, Verdict::in_doubt);
  EXPECT_TRUE(groups_on(89.8, 5.5).empty());
  EXPECT_TRUE(groups_on(80, 1.2).empty());
  EXPECT_EQ(groups_on(89.5, 0.9).at(0).verdict, Verdict::certain);
  // Nor in the factor, which is that of the block judged alone; certainty counts all of it.
  const double half = sin_deg(0.5) / sin_deg(1);
  const Group sure = groups_on(89.5, 0.9).at(0), doubtful = groups_on(89.5, 1.2).at(0);
  EXPECT_NEAR(sure.up.factor, 0.9 / sin_deg(89.5), 1e-6);
  EXPECT_NEAR(sure.moving.factor, half * 0.9 / sin_deg(89.5), 1e-6);
  EXPECT_NEAR(doubtful.moving.factor, half * 1.2 / sin_deg(89.5), 1e-6);
  // Full from one degree on.
  EXPECT_NEAR(groups_on(88.9, 0.9).at(0).moving.factor, 0.9 / sin_deg(88.9), 1e-7);
}

// Two blocks apart from one another, one that slides and one that half of its cohesion does not hold.
TEST(KeyGroups, OnlyWhatIsAskedForIsFound) {
  Builder b{Freedom::translation};
  for (const double cohesion : {0.0, 1.2}) {
    const std::uint32_t block = b.block({0, 0, -1}, 1);
    Contact& contact = b.contact(block, rock, {sin_deg(89.5), 0, cos_deg(89.5)}, 0);
    contact.bonds.push_back({.corners = {Vec3{}, Vec3{1, 0, 0}, Vec3{0, 1, 0}}, .cohesion = cohesion});
  }
  using Marks = std::vector<std::uint8_t>;
  const auto bodies = [&](Ask ask, const Marks& among) {
    std::vector<std::uint32_t> out;
    for (const Group& group : find_groups(b.made(), ask, 1, among).groups) {
      out.insert(out.end(), group.bodies.begin(), group.bodies.end());
    }
    return out;
  };
  EXPECT_EQ(bodies(Ask::verdicts, {}), (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(bodies(Ask::motion, {}), (std::vector<std::uint32_t>{0}));
  EXPECT_EQ(bodies(Ask::verdicts, {0, 1}), (std::vector<std::uint32_t>{1}));
  EXPECT_EQ(bodies(Ask::motion, {1, 0}), (std::vector<std::uint32_t>{0}));
  EXPECT_TRUE(bodies(Ask::motion, {0, 1}).empty());
}

// A slab and a crumb at its foot that slips away from it: the group's factor is the crumb's, the slab has its own.
TEST(KeyGroups, TheHeaviestBodyHasItsOwnFactor) {
  const auto group_of = [](double slab, double crumb, bool crumb_first) {
    Builder b{Freedom::translation};
    const auto add = [&](double mass, double dip) {
      const std::uint32_t block = b.block({0, 0, -mass}, mass);
      b.contact(block, rock, {sin_deg(dip), 0, cos_deg(dip)}, tan_deg(20));
      return block;
    };
    const std::uint32_t first = crumb_first ? add(crumb, 60) : add(slab, 30);
    const std::uint32_t second = crumb_first ? add(slab, 30) : add(crumb, 60);
    b.contact(crumb_first ? first : second, crumb_first ? second : first, {1, 0, 0}, tan_deg(20));
    return find_groups(b.made()).groups.at(0);
  };
  const double of_slab = tan_deg(20) / tan_deg(30), of_crumb = tan_deg(20) / tan_deg(60);
  for (const bool crumb_first : {false, true}) {
    SCOPED_TRACE(crumb_first);
    const Group group = group_of(100, 1, crumb_first);
    ASSERT_EQ(group.bodies.size(), 2U);
    EXPECT_NEAR(group.moving.factor, of_crumb, 1e-6);
    ASSERT_TRUE(group.heaviest.has_value());
    EXPECT_NEAR(*group.heaviest / of_slab, 1, 2e-3);
    // Where the heavy one moves first, its factor is the group's.
    const Group other = group_of(1, 100, crumb_first);
    EXPECT_EQ(other.heaviest, other.moving.factor);
    // Of equal ones the least.
    const Group equal = group_of(1, 1, crumb_first);
    EXPECT_EQ(equal.heaviest, equal.moving.factor);
  }
  Builder alone{Freedom::translation};
  alone.contact(alone.block({0, 0, -1}, 1), rock, {sin_deg(30), 0, cos_deg(30)}, tan_deg(20));
  EXPECT_FALSE(find_groups(alone.made()).groups.at(0).heaviest.has_value());
}

// A block before a wedge slides off for certain; the wedge behind it, which only locked forces could hold, is a group
// of its own. What goes on before it does not hold it: its factor is that of the wedge.
TEST(KeyGroups, WhatMovesBesideAGroupDoesNotHoldIt) {
  const auto wedge_behind = [](double friction) {
    Builder b{Freedom::translation};
    const Vec3 up{sin_deg(30), 0, cos_deg(30)}, down{cos_deg(30), 0, -sin_deg(30)}, across{0, 1, 0};
    const std::uint32_t before = b.block({0, 0, -1}, 1), wedge = b.block({0, 0, -1}, 1);
    b.contact(before, rock, up, tan_deg(10));
    for (const double side : {-1.0, 1.0}) {
      b.contact(wedge, rock, cos_deg(60) * up + side * sin_deg(60) * across, friction);
    }
    b.contact(before, wedge, down, tan_deg(10));
    return find_groups(b.made()).groups;
  };
  // 2 N cos 60 balances cos 30 of the weight.
  const auto factor = [](double friction) { return friction / (cos_deg(60) * tan_deg(30)); };
  const std::vector<Group> moving = wedge_behind(0.27);
  ASSERT_EQ(moving.size(), 2U);
  EXPECT_EQ(moving[0].verdict, Verdict::certain);
  EXPECT_NEAR(moving[0].moving.factor, tan_deg(10) / tan_deg(30), 1e-6);
  EXPECT_EQ(moving[1].verdict, Verdict::unsafe);
  EXPECT_NEAR(moving[1].moving.factor / factor(0.27), 1, 1e-6);
  ASSERT_TRUE(moving[1].turning.has_value());
  EXPECT_LE(moving[1].turning->factor, moving[1].moving.factor);
}

// Cohesion that only an even share of shear would bear, or that a corner that opens would lose, is not relied on where
// blocks lean on one another: neither is motion proved, nor does it stand.
TEST(KeyGroups, HeldByCohesionThatBreaksBitByBitAreInDoubt) {
  for (const double cohesion : {0.3, 1.0}) {
    Builder b{Freedom::section};
    const double c = cos_deg(35), s = sin_deg(35);
    // Two blocks 4 m long and 1 m high in line on a plane of 35 degrees, friction 25; along it 2 units of load each
    // need 0.77 of cohesion.
    for (const double from : {0.0, 4.0}) {
      b.polygon({{from * c, from * s},
                 {(from + 4) * c, (from + 4) * s},
                 {(from + 4) * c - s, (from + 4) * s + c},
                 {from * c - s, from * s + c}},
                0.5);
      Contact& base =
          b.edge(from > 0 ? 1 : 0, rock, {from * c, from * s}, {(from + 4) * c, (from + 4) * s}, tan_deg(25));
      base.bonds = {{.corners = {base.points[0], base.points[1], base.points[1]}, .cohesion = 2 * cohesion}};
    }
    b.edge(1, 0, {4 * c - s, 4 * s + c}, {4 * c, 4 * s}, tan_deg(25));
    const Groups found = find_groups(b.made());
    if (cohesion > 0.9) {
      EXPECT_TRUE(found.groups.empty());
      continue;
    }
    ASSERT_FALSE(found.groups.empty());
    for (const Group& group : found.groups) EXPECT_EQ(group.verdict, Verdict::in_doubt);
  }
}

// Many blocks of which few move. Blocks that come to rest on the way are held by forces that contacts carry: nothing is
// in doubt.
TEST(KeyGroups, FewAmongMany) {
  for (const Freedom freedom : {Freedom::translation, Freedom::rigid}) {
    const Lattice many = lattice(8, 6, freedom);
    const Groups found = find_groups(many.builder.made());
    std::vector<std::uint32_t> moving;
    for (const Group& group : found.groups) {
      EXPECT_EQ(group.verdict, Verdict::certain);
      EXPECT_EQ(group.bodies.size(), 1U);
      EXPECT_NEAR(group.moving.factor, many.factor, 1e-6);
      moving.push_back(group.bodies.front());
    }
    EXPECT_EQ(moving, many.loose);
  }
}

// The certificate is a function of the input: in another order the same blocks move at the same rates.
TEST(KeyGroups, DoNotDependOnTheOrder) {
  const Builder b = toppling_columns(30);
  Builder turned{Freedom::section};
  const auto count = static_cast<std::uint32_t>(b.spec.bodies.size());
  for (std::uint32_t k = count; k-- > 0;) turned.spec.bodies.push_back(b.spec.bodies[k]);
  for (std::size_t k = b.spec.contacts.size(); k-- > 0;) {
    Contact c = b.spec.contacts[k];
    c.body = count - 1 - c.body;
    if (c.other) c.other = count - 1 - *c.other;
    turned.spec.contacts.push_back(c);
  }
  const Projection p = project(b.made(), 1), q = project(turned.made(), 1);
  ASSERT_GT(p.largest, 1e-3);
  for (std::uint32_t k = 0; k < count; ++k) EXPECT_NEAR(p.speed[k], q.speed[count - 1 - k], 1e-9);
}

// One block in translation: the moving factor is that of key block theory (T3), the static one no less.
TEST(KeyGroups, OneBlockIsKeyBlockTheory) {
  Rng rng{20261123};
  // Sanitizers take twenty times as long: a part of the same blocks.
  constexpr int trials = support::sanitized ? 100 : 1000;
  int finite = 0, wedged = 0, certain = 0;
  for (int trial = 0; trial < trials; ++trial) {
    SCOPED_TRACE(trial);
    const std::vector<Side> sides = random_sides(rng);
    const double factor = conventional(sides, {0, 0, -1});
    const Judged got = judge(single(sides).made());
    EXPECT_GE(got.up.factor, got.moving.factor * (1 - 1e-6));
    if (factor == 0 || factor == infinite) {
      EXPECT_EQ(got.moving.factor, factor);
    } else {
      EXPECT_NEAR(got.moving.factor, factor, 2e-6 * factor);
      ++finite;
      if (got.up.factor > 1.001 * factor) ++wedged;
    }
    const bool unsafe = got.verdict == Verdict::certain || got.verdict == Verdict::unsafe;
    if (std::abs(factor - 1) > 1e-5) {
      EXPECT_EQ(unsafe, factor < 1) << factor;
    }
    certain += got.verdict == Verdict::certain ? 1 : 0;
  }
  EXPECT_GT(10 * finite, 3 * trials);
  EXPECT_GT(20 * wedged, trials);
  EXPECT_GT(10 * certain, trials);
}

}  // namespace
}  // namespace cleave::assembly
