#include "init_texts.hpp"

#include <array>

#include "cleave/field_data/survey_file.hpp"
#include "cleave/scene3d/key_tables.hpp"

namespace cleave::cli {
namespace {

constexpr std::string_view support =
    R"toml(# A tunnel whose key blocks are held by bolts and shotcrete: what holds, what does not, and what that takes.
# Run it:  cleave run support.toml -o out     then open out/report.html, section Support
# SI units (metres, newtons, pascals), angles in degrees; texts with units are read too: "200 kN", "75 mm".
schema = 1
title = "Tunnel with support"
seed = 1

[domain]
box = { min = [0, 0, 0], max = [30, 30, 30] }

[[joint_set]]
name = "A"
orientation = { dip = 40, dip_direction = 30, distribution = "fisher", kappa = 60 }
shape = "disc"
size = { distribution = "lognormal", mean = 12, std = 4, min = 2, max = 30 }   # diameter
intensity = { p32 = 0.4 }

[[joint_set]]
name = "B"
orientation = { dip = 60, dip_direction = 150, distribution = "fisher", kappa = 60 }
shape = "disc"
size = { distribution = "lognormal", mean = 12, std = 4, min = 2, max = 30 }
intensity = { p32 = 0.4 }

[[joint_set]]
name = "C"
orientation = { dip = 65, dip_direction = 270, distribution = "fisher", kappa = 60 }
shape = "disc"
size = { distribution = "lognormal", mean = 12, std = 4, min = 2, max = 30 }
intensity = { p32 = 0.4 }

[joints.default]
friction = 30
cohesion = 0

[rock]
density = 2700

[[excavation]]
name = "tunnel"
kind = "tunnel"
section = { shape = "horseshoe", width = 6, height = 6 }
axis = [[15, 0, 15], [15, 30, 15]]

[stability]
target = { falling = 1.5, sliding = 1.3 }   # factors of safety that support has to reach

[support]
shotcrete = { thickness = 0.05, strength = 1e6 }

[[support.bolts]]
name = "pattern"
tunnel = "tunnel"
spacing = [1.5, 1.5]
length = 4
tendon_capacity = 200e3
plate_capacity = 100e3
bond_strength = 200e3
anchorage = 0.5
)toml";

constexpr std::string_view survey =
    R"toml(# Field data to joint sets: orientations are sorted into sets, and sets.toml is written for a scene to include.
# First the measurements:  cleave init csv > joints.csv   (or your own table)
# Run it:  cleave survey survey.toml -o out     then open out/report.html and use out/sets.toml:  include = ["sets.toml"]
schema = 1
title = "Survey"
seed = 1

[[orientations]]
file = "joints.csv"            # columns dip and dip_direction (or strike; or trend and plunge of the pole), set
# wrap = true                  # accept angles outside 0 to 90 and 0 to 360

# [[scanline]]                 # joints met by a line: spacings and trace lengths
# file = "line.csv"            # column distance (m), with dip, dip_direction and length where measured
# trend = 40                   # degrees
# plunge = 0
# length = 30                  # m

# [[window]]                   # a mapped wall: traces give sizes and intensity
# traces = "traces.geojson"
# dip = 90
# dip_direction = 180
)toml";

constexpr std::string_view bench =
    R"toml(# A pit of two benches in jointed rock: bench heights, face angles and berms, and what slides off each bench.
# Run it:  cleave run bench.toml -o out     then open out/report.html
# SI units (metres, pascals, kg/m3), angles in degrees. x = east, y = north, z = up.
schema = 1
title = "Two benches"
seed = 2

[domain]
box = { min = [0, 0, 0], max = [80, 80, 40] }

[[joint_set]]
name = "bedding"
orientation = { dip = 45, dip_direction = 90, distribution = "fisher", kappa = 200 }
shape = "rectangle"
size = { distribution = "constant", mean = 20 }
intensity = { p32 = 0.35 }

[[joint_set]]
name = "cross"
orientation = { dip = 85, dip_direction = 0, distribution = "fisher", kappa = 100 }
shape = "rectangle"
size = { distribution = "constant", mean = 20 }
intensity = { p32 = 0.35 }

[[joint_set]]
name = "back"
orientation = { dip = 80, dip_direction = 270, distribution = "fisher", kappa = 100 }
shape = "rectangle"
size = { distribution = "constant", mean = 20 }
intensity = { p32 = 0.25 }

[joints.default]
friction = 32
cohesion = 0

[rock]
density = 2650

[[excavation]]
name = "pit"
kind = "benches"
plan = [[20, 20], [60, 20], [60, 60], [20, 60]]   # the crest, seen from above
top = 40
height = 10
width = 5
angle = 70
count = 2
stage_each = true              # one bench after the other: blocks_stage_1.vtu, ...

