#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cleave/core/cost.hpp"
#include "cleave/core/progress.hpp"
#include "cleave/realize/monte_carlo.hpp"
#include "cleave/realize/run.hpp"
#include "parse_support.hpp"
#include "run_scene.hpp"

namespace cleave::scene::test::loads_scene_test {
namespace {

constexpr std::string_view rock = R"([domain]
box = { min = [0, 0, 0], max = [8, 8, 6] }
[[joint]]
plane = { through = [4, 4, 3], dip = 30, dip_direction = 90 }
set = "A"
friction = 40
cohesion = 5e3
[joints.A]
friction = 25
[joints.B]
jrc = 8
jcs = 50e6
[[joint]]
plane = { through = [4, 4, 0.5], dip = 0, dip_direction = 0 }
set = "B"
[stability]
free = ["top", "east", "west", "north", "south"]
seismic = [0.1, 0, 0]
target = { sliding = 1.2 }
water = { table = 5, pressures = { B = 2e3 } }
surcharge = [{ on = "top", pressure = 1e3 }]
[[load]]
name = "rain"
water = { table = 5.5, unit_weight = 10e3 }
point = [{ at = [1, 1, 6], force = [0, 0, -1e3] }]
[[load]]
name = "quake"
seismic = [0, 0.2, 0]
combine = { rain = 0.5 }
)";

TEST(LoadsSceneTest, CasesAddUpToTheBaseCase) {
  const Scene scene = scene_of(rock);
  ASSERT_TRUE(scene.stability.has_value());
  const StabilitySettings& s = *scene.stability;
  EXPECT_EQ(s.loads.body.seismic(), (geometry::Vec3{0.1, 0, 0}));
  ASSERT_TRUE(s.target.has_value());
  EXPECT_EQ(s.target->falling, 1.5);
  EXPECT_EQ(s.target->sliding, 1.2);
  EXPECT_EQ(s.loads.actions.spec().water->level, 5);
  ASSERT_EQ(s.cases.size(), 2U);
  const LoadSet& rain = s.cases[0].loads;
  EXPECT_EQ(rain.actions.spec().water->level, 5.5);
  EXPECT_EQ(rain.actions.spec().water->unit_weight.si(), 10e3);
  EXPECT_EQ(rain.body.seismic(), (geometry::Vec3{0.1, 0, 0}));
  EXPECT_EQ(rain.actions.spec().surcharges.size(), 1U);
  ASSERT_EQ(rain.actions.spec().points.size(), 1U);
  const LoadSet& quake = s.cases[1].loads;
  EXPECT_EQ(quake.body.seismic(), (geometry::Vec3{0.1, 0.2, 0}));
  EXPECT_EQ(quake.actions.spec().water->unit_weight.si(), 5e3);
  EXPECT_EQ(quake.actions.spec().points.at(0).force, (geometry::Vec3{0, 0, -500}));
  EXPECT_EQ(scene.joints[0].own.friction->degrees(), 40);
  EXPECT_EQ(scene.joints[0].own.cohesion->si(), 5e3);
  const auto drawn = sample(scene);
  ASSERT_TRUE(drawn.has_value());
  ASSERT_TRUE(drawn->joints.items()[1].strength.roughness().has_value());
  EXPECT_EQ(drawn->joints.items()[1].strength.roughness()->jrc, 8);
  EXPECT_FALSE(drawn->joints.items()[0].strength.roughness().has_value());
}

TEST(LoadsSceneTest, EveryCaseIsJudged) {
  const Scene scene = scene_of(rock);
  StageTimer timer;
  Progress progress{ProgressStyle::quiet};
  const auto result = run(scene, {}, timer, progress);
  ASSERT_TRUE(result.has_value());
  ASSERT_EQ(result->load_cases.size(), 2U);
  EXPECT_EQ(result->load_cases[0].name, "rain");
  const auto factor = [](const stability::Analysis& a) { return a.judgements.at(0).factor_of_safety; };
  EXPECT_GT(factor(*result->analysis), 0);
  EXPECT_NE(factor(result->load_cases[1].analysis), factor(*result->analysis));
}

// A factor makes water light, so of two tables neither the higher one nor the lower one may press more everywhere.
TEST(LoadsSceneTest, CombinedWaterPressesNowhereLessThanEither) {
  const auto with = [](const std::string& base) {
    return scene_of(with_box("[stability]\nfree = [\"top\"]\n" + base +
                             "[[load]]\nname = \"rain\"\nwater = { table = 5, free_faces = true }\n"
                             "[[load]]\nname = \"both\"\ncombine = { rain = 0.1 }\nwater = { table = 4 }\n"
                             "[[load]]\nname = \"part\"\ncombine = { rain = 0.5 }\n"));
  };
  const Scene scene = with("");
  const auto& both = scene.stability->cases.at(1).loads.actions.spec().water;
  ASSERT_TRUE(both.has_value());
  EXPECT_EQ(both->level, 5);
  EXPECT_EQ(both->unit_weight.si(), 9810);
  EXPECT_TRUE(both->on_free_faces);
  EXPECT_EQ(scene.stability->cases.at(2).loads.actions.spec().water->unit_weight.si(), 4905);
  const auto said = [](const Scene& s) {
    return std::ranges::count_if(s.notes, [](const Problem& note) {
      return note.what == "makes water lighter than that of [stability], whose place it takes";
    });
  };
  EXPECT_EQ(said(scene), 0);
  EXPECT_EQ(said(with("water = { table = 3 }\n")), 1);
}

// Hydrostatic pressure of a table at 10 m and 1000 N/m3 on a joint with its centroid at 3 m is 7 kPa in the mean. A
// case with a table knows none of the water of [stability]; of a pressure and a table put together what presses more
// counts.
TEST(LoadsSceneTest, ATableTakesThePlaceOfPressuresAndCombinedPressesMost) {
  const auto mean_pressures = [](const std::string& base, const std::string& cases) {
    const Scene scene = scene_of(R"([domain]
box = { min = [0, 0, 0], max = [8, 8, 6] }
[[joint]]
plane = { through = [4, 4, 3], dip = 30, dip_direction = 90 }
set = "bedding"
[joints.default]
friction = 50
[stability]
free = ["top", "east", "west", "north", "south"]
)" + base + cases);
    StageTimer timer;
    Progress progress{ProgressStyle::quiet};
    const auto result = run(scene, {}, timer, progress);
    EXPECT_TRUE(result.has_value());
    const auto& complex = result->complex->complex();
    const double degree = 3.14159265358979323846 / 180, area = 64 / std::cos(30 * degree);
    const auto mean = [&](const stability::Analysis& a) {
      const auto upper = *std::ranges::max_element(a.judgements, {},
                                                   [&](const auto& j) { return complex.blocks()[j.block].centroid.z; });
      const double weight = upper.weight.si();
      const double pressed = upper.factor_of_safety * weight * std::sin(30 * degree) / std::tan(50 * degree);
      return (weight * std::cos(30 * degree) - pressed) / area;
    };
    std::vector<double> out{mean(*result->analysis)};
    for (const CaseResult& load : result->load_cases) out.push_back(mean(load.analysis));
    return out;
  };
  const auto expect = [](const std::vector<double>& found, const std::vector<double>& wanted) {
    ASSERT_EQ(found.size(), wanted.size());
    for (std::size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k], wanted[k], 1e-6) << k;
  };
  const std::string table = "water = { table = 10, unit_weight = 1000 }\n";
  expect(mean_pressures("water = { pressures = { bedding = 2e3 } }\n",
                        "[[load]]\nname = \"rain\"\n" + table +
                            "[[load]]\nname = \"wet\"\nwater = { pressures = { bedding = 20e3 } }\n"
                            "[[load]]\nname = \"quiet\"\nseismic = [0, 0, 0]\n"),
         {2e3, 7e3, 20e3, 2e3});
  // A pressure alone takes the place of the table on its joints.
  expect(mean_pressures(table, "[[load]]\nname = \"drained\"\nwater = { pressures = { bedding = 0 } }\n"), {7e3, 0});
  for (const std::string order : {"{ low = 1, rain = 1 }", "{ rain = 1, low = 1 }"}) {
    expect(mean_pressures("",
                          "[[load]]\nname = \"low\"\nwater = { pressures = { bedding = 2e3 } }\n"
                          "[[load]]\nname = \"rain\"\n" +
                              table + "[[load]]\nname = \"both\"\ncombine = " + order +
                              "\n[[load]]\nname = \"more\"\nwater = { pressures = { bedding = 20e3 } }\n"
                              "[[load]]\nname = \"all\"\ncombine = { both = 0.5, more = 1 }\n"
                              "[[load]]\nname = \"half\"\ncombine = { both = 0.5 }\n"),
           {0, 2e3, 7e3, 7e3, 20e3, 20e3, 3.5e3});
  }
  // Both stated in one case: the pressure is in place of the table, combined or not.
  expect(mean_pressures("",
                        "[[load]]\nname = \"both\"\nwater = { table = 10, unit_weight = 1000, pressures = { "
                        "bedding = 2e3 } }\n[[load]]\nname = \"again\"\ncombine = { both = 1 }\n"),
         {0, 2e3, 2e3});
}

