// What a scene states or leaves out is said where it is likely a slip: units, defaults, lengths in millimetres.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "parse_support.hpp"

namespace cleave::scene::test::unusual_inputs_test {
namespace {

const std::string joints_and_rock =
    "[[joint]]\nplane = { through = [4, 4, 3], dip = 60, dip_direction = 270 }\nset = \"A\"\n"
    "[[joint]]\nplane = { through = [4, 4, 2], dip = 50, dip_direction = 90 }\nset = \"B\"\n"
    "[rock]\ndensity = 2700\n";
const std::string strength = "[joints.default]\nfriction = 30\ncohesion = 0\n";

/// "key: remedy" of the notes; scenes in a box, or whole where `more` has a domain.
std::vector<std::string> remedies(const std::string& more, const Files& files = {}) {
  std::vector<std::string> said;
  for (const Problem& note : scene_of(more.contains("[domain]") ? more : with_box(more), files).notes) {
    said.push_back(note.key + ": " + note.remedy);
  }
  return said;
}
std::vector<std::string> texts(const std::string& more, const Files& files = {}) {
  std::vector<std::string> said;
  for (const Problem& note : scene_of(with_box(more), files).notes) said.push_back(note.key + " " + note.what);
  return said;
}
using Said = std::vector<std::string>;

TEST(UnusualInputs, LoadsInKiloUnitsNameTheUnit) {
  EXPECT_EQ(remedies(joints_and_rock + strength +
                     "[stability]\nfree = [\"top\"]\nseismic = [0, 1.5, 0]\nwater = { pressures = { A = 60 } }\n"
                     "surcharge = [{ on = \"top\", pressure = 200 }, { traction = [3, 0, -90] }]\n"
                     "point = [{ at = [4, 4, 6], force = [0.5, 0, -200] }]\n"
                     "line = [{ from = [1, 1, 6], to = [2, 1, 6], force_per_metre = [0, 0, -50] }]\n"),
            (Said{"stability.seismic: it is a share of the weight: divide m/s2 by 9.81, per cent by 100",
                  "stability.water.pressures.A: if it is meant in kPa, write \"60 kPa\"",
                  "stability.surcharge[1].pressure: if it is meant in kPa, write \"200 kPa\"",
                  "stability.surcharge[2].traction: if it is meant in kPa, write \"-90 kPa\"",
                  "stability.point[1].force: if it is meant in kN, write \"-200 kN\"",
                  "stability.line[1].force_per_metre: if it is meant in kN/m, write \"-50 kN/m\""}));
}

// A unit that is stated may be the wrong one.
TEST(UnusualInputs, NumbersWithAUnitAreLookedAtAsBareOnesAre) {
  const std::string planes = joints_and_rock.substr(0, joints_and_rock.find("[rock]"));
  const auto with = [&](const std::string& density, const std::string& cohesion) {
    return planes + "[rock]\ndensity = " + density + "\n[joints.default]\nfriction = 30\ncohesion = " + cohesion +
           "\n[stability]\nfree = [\"top\"]\n";
  };
  EXPECT_EQ(texts(with("\"26 N/m3\"", "\"15 MPa\"")),
            (Said{"joints.default.cohesion is 15 MPa (1.5e+07 Pa), which is far from usual (500 to 1e+07)",
                  "rock.density is 26 N/m3 (2.65 kg/m3), which is far from usual (500 to 10000)"}));
  EXPECT_EQ(remedies(with("\"26 N/m3\"", "\"15 MPa\"")),
            (Said{"joints.default.cohesion: if it is meant in kPa, write \"15 kPa\"",
                  "rock.density: if it is meant in kN/m3, write \"26 kN/m3\""}));
  EXPECT_EQ(remedies(with("\"2.7 kg/m3\"", "\"20000 kPa\"")),
            (Said{"joints.default.cohesion: if it is meant in Pa, write \"20000 Pa\"",
                  "rock.density: if it is meant in t/m3, write \"2.7 t/m3\""}));
  EXPECT_EQ(remedies(with("\"0.027 kg/m3\"", "\"0.0015 Pa\"")),
            (Said{"joints.default.cohesion: if it is meant in MPa, write \"0.0015 MPa\"",
                  "rock.density: if it is meant in MN/m3, write \"0.027 MN/m3\""}));
  EXPECT_EQ(remedies(with("\"20 t/m3\"", "\"1e9 MPa\"")),
            (Said{"joints.default.cohesion: it is taken as it stands: check it",
                  "rock.density: if it is meant in kN/m3, write \"20 kN/m3\""}));
  EXPECT_EQ(texts(with("\"26 kg/m3\"", "0")), Said{"rock.density is 26 kg/m3, which is far from usual (500 to 10000)"});
  EXPECT_EQ(texts(with("\"26 kN/m3\"", "\"15 kPa\"")), Said{});
  EXPECT_EQ(texts(with("\"2.7 t/m3\"", "\"0 kPa\"")), Said{});
  // Of a vector the largest; of a uniform law, too.
  EXPECT_EQ(remedies(joints_and_rock + strength +
                     "[stability]\nfree = [\"top\"]\npoint = [{ at = [4, 4, 6], force = [10, 0, \"-200 N\"] }]\n"),
            Said{"stability.point[1].force: if it is meant in kN, write \"-200 kN\""});
  EXPECT_EQ(remedies(with("2700", "{ distribution = \"uniform\", min = 0, max = \"20 MPa\" }")),
            Said{"joints.default.cohesion.max: if it is meant in kPa, write \"20 kPa\""});
}

TEST(UnusualInputs, GravityIsThatOfAPlanet) {
  const auto with = [](const std::string& gravity) {
    return texts(joints_and_rock + strength + "[stability]\nfree = [\"top\"]\ngravity = " + gravity + "\n");
  };
  EXPECT_EQ(with("0.981"), (Said{"stability.gravity is 0.981 m/s2, which is far from usual (1.5 to 500)"}));
  EXPECT_EQ(with("9.81"), Said{});
  EXPECT_EQ(with("1.62"), Said{});
}

TEST(UnusualInputs, WhatMeansAnotherThingThanItSaysIsSaid) {
  const auto with = [](const std::string& stability) {
    return texts(joints_and_rock + strength + "[stability]\nfree = [\"top\"]\n" + stability);
  };
  EXPECT_EQ(with("gravity = 0\n"), (Said{"stability.gravity is 0, so that blocks have no weight"}));
  EXPECT_EQ(with("water = { table = -5 }\n"),
            (Said{"water.table is -5, below all of the rock (from 0 on), so that nothing is wet"}));
  EXPECT_EQ(with("[[load]]\nname = \"wet\"\nwater = { table = -5 }\n").size(), 1U);
  EXPECT_EQ(with("water = { table = 2 }\n"), Said{});
  EXPECT_EQ(with("water = { table = 6 }\n"), Said{});
  EXPECT_EQ(with("water = { table = 60 }\n"),
            (Said{"water.table is 60, above all of the ground (up to 6): the rock stands under a lake"}));
  // Without a free top there is rock above the box.
  for (const std::string side : {"west", "bottom"}) {
    EXPECT_EQ(texts(joints_and_rock + strength + "[stability]\nfree = [\"" + side + "\"]\nwater = { table = 60 }\n"),
              Said{})
        << side;
  }
  // A table counts against gravity, wherever that points.
  const std::string upwards =
      "stability.gravity points upwards, as z does: what is taken out of a roof would fall upwards";
  EXPECT_EQ(with("gravity = [0, 0, 9.81]\nwater = { table = -5 }\n"), Said{upwards});
  EXPECT_EQ(with("gravity = [0.5, 0, -9.8]\n"), Said{});
  EXPECT_EQ(with("gravity = [0, 6.9, -7]\n"), Said{});
  for (const std::string sideways : {"[9.81, 0, 0]", "[0, -9.81, 0]", "[0, 7, -6.9]", "[5, 5, -7]"}) {
    EXPECT_EQ(with("gravity = " + sideways + "\n"), (Said{"stability.gravity acts more sideways than down"}))
        << sideways;
  }
  EXPECT_EQ(with("surcharge = [{ on = \"top\", pressure = -20e3 }]\n"),
            (Said{"stability.surcharge[1].pressure is below 0: it pulls at the rock"}));
  EXPECT_EQ(with("target = { falling = 0.5 }\n"),
            (Said{"stability.target.falling asks for a factor of safety below 1"}));
  EXPECT_EQ(with("target = { falling = 1, sliding = 1 }\n"), Said{});
}

TEST(UnusualInputs, AnglesThatMayBeRadiansAreSaid) {
  const auto with = [](const std::string& angles) {
    return texts("[[joint]]\nplane = { through = [4, 4, 3], " + angles + " }\n[rock]\ndensity = 2700\n" + strength +
                 "[stability]\nfree = [\"top\"]\n");
  };
  EXPECT_EQ(with("dip = 0.785, dip_direction = 4.71"),
            (Said{"joint[1].plane.dip is 0.785 beside dip_direction = 4.71, in degrees"}));
  EXPECT_EQ(with("plunge = 0.785, trend = 4.71"),
            (Said{"joint[1].plane.plunge is 0.785 beside trend = 4.71, in degrees"}));
  EXPECT_EQ(with("dip = 1, dip_direction = 5"), Said{});
  // The dip alone; level beds are stated to a tenth of a degree at most.
  EXPECT_EQ(with("dip = 0.663, dip_direction = 90"),
            (Said{"joint[1].plane.dip is 0.663 beside dip_direction = 90, in degrees"}));
  EXPECT_EQ(with("plunge = 0.785, trend = 64.5"),
            (Said{"joint[1].plane.plunge is 0.785 beside trend = 64.5, in degrees"}));
  for (const char* level : {"0.5", "1.3", "0.01", "1", "2.25", "\"0.663 deg\"", "\"0.663 rad\""}) {
    EXPECT_EQ(with(std::string{"dip = "} + level + ", dip_direction = 64.5"), Said{}) << level;
  }
  EXPECT_EQ(with("dip = \"0.785 deg\", dip_direction = \"4.71 deg\""), Said{});
}

TEST(UnusualInputs, ShotcreteAndStressOfOtherConventions) {
  const std::string tunnel =
      "[[excavation]]\nname = \"t\"\nkind = \"tunnel\"\nsection = { shape = \"circle\", diameter = 2 }\n"
      "axis = [[4, 0, 3], [4, 8, 3]]\n[support]\nshotcrete = { thickness = 0.1, ";
  const auto with = [&](const std::string& more) { return texts(joints_and_rock + strength + tunnel + more); };
  EXPECT_EQ(with("strength = 30e6 }\n"),
            (Said{"support.shotcrete.strength is 30000000 Pa, which is far from usual (10000 to 1e+07)"}));
  EXPECT_EQ(with("strength = 1e6, adhesion = 0.5e6, bond_width = 30 }\n"),
            (Said{"support.shotcrete.bond_width is 30 m, which is far from usual (0.001 to 0.5)"}));
  const std::string stress = "strength = 1e6 }\n[field_stress]\ntolerance = 1e-2\nstress = ";
  EXPECT_EQ(texts(joints_and_rock + "poisson = 0.25\n" + strength + tunnel + stress + "[5e6, 5e6, 5e6, 0, 0, 0]\n"),
            (Said{"field_stress.stress pulls: normal stresses above 0 are tension"}));
  const std::string pressed =
      joints_and_rock + "poisson = 0.25\n" + strength + tunnel + stress + "[-5e6, -5e6, -5e6, 0, 0, 0]\n";
  EXPECT_EQ(texts(pressed), Said{});
  EXPECT_EQ(texts(pressed + "gradient = [26e3, 26e3, 26e3, 0, 0, 0]\n"), Said{});
  EXPECT_EQ(texts(pressed + "gradient = [0, 0, -26e3, 0, 0, 0]\n"),
            (Said{"field_stress.gradient has zz = -2.6e+04 Pa/m: the rock is pressed more the higher it lies"}));
  EXPECT_EQ(texts(pressed + "gradient = [0, 0, 2.6e3, 0, 0, 0]\n"),
            (Said{"field_stress.gradient has zz = 2600 Pa/m, far from the weight of the rock"}));
  // 5 MPa are used up 192 m above the level they are given at.
  EXPECT_EQ(texts(pressed + "gradient = [0, 0, 26e3, 0, 0, 0]\nlevel = -180\n"), Said{});
  EXPECT_EQ(texts(pressed + "gradient = [0, 0, 26e3, 0, 0, 0]\nlevel = -200\n"),
            (Said{"field_stress.stress pulls at the tunnel \"t\", 203 m above the level it is given at"}));
}

// As the table of keys says.
TEST(UnusualInputs, RingsWithoutAnArcLeaveTheFloor) {
  const auto bolts = [](const std::string& arc) {
    return scene_of("[domain]\nbox = { min = [0, 0, 0], max = [8, 8, 6] }\n" + joints_and_rock + strength +
                    "[[excavation]]\nname = \"t\"\nkind = \"tunnel\"\nsection = { shape = \"rectangle\", width = 2, "
                    "height = 2 }\n"
                    "axis = [[4, 0, 3], [4, 8, 3]]\n[support]\n[[support.bolts]]\ntunnel = \"t\"\n"
                    "tendon_capacity = 200e3\nbond_strength = 200e3\nspacing = [1, 1]\nlength = 4\nanchorage = 0.5\n" +
                    arc)
        .support->plan.bolts.size();
  };
  EXPECT_EQ(bolts(""), bolts("arc = [-120, 120]\n"));
  // 9 rings of 6 m, both ends bolted; of 8 m all round, where the last bolt would stand where the first one does.
  EXPECT_EQ(bolts(""), 63U);
  EXPECT_EQ(bolts("arc = [-180, 180]\n"), 72U);
  EXPECT_EQ(bolts("arc = [-180, 180]\noffset = [0, 0.5]\n"), 72U);
}

TEST(UnusualInputs, PatternsAndLawsThatHoldNothing) {
  const auto with = [](const std::string& bolts) {
    return texts(joints_and_rock + strength +
                 "[[excavation]]\nname = \"t\"\nkind = \"tunnel\"\nsection = { shape = \"circle\", diameter = 2 }\n"
                 "axis = [[4, 0, 3], [4, 8, 3]]\n[support]\n[[support.bolts]]\ntunnel = \"t\"\n"
                 "tendon_capacity = 200e3\nplate_capacity = 100e3\nbond_strength = 200e3\n" +
                 bolts);
  };
  EXPECT_EQ(with("spacing = [1.5, 1.5]\nlength = 4\nanchorage = 0.5\n"), Said{});
  EXPECT_EQ(with("spacing = [1500, 1500]\nlength = 4\nanchorage = 0.5\n"),
            (Said{"support.bolts[1].spacing is 1500 m, which is far from usual (0.1 to 50)"}));
  EXPECT_EQ(with("spacing = [1.5, 1.5]\nlength = 4\nanchorage = 4\n"),
            (Said{"support.bolts[1].anchorage is 4 m, and the bolt is 4 m long: no bolt is gripped so, and none holds "
                  "anything"}));
  const std::string cable = "spacing = [1.5, 1.5]\nlength = 8\nanchorage = 2\nkind = \"cable\"\nfree_length = ";
  EXPECT_EQ(with(cable + "6\n"), Said{});
  EXPECT_EQ(with(cable + "6.5\n"),
            (Said{"support.bolts[1].free_length is 6.5 m, and the cable is 8 m long: less than its anchorage of 2 m is "
                  "left to grip, and none holds anything"}));
  // One that was copied counts twice.
  const std::string single =
      "\n[[support.bolts]]\nname = \"spot\"\nat = [[4, 4, 4]]\ndirection = [0, 0, 1]\nlength = 1.5\n"
      "tendon_capacity = 200e3\nplate_capacity = 100e3\nbond_strength = 200e3\nanchorage = 0.5\n";
  const std::string rings = "spacing = [1.5, 1.5]\nlength = 4\nanchorage = 0.5\n";
  EXPECT_EQ(with(rings + single), Said{});
  EXPECT_EQ(with(rings + single + single),
            (Said{"support.bolts has 1 bolt where another stands with the same direction (of \"spot\" and \"spot\"): "
                  "each counts"}));
  const auto set = [](const std::string& size, const std::string& kappa) {
    return texts(
        "[[joint_set]]\nname = \"S\"\norientation = { dip = 40, dip_direction = 30, distribution = "
        "\"fisher\", kappa = " +
        kappa + " }\nshape = \"disc\"\nsize = { distribution = \"lognormal\", " + size +
        " }\nintensity = { p32 = 0.1 }\n[rock]\ndensity = 2700\n" + strength + "[stability]\nfree = [\"top\"]\n");
  };
  EXPECT_EQ(set("mean = 3, std = 1, min = 2, max = 5", "20"), Said{});
  const std::string tail = ".size.mean is 1.5 m, outside of min..max: no more than a tail of the law is drawn";
  EXPECT_EQ(set("mean = 1.5, std = 1, min = 2, max = 5", "20"), Said{"joint_set[1]" + tail});
  EXPECT_EQ(set("mean = 1.5, std = 1, min = 0.1, max = 1.4", "20"), Said{"joint_set[1]" + tail});
  EXPECT_EQ(set("mean = 3, std = 1, min = 2, max = 5", "0.6").size(), 1U);
}

TEST(UnusualInputs, JointsInMillimetres) {
  const auto set = [](const std::string& size, const std::string& intensity) {
    return remedies("[[joint_set]]\nname = \"S\"\norientation = { dip = 40, dip_direction = 30 }\nsize = " + size +
                    "\nintensity = { " + intensity + " }\n[rock]\ndensity = 2700\n" + strength +
                    "[stability]\nfree = [\"top\"]\n");
  };
  EXPECT_EQ(set("5", "spacing = 600"),
            (Said{"joint_set[1].intensity.spacing: if it is meant in mm, write \"600 mm\""}));
  EXPECT_EQ(set("12000", "spacing = 0.6"), (Said{"joint_set[1].size: if it is meant in mm, write \"12000 mm\""}));
  EXPECT_EQ(set("{ distribution = \"exponential\", mean = 3000 }", "p32 = 1"),
            (Said{"joint_set[1].size.mean: if it is meant in mm, write \"3000 mm\""}));
  EXPECT_EQ(set("{ distribution = \"power\", exponent = 2.5, min = 0.005, max = 5000 }", "spacing = 0.6"), Said{});
  EXPECT_EQ(set("\"12000 mm\"", "spacing = \"600 mm\""), Said{});
  const Scene in_mm =
      scene_of(with_box("[[joint_set]]\norientation = { dip = 40, dip_direction = 30 }\nsize = \"4000 mm\"\nintensity "
                        "= { p32 = 0.5 }\n"));
  EXPECT_TRUE(std::holds_alternative<dfn::Rectangle>(in_mm.joint_sets[0].law.spec().shape));
}

TEST(UnusualInputs, FactorsOnTheUnsafeSideAndNamesAlike) {
  const auto with = [](const std::string& more) {
    return texts(joints_and_rock + strength + "[stability]\nfree = [\"top\"]\n" + more);
  };
  EXPECT_EQ(with("partial = { friction = 1.25, cohesion = 1.6, weight = 1.35 }\n"), Said{});
  EXPECT_EQ(
      with("partial = { friction = 1.25, weight = 0.5 }\n"),
      (Said{"stability.partial.weight is 0.5: weight is multiplied by it, so that one below 1 makes rock lighter"}));
  EXPECT_EQ(with("gravity = 981\n").size(), 1U);
  EXPECT_EQ(with("[[joint]]\nset = \"a\"\nplane = { through = [4, 4, 1], dip = 50, dip_direction = 90 }\n"),
            (Said{"joints the sets \"A\" and \"a\" differ in case alone: they are two sets"}));
}

TEST(UnusualInputs, TailsBelowAnUnstatedLimit) {
  const auto law = [](const std::string& table) {
    return texts(joints_and_rock + "[stability]\nfree = [\"top\"]\n[joints.default]\n" + table);
  };
  const std::string cohesion = "friction = 30\ncohesion = { distribution = ";
  // Above 0 a normal law of (1, 1) has the mean 1 + phi(1)/Phi(1) = 1.2876.
  EXPECT_EQ(
      law(cohesion + "\"normal\", mean = 10e3, std = 10e3 }\n"),
      (Said{"joints.default.cohesion 16 % of this normal law lie below 0 and are drawn again: the values drawn are "
            "1.29e+04 on average, not 10000"}));
  EXPECT_EQ(law("friction = { distribution = \"normal\", mean = 30, std = 25 }\ncohesion = 0\n").size(), 1U);
  EXPECT_EQ(law(cohesion + "\"normal\", mean = 10e3, std = 10e3, min = 0 }\n"), Said{});
  EXPECT_EQ(law(cohesion + "\"lognormal\", mean = 10e3, std = 10e3 }\n"), Said{});
  EXPECT_EQ(law(cohesion + "\"normal\", mean = 10e3, std = 3e3 }\n"), Said{});
  // A law over whatever values is not cut.
  EXPECT_EQ(law("friction = 30\ncohesion = 0\n[stability.water]\n"
                "table = { distribution = \"normal\", mean = 1, std = 2 }\n"),
            Said{});
}

TEST(UnusualInputs, SmallComponentsBesideUsualOnesAreUsual) {
  EXPECT_EQ(remedies(joints_and_rock + strength +
                     "[stability]\nfree = [\"top\"]\nseismic = [0.15, 0, 1e-5]\nwater = { pressures = { A = 60e3 } }\n"
                     "surcharge = [{ traction = [3, 0, -90e3] }, { pressure = \"200 kPa\" }]\n"
                     "point = [{ at = [4, 4, 6], force = [0.5, 0, -200e3] }]\n"),
            Said{});
}

TEST(UnusualInputs, StressOfTheFieldInMegapascal) {
  const std::string tunnel =
      "[[excavation]]\nname = \"t\"\nkind = \"tunnel\"\nsection = { shape = \"circle\", diameter = 2 }\n"
      "axis = [[4, 0, 3], [4, 8, 3]]\n[joints.default]\nfriction = 30\n[rock]\ndensity = 2700\npoisson = 0.25\n"
      "[[joint]]\nplane = { through = [4, 4, 3], dip = 60, dip_direction = 270 }\n";
  EXPECT_EQ(remedies(tunnel + "[field_stress]\nstress = [-6, -6, -4, 0, 0, 0]\ngradient = [0, 0, 0.027, 0, 0, 0]\n"),
            (Said{"field_stress.stress: if it is meant in MPa, write \"-6 MPa\"",
                  "field_stress.gradient: if it is meant in MPa/m, write \"0.027 MPa/m\""}));
  EXPECT_EQ(remedies(tunnel + "[field_stress]\nstress = [-6e6, -6e6, -4e6, 100, 0, 0]\n"), Said{});
}

TEST(UnusualInputs, LawsAreLookedAtAsNumbersAre) {
  const auto law = [](const std::string& friction, const std::string& cohesion) {
    return remedies(joints_and_rock + "[stability]\nfree = [\"top\"]\n[joints.default]\nfriction = { distribution = " +
                    friction + " }\ncohesion = { distribution = " + cohesion + " }\n");
  };
  EXPECT_EQ(law("\"uniform\", min = 0.5, max = 0.7", "\"uniform\", min = 20, max = 50"),
            (Said{"joints.default.friction.max: if it is meant in rad, write \"0.7 rad\"",
                  "joints.default.cohesion.max: if it is meant in kPa, write \"50 kPa\""}));
  EXPECT_EQ(law("\"normal\", mean = 0.6, std = 0.05", "\"lognormal\", mean = 50, std = 10"),
            (Said{"joints.default.friction.mean: if it is meant in rad, write \"0.6 rad\"",
                  "joints.default.cohesion.mean: if it is meant in kPa, write \"50 kPa\""}));
  // A lower end of nearly nothing, a small spread and far limits are usual.
  EXPECT_EQ(law("\"normal\", mean = 30, std = 0.5, min = 1, max = 89", "\"uniform\", min = 10, max = 50e3"), Said{});
}

TEST(UnusualInputs, WhatNoUnitMakesUsualIsSaidToo) {
  EXPECT_EQ(remedies("[[joint]]\nplane = { through = [4, 4, 3], dip = 60, dip_direction = 270 }\n"
                     "[joints.default]\nfriction = 85\ncohesion = 1e12\n[rock]\ndensity = 100\n"
                     "[stability]\nfree = [\"top\"]\n"),
            (Said{"joints.default.friction: it is taken as it stands: check it",
                  "joints.default.cohesion: it is taken as it stands: check it",
                  "rock.density: it is taken as it stands: check it"}));
}

TEST(UnusualInputs, TensionAboveTheApexIsSaid) {
  const auto with = [](const std::string& strengths) {
    return texts(joints_and_rock + "[stability]\nfree = [\"top\"]\n" + strengths);
  };
  const std::string above = "is above cohesion / tan(friction) = ";
  EXPECT_EQ(with("[joints.default]\nfriction = 45\ncohesion = 1e4\ntension = 2e4\n"),
            (Said{"joints.default.tension " + above + "10000 Pa, the apex of the Mohr-Coulomb line"}));
  // Cohesion that is not given is 0, or that of all sets.
  EXPECT_EQ(with("[joints.default]\nfriction = 45\ntension = 2e4\n"),
            (Said{"joints.default.tension " + above + "0 Pa, the apex of the Mohr-Coulomb line"}));
  const std::string base = "[joints.default]\nfriction = 45\ncohesion = 1e4\n[joints.A]\ntension = ";
  EXPECT_EQ(with(base + "2e4\n"), (Said{"joints.A.tension " + above + "10000 Pa, the apex of the Mohr-Coulomb line"}));
  EXPECT_EQ(with(base + "5e3\n"), Said{});
}

TEST(UnusualInputs, ColumnsOfStrengthAreLookedAt) {
  const auto of = [](const std::string& table) {
    return texts("[[joint]]\nfile = \"j.csv\"\n[rock]\ndensity = 2700\n" + strength + "[stability]\nfree = [\"top\"]\n",
                 {{"j.csv", table}});
  };
  const Said said = of("dip,dd,x,y,z,friction,cohesion\n30,90,4,4,3,0.6,50\n40,90,4,4,3,35,60\n");
  ASSERT_EQ(said.size(), 3U);  // the first says how the columns are read
  EXPECT_EQ(said[1], "friction is 0.6 degrees, which is far from usual (3 to 80)");
  EXPECT_EQ(said[2], "cohesion is 50 Pa, which is far from usual (500 to 1e+07), and so are 2 rows in all");
  EXPECT_EQ(of("dip,dd,x,y,z,friction,cohesion (kPa)\n30,90,4,4,3,35,50\n").size(), 1U);
  // A unit that the header states may be the wrong one.
  const Said stated = of("dip,dd,x,y,z,friction [rad],cohesion [MPa],tension_MPa\n30,90,4,4,3,0.6,20,0.02\n");
  ASSERT_EQ(stated.size(), 2U);
  EXPECT_EQ(stated[1], "cohesion is 20000000 Pa, which is far from usual (500 to 1e+07)");
  EXPECT_EQ(of("dip,dd,x,y,z,tension\n30,90,4,4,3,20\n").size(), 2U);
  EXPECT_EQ(
      remedies("[[joint]]\nfile = \"j.csv\"\n[rock]\ndensity = 2700\n" + strength + "[stability]\nfree = [\"top\"]\n",
               {{"j.csv", "dip,dd,x,y,z,cohesion [Pa]\n30,90,4,4,3,50\n"}})
          .back(),
      "cohesion: check the unit that the header states");
}

TEST(UnusualInputs, SetsWithoutFrictionAreNamed) {
  const auto with = [](const std::string& strengths) {
    return texts(joints_and_rock + "[stability]\nfree = [\"top\"]\n" + strengths);
  };
  EXPECT_EQ(with("[joints.B]\nfriction = 40\n"),
            Said{"joints no friction is given for A: 30 degrees are taken, and cohesion 0"});
  EXPECT_EQ(with("[joints.B]\ntension = 0\n[joints.A]\ncohesion = 5e4\n"),
            Said{"joints no friction is given for A, B: 30 degrees are taken, and cohesion 0 for B"});
  EXPECT_EQ(with("[joints.default]\ntension = 0\n"),
            Said{"joints no friction is given for A, B: 30 degrees are taken, and cohesion 0"});
  EXPECT_EQ(with("[joints.A]\nfriction = 30\n[joints.B]\nfriction = 30\n"), Said{});
}

TEST(UnusualInputs, RockWithoutDensityIsSaid) {
  EXPECT_EQ(remedies("[[joint]]\nplane = { through = [4, 4, 3], dip = 60, dip_direction = 270 }\n" + strength +
                     "[rock]\npoisson = 0.2\n[stability]\nfree = [\"top\"]\n"),
            Said{"rock: add density to [rock]"});
}

TEST(UnusualInputs, LengthsInMillimetres) {
  const auto of = [](const std::string& size) {
    return remedies("[domain]\nbox = { min = [0, 0, 0], max = [" + size + ", " + size + ", " + size +
                    "] }\n[[joint]]\nplane = { through = [0.01, 0.01, 0.01], dip = 60, dip_direction = 270 }\n");
  };
  const std::string millimetres = "domain: if its lengths are millimetres or feet, write them in metres";
  EXPECT_EQ(of("60000"), Said{millimetres});
  EXPECT_EQ(of("0.04"), Said{"domain: if its lengths are kilometres, write them in metres"});
  EXPECT_EQ(of("20000"), Said{});  // a region
  std::string room;                // of 10 m
  for (const int z : {0, 10000}) {
    for (const int y : {0, 10000}) {
      for (const int x : {0, 10000}) {
        room += "v " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
      }
    }
  }
  room += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  EXPECT_EQ(remedies("[domain]\nmesh = \"room.obj\"\n[[joint]]\nplane = { through = [1, 1, 1], dip = 60, "
                     "dip_direction = 270 }\n",
                     {{"room.obj", room}}),
            Said{millimetres});
  const auto opening =
      remedies("[domain]\nbox = { min = [0, 0, 0], max = [40, 40, 40] }\n" + joints_and_rock + strength +
               "[[excavation]]\nname = \"hall\"\nkind = \"polyhedron\"\n"
               "box = { min = [10, 10, 10], max = [9000, 9000, 9000] }\n");
  EXPECT_TRUE(std::ranges::any_of(opening, [](const std::string& s) {
    return s == "excavation.hall: if its lengths are millimetres or feet, write them in metres";
  }));
}

}  // namespace
}  // namespace cleave::scene::test::unusual_inputs_test
