#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/core/overloaded.hpp"
#include "detail/facet_builder.hpp"
#include "detail/lattice_polygon.hpp"
#include "detail/prepared.hpp"
#include "detail/snapping.hpp"
#include "detail/solids.hpp"

namespace cleave::topology::detail {
namespace {

using exact::LatticePoint;
using exact::Plane;
using exact::Sign;
using geometry::Vec3;

struct Bounds {
  std::array<double, 3> lo, hi;
  Bounds() {
    lo.fill(std::numeric_limits<double>::infinity());
    hi.fill(-std::numeric_limits<double>::infinity());
  }
  void add(Vec3 p) {
    const std::array c{p.x, p.y, p.z};
    for (std::size_t k = 0; k < 3; ++k) {
      lo[k] = std::min(lo[k], c[k]);
      hi[k] = std::max(hi[k], c[k]);
    }
  }
};

/// Apart by more than a polygon's corners leave its plane.
bool far_apart(const Bounds& polygon, const Bounds& region, double pitch) {
  double size = 0, farthest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    size += polygon.hi[k] - polygon.lo[k];
    farthest = std::max({farthest, std::abs(polygon.lo[k]), std::abs(polygon.hi[k])});
  }
  const double margin = 1e-5 * size + 1e-13 * farthest + 16 * pitch;
  for (std::size_t k = 0; k < 3; ++k) {
    if (polygon.lo[k] - margin > region.hi[k] || polygon.hi[k] + margin < region.lo[k]) return true;
  }
  return false;
}

/// The region on one side of the polygon's plane, by more than corners leave it. The box of a large joint meets a small
/// window long before the joint does.
bool beside(std::span<const Vec3> corners, const Bounds& region, double pitch) {
  const Vec3 o = corners[0];
  Vec3 n{};
  double size = 0;
  for (std::size_t i = 2; i < corners.size(); ++i) n += cross(corners[i - 1] - o, corners[i] - o);
  for (const Vec3& c : corners) size = std::max({size, std::abs(c.x - o.x), std::abs(c.y - o.y), std::abs(c.z - o.z)});
  const Vec3 lo{region.lo[0], region.lo[1], region.lo[2]}, hi{region.hi[0], region.hi[1], region.hi[2]};
  const Vec3 half = 0.5 * (hi - lo);
  const double length = norm(n), distance = std::abs(dot(n, lo + half - o));
  const double across = std::abs(n.x) * half.x + std::abs(n.y) * half.y + std::abs(n.z) * half.z;
  const double farthest = std::max({std::abs(o.x), std::abs(o.y), std::abs(o.z)});
  return length > 0 && distance > across + (1e-4 * size + 1e-12 * farthest + 64 * pitch) * length;
}

/// Sites that are corners of more than one polygon. A polygon given twice counts once: repeating a joint changes
/// nothing.
class SharedSites {
 public:
  void add(std::vector<LatticePoint> sites) {
    std::ranges::sort(sites);
    const auto repeated = std::ranges::unique(sites);
    sites.erase(repeated.begin(), repeated.end());
    begin_.push_back(sites_.size());
    sites_.insert(sites_.end(), sites.begin(), sites.end());
  }
  void finish() {
    begin_.push_back(sites_.size());
    std::vector<std::span<const LatticePoint>> polygons;
    for (std::size_t i = 0; i + 1 < begin_.size(); ++i) {
      polygons.push_back(std::span{sites_}.subspan(begin_[i], begin_[i + 1] - begin_[i]));
    }
    std::ranges::sort(polygons, [](auto a, auto b) { return std::ranges::lexicographical_compare(a, b); });
    const auto repeated = std::ranges::unique(polygons, [](auto a, auto b) { return std::ranges::equal(a, b); });
    polygons.erase(repeated.begin(), repeated.end());
    std::vector<LatticePoint> uses;
    for (const auto polygon : polygons) uses.insert(uses.end(), polygon.begin(), polygon.end());
    std::ranges::sort(uses);
    sites_.clear();
    for (std::size_t i = 1; i < uses.size(); ++i) {
      if (uses[i] == uses[i - 1] && (sites_.empty() || sites_.back() != uses[i])) sites_.push_back(uses[i]);
    }
  }
  /// After `finish`: which of these are shared.
  [[nodiscard]] std::vector<std::size_t> among(std::span<const LatticePoint> sites) const {
    std::vector<std::size_t> shared;
    for (std::size_t i = 0; i < sites.size(); ++i) {
      if (std::ranges::binary_search(sites_, sites[i])) shared.push_back(i);
    }
    return shared;
  }