// W sin(dip) against (W cos(dip) - u A) tan(friction): the pressure of one set is on its joints and on no other's.
TEST(LoadsSceneTest, PressureOfASetActsOnItsJointsOnly) {
  const Scene scene = scene_of(R"([domain]
box = { min = [0, 0, 0], max = [8, 8, 6] }
[[joint]]
plane = { through = [4, 4, 3], dip = 30, dip_direction = 90 }
set = "bedding"
[[joint]]
plane = { through = [4, 4, 0.3], dip = 0, dip_direction = 0 }
set = "base"
[joints.default]
friction = 50
[stability]
free = ["top", "east", "west", "north", "south"]
[[load]]
name = "bedding wet"
water = { pressures = { bedding = 20e3 } }
[[load]]
name = "base wet"
water = { pressures = { base = 20e3 } }
)");
  StageTimer timer;
  Progress progress{ProgressStyle::quiet};
  const auto result = run(scene, {}, timer, progress);
  ASSERT_TRUE(result.has_value());
  const auto& complex = result->complex->complex();
  const double degree = 3.14159265358979323846 / 180, tangent = std::tan(50 * degree);
  const auto upper = [&](const stability::Analysis& a) {
    return *std::ranges::max_element(a.judgements, {},
                                     [&](const auto& j) { return complex.blocks()[j.block].centroid.z; });
  };
  const stability::Judgement dry = upper(*result->analysis);
  ASSERT_EQ(dry.pressing.size(), 1U);
  const double area = complex.faces()[dry.pressing[0].face].area.si(), weight = dry.weight.si();
  EXPECT_NEAR(area, 64 / std::cos(30 * degree), 1e-9);
  EXPECT_NEAR(dry.factor_of_safety, tangent / std::tan(30 * degree), 1e-12);
  ASSERT_EQ(result->load_cases.size(), 2U);
  const double wet = (weight * std::cos(30 * degree) - 20e3 * area) * tangent / (weight * std::sin(30 * degree));
  EXPECT_NEAR(upper(result->load_cases[0].analysis).factor_of_safety, wet, 1e-9);
  EXPECT_EQ(upper(result->load_cases[1].analysis).factor_of_safety, dry.factor_of_safety);
}

