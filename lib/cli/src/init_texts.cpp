#include "init_texts.hpp"

#include <algorithm>
#include <array>
#include <iterator>

#include "cleave/scene2d/bodies.hpp"
#include "cleave/scene2d/contact.hpp"
#include "cleave/scene3d/key_tables.hpp"

namespace cleave::cli {
namespace {

constexpr std::string_view tunnel =
    R"toml(# A tunnel in fractured rock: three random joint sets, a horseshoe tunnel through the middle.
# Run it:  cleave run tunnel.toml -o out     then open out/report.html
# SI units (metres, pascals, kg/m3), angles in degrees. x = east, y = north, z = up.
schema = 1
title = "Tunnel"
seed = 1                       # another seed gives another network of the same statistics

[domain]
box = { min = [0, 0, 0], max = [40, 40, 30] }

[[joint_set]]
name = "A"
model = "baecher"              # centres, orientations and sizes independent of each other
orientation = { dip = 30, dip_direction = 30, distribution = "uniform", dip_range = 15, dip_direction_range = 15 }
shape = "rectangle"            # or square, disc, ellipse, polygon(6)
size = { distribution = "normal", mean = 15, std = 5, min = 1, max = 40 }   # m, both sides drawn from it
intensity = { p32 = 0.4 }      # m2 of joint in a m3 of rock; or count = 100, p30, p10, spacing

[[joint_set]]
name = "B"
orientation = { dip = 45, dip_direction = 150, distribution = "fisher", kappa = 40 }
size = { distribution = "exponential", mean = 12, min = 5, max = 40 }
intensity = { p32 = 0.4 }

[[joint_set]]
name = "C"
orientation = { dip = 60, dip_direction = 270, distribution = "fisher", kappa = 40 }
size = { distribution = "exponential", mean = 12, min = 5, max = 40 }
intensity = { p32 = 0.4 }

[joints.default]               # [joints.A] for one set alone
friction = { distribution = "uniform", min = 20, max = 30 }   # degrees, one value a joint; or just a number
cohesion = 0

[rock]
density = 2700

[[excavation]]
name = "tunnel"
kind = "tunnel"
section = { shape = "horseshoe", width = 8, height = 8 }
axis = [[20, 0, 15], [20, 40, 15]]

[stability]
gravity = 9.81
max_batches = 50
)toml";

constexpr std::string_view slope =
    R"toml(# A rock slope of 70 degrees, 20 m high, with two joint sets: which blocks can slide out of it?
# Run it:  cleave run slope.toml -o out     then open out/report.html
# SI units (metres, pascals, kg/m3), angles in degrees. x = east, y = north, z = up.
schema = 1
title = "Slope"
seed = 1

[domain]
# Eight corners; bit 0, 1, 2 of a corner's number = its x, y, z side. The east side leans back by 20 / tan 70 = 7.279405 m.
corners = [
  [0, 0, 0], [40, 0, 0], [0, 40, 0], [40, 40, 0],
  [0, 0, 20], [32.720595, 0, 20], [0, 40, 20], [32.720595, 40, 20],
]

[[joint_set]]
name = "bedding"
orientation = { dip = 40, dip_direction = 80, distribution = "fisher", kappa = 100 }
shape = "rectangle"
size = { distribution = "constant", mean = 60 }
intensity = { spacing = 4 }

[[joint_set]]
name = "cross"
orientation = { dip = 75, dip_direction = 180, distribution = "fisher", kappa = 60 }
shape = "disc"
size = { distribution = "lognormal", mean = 30, std = 10, min = 2, max = 80 }   # diameter
intensity = { p32 = 0.15 }

[[joint]]                      # one joint that was measured
plane = { through = [25, 20, 0], dip = 80, dip_direction = 260 }
set = "fault"

[joints.default]
friction = 30
cohesion = 0

[joints.fault]
friction = 18
cohesion = 2e3

[rock]
density = 2600

[stability]
free = ["top", "east"]         # all other sides of the domain are rock that stays
seismic = [0, 0, 0]            # pseudo-static force / weight, for example [0.1, 0, 0]
)toml";

constexpr std::string_view wedge =
    R"toml(# One wedge between two joints on a slope: the textbook case with a known answer.
