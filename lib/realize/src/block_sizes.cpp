#include "cleave/realize/block_sizes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <variant>

#include "cleave/core/assert.hpp"
#include "cleave/core/overloaded.hpp"
#include "cleave/scene3d/bounds.hpp"
#include "cleave/survey/orientation.hpp"
#include "cleave/topology/block_shape.hpp"

namespace cleave::scene {
namespace {

using geometry::Vec3;
using topology::BlockComplex;
using topology::BlockId;

/// Index of a block's class in stochastic::shape_class_names.
std::size_t shape_class(const BlockComplex& complex, const topology::Block& block) {
  const auto values = topology::inertia(complex, block);
  constexpr double limit = 4.0 / 9;  // squares of the axes
  const bool rod = values[1] <= limit * values[0], plate = values[2] <= limit * values[1];
  return (rod ? 2U : 0U) + (plate ? 1U : 0U);
}

void add_shape(ShapeClasses& classes, const BlockComplex& complex, const topology::Block& block) {
  ++*std::array{&classes.cubic, &classes.platy, &classes.elongated, &classes.bladed}.at(shape_class(complex, block));
}

/// How much rarer than a point a block is met whole in the box.
double border_weight(const BlockComplex& complex, const topology::Block& block, const Box& box) {
  const Box own = topology::extents(complex, block);
  constexpr double least = 0.01;
  const auto along = [&](double Vec3::* p) {
    const double side = box.max.*p - box.min.*p;
    return 1 / std::max(least, 1 - (own.max.*p - own.min.*p) / side);
  };
  return along(&Vec3::x) * along(&Vec3::y) * along(&Vec3::z);
}

/// Area vectors of a joint's flat parts within the box.
std::vector<Vec3> areas_of(const topology::CutInput& input, std::size_t joint, const Box& box) {
  std::vector<Vec3> areas;
  std::visit(overloaded{
                 [&](const topology::Joint& polygons) {
                   for (std::size_t i = 0; i < polygons.polygons.size(); ++i) {
                     const auto corners = polygons.polygons[i].corners();
                     Vec3 area = area_within({corners.begin(), corners.end()}, box);
                     if (i < polygons.holes.size()) {
                       for (const geometry::Polygon& hole : polygons.holes[i]) {
                         const auto own = hole.corners();
                         const Vec3 less = area_within({own.begin(), own.end()}, box);
                         area = area - (dot(less, area) < 0 ? -less : less);
                       }
                     }
                     areas.push_back(area);
                   }
                 },
                 [&](const topology::PersistentJoint& plane) {
                   const Vec3 n = normalized(plane.normal), some = std::abs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
                   const Vec3 e1 = normalized(cross(n, some)), e2 = cross(n, e1);
                   const Vec3 middle = (box.min + box.max) / 2;
                   const Vec3 foot = middle + dot(plane.through - middle, n) * n;
                   const double far = norm(box.max - box.min);
                   areas.push_back(area_within({foot - far * e1 - far * e2, foot + far * e1 - far * e2,
                                                foot + far * e1 + far * e2, foot - far * e1 + far * e2},
                                               box));
                 },
             },
             input.joints[joint]);
  return areas;
}

/// Sum of the areas, each turned to the side of `axis`, then of the sum, until none turns.
Vec3 turned_sum(const std::vector<Vec3>& areas, Vec3 axis) {
  for (int round = 0; round < 50; ++round) {
    Vec3 next{0, 0, 0};
    for (const Vec3 a : areas) next += dot(a, axis) < 0 ? -a : a;
    const bool same = norm(next - axis) <= 1e-12 * norm(axis);
    axis = next;
    if (same || !(norm(axis) > 0)) break;
  }
  return axis;
}

SetFigures figures_of(std::string name, std::uint64_t joints, const std::vector<Vec3>& areas, double volume) {
  SetFigures set{.name = std::move(name), .joints = joints};
  std::vector<Vec3> normals;
  std::vector<double> weights;
  for (const Vec3 a : areas) {
    if (!(norm(a) > 0)) continue;
    normals.push_back(a / norm(a));
    weights.push_back(norm(a));
  }
  if (normals.empty()) return set;
  // Mean axis by area. A set that scatters widely has several such sums that turn no joint: the longest of those that
  // the main axes lead to, whatever the order of the joints.
  Vec3 mean{0, 0, 0};
  for (const Vec3 axis : survey::orientation_tensor(normals, weights).vectors) {
    const Vec3 found = turned_sum(areas, axis);
    if (norm(found) > norm(mean)) mean = found;
  }
  const double length = norm(mean);
  for (const Vec3 a : areas) {
    set.p32 += norm(a) / volume;
    set.p21 += std::hypot(a.x, a.y) / volume;
    set.p10 += length > 0 ? std::abs(dot(a, mean)) / length / volume : 0;
  }
  return set;
}

}  // namespace

double Percentiles::at(std::string_view level) const {
  const auto found = std::ranges::find(levels, level, &std::pair<std::string_view, double>::first);
  CLEAVE_ASSERT(found != levels.end());
  return values.at(static_cast<std::size_t>(found - levels.begin()));
}

Percentiles percentiles_by_number(std::vector<double> volumes) {
  std::ranges::sort(volumes);
  Percentiles result;
  for (std::size_t i = 0; i < Percentiles::levels.size(); ++i) {
    const double at = Percentiles::levels.at(i).second * static_cast<double>(volumes.size() - 1);
    const auto below = std::min(static_cast<std::size_t>(at), volumes.size() - 1);
    const std::size_t above = std::min(below + 1, volumes.size() - 1);
    result.values.at(i) = volumes[below] + (at - static_cast<double>(below)) * (volumes[above] - volumes[below]);
  }
  return result;
}

Percentiles percentiles_by_volume(std::vector<double> volumes) {
  std::ranges::sort(volumes);
  const double all = std::accumulate(volumes.begin(), volumes.end(), 0.0);
  Percentiles result;
  double passed = 0;
  std::size_t next = 0;
  for (std::size_t i = 0; i < Percentiles::levels.size(); ++i) {
    const double wanted = Percentiles::levels.at(i).second * all * (1 - 1e-12);
    while (next + 1 < volumes.size() && passed + volumes[next] < wanted) passed += volumes[next++];
    result.values.at(i) = volumes[next];
  }
  return result;
}

std::optional<BlockSizes> block_sizes(const BlockComplex& complex) {
  constexpr std::size_t enough = 30;
  std::vector<BlockId> inner, all;
  for (std::size_t i = 0; i < complex.blocks().size(); ++i) {
    const topology::Block& block = complex.blocks()[BlockId{i}];
    if (block.truncated) continue;
    all.emplace_back(i);
    if (!block.fixed) inner.emplace_back(i);
  }
  if (all.empty()) return std::nullopt;
  BlockSizes sizes;
  sizes.inner = inner.size() >= enough;
  const std::vector<BlockId>& counted = sizes.inner ? inner : all;
  sizes.count = counted.size();
  std::vector<double> volumes;
  for (const BlockId id : counted) {
    const topology::Block& block = complex.blocks()[id];
    volumes.push_back(block.volume.si());
    add_shape(sizes.shapes, complex, block);
  }
  sizes.by_number = percentiles_by_number(volumes);
  sizes.by_volume = percentiles_by_volume(std::move(volumes));
  sizes.d50 = metres(std::cbrt(sizes.by_volume.at("p50")));
  sizes.d80 = metres(std::cbrt(sizes.by_volume.at("p80")));
  return sizes;
}

std::optional<Box> undisturbed_box(const Scene& scene) {
  const Box box = box_of(scene.domain);
  const Vec3 sides = box.max - box.min;
  const double volume = sides.x * sides.y * sides.z;
  const bool is_box = std::abs(scene.domain.volume().si() - volume) <= 1e-9 * volume;
  if (!is_box || !scene.excavations.empty() || !scene.free_domain_tags.empty()) return std::nullopt;
  return box;
}

stochastic::WholeBlocks tally_blocks(const BlockComplex& complex, const std::optional<Box>& box) {
  stochastic::WholeBlocks whole;
  std::array<std::pair<double, double>, stochastic::SizeHistogram::bins> bins{};
  for (const topology::Block& block : complex.blocks()) {
    if (block.truncated || block.fixed) continue;
    const double weight = box ? border_weight(complex, block, *box) : 1, volume = block.volume.si();
    ++whole.count;
    whole.volume += block.volume;
    whole.shapes.at(shape_class(complex, block)) += weight;
    auto& [number, sum] = bins.at(stochastic::SizeHistogram::bin_of(volume));
    number += weight;
    sum += weight * volume;
  }
  for (std::uint32_t i = 0; i < bins.size(); ++i) {
    const auto& [number, sum] = bins.at(i);
    if (number > 0) whole.bins.push_back({i, static_cast<float>(number), static_cast<float>(sum)});
  }
  return whole;
}

std::vector<SetFigures> count_all_sets(const topology::CutInput& input, const std::vector<SetId>& set_of,
                                       const std::vector<std::string>& names) {
  const Box box = box_of(input.domain);
  const Vec3 sides = box.max - box.min;
  std::vector<std::vector<Vec3>> areas(names.size());
  std::vector<std::uint64_t> joints(names.size(), 0);
  for (std::size_t j = 0; j < input.joints.size(); ++j) {
    const std::size_t set = set_of[j].index();
    bool meets = false;
    for (const Vec3 area : areas_of(input, j, box)) {
      if (!(norm(area) > 0)) continue;
      areas[set].push_back(area);
      meets = true;
    }
    joints[set] += meets ? 1U : 0U;
  }
  std::vector<SetFigures> figures;
  for (std::size_t set = 0; set < names.size(); ++set) {
    figures.push_back(figures_of(names[set], joints[set], areas[set], sides.x * sides.y * sides.z));
  }
  return figures;
}

std::vector<SetFigures> count_sets(const topology::CutInput& input, const std::vector<SetId>& set_of,
                                   const std::vector<std::string>& names) {
  std::vector<SetFigures> sets = count_all_sets(input, set_of, names);
  std::erase_if(sets, [](const SetFigures& set) { return set.joints == 0; });
  return sets;
}

}  // namespace cleave::scene