 private:
  std::vector<LatticePoint> sites_;
  std::vector<std::size_t> begin_;
};

/// The plane of a persistent joint: lattice vectors that depend on the orientation alone, so equal orientations are
/// exactly parallel.
std::optional<Plane> persistent_plane(const PersistentJoint& joint, const exact::Lattice& lattice) {
  const Vec3 n = geometry::normalized(joint.normal);
  const Vec3 helper = std::abs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 u = geometry::normalized(geometry::cross(n, helper));
  const Vec3 v = geometry::cross(n, u);
  const auto site = [](Vec3 d) {
    const auto c = [](double x) { return static_cast<std::int64_t>(std::nearbyint(std::ldexp(x, 46))); };
    return LatticePoint{c(d.x), c(d.y), c(d.z)};
  };
  return Plane::spanned(lattice.snap(joint.through.x, joint.through.y, joint.through.z), site(u), site(v));
}

/// The point that tells which part of a joint is kept.
LatticePoint middle_of(const std::variant<Joint, PersistentJoint>& joint, const exact::Lattice& lattice) {
  Vec3 middle{};
  if (const auto* polygons = std::get_if<Joint>(&joint)) {
    double count = 0;
    for (const auto& polygon : polygons->polygons) {
      for (const Vec3& v : polygon.corners()) {
        ++count;
        middle += (v - middle) / count;
      }
    }
  } else {
    middle = std::get<PersistentJoint>(joint).through;
  }
  return lattice.snap(middle.x, middle.y, middle.z);
}

}  // namespace