TEST(LoadsSceneTest, ForcesOffTheRockAreRefused) {
  const Scene scene = scene_of(with_box(
      "[stability]\nfree = [\"top\"]\npoint = [{ at = [1, 1, 5], force = [0, 0, -1] }]\n[[load]]\nname = \"a\"\n"));
  StageTimer timer;
  Progress progress{ProgressStyle::quiet};
  const auto result = run(scene, {}, timer, progress);
  ASSERT_FALSE(result.has_value());
  ASSERT_EQ(result.error().size(), 1U);
  EXPECT_EQ(
      describe(result.error()[0]),
      "s.toml:3: stability.point[1]: lies 1 m off the nearest free face; forces act on free faces: move it onto one");
}

TEST(LoadsSceneTest, SurchargesThatLoadNothingAreRefused) {
  for (const std::string_view load :
       {"{ on = \"top\", within = { min = [50, 50, 0], max = [60, 60, 9] }, pressure = 1 }",
        "{ on = \"east\", pressure = 1 }"}) {
    const Scene scene = scene_of(with_box(fmt::format("[stability]\nfree = [\"top\"]\nsurcharge = [{}]\n", load)));
    StageTimer timer;
    Progress progress{ProgressStyle::quiet};
    const auto result = run(scene, {}, timer, progress);
    ASSERT_FALSE(result.has_value()) << load;
    EXPECT_NE(describe(result.error().at(0)).find("stability.surcharge[1]: loads nothing: no free face lies there"),
              std::string::npos);
  }
}

