#include "init_texts.hpp"

#include <array>

#include "cleave/field_data/survey_file.hpp"

/// Surveys by what was measured: a survey file, and the table that it reads.
namespace cleave::cli {
namespace {

constexpr std::string_view scanline =
    R"toml(# A scanline: a tape along a wall, and every joint that it meets, with its trace. Spacings give how many joints there
# are, traces give sizes.
# First the measurements:  cleave init scanline-csv > scanline.csv   (or your own table)
# Run it:  cleave survey scanline.toml -o out     then open out/report.html and use out/sets.toml:  include = ["sets.toml"]
schema = 1
title = "Scanline"

[[scanline]]
name = "east wall"
trend = 25
plunge = 0
length = 40
file = "scanline.csv"
truncation = 0.4
declination = 2.5

[[set]]                        # without sets: those of the column `set`, or give `clusters = 2` at the top
name = "A"
polygon = [[190, 5], [260, 5], [260, 60], [190, 60]]

[[set]]
name = "B"
polygon = [[150, 0], [180, 0], [180, 40], [150, 40]]
)toml";

constexpr std::string_view scanline_csv =
    R"toml(# Joints met by a tape, one a row. Keep it by:  cleave init scanline-csv > scanline.csv
# ends: how many ends of the trace were seen (0, 1, 2).
distance (m),dip (deg),dip_direction (deg),length (m),ends,set
1.46,59,33,7.1,1,A
1.68,74,358,1.6,1,B
3.02,76,356,4.5,2,B
4.51,80,352,2.4,1,B
5.30,67,46,7.2,2,A
6.70,79,352,1.0,2,B
8.76,65,50,0.7,2,A
10.04,64,45,0.8,1,A
10.80,76,2,13.1,1,B
12.22,66,56,0.4,2,A
12.42,72,45,0.6,2,A
18.48,63,41,8.1,2,A
19.01,71,357,2.4,2,B
19.76,75,357,0.9,0,B
20.18,64,61,2.9,0,A
23.55,58,51,0.5,2,A
23.65,57,54,0.4,2,A
24.27,56,57,1.6,2,A
25.25,59,43,9.2,2,A
26.83,73,349,0.7,2,B
27.33,61,44,3.9,2,A
27.53,80,341,0.8,1,B
28.62,62,45,0.5,0,A
28.95,60,29,7.1,2,A
29.61,50,43,0.4,1,A
30.81,75,345,2.6,2,B
32.00,61,44,7.3,2,A
32.63,50,35,1.0,1,A
33.50,77,3,2.6,2,B
33.81,58,51,0.5,2,A
34.05,52,23,0.4,2,A
34.26,86,352,1.6,2,B
36.00,78,5,1.1,1,B
38.30,80,349,1.9,1,B
)toml";

constexpr std::string_view borehole =
    R"toml(# A borehole with oriented core: each joint by its angles to the core. Traces are not seen, so that sizes are not known.
# First the measurements:  cleave init borehole-csv > borehole.csv   (or your own table)
# Run it:  cleave survey borehole.toml -o out     then open out/report.html and use out/sets.toml:  include = ["sets.toml"]
schema = 1
title = "Borehole"

[[borehole]]
name = "BH 1"
trend = 120
plunge = 65
length = 60
reference = "bottom"
file = "borehole.csv"

[[scanline]]                   # sizes come from traces elsewhere: a tape along an outcrop with the same sets
trend = 25
plunge = 0
length = 40
file = "scanline.csv"
truncation = 0.4
)toml";

constexpr std::string_view borehole_csv =
    R"toml(# Joints of an oriented core, one a row. Keep it by:  cleave init borehole-csv > borehole.csv
