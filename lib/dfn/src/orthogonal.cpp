#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <variant>

#include "cleave/core/overloaded.hpp"
#include "models.hpp"
#include "orientation.hpp"
#include "plane_cells.hpp"

namespace cleave::dfn::detail {

using geometry::Vec3;

namespace {

/// Next gap of a renewal process with this mean.
double gap(const Orthogonal& model, double mean, Rng& rng) {
  switch (model.gaps) {
    case Orthogonal::Gaps::poisson: return -mean * std::log(rng.uniform());
    case Orthogonal::Gaps::constant: return mean;
    case Orthogonal::Gaps::lognormal: {
      const double variance = std::log1p(model.gap_variation * model.gap_variation);
      return mean * std::exp(std::sqrt(variance) * rng.normal() - variance / 2);
    }
  }
  std::unreachable();
}

/// Where a stationary process of gaps starts: a gap is met with a probability that grows with its length, and then
/// anywhere in it. Lognormal gaps by their length are lognormal again, mu + sigma^2.
double first_gap(const Orthogonal& model, double mean, Rng& rng) {
  const double u = rng.uniform();
  switch (model.gaps) {
    case Orthogonal::Gaps::poisson: return -mean * std::log(u);
    case Orthogonal::Gaps::constant: return u * mean;
    case Orthogonal::Gaps::lognormal: {
      const double variance = std::log1p(model.gap_variation * model.gap_variation);
      return u * mean * std::exp(std::sqrt(variance) * rng.normal() + variance / 2);
    }
  }
  std::unreachable();
}

struct Run {
  double from, to;
};

/// Where the planes lie along the mean normal, from -radius to radius about the middle.
std::vector<double> offsets(const Orthogonal& model, double spacing, double radius, std::optional<double> through,
                            Rng& rng) {
  std::vector<double> all;
  if (through) {
    const double first = -radius + std::fmod(std::fmod(*through + radius, spacing) + spacing, spacing);
    for (std::size_t i = 0; first + static_cast<double>(i) * spacing < radius; ++i) {
      all.push_back(first + static_cast<double>(i) * spacing);
    }
    return all;
  }
  for (double at = -radius + first_gap(model, spacing, rng); at < radius; at += gap(model, spacing, rng)) {
    all.push_back(at);
  }
  return all;
}

/// Joints of one row between `low` and `high`, begun so far before that the start is forgotten.
std::vector<Run> runs(const SizeLaw& size, const SizeLaw& bridge, double low, double high, Rng& rng) {
  const double cycle = size.moment(1) + bridge.moment(1);
  double at = low - cycle * (20 + rng.uniform()) - size.largest().si();
  std::vector<Run> result;
  while (at < high) {
    const double length = size.quantile(rng.uniform()).si();
    if (at + length > low) result.push_back({std::max(at, low), std::min(at + length, high)});
    at += length + bridge.quantile(rng.uniform()).si();
  }
  std::erase_if(result, [](const Run& r) { return r.from >= r.to; });
  return result;
}

}  // namespace

std::vector<SampledJoint> orthogonal(const JointSet& set, const DomainBox& domain, const SetStreams& streams) {
  const auto& model = std::get<Orthogonal>(set.spec().model);
  const DomainBox box = slightly_grown(domain);
  const Frame mean = mean_frame(set.spec().orientation);
  const Vec3 middle = (box.min + box.max) / 2;
  const double radius = norm(box.max - box.min) / 2;
  // Planes per length of the normal: their area per volume, less what the bridges take.
  const Vec3 s = domain.max - domain.min;
  const double spacing = set.area_share() / set.expected_p32(s.x * s.y * s.z);
  const auto* rectangle = std::get_if<Rectangle>(&set.spec().shape);
  std::vector<SampledJoint> joints;
  Rng positions = streams.of(Draw::position, 0);
  std::optional<double> known;
  if (model.through) known = dot(*model.through - middle, mean.normal);
  std::uint32_t number = 0;
  for (const double at : offsets(model, spacing, radius, known, positions)) {
    const std::uint32_t plane = number++;
    Rng turn = streams.of(Draw::orientation, plane);
    const double u = turn.uniform(), v = turn.uniform();
    const Frame frame = draw(set.spec().orientation, u, v);
    const Vec3 through = middle + at * mean.normal;
    const auto index = [&] { return static_cast<std::uint32_t>(joints.size()); };
    if (rectangle == nullptr || !model.bridge) {
      joints.push_back({InfinitePlane{through, frame.normal}, through, frame.normal, index()});
      continue;
    }
    const GridPlane grid{through, frame.strike, frame.normal, 2 * radius};
    const Cell outline = section(grid, box);
    if (outline.corners.size() < 3) continue;
    double low_x = INFINITY, high_x = -INFINITY, low_y = INFINITY, high_y = -INFINITY;
    for (const Vec2 p : outline.corners) {
      low_x = std::min(low_x, p.x);
      high_x = std::max(high_x, p.x);
      low_y = std::min(low_y, p.y);
      high_y = std::max(high_y, p.y);
    }
    const SizeLaw second = std::visit(
        overloaded{[&](IndependentSize) { return rectangle->size; },
                   [&](AspectRatio r) { return SizeLaw::constant(metres(rectangle->size.moment(1) / r.ratio)); },
                   [](const SizeLaw& law) { return law; }},
        rectangle->second);
    Rng along = streams.of(Draw::size, plane), across = streams.of(Draw::aspect, plane);
    const std::vector<Run> rows = runs(second, *model.bridge, low_y, high_y, across);
    for (const Run& row : rows) {
      for (const Run& run : runs(rectangle->size, *model.bridge, low_x, high_x, along)) {
        const Cell cell{{{run.from, row.from}, {run.to, row.from}, {run.to, row.to}, {run.from, row.to}},
                        std::vector<std::size_t>(4, Cell::border)};
        if (auto polygon = joint_of(grid, cell)) {
          joints.push_back({*std::move(polygon), grid.at(centroid(cell)), grid.normal(), index()});
        }
      }
    }
  }
  return joints;
}

}  // namespace cleave::dfn::detail