TEST(LoadsSceneTest, MistakesAreToldByKey) {
  const auto told = [](std::string_view more, std::string_view part) {
    const std::string message = error_of(with_box(more));
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  told("[stability]\nwater = { unit_weight = 9810 }\n", "stability.water");
  told("[[load]]\nseismic = [0.1, 0, 0]\n", "load[1].name");
  told("[[load]]\nname = \"a\"\ncombine = { b = 1 }\n[[load]]\nname = \"b\"\n", "load[1].combine.b");
  told("[[load]]\nname = \"base\"\n", "load[1].name");
  told("[stability]\nsurcharge = [{ on = \"topp\", pressure = 1 }]\n", "did you mean \"top\"");
  told("[stability]\nsurcharge = [{ on = \"top\" }]\n", "traction");
  told("[joints.default]\njrc = 8\n", "joints.default.jcs");
  told("[joints.default]\njrc = 8\njcs = 5e6\ncohesion = 3\n", "joints.default.cohesion");
  told("[stability]\nline = [{ from = [1,1,6], to = [1,1,6], force_per_metre = [0,0,-1] }]\n", "stability.line[1].to");
  told("[stability]\nwater = { pressures = { Q = 1 } }\n", "stability.water.pressures.Q");
}

// A slab of 1 m in the floor, under a table 3 m above it: 39 kPa below it against a weight of 26 kPa.
TEST(LoadsScene, WaterThatLiftsTheFloorIsSaid) {
  const auto wall = [](const std::string& at, double direction) {
    return fmt::format("[[joint]]\nplane = {{ through = [{}, 5], dip = 90, dip_direction = {} }}\n", at, direction);
  };
  const std::string slab = with_box("[[joint]]\nplane = { through = [4, 4, 5], dip = 0, dip_direction = 0 }\n" +
                                    wall("2, 4", 90) + wall("6, 4", 90) + wall("4, 2", 0) + wall("4, 6", 0) +
                                    "[joints.default]\nfriction = 30\n[stability]\nfree = [\"top\"]\n");
  const std::string_view lifted = "water lifts 1 key block (16 m3)";
  EXPECT_EQ(notes_with(run_of(slab + "water = { table = 9 }\n"), lifted), 1U);
  EXPECT_EQ(notes_with(run_of(slab + "water = { table = 9, free_faces = true }\n"), "water lifts"), 0U);
  EXPECT_EQ(notes_with(run_of(slab + "water = { table = 7 }\n"), "water lifts"), 0U);
  const RunResult flood = run_of(slab + "[[load]]\nname = \"flood\"\nwater = { table = 9 }\n");
  EXPECT_EQ(notes_with(flood, lifted), 1U);
  EXPECT_EQ(notes_with(flood, "load case flood: water lifts"), 1U);
  // Ensembles count it under each load case.
  const Scene ensemble =
      scene_of(slab + "[[load]]\nname = \"flood\"\nwater = { table = 9 }\n[monte_carlo]\nrealizations = 2\n");
  EXPECT_FALSE(ensemble_options_of(ensemble).openings);
  const stochastic::Record record = make_record(ensemble, shared_by_realizations(ensemble), 1);
  EXPECT_EQ(record.all.count, 0U);
  ASSERT_EQ(record.cases.size(), 1U);
  EXPECT_EQ(record.cases[0].count, 1U);
  EXPECT_EQ(record.cases[0].lifting, 1U);
  // What an earthquake lifts is no matter of water.
  EXPECT_EQ(notes_with(run_of(slab + "seismic = [0, 0, 1.5]\n"), "water lifts"), 0U);
}

// A slab on 20 degrees with 30 of friction.
const std::string slab_on_twenty = R"([domain]
box = { min = [0, 0, 0], max = [8, 8, 6] }
[[joint]]
plane = { through = [4, 4, 3], dip = 20, dip_direction = 90 }
[joints.default]
friction = 30
[stability]
free = ["top", "east", "west", "north", "south"]
)";