# Joints 60/045 and 60/135, slope 70/090, friction 30 degrees: the wedge slides along their line, to the east at 50.8 degrees
# down, with a factor of safety of (4 / sqrt 15) tan 30 = 0.596.
# Run it:  cleave run wedge.toml -o out     then look at out/key_blocks.csv
schema = 1
title = "Wedge on a slope"

[domain]
# A block of 10 m height; the east side is the slope: it leans back by 10 / tan 70 = 3.639702 m.
corners = [
  [0, 0, 0], [20, 0, 0], [0, 20, 0], [20, 20, 0],
  [0, 0, 10], [16.360298, 0, 10], [0, 20, 10], [16.360298, 20, 10],
]

[[joint]]
plane = { through = [19.5, 10, 1], dip = 60, dip_direction = 45 }
set = "north-east"

[[joint]]
plane = { through = [19.5, 10, 1], dip = 60, dip_direction = 135 }
set = "south-east"

[joints.default]
friction = 30
cohesion = 0

[rock]
density = 2700

[stability]
free = ["top", "east"]
)toml";

constexpr std::string_view network =
    R"toml(# A fracture network without an excavation: how many blocks does it cut, and how large are they?
# Run it:  cleave run network.toml -o out     then open out/report.html
schema = 1
title = "Network"
seed = 1

[domain]
box = { min = [0, 0, 0], max = [50, 50, 50] }

[[joint_set]]
name = "A"
orientation = { dip = 80, dip_direction = 90, distribution = "fisher", kappa = 30 }
shape = "disc"
size = { distribution = "exponential", mean = 30, min = 2, max = 100 }   # diameter, metres
intensity = { p32 = 0.2 }

[[joint_set]]
name = "B"
orientation = { dip = 85, dip_direction = 0, distribution = "fisher", kappa = 30 }
shape = "disc"
size = { distribution = "exponential", mean = 30, min = 2, max = 100 }
intensity = { p32 = 0.2 }

[[joint_set]]
name = "C"
orientation = { dip = 5, dip_direction = 0, distribution = "fisher", kappa = 30 }
shape = "rectangle"
size = { distribution = "power", exponent = 2.5, min = 10, max = 100 }
intensity = { p32 = 0.2 }

# Joints from a file instead: each face of an OBJ file is one joint, each row of a CSV file one disc, rectangle or plane.
# [[joint]]
# file = "joints.obj"
# set = "measured"
)toml";

constexpr std::string_view bodies =
    R"toml(# Plane elastic bodies by boundary elements. x to the right, y up, metres; forces per metre of thickness.
# Run it: cleave run SCENE.toml -o OUT
schema = 1
title = "Loaded bracket"

[rock]
density = 2700
young = 60e9
poisson = 0.25

[elastic]
plane = "strain"               # or "stress"
gravity = 9.81
# order = "quadratic"          # constant, linear
# element = 0.2                # longest element, metres
tolerance = 1e-3               # refine until displacements change by less (relative)
points = [ { name = "tip", at = [4, 1] }, { name = "middle", at = [2, 0.5] } ]

# With this table the scene moves: bodies vibrate, fall or swing.
# [elastic.time]
# end = 0.1                    # s
# step = 1e-4                  # s
# scheme = "generalized_alpha" # newmark, houbolt, backward_euler
# rho = 0.8                    # radius at infinite frequency
# damping = { share = 0.02 }   # of critical, in every mode

[[body]]
name = "bracket"
outline = [[0, 0], [4, 0], [4, 1], [0, 1]]            # counter-clockwise; side 1 runs from the first corner to the second
round_holes = [ { centre = [1, 0.5], radius = 0.2 } ]
support = [ { side = 4, kind = "fixed" } ]            # roller symmetry spring displacement bonded pin
load = [ { side = 3, pressure = 1e5 },                # Pa on the top
         { side = 2, traction = [0, -2e5] } ]         # Pa; a point force: { at = [4, 0.5], force = [0, -2e5] }, N per metre
)toml";

constexpr std::string_view contact =
    R"toml(# Bodies that touch, slide, fall and come to rest. x to the right, y up, metres; masses and forces per metre.
# Run it: cleave run SCENE.toml -o OUT     then open OUT/report.html and press Play.
schema = 1
title = "Columns on a slope"