depth (m),alpha (deg),beta (deg),set
0.14,21,71,B
0.84,33,120,A
1.72,27,121,A
2.01,27,121,A
3.97,29,61,B
4.21,16,119,A
4.34,21,109,A
4.40,8,110,A
5.89,23,117,A
5.91,22,119,A
6.21,20,119,A
7.08,27,126,A
8.10,26,115,A
8.96,24,64,B
9.58,26,65,B
9.62,24,121,A
9.97,27,72,B
10.25,28,77,B
18.10,11,113,A
18.13,32,57,B
19.83,20,122,A
19.88,23,64,B
19.92,20,55,B
20.30,11,118,A
21.02,19,112,A
25.46,20,118,A
25.79,17,112,A
26.50,17,61,B
27.82,27,58,B
31.29,21,120,A
32.68,21,113,A
32.81,22,133,A
34.79,16,119,A
34.94,10,118,A
35.22,26,119,A
35.51,22,115,A
36.96,15,120,A
37.29,16,133,A
39.57,19,130,A
39.90,25,128,A
41.34,4,122,A
41.68,17,128,A
42.23,20,120,A
42.37,24,118,A
42.52,18,64,B
43.65,22,124,A
45.19,20,54,B
47.62,27,48,B
48.13,26,122,A
48.49,34,52,B
50.95,18,120,A
52.59,30,73,B
54.30,20,113,A
54.59,27,106,A
54.90,12,110,A
56.19,22,120,A
56.25,17,115,A
56.57,33,62,B
57.53,32,62,B
57.70,41,52,B
57.95,16,128,A
59.23,20,122,A
)toml";

constexpr std::string_view window =
    R"toml(# A mapped wall: traces in a window give sizes and intensity; what leaves the window is corrected for.
# First the traces:  cleave init window-csv > window.csv   (or a GeoJSON of your own)
# Run it:  cleave survey window.toml -o out     then open out/report.html and use out/sets.toml:  include = ["sets.toml"]
schema = 1
title = "Window"

[[window]]
name = "north wall"
traces = "window.csv"          # x1, y1, x2, y2 (m): x along the strike of the wall, y up its slope
rectangle = { min = [0, 0], max = [12, 5] }
dip = 85
dip_direction = 350
border = 0.02
truncation = 0.25

[[set]]                        # traces tell no dip: as a compass on some joints has it; each trace goes to the set
name = "A"                     # that leaves such traces most likely
dip = 65
dip_direction = 105
kappa = 30

[[set]]                        # on maps of level ground  azimuth = [from, to]  can stand instead of dip_direction, kappa
name = "B"
dip = 75
dip_direction = 217
kappa = 30
)toml";

constexpr std::string_view window_csv =
    R"toml(# Traces on a wall of 12 by 5 m, one a row. Keep it by:  cleave init window-csv > window.csv
x1 (m),y1 (m),x2 (m),y2 (m)
3.50,0.00,2.79,1.91
9.51,0.26,8.23,2.32
9.57,3.44,10.29,5.00
2.63,4.08,3.32,5.00
1.91,0.40,0.85,2.87
10.37,3.70,11.02,5.00
4.13,1.10,4.71,1.91
7.46,0.00,7.59,0.23
11.81,0.00,11.13,2.19
0.54,4.08,0.93,4.50
3.94,0.00,4.35,0.56
5.06,0.36,4.93,0.65
2.95,1.88,2.75,2.36
0.02,2.66,0.60,3.88
6.33,0.00,7.23,1.53
5.73,2.90,5.97,3.33
4.00,3.01,3.14,5.00
2.40,2.92,3.26,5.00
-0.00,1.78,0.77,2.89
0.01,0.00,0.40,0.65
10.13,0.00,9.85,0.71
11.21,4.08,10.95,4.81
11.59,1.91,12.00,2.97
11.50,0.08,11.79,0.59
11.82,1.47,12.00,1.80
10.28,1.68,10.45,2.01
8.33,0.15,9.19,1.63
1.24,0.00,2.08,1.73
0.44,4.47,0.74,5.00
10.47,2.40,10.82,2.94
4.69,3.94,4.30,4.93
2.24,4.23,2.02,4.57
0.30,2.46,0.82,3.43
0.37,2.35,2.13,4.68
8.33,4.74,8.49,5.00
6.22,4.30,6.58,5.00
6.85,0.73,4.84,4.05
0.13,0.00,0.35,0.47
1.12,4.56,0.96,4.83
10.34,2.28,9.92,3.44
0.23,0.68,0.59,1.33
1.10,4.09,1.41,4.56
)toml";

constexpr std::array<InitText, 6> texts{{{"scanline", scanline, &scene::survey_keys},
                                         {"scanline-csv", scanline_csv, nullptr},
                                         {"borehole", borehole, &scene::survey_keys},
                                         {"borehole-csv", borehole_csv, nullptr},
                                         {"window", window, &scene::survey_keys},
                                         {"window-csv", window_csv, nullptr}}};

}  // namespace

std::span<const InitText> survey_init_texts() noexcept { return texts; }

}  // namespace cleave::cli