// A depth in place of a level, an earthquake that pushes the rock into the slope: nothing moves, and the note says why.
TEST(LoadsScene, CasesThatChangeNothingOrHelpAreSaid) {
  const auto load = [](std::string_view what) { return fmt::format("[[load]]\nname = \"a\"\n{}\n", what); };
  const auto run_with = [&](std::string_view what) { return run_of(slab_on_twenty + load(what)); };
  constexpr std::string_view nothing = "load case a changes the factor of safety of no block";
  const RunResult deep = run_with("water = { table = 1 }");  // the joint lies at 1.54 m and more
  EXPECT_EQ(notes_with(deep, "load case a changes the factor of safety of no block: its water (table = 1)"), 1U);
  EXPECT_EQ(notes_with(run_with("water = { table = 3 }"), nothing), 0U);
  EXPECT_EQ(notes_with(run_with("seismic = [0, 0, 0]"), nothing), 1U);
  EXPECT_EQ(notes_with(run_with("seismic = [0, 0, 0]"), "its water"), 0U);
  EXPECT_EQ(notes_with(run_with("target = { sliding = 1.7 }"), nothing), 0U);  // it is there for that
  constexpr std::string_view sign = "check its sign";
  EXPECT_EQ(notes_with(run_with("seismic = [-0.1, 0, 0]"), sign), 1U);
  EXPECT_EQ(notes_with(run_with("seismic = [0.1, 0, 0]"), sign), 0U);
  EXPECT_EQ(notes_with(run_with("water = { table = 3 }"), sign), 0U);
  // What slides with friction alone has the same factor at any weight, and less to be held at less of it.
  std::string sliding = slab_on_twenty;
  sliding.replace(sliding.find("friction = 30"), 13, "friction = 10");
  EXPECT_EQ(notes_with(run_of(sliding + load("seismic = [0, 0, 0.5]")), sign), 1U);
  EXPECT_EQ(notes_with(run_of(sliding + load("seismic = [0, 0, -0.5]")), sign), 0U);
}

// A slab on 20 degrees with 30 of friction: 1.586. What a case does not state is that of [stability].
TEST(LoadsScene, ACaseMayHaveTargetsOfItsOwn) {
  const std::string slab = slab_on_twenty + R"(target = { falling = 2, sliding = 1.3 }
[[load]]
name = "strict"
target = { sliding = 1.7 }
[[load]]
name = "short"
target = { falling = 1.2, sliding = 1.1 }
[[load]]
name = "plain"
[support]
shotcrete = { thickness = 0.1, strength = 1e5, on = "all" }
)";
  const Figures figures = run_of(slab).figures;
  EXPECT_EQ(figures.key_blocks->below_target, 0U);
  EXPECT_EQ(figures.support->blocks, 0U);
  const std::array<Targets, 3> targets{{{2, 1.7}, {1.2, 1.1}, {2, 1.3}}};
  ASSERT_EQ(figures.load_cases.size(), targets.size());
  ASSERT_EQ(figures.support_cases.size(), targets.size());
  for (std::size_t k = 0; k < targets.size(); ++k) {
    SCOPED_TRACE(figures.load_cases[k].name);
    EXPECT_EQ(figures.load_cases[k].figures.below_target, k == 0 ? 1U : 0U);
    EXPECT_EQ(figures.support_cases[k].figures.blocks, k == 0 ? 1U : 0U);
    EXPECT_EQ(figures.support_cases[k].figures.targets.falling, targets[k].falling);
    EXPECT_EQ(figures.support_cases[k].figures.targets.sliding, targets[k].sliding);
  }
  EXPECT_EQ(notes_with(run_of(slab + "[[load]]\nname = \"none\"\ntarget = { sliding = 0.9 }\n"),
                       "asks for a factor of safety below 1"),
            1U);
}

// Loads add up: an earthquake of nothing does not take that of the base case away.
TEST(LoadsScene, ACaseWithoutAnEarthquakeOfItsOwnHasThatOfTheBaseCase) {
  const auto told = [](std::string_view base, std::string_view own) {
    const Scene scene = scene_of(with_box("[stability]\nfree = [\"top\"]\nseismic = " + std::string{base} +
                                          "\n[[load]]\nname = \"calm\"\nseismic = " + std::string{own} + "\n"));
    EXPECT_EQ(
        scene.stability->cases.at(0).loads.body.seismic(),
        scene.stability->loads.body.seismic() + (own == "[0.1, 0, 0]" ? geometry::Vec3{0.1, 0, 0} : geometry::Vec3{}));
    return std::ranges::count_if(scene.notes, [](const Problem& note) {
      return note.what == "adds nothing to the earthquake of [stability], which acts in this case as well";
    });
  };
  EXPECT_EQ(told("[0.2, 0, 0]", "[0, 0, 0]"), 1);
  EXPECT_EQ(told("[0.2, 0, 0]", "[0.1, 0, 0]"), 0);
  EXPECT_EQ(told("[0, 0, 0]", "[0, 0, 0]"), 0);
}

}  // namespace
}  // namespace cleave::scene::test::loads_scene_test