[rock]
density = 2600
# young = 20e9                 # Pa; with poisson, blocks deform where strains are worth it (cleave plan says so)
# poisson = 0.25

[joints.default]
friction = 35
cohesion = 0
tension = 0

[contact]
duration = 2                   # s; or static = true: relax to rest
# step = 0.01                  # s; default from sizes and speeds
# max_step = 0.05              # s: steps grow while little moves
# rigid = "auto"               # true, false
# gravity = 9.81               # m/s2 downwards, or [x, y]
# restitution = 0              # of impacts
points = [ { name = "top", at = [3.24, 4.95], body = "tall" } ]

[[body]]
name = "slope"
fixed = true
outline = [[0, 0], [8, 0], [8, 3]]                            # counter-clockwise

[[body]]
name = "low"                                                  # side 1 runs from the first corner to the second
rectangle = { corner = [2, 0.75], width = 1, height = 1, angle = 20.556045219583467 }

[[body]]
name = "tall"
rectangle = { corner = [4, 1.5], width = 1, height = 3.5, angle = 20.556045219583467 }

# [[body]]                     # an arch: one stone, turned eleven times more
# name = "stone"
# voussoir = { centre = [0, 0], radius = 5, thickness = 0.6, from = 0, to = 15 }
# repeat = { count = 12, rotation = 15, centre = [0, 0] }
)toml";

constexpr std::string_view monte_carlo =
    R"toml(# How likely is it that a block of a given size falls into a tunnel? Many random networks of the same statistics.
# Run it:  cleave run monte-carlo.toml -o out     then open out/report.html. Ended early, the same command goes on.
# One of the realizations as a full run:  cleave replay out --realization 7
# SI units (metres, pascals, kg/m3), angles in degrees. x = east, y = north, z = up.
schema = 1
title = "Tunnel, many realizations"
seed = 1

[domain]
box = { min = [0, 0, 0], max = [24, 20, 24] }

[[joint_set]]
name = "A"
orientation = { dip = 30, dip_direction = 30, distribution = "fisher", kappa = 40 }
shape = "disc"
size = { distribution = "lognormal", mean = 15, std = 6, min = 2, max = 40 }   # diameter, m
intensity = { p32 = 0.2 }

[[joint_set]]
name = "B"
orientation = { dip = 60, dip_direction = 150, distribution = "fisher", kappa = 40 }
shape = "disc"
size = { distribution = "lognormal", mean = 15, std = 6, min = 2, max = 40 }
intensity = { p32 = 0.2 }

[[joint_set]]
name = "C"
orientation = { dip = 70, dip_direction = 270, distribution = "fisher", kappa = 40 }
shape = "disc"
size = { distribution = "lognormal", mean = 15, std = 6, min = 2, max = 40 }
intensity = { p32 = 0.2 }

[rock]
density = 2700

[joints.default]
friction = { distribution = "normal", mean = 28, std = 3, min = 15, max = 40 }   # degrees, one value a joint
cohesion = 0                   # Pa; a law here, too, if you like

[[excavation]]
name = "tunnel"
kind = "tunnel"
section = { shape = "horseshoe", width = 6, height = 6 }
axis = [[12, 0, 12], [12, 20, 12]]

[monte_carlo]
realizations = 100             # or stop = { quantity = "key_block_volume", relative_half_width = 0.1, max = 5000 }
volume_thresholds = [0.1, 1, 10]
chainage_bins = 10
)toml";

constexpr std::array<InitText, 7> texts{{{"tunnel", tunnel, &scene::scene_keys},
                                         {"slope", slope, &scene::scene_keys},
                                         {"wedge", wedge, &scene::scene_keys},
                                         {"network", network, &scene::scene_keys},
                                         {"monte-carlo", monte_carlo, &scene::scene_keys},
                                         {"bodies", bodies, &scene::elastic_scene_keys},
                                         {"contact", contact, &scene::contact_scene_keys}}};

}  // namespace

std::vector<InitText> init_texts() {
  std::vector<InitText> all{texts.begin(), texts.end()};
  std::ranges::copy(special_init_texts(), std::back_inserter(all));
  std::ranges::copy(survey_init_texts(), std::back_inserter(all));
  return all;
}

}  // namespace cleave::cli
