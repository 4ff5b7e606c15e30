#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "cleave/core/overloaded.hpp"
#include "cleave/geometry/tunnel.hpp"
#include "detail/as_vec3.hpp"
#include "detail/input_check.hpp"
#include "detail/preparation.hpp"
#include "detail/solids.hpp"

namespace cleave::topology::detail {
namespace {

/// The plane of a persistent joint: lattice vectors that depend on the orientation alone, so equal orientations are
/// exactly parallel.
std::optional<Plane> persistent_plane(Vec3 through, Vec3 normal, const exact::Lattice& lattice) {
  const Vec3 n = geometry::normalized(normal);
  const Vec3 helper = std::abs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 u = geometry::normalized(geometry::cross(n, helper));
  const Vec3 v = geometry::cross(n, u);
  const auto site = [](Vec3 d) {
    const auto c = [](double x) { return static_cast<std::int64_t>(std::nearbyint(std::ldexp(x, 46))); };
    return LatticePoint{c(d.x), c(d.y), c(d.z)};
  };
  return Plane::spanned(lattice.snap(through.x, through.y, through.z), site(u), site(v));
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

/// Covers the domain, what is excavated, and every joint that reaches the domain.
exact::Lattice Preparation::covering() const {
  Bounds scene = domain_;
  for (const auto& solid : input_.excavations) {
    for (const Vec3& v : solid.vertices()) scene.add(v);
  }
  for (std::size_t j = 0; j < input_.joints.size(); ++j) {
    std::visit(overloaded{[&](const Joint& joint) {
                            for (const auto& polygon : joint.polygons) {
                              const Bounds box = bounds_of(polygon.corners());
                              if (left_out(j, box)) continue;
                              scene.add(box.lo);
                              scene.add(box.hi);
                            }
                          },
                          [&](const PersistentJoint& joint) {
                            if (!left_out(j, joint)) scene.add(point_of(joint));
                          }},
               input_.joints[j]);
  }
  return exact::Lattice::covering(scene.lo, scene.hi);
}

void Preparation::weld() {
  if (!snapper_.active()) return;
  for (const Vec3& v : input_.domain.vertices()) snapper_.add_corner(v, true);
  for (const auto& solid : input_.excavations) {
    for (const Vec3& v : solid.vertices()) snapper_.add_corner(v, true);
  }
  for (std::size_t j = 0; j < input_.joints.size(); ++j) {
    const auto* joint = std::get_if<Joint>(&input_.joints[j]);
    if (joint == nullptr) continue;
    for (std::size_t k = 0; k < joint->polygons.size(); ++k) {
      if (left_out(j, bounds_of(joint->polygons[k].corners()))) continue;
      for (const Vec3& v : joint->polygons[k].corners()) snapper_.add_corner(v, false);
      if (k >= joint->holes.size()) continue;
      for (const auto& hole : joint->holes[k]) {
        for (const Vec3& v : hole.corners()) snapper_.add_corner(v, false);
      }
    }
  }
  snapper_.weld();
}

Preparation::Done Preparation::add_solid(const geometry::Solid& solid, Owner owner, Index index,
                                         std::optional<std::uint32_t> excavation) {
  std::vector<LatticePoint> sites;
  for (const Vec3& v : solid.vertices()) sites.push_back(snapper_.site(v, none));
  const auto flat = solid.from_half_spaces() ? add_half_spaces(solid, sites, builder_, out_, owner, index)
                                             : add_surface(solid, sites, builder_, out_, owner, index);
  if (flat) return std::unexpected(CutError{SolidCollapsed{excavation, *flat, metres(lattice_.pitch())}});
  for (const auto& face : solid.faces()) {
    const std::size_t count = face.corners.size();
    for (std::size_t i = 0; i < count && !solid.from_half_spaces(); ++i) {
      shared_.add_surface_side(sites[face.corners[i]], sites[face.corners[(i + 1) % count]]);
    }
    const bool clips = owner == Owner::domain && !out_.clip.empty();
    if (!snapper_.active() && clips) continue;
    std::vector<LatticePoint> corners;
    for (const std::uint32_t v : face.corners) corners.push_back(sites[v]);
    const auto polygon = make_lattice_polygon(std::move(corners));
    if (!polygon) continue;
    if (snapper_.active()) snapper_.remember(*polygon, !clips);
    if (clips) continue;
    surfaces_.add(*polygon, owner == Owner::domain);
  }
  return {};
}

Preparation::Done Preparation::add_solids() {
  CLEAVE_CHECK(add_solid(input_.domain, Owner::domain, 0, std::nullopt));
  for (std::size_t e = 0; e < input_.excavations.size(); ++e) {
    CLEAVE_CHECK(
        add_solid(input_.excavations[e], Owner::excavation, static_cast<Index>(e), static_cast<std::uint32_t>(e)));
  }
  for (std::size_t k = 0; k < 3; ++k)
    farthest_ = std::max({farthest_, std::abs(domain_.lo[k]), std::abs(domain_.hi[k])});
  if (!out_.clip.empty()) touch_.emplace(out_, out_.clip, farthest_);
  boxed_ = std::ranges::all_of(out_.clip, [&](const HalfSpace& side) {
    return std::ranges::count(out_.planes[side.plane].normal(), exact::Int128{0}) == 2;
  });
  if (touch_) builder_.adoption_margin_ += 2000 * touch_->reach() / lattice_.pitch() * lattice_unit;
  const double reach = std::max(roundings(), 2 * geometry::opening_quantum.si() / lattice_.pitch());
  on_surfaces_.emplace(surfaces_, reach);
  if (snapper_.active()) within_snap_.emplace(surfaces_, std::max(reach, input_.snap.si() / lattice_.pitch()));
  return {};
}

Preparation::Done Preparation::add_window() {
  if (!input_.window) return {};
  const auto clamped = [&](Vec3 p) {
    return lattice_.snap(std::clamp(p.x, domain_.lo[0], domain_.hi[0]), std::clamp(p.y, domain_.lo[1], domain_.hi[1]),
                         std::clamp(p.z, domain_.lo[2], domain_.hi[2]));
  };
  const LatticePoint lo = clamped(input_.window->min), hi = clamped(input_.window->max);
  if (!builder_.add_window(lo, hi)) return std::unexpected(CutError{WindowOutside{}});
  out_.domain_surface = surface_of_box(lo, hi);
  return {};
}

Preparation::Done Preparation::add_persistent() {
  for (std::size_t j = 0; j < input_.joints.size(); ++j) {
    const auto* persistent = std::get_if<PersistentJoint>(&input_.joints[j]);
    if (persistent == nullptr) continue;
    if (left_out(j, *persistent)) {
      out_.outside.push_back(static_cast<Index>(j));
      continue;
    }
    const auto plane = persistent_plane(point_of(*persistent), persistent->normal, lattice_);
    if (!plane) return std::unexpected(collapsed(j));
    snapper_.remember(*plane);
    // Bounded by a box well around the domain, so that its outline means something where other joints share its
    // plane.
    const LatticePoint lo = lattice_.snap(domain_.lo[0], domain_.lo[1], domain_.lo[2]);
    const LatticePoint hi = lattice_.snap(domain_.hi[0], domain_.hi[1], domain_.hi[2]);
    constexpr std::int64_t margin = 1 << 20;
    FacetBuilder::Piece piece{blank_facet(Owner::joint, static_cast<Index>(j), 0), {}, {}, {}};
    const auto [number, same] = builder_.add_plane(*plane);
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
    builder_.add_piece(std::move(piece));
  }
  return {};
}

void Preparation::touch_domain() {
  if (!touch_ || !shared_.any()) return;
  Moves moves;
  for (const JointPolygon& entry : polygons_) {
    if (!entry.at_border) continue;
    for (const LatticePoint c : entry.corners) {
      if (!shared_.shared(c)) continue;
      if (const LatticePoint to = touch_->beyond(c); to != c) moves.add(c, to);
    }
  }
  moves.finish();
  move(moves);
}

void Preparation::touch_surfaces() {
  for (std::size_t k = 0; k < polygons_.size(); ++k) {
    const JointPolygon& entry = polygons_[k];
    const auto may_touch = [&](const auto& surfaces) { return surfaces && surfaces->near(entry.corners); };
    if (beside_[k] != 0 || !(may_touch(on_surfaces_) || may_touch(within_snap_))) continue;
    const std::vector<std::size_t> shared = shared_.among(entry.corners);
    const auto polygon = make_lattice_polygon(entry.corners, shared);
    if (!polygon) continue;
    const bool by_corners = snapper_.active() && (!polygon->convex || !shared.empty());
    (by_corners ? within_snap_ : on_surfaces_)->look(*polygon);
  }
  move_beyond(*on_surfaces_);
  if (within_snap_) move_beyond(*within_snap_);
}

/// What ends on another joint, from the side on which it lies.
void Preparation::touch_joints() {
  if (endings_.empty()) return;
  SurfaceFaces faces;
  const auto for_each_polygon = [&](Index joint, const auto& visit) {
    for (const JointPolygon& entry : std::ranges::equal_range(polygons_, joint, {}, &JointPolygon::joint)) {
      if (const auto polygon = make_lattice_polygon(entry.corners, shared_.among(entry.corners))) visit(*polygon);
    }
  };
  std::vector<Index> on;
  for (const Ending& ending : endings_) on.push_back(ending.other);
  std::ranges::sort(on);
  const auto again = std::ranges::unique(on);
  on.erase(again.begin(), again.end());
  for (const Index other : on) {
    for_each_polygon(other, [&](const LatticePolygon& polygon) { faces.add(polygon, other); });
    if (const auto plane = builder_.plane_of_joint(other)) faces.add(out_.planes[*plane], other);
  }
  SurfaceTouch others{faces, roundings()};
  for (std::size_t first = 0, last = 0; first < endings_.size(); first = last) {
    const Index joint = endings_[first].joint;
    on.clear();
    for (; last < endings_.size() && endings_[last].joint == joint; ++last) {
      if (endings_[last].other != joint) on.push_back(endings_[last].other);
    }
    if (on.empty()) continue;
    for_each_polygon(joint, [&](const LatticePolygon& polygon) { others.look(polygon, on, shared_); });
  }
  move_beyond(others);
}

void Preparation::move_beyond(SurfaceTouch& surfaces) {
  const Moves moves = surfaces.beyond();
  if (moves.empty()) return;
  for (JointPolygon& entry : polygons_) {
    for (const LatticePoint c : entry.corners) {
      if (moves(c) == c) continue;
      beyond_.push_back(moves(c));
      farthest_move_ = std::max(farthest_move_, distance(c, moves(c)) * lattice_.pitch());
      entry.moved = true;
    }
  }
  std::ranges::sort(beyond_);
  move(moves);
}

/// What ends on a folded polygon ends just behind its plane, so that it meets the pieces.
std::optional<Plane> Preparation::behind(Index joint, LatticePoint middle) const {
  const auto own = std::ranges::find(polygons_, joint, &JointPolygon::joint);
  if (own == polygons_.end() || !own->folded) return std::nullopt;
  const auto number = static_cast<std::size_t>(own - polygons_.begin());
  if (!sheets_[number]) return std::nullopt;
  for (std::size_t k = number; k < polygons_.size(); ++k) {
    if (polygons_[k].joint == joint && (!sheets_[k] || !(*sheets_[k] == *sheets_[number]))) return std::nullopt;
  }
  const Plane& plane = own->polygon.plane;
  const auto n = plane.unit_normal();
  const double by = (plane.side_of(middle) == Sign::positive ? -1 : 1) * (out_.bend + 16);
  const auto moved = [&](std::int64_t x, double c) { return x + static_cast<std::int64_t>(std::llround(c * by)); };
  std::vector<LatticePoint> corners;
  for (const LatticePoint c : own->corners) corners.push_back({moved(c.x, n[0]), moved(c.y, n[1]), moved(c.z, n[2])});
  const auto made = make_lattice_polygon(std::move(corners));
  return made ? std::optional{made->plane} : std::nullopt;
}

Preparation::Done Preparation::terminate() {
  for (const auto& [joint, at] : input_.terminations) {
    const LatticePoint middle = middle_of(input_.joints[joint.index()], lattice_);
    std::optional<Index> plane = builder_.plane_of_joint(at.value());
    if (const auto shifted = behind(at.value(), middle); !plane && shifted) plane = builder_.add_plane(*shifted).first;
    const Sign side = plane ? out_.planes[*plane].side_of(middle) : Sign::zero;
    if (side == Sign::zero) return std::unexpected(CutError{TerminationUndecided{joint, at}});
    builder_.cut_off(joint.value(), {*plane, side == Sign::positive});
  }
  return {};
}

bool HeldCorners::common(std::initializer_list<Index> planes, int count) const {
  const Index fewest = std::ranges::min(planes, {}, [&](Index p) { return of(p).size(); });
  for (const Index corner : of(fewest)) {
    const bool all = std::ranges::all_of(planes, [&](Index p) { return std::ranges::binary_search(of(p), corner); });
    if (all && --count == 0) return true;
  }
  return false;
}

std::expected<Prepared, CutError> prepare(const CutInput& input, std::span<const Ending> endings) {
  CLEAVE_CHECK(check_input(input));
  return Preparation{input, endings}.run();
}

}  // namespace cleave::topology::detail