[stability]
)toml";

constexpr std::string_view csv =
    R"toml(# Joints that were measured, one a row; a scene reads them by  [[joint]]  file = "joints.csv", a survey by
# [[orientations]]  file = "joints.csv". Keep it by:  cleave init csv > joints.csv
# Units may stand behind the names. Diameter (or radius, or side_a and side_b) empty: through the whole domain.
# x, y, z: the middle of the joint. friction, cohesion, set and id may be left out.
dip (deg),dip_direction (deg),x (m),y (m),z (m),diameter (m),friction (deg),cohesion (kPa),set,id
58,42,12.0,8.5,10.2,9,32,0,A,1
61,38,16.5,14.0,11.8,7,32,0,A,2
55,47,9.0,18.5,9.4,12,32,0,A,3
63,44,14.2,22.0,12.6,8,32,0,A,4
59,40,18.8,11.3,8.9,10,32,0,A,5
72,155,11.5,9.0,11.0,8,28,5,B,6
75,148,15.0,15.5,10.0,11,28,5,B,7
70,152,17.2,20.5,9.0,9,28,5,B,8
74,158,10.4,24.0,12.2,7,28,5,B,9
71,150,13.6,5.5,10.6,10,28,5,B,10
8,270,14.0,12.0,13.0,14,35,0,C,11
5,300,13.0,18.0,7.5,16,35,0,C,12
10,255,16.0,6.0,14.5,12,35,0,C,13
6,280,12.5,25.0,9.8,15,35,0,C,14
9,262,15.5,9.5,12.4,13,35,0,C,15
)toml";

constexpr std::string_view water =
    R"toml(# A block on a slope with water behind it, and an earthquake: what both do to its factor of safety.
# Run it:  cleave run water.toml -o out     then look at out/key_blocks.csv and out/load_cases.csv
# Dry it slides on a joint of 35 degrees with friction 40: tan 40 / tan 35 = 1.198.
# SI units (metres, pascals, kg/m3), angles in degrees. x = east, y = north, z = up.
schema = 1
title = "Block with water and earthquake"

[domain]
box = { min = [0, 0, 0], max = [20, 12, 12] }

[[joint]]                      # it slides on this one
plane = { through = [20, 6, 1], dip = 35, dip_direction = 90 }
set = "base"

[[joint]]                      # tension crack behind it
plane = { through = [10, 6, 0], dip = 90, dip_direction = 90 }
set = "crack"

[[joint]]                      # both sides
plane = { through = [0, 2, 0], dip = 90, dip_direction = 0 }
set = "sides"
[[joint]]
plane = { through = [0, 10, 0], dip = 90, dip_direction = 0 }
set = "sides"

[joints.default]
friction = 40
cohesion = 0

[rock]
density = 2600

[stability]
free = ["top", "east"]

[[load]]
name = "water"
water = { table = 9 }          # z of the water level in the joints; unit_weight = 9810 N/m3

[[load]]
name = "earthquake"
seismic = [0.1, 0, 0]          # pseudo-static force over weight

[[load]]
name = "both"
water = { table = 9 }
seismic = [0.1, 0, 0]
)toml";

constexpr std::string_view motion =
    R"toml(# Key blocks of a slope let go: they slide until they rest. See docs/motion.md.
schema = 1
title = "Blocks in motion"

[domain]
box = { min = [0, 0, 0], max = [30, 10, 14] }

[[joint]]                      # what the blocks slide on
plane = { through = [14, 5, 6], dip = 36, dip_direction = 90 }

[[joint]]
plane = { through = [9, 5, 8], dip = 80, dip_direction = 270 }

[[joint]]
plane = { through = [12, 3.5, 6], dip = 88, dip_direction = 180 }

[[joint]]
plane = { through = [12, 7.5, 6], dip = 88, dip_direction = 0 }

[joints.default]
friction = 28
cohesion = 0

[rock]
density = 2600

[[excavation]]
name = "slope"
kind = "slope"
profile = { direction = 90, points = [[0, 12], [11, 12], [15, 4], [30, 4]] }

[stability]

[motion]
release = "batches"            # or "all", "groups", "stage"
until = "rest"                 # after `duration` at the latest
duration = 4
step = 0.01                    # s, the longest
restitution = 0
surface_friction = 35          # degrees, of faces that are no joints
)toml";

constexpr std::array<InitText, 6> texts{{{"support", support, &scene::scene_keys},
                                         {"survey", survey, &scene::survey_keys},
                                         {"bench", bench, &scene::scene_keys},
                                         {"csv", csv, nullptr},
                                         {"water", water, &scene::scene_keys},
                                         {"motion", motion, &scene::scene_keys}}};

}  // namespace

std::span<const InitText> special_init_texts() noexcept { return texts; }

}  // namespace cleave::cli
