#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "cleave/core/overloaded.hpp"
#include "models.hpp"
#include "orientation.hpp"
#include "plane_cells.hpp"

namespace cleave::dfn::detail {

using geometry::Polygon;
using geometry::Vec3;

namespace {

constexpr double degrees = std::numbers::pi / 180;

bool good_shape(const Mit& model, const Cell& cell) {
  if (cell.corners.size() < model.min_corners || smallest_angle(cell) < model.min_angle * degrees) return false;
  const Calipers widths = calipers(cell);
  return widths.largest <= model.max_elongation * widths.smallest;
}

/// Lines along which older joints cross a plane; those of one older plane count once.
std::vector<Line2> traces_of(const GridPlane& plane, std::span<const std::span<const SampledJoint>> older) {
  std::vector<Line2> lines;
  for (const auto& set : older) {
    for (const SampledJoint& joint : set) {
      if (const auto* polygon = std::get_if<Polygon>(&joint.shape)) {
        // Only joints that cross the plane.
        double low = INFINITY, high = -INFINITY;
        for (const Vec3 corner : polygon->corners()) {
          const double d = dot(corner - plane.at({0, 0}), plane.normal());
          low = std::min(low, d);
          high = std::max(high, d);
        }
        if (low > 0 || high < 0) continue;
      }
      const auto line = plane.trace(joint.centre, joint.normal);
      if (!line) continue;
      const auto same = [&](const Line2& l) {
        return std::abs(l.cos * line->cos + l.sin * line->sin) > 1 - 1e-12 &&
               std::abs(std::abs(l.offset) - std::abs(line->offset)) < 10 * plane.step();
      };
      if (std::ranges::none_of(lines, same)) lines.push_back(*line);
    }
  }
  return lines;
}

/// How many edges of the cell lie on lines.
std::size_t bounded_by(const Cell& cell) {
  return static_cast<std::size_t>(std::ranges::count_if(cell.line, [](std::size_t l) { return l != Cell::border; }));
}

class PlaneModel final {
 public:
  PlaneModel(const JointSet& set, std::span<const SampledJoint> planes,
             std::span<const std::span<const SampledJoint>> older, const DomainBox& domain, const SetStreams& streams)
      : set_{set}, planes_{planes}, older_{older}, box_{slightly_grown(domain)}, streams_{streams} {}

  std::vector<SampledJoint> run() {
    for (const SampledJoint& plane : planes_) draw_on(plane);
    return std::move(joints_);
  }

 private:
  void draw_on(const SampledJoint& plane) {
    const Vec3 horizontal = Vec3{-plane.normal.y, plane.normal.x, 0};
    const Vec3 strike = norm(horizontal) < 1e-12 ? Vec3{1, 0, 0} : normalized(horizontal);
    const Vec3 middle = (box_.min + box_.max) / 2;
    const Vec3 origin = middle - dot(middle - plane.centre, plane.normal) * plane.normal;
    const GridPlane grid{origin, strike, plane.normal, norm(box_.max - box_.min)};
    Cell outline = section(grid, box_);
    if (outline.corners.size() < 3) return;
    double radius = 0;
    for (const Vec2 p : outline.corners) radius = std::max(radius, std::hypot(p.x, p.y));
    Rng marks = streams_.of(Draw::termination, plane.index);
    Rng lines_stream = streams_.of(Draw::size, plane.index);
    std::visit(
        overloaded{
            [&](const Veneziano& m) {
              const double density = std::sqrt(std::numbers::pi / set_.mean_area());
              for (const Cell& cell : cut_by_lines(std::move(outline), poisson_lines(density, radius, lines_stream))) {
                if (marks.uniform() < m.share) keep(grid, cell);
              }
            },
            [&](const Dershowitz& m) {
              std::vector<Line2> lines;
              for (const SampledJoint& other : planes_) {
                if (other.index == plane.index) continue;
                if (const auto line = grid.trace(other.centre, other.normal)) lines.push_back(*line);
              }
              for (const Cell& cell : cut_by_lines(std::move(outline), lines)) {
                if (marks.uniform() < m.share) keep(grid, cell);
              }
            },
            [&](const Hierarchical& m) {
              for (const Cell& cell : cut_by_lines(std::move(outline), traces_of(grid, older_))) {
                const double share = m.share[std::min<std::size_t>(bounded_by(cell), 2)];
                if (marks.uniform() < share) keep(grid, cell);
              }
            },
            [&](const Mit& m) {
              const double density = std::sqrt(std::numbers::pi / set_.mean_area());
              for (const Cell& cell : cut_by_lines(std::move(outline), poisson_lines(density, radius, lines_stream))) {
                const double mark = marks.uniform();
                if (good_shape(m, cell) && mark < m.share * zone_probability(m, grid.at(centroid(cell)))) {
                  keep_moved(m, grid, cell);
                }
              }
            },
            [](const auto&) {},
        },
        set_.spec().model);
  }

