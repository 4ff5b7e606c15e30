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

/// Lines per length (of all directions) whose cells have the mean area of the set's joints.
double line_density(const JointSet& set) { return std::sqrt(std::numbers::pi / set.mean_area()); }

/// How far whole cells may reach from a point of theirs: farther with a chance of e^-19, as no line may cross a segment
/// of that length.
double reach_of_cells(const JointSet& set) { return 30 / line_density(set); }

/// Of the disc about the origin that holds the cell.
double radius_of(const Cell& cell) {
  double radius = 0;
  for (const Vec2 p : cell.corners) radius = std::max(radius, std::hypot(p.x, p.y));
  return radius;
}

/// How many edges of the cell lie on lines.
std::size_t bounded_by(const Cell& cell) {
  return static_cast<std::size_t>(std::ranges::count_if(cell.line, [](std::size_t l) { return l != Cell::border; }));
}

class PlaneModel final {
 public:
  PlaneModel(const JointSet& set, std::span<const SampledJoint> planes,
             std::span<const std::span<const SampledJoint>> older, const DomainBox& domain, const SetStreams& streams)
      : set_{set},
        planes_{planes},
        older_{older},
        box_{slightly_grown(domain)},
        around_{box_.grown(reach_of_moves(set))},
        streams_{streams} {}

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
    // Polygons that are moved stay whole.
    const double beyond = moves() ? reach_of_cells(set_) : 0;
    const GridPlane grid{origin, strike, plane.normal, norm(around_.max - around_.min) + 2 * beyond};
    Cell outline = section(grid, around_);
    if (outline.corners.size() < 3) return;
    Rng marks = streams_.of(Draw::termination, plane.index);
    Rng lines_stream = streams_.of(Draw::size, plane.index);
    std::visit(
        overloaded{
            [&](const Veneziano& m) {
              const double density = line_density(set_), radius = radius_of(outline);
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
            [&](const Mit& m) { draw_good_shapes(m, grid, outline, marks, lines_stream); },
            [](const auto&) {},
        },
        set_.spec().model);
  }

  /// Shapes are those of whole cells, however little of them lies in the domain.
  void draw_good_shapes(const Mit& m, const GridPlane& grid, const Cell& outline, Rng& marks, Rng& lines_stream) {
    const double radius = radius_of(outline) + reach_of_cells(set_);
    for (const Cell& cell : cells_reaching(outline, radius, poisson_lines(line_density(set_), radius, lines_stream))) {
      const double mark = marks.uniform();
      if (mark >= m.share || !may_reach(m, grid, cell) || !good_shape(m, cell)) continue;
      if (mark >= m.share * zone_probability(m, grid.at(centroid(cell)))) continue;
      if (moves()) {
        keep_moved(m, grid, cell);
      } else if (auto polygon = joint_of(grid, common_part(cell, outline))) {
        add(*std::move(polygon), grid.at(centroid(cell)), grid.normal());
      }
    }
  }

  /// Whether the cell, shifted and turned somehow, may meet the domain.
  [[nodiscard]] bool may_reach(const Mit& model, const GridPlane& grid, const Cell& cell) const {
    if (!moves()) return true;
    const Vec2 middle = centroid(cell);
    double reach = 0;
    for (const Vec2 p : cell.corners) reach = std::max(reach, std::hypot(p.x - middle.x, p.y - middle.y));
    const Vec3 at = grid.at(middle);
    return box_.overlaps(DomainBox{at, at}.grown((1 + 1e-6) * (model.shift + reach)));
  }

  [[nodiscard]] bool moves() const { return reach_of_moves(set_) > 0; }

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
    Rng rng = streams_.of(Draw::position, 0x80000000U + moved_++);
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
    auto moved = Polygon::make(std::move(corners));
    if (!moved || !box_.overlaps(geometry::box_of(moved->corners()))) return;
    add(*std::move(moved), centre + model.shift * shift, to);
  }

  const JointSet& set_;
  std::span<const SampledJoint> planes_;
  std::span<const std::span<const SampledJoint>> older_;
  DomainBox box_, around_;  ///< what joints meet; where the planes do before they are moved
  SetStreams streams_;
  std::vector<SampledJoint> joints_;
  std::uint32_t moved_ = 0;
};

}  // namespace

DomainBox slightly_grown(const DomainBox& domain) noexcept {
  const double by = 0.005 * norm(domain.max - domain.min);
  return {domain.min - Vec3{by, by, by}, domain.max + Vec3{by, by, by}};
}

double reach_of_moves(const JointSet& set) {
  const auto* mit = std::get_if<Mit>(&set.spec().model);
  if (mit == nullptr) return 0;
  if (!mit->turn_kappa) return mit->shift;
  // Of the area of all cells 0.2 % lies in those that reach farther than 10 mean distances of lines from their
  // centroid, and larger turns than here have a chance of 1.1 %: what comes from farther away would need both.
  const double fall = std::min(1.0, 4.5 / *mit->turn_kappa);  // 1 - cos
  return mit->shift + std::sqrt(fall * (2 - fall)) * 10 / line_density(set);
}

std::vector<SampledJoint> on_planes(const JointSet& set, std::span<const SampledJoint> planes,
                                    std::span<const std::span<const SampledJoint>> older, const DomainBox& domain,
                                    const SetStreams& streams) {
  return PlaneModel{set, planes, older, domain, streams}.run();
}

}  // namespace cleave::dfn::detail

namespace cleave::dfn {

double good_shape_share(const Mit& model) {
  constexpr Mit usual;
  if (model.min_corners == usual.min_corners && model.min_angle == usual.min_angle &&
      model.max_elongation == usual.max_elongation) {
    return 0.1762;  // of 13 million cells as below: standard error 0.0001
  }
  constexpr std::uint32_t cells = 32768;
  Rng rng{{.seed = 1978}};
  std::uint32_t good = 0;
  for (std::uint32_t i = 0; i < cells; ++i) good += detail::good_shape(model, detail::cell_at_origin(rng)) ? 1U : 0U;
  return std::max(1.0, static_cast<double>(good)) / cells;
}

}  // namespace cleave::dfn