std::expected<Prepared, CutError> prepare(const CutInput& input) {
  Bounds scene, domain;
  for (const Vec3& v : input.domain.vertices()) domain.add(v);
  scene = domain;
  for (const auto& solid : input.excavations) {
    for (const Vec3& v : solid.vertices()) scene.add(v);
  }
  for (const auto& entry : input.joints) {
    std::visit(overloaded{[&](const Joint& joint) {
                            for (const auto& polygon : joint.polygons) {
                              for (const Vec3& v : polygon.corners()) scene.add(v);
                            }
                          },
                          [&](const PersistentJoint& joint) { scene.add(joint.through); }},
               entry);
  }
  const exact::Lattice lattice = exact::Lattice::covering(scene.lo, scene.hi);
  Prepared out{lattice};
  out.joint_count = static_cast<Index>(input.joints.size());
  out.excavation_count = static_cast<Index>(input.excavations.size());

  Snapper snapper{lattice, input.snap.si()};
  const auto sites_of = [&](std::span<const Vec3> points) {
    std::vector<LatticePoint> sites;
    sites.reserve(points.size());
    for (const Vec3& p : points) sites.push_back(snapper.site(p));
    return sites;
  };

  FacetBuilder builder{out};
  builder.adoption_margin_ = box_margin + 4 * input.snap.si() / lattice.pitch() * lattice_unit;
  const auto add_solid = [&](const geometry::Solid& solid, Owner owner, Index index) {
    const auto sites = sites_of(solid.vertices());
    const auto collapsed = solid.from_half_spaces() ? add_half_spaces(solid, sites, builder, out, owner, index)
                                                    : add_surface(solid, sites, builder, out, owner, index);
    for (const auto& face : solid.faces()) {
      std::vector<LatticePoint> corners;
      for (const std::uint32_t v : face.corners) corners.push_back(sites[v]);
      if (auto polygon = make_lattice_polygon(std::move(corners))) snapper.remember(*polygon);
    }
    return collapsed;
  };
  if (const auto collapsed = add_solid(input.domain, Owner::domain, 0)) {
    return std::unexpected(CutError{SolidCollapsed{std::nullopt, *collapsed, metres(lattice.pitch())}});
  }
  for (std::size_t e = 0; e < input.excavations.size(); ++e) {
    if (const auto collapsed = add_solid(input.excavations[e], Owner::excavation, static_cast<Index>(e))) {
      return std::unexpected(
          CutError{SolidCollapsed{static_cast<std::uint32_t>(e), *collapsed, metres(lattice.pitch())}});
    }
  }

  Bounds region = domain;  // what is outside it cuts nothing
  if (input.window) {
    const auto clamped = [&](Vec3 p) {
      return lattice.snap(std::clamp(p.x, domain.lo[0], domain.hi[0]), std::clamp(p.y, domain.lo[1], domain.hi[1]),
                          std::clamp(p.z, domain.lo[2], domain.hi[2]));
    };
    const LatticePoint lo = clamped(input.window->min), hi = clamped(input.window->max);
    if (!builder.add_window(lo, hi)) return std::unexpected(CutError{WindowOutside{}});
    const Vec3 window_min = input.window->min, window_max = input.window->max;
    const auto narrow = [&](std::size_t k, double from, double to) {
      region.lo[k] = std::max(region.lo[k], from);
      region.hi[k] = std::min(region.hi[k], to);
    };
    narrow(0, window_min.x, window_max.x);
    narrow(1, window_min.y, window_max.y);
    narrow(2, window_min.z, window_max.z);
    out.domain_surface = surface_of_box(lo, hi);
  }

  // Joints: first all polygons on the lattice (with corners, then planes snapped), then their facets (with edges
  // snapped). Corners that two polygons share are the first choice for what fixes their planes: edges that were meant
  // to be shared then are.
  SharedSites shared;
  for (const auto& entry : input.joints) {
    if (const auto* joint = std::get_if<Joint>(&entry)) {
      for (const auto& polygon : joint->polygons) shared.add(sites_of(polygon.corners()));
    }
  }
  shared.finish();
  struct JointPolygon {
    Index joint;
    LatticePolygon polygon;
    std::vector<std::vector<LatticePoint>> holes;
  };
  std::vector<JointPolygon> polygons;
  const auto ended_on = [&](std::size_t j) {  // its plane is needed wherever it lies
    return std::ranges::find(input.terminations, JointId{j}, &Termination::at) != input.terminations.end();
  };
  for (std::size_t j = 0; j < input.joints.size(); ++j) {
    const JointCollapsed collapsed{JointId{j}, metres(lattice.pitch())};
    if (const auto* joint = std::get_if<Joint>(&input.joints[j])) {
      Bounds own;
      for (std::size_t k = 0; k < joint->polygons.size(); ++k) {
        const auto& polygon = joint->polygons[k];
        Bounds box;
        for (const Vec3& v : polygon.corners()) {
          own.add(v);
          box.add(v);
        }
        if (!snapper.active() && !ended_on(j) &&
            (far_apart(box, region, lattice.pitch()) ||
             (input.window && beside(polygon.corners(), region, lattice.pitch())))) {
          continue;  // cuts nothing
        }
        snapper.begin_joint(static_cast<Index>(j));
        auto sites = sites_of(polygon.corners());
        const auto preferred = shared.among(sites);
        auto made = make_lattice_polygon(std::move(sites), preferred);
        if (!made) return std::unexpected(CutError{collapsed});
        std::vector<std::vector<LatticePoint>> holes;
        if (k < joint->holes.size()) {
          for (const auto& hole : joint->holes[k]) holes.push_back(sites_of(hole.corners()));
        }
        polygons.push_back({static_cast<Index>(j), std::move(*made), std::move(holes)});
      }
      bool apart = joint->polygons.empty();
      for (std::size_t k = 0; k < 3; ++k) apart = apart || own.hi[k] < domain.lo[k] || own.lo[k] > domain.hi[k];
      if (apart) out.outside.push_back(static_cast<Index>(j));
    } else {
      const auto& persistent = std::get<PersistentJoint>(input.joints[j]);
      const auto plane = persistent_plane(persistent, lattice);
      if (!plane) return std::unexpected(CutError{collapsed});
      snapper.remember(*plane);
      // Bounded by a box well around the domain, so that its outline means something where other joints share its
      // plane.
      const LatticePoint lo = lattice.snap(domain.lo[0], domain.lo[1], domain.lo[2]);
      const LatticePoint hi = lattice.snap(domain.hi[0], domain.hi[1], domain.hi[2]);
      constexpr std::int64_t margin = 1 << 20;
      FacetBuilder::Piece piece{blank_facet(Owner::joint, static_cast<Index>(j), 0), {}, {}, {}};
      const auto [number, same] = builder.add_plane(*plane);
      piece.facet.plane = number;
      const LatticePoint x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
      const LatticePoint a{lo.x - margin, lo.y - margin, lo.z - margin}, b{hi.x + margin, hi.y + margin, hi.z + margin};
      const std::array<std::array<LatticePoint, 3>, 6> sides{
          {{a, y, z}, {b, z, y}, {a, z, x}, {b, x, z}, {a, x, y}, {b, y, x}}};
      for (const auto& [site, u, v] : sides) {
        const Plane side = Plane::spanned(site, u, v).value();
        if (!side.parallel_to(*plane)) piece.own_edges.push_back(side);
      }
      piece.facet.lo = {-1, -1, -1};
      piece.facet.hi = {1, 1, 1};
      builder.add_piece(std::move(piece));
    }
  }
  if (snapper.active()) {
    std::vector<const LatticePolygon*> all;
    all.reserve(polygons.size());
    for (const auto& entry : polygons) all.push_back(&entry.polygon);
    snapper.begin_merging(all);
    for (auto& entry : polygons) {
      snapper.begin_joint(entry.joint);
      snapper.merge_plane(entry.polygon);
    }
  }
  for (auto& [joint, polygon, holes] : polygons) {
    const JointCollapsed collapsed{JointId{joint}, metres(lattice.pitch())};
    if (!holes.empty()) {
      if (!builder.add_with_holes(polygon, std::move(holes), blank_facet(Owner::joint, joint, 0))) {
        return std::unexpected(CutError{collapsed});
      }
      continue;
    }
    std::vector<std::optional<HalfSpace>> adopted;
    if (snapper.active()) {
      snapper.begin_joint(joint);
      adopted = snapper.adopt_edges(polygon, [&](const Plane& plane) { return builder.add_plane(plane); });
    }
    if (!builder.add_polygon(polygon, blank_facet(Owner::joint, joint, 0), adopted, ended_on(joint))) {
      return std::unexpected(CutError{collapsed});
    }
  }
  for (const auto& [joint, at] : input.terminations) {
    const auto plane = builder.plane_of_joint(at.value());
    const Sign side = plane ? out.planes[*plane].side_of(middle_of(input.joints[joint.index()], lattice)) : Sign::zero;
    if (side == Sign::zero) return std::unexpected(CutError{TerminationUndecided{joint, at}});
    builder.cut_off(joint.value(), {*plane, side == Sign::positive});
  }
  out.keep_dangling = input.keep_dangling;
  builder.finish();
  out.largest_snap = snapper.largest_move();
  out.merged_planes = snapper.merged_planes();
  out.adopted_edges = snapper.adopted_edges();
  out.snapped = snapper.changed();
  return out;
}

}  // namespace cleave::topology::detail