  static double zone_probability(const Mit& model, Vec3 p) {
    for (const Zone& z : model.zones) {
      if (p.x >= z.min.x && p.y >= z.min.y && p.z >= z.min.z && p.x <= z.max.x && p.y <= z.max.y && p.z <= z.max.z) {
        return z.probability;
      }
    }
    return 1;
  }

  void add(Polygon polygon, Vec3 centre, Vec3 normal) {
    joints_.push_back({std::move(polygon), centre, normal, static_cast<std::uint32_t>(joints_.size())});
  }

  void keep(const GridPlane& grid, const Cell& cell) {
    if (auto polygon = joint_of(grid, cell)) add(*std::move(polygon), grid.at(centroid(cell)), grid.normal());
  }

  /// Polygons that were shifted and turned lie on planes of their own.
  void keep_moved(const Mit& model, const GridPlane& grid, const Cell& cell) {
    auto polygon = joint_of(grid, cell);
    if (!polygon) return;
    const Vec3 centre = grid.at(centroid(cell));
    const auto number = static_cast<std::uint32_t>(joints_.size());
    if (model.shift == 0 && !model.turn_kappa) {
      add(*std::move(polygon), centre, grid.normal());
      return;
    }
    Rng rng = streams_.of(Draw::position, 0x80000000U + number);
    Vec3 shift;
    do {
      shift.x = 2 * rng.uniform() - 1;
      shift.y = 2 * rng.uniform() - 1;
      shift.z = 2 * rng.uniform() - 1;
    } while (dot(shift, shift) > 1);
    const double u = rng.uniform(), v = rng.uniform();
    const Vec3 from = grid.normal();
    const Vec3 to = model.turn_kappa ? turned_by_fisher(from, *model.turn_kappa, u, v).normal : from;
    // The smallest rotation that takes one normal to the other (Rodrigues).
    const Vec3 axis = cross(from, dot(from, to) < 0 ? -to : to);
    const double cosine = std::abs(dot(from, to));
    std::vector<Vec3> corners;
    for (const Vec3 corner : polygon->corners()) {
      const Vec3 r = corner - centre;
      const Vec3 turned = cosine * r + cross(axis, r) + dot(axis, r) / (1 + cosine) * axis;
      corners.push_back(centre + model.shift * shift + turned);
    }
    if (auto moved = Polygon::make(std::move(corners))) add(*std::move(moved), centre + model.shift * shift, to);
  }

  const JointSet& set_;
  std::span<const SampledJoint> planes_;
  std::span<const std::span<const SampledJoint>> older_;
  DomainBox box_;

  SetStreams streams_;
  std::vector<SampledJoint> joints_;
};

}  // namespace

DomainBox slightly_grown(const DomainBox& domain) noexcept {
  const double by = 0.005 * norm(domain.max - domain.min);
  return {domain.min - Vec3{by, by, by}, domain.max + Vec3{by, by, by}};
}

std::vector<SampledJoint> on_planes(const JointSet& set, std::span<const SampledJoint> planes,
                                    std::span<const std::span<const SampledJoint>> older, const DomainBox& domain,
                                    const SetStreams& streams) {
  return PlaneModel{set, planes, older, domain, streams}.run();
}

}  // namespace cleave::dfn::detail

namespace cleave::dfn {

double good_shape_share(const Mit& model) {
  // Points within a disc of 12 mean cell sizes, lines within twice that: cells at points are area-weighted.
  constexpr double radius = 24, inner = 12;
  constexpr std::uint32_t fields = 40, points = 200;
  std::uint32_t good = 0;
  for (std::uint32_t field = 0; field < fields; ++field) {
    Rng rng{{.seed = 1978, .realization = field}};
    const std::vector<detail::Line2> lines = detail::poisson_lines(std::sqrt(std::numbers::pi), radius, rng);
    for (std::uint32_t i = 0; i < points; ++i) {
      const double r = inner * std::sqrt(rng.uniform()), angle = 2 * std::numbers::pi * rng.uniform();
      const detail::Cell disc{{{-radius, -radius}, {radius, -radius}, {radius, radius}, {-radius, radius}},
                              std::vector<std::size_t>(4, detail::Cell::border)};
      const detail::Cell cell = detail::cell_around(disc, lines, {r * std::cos(angle), r * std::sin(angle)});
      good += detail::good_shape(model, cell) ? 1U : 0U;
    }
  }
  return std::max(1.0, static_cast<double>(good)) / (fields * points);
}

}  // namespace cleave::dfn
