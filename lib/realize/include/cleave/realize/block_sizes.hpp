#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cleave/core/fields.hpp"
#include "cleave/core/quantity.hpp"
#include "cleave/facets/cut_input.hpp"
#include "cleave/geometry/vec3.hpp"
#include "cleave/scene3d/scene.hpp"
#include "cleave/stochastic/record.hpp"
#include "cleave/survey/traces.hpp"
#include "cleave/topology/block_complex.hpp"

/// Block sizes of a mass, and how much of each joint set is in it.
namespace cleave::scene {

/// Volumes below which so much of the blocks lies, m3.
struct Percentiles {
  static constexpr std::array<std::pair<std::string_view, double>, 11> levels{{{"p10", 0.1},
                                                                               {"p20", 0.2},
                                                                               {"p25", 0.25},
                                                                               {"p30", 0.3},
                                                                               {"p40", 0.4},
                                                                               {"p50", 0.5},
                                                                               {"p60", 0.6},
                                                                               {"p70", 0.7},
                                                                               {"p75", 0.75},
                                                                               {"p80", 0.8},
                                                                               {"p90", 0.9}}};
  std::array<double, levels.size()> values{};
  /// By its name; precondition: one of `levels`.
  [[nodiscard]] double at(std::string_view level) const;
};
template <class V>
void fields(V& v, const Percentiles& x) {
  for (std::size_t i = 0; i < Percentiles::levels.size(); ++i) v(Percentiles::levels.at(i).first, x.values.at(i));
}

/// Zingg's (1935) classes by the axes a >= b >= c of the ellipsoid of inertia, each limit 2/3.
struct ShapeClasses {
  std::uint64_t cubic = 0, platy = 0, elongated = 0, bladed = 0;
};
template <class V>
void fields(V& v, const ShapeClasses& x) {
  v("cubic", x.cubic, "b/a and c/b above 2/3");
  v("platy", x.platy, "c/b at most 2/3");
  v("elongated", x.elongated, "b/a at most 2/3");
  v("bladed", x.bladed, "both at most 2/3");
}

struct BlockSizes {
  std::uint64_t count = 0;
  bool inner = true;  ///< blocks that touch a fixed side are left out
  Percentiles by_number, by_volume;
  Length d50, d80;
  double jv = 0;
  ShapeClasses shapes;
};
template <class V>
void fields(V& v, const BlockSizes& x) {
  v("count", x.count, "blocks whose sizes these are, whole ones only");
  v("blocks", one_of(x.inner ? "inner" : "all", {"inner", "all"}),
    "inner: those that touch no fixed side of the domain; all: fewer than 30 are, so the others count too");
  v("by_number", x.by_number, "m3, below which so much of their number lies");
  v("by_volume", x.by_volume, "m3, of blocks up to which so much of their volume is made (passing)");
  v("d50_m", x.d50, "cube root of by_volume.p50");
  v("d80_m", x.d80, "cube root of by_volume.p80");
  v("jv", x.jv, "1/m, volumetric joint count: joints of each set along its mean normal, added (Palmstrom 1982)");
  v("shapes", x.shapes, "number by Zingg's classes, a >= b >= c the axes of the ellipsoid of inertia");
}
/// Of blocks that touch no fixed side where there are at least 30 of them, else of all; empty without blocks.
[[nodiscard]] std::optional<BlockSizes> block_sizes(const topology::BlockComplex& complex);
/// The box of a domain that is one, without openings and free sides: there it is known how rarely a whole block of some
/// size is met. Empty of other scenes.
[[nodiscard]] std::optional<geometry::Box> undisturbed_box(const Scene& scene);
/// Blocks that touch no fixed side, as an ensemble adds them up. With a box a block of the extents w counts |box| over
/// the volume of the places where it lies within, prod(L - w) (Miles 1974, Lantuejoul 1980): the larger a block, the
/// more of its kind are cut by a side. Gaps L - w below a hundredth of L count as that.
[[nodiscard]] stochastic::WholeBlocks tally_blocks(const topology::BlockComplex& complex,
                                                   const std::optional<geometry::Box>& box);
/// Percentiles of volumes, in any order, by number (between the values) and by volume; not empty.
[[nodiscard]] Percentiles percentiles_by_number(std::vector<double> volumes);
[[nodiscard]] Percentiles percentiles_by_volume(std::vector<double> volumes);

/// How much of a set lies in the box around the domain: means over the whole box, without the error of one line or
/// plane.
struct SetFigures {
  std::string name;
  std::uint64_t joints = 0;
  double p32 = 0, p10 = 0, p21 = 0;
};
template <class V>
void fields(V& v, const SetFigures& x) {
  v("name", x.name);
  v("joints", x.joints, "that meet the box around the domain");
  v("p32", x.p32, "1/m, area of joints in that box over its volume");
  v("p10", x.p10, "1/m, joints along their mean normal, mean over all lines that way");
  v("p21", x.p21, "1/m, length of traces on level planes, mean over all of them");
}
/// Of all sets, in their order. `set_of`: of each joint of the input.
[[nodiscard]] std::vector<SetFigures> count_all_sets(const topology::CutInput& input, const std::vector<SetId>& set_of,
                                                     const std::vector<std::string>& names);
/// Of the sets that have joints in the box.
[[nodiscard]] std::vector<SetFigures> count_sets(const topology::CutInput& input, const std::vector<SetId>& set_of,
                                                 const std::vector<std::string>& names);

/// A scanline of the scene, and which parts of it lie in the rock.
struct LineInRock {
  struct Leg {
    geometry::Vec3 from, to;
    std::vector<std::pair<double, double>> rock;  ///< along the leg from `from`, in order
  };
  std::string name;
  std::vector<Leg> legs;
};
/// Of every scanline: what is outside the domain or excavated is left out.
[[nodiscard]] std::vector<LineInRock> lines_in_rock(const Scene& scene);
/// What the joints cut a line into. A joint that a line runs along is not met. Whether a polygon is crossed is decided
/// exactly; of two polygons that share an edge through which the line goes it crosses one.
struct LinePieces {
  std::uint64_t joints = 0;
  Length length = {};          ///< of rock
  std::vector<double> pieces;  ///< in order; those at the ends of the rock included
};
[[nodiscard]] LinePieces pieces_on(const LineInRock& line, const topology::CutInput& input);

/// Joints, frequency and RQD along one line, as a log of it would have them.
struct LineFigures {
  std::string name;
  Length length = {};
  std::uint64_t joints = 0;
  survey::Estimate frequency = {}, rqd = {};
  Length mean_piece = {}, longest_piece = {};
};
template <class V>
void fields(V& v, const LineFigures& x) {
  v("name", x.name);
  v("length_m", x.length, "in the rock");
  v("joints", x.joints, "crossed");
  v("frequency_per_m", x.frequency.value.value_or(0));
  v("frequency_low", x.frequency.low, "exact Poisson interval: what the line says of the rock mass");
  v("frequency_high", x.frequency.high);
  v("rqd", x.rqd.value.value_or(0), "%, share of the line in pieces of 0.1 m and more");
  v("rqd_low", x.rqd.low);
  v("rqd_high", x.rqd.high);
  v("mean_piece_m", x.mean_piece);
  v("longest_piece_m", x.longest_piece);
}
/// Of lines that meet no rock.
[[nodiscard]] std::vector<std::string> notes_on_lines(const Scene& scene);
/// Lines that meet no rock are left out.
[[nodiscard]] std::vector<LineFigures> count_lines(const Scene& scene, const topology::CutInput& input);

}  // namespace cleave::scene
