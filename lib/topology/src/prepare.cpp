#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/core/overloaded.hpp"
#include "detail/domain_touch.hpp"
#include "detail/extents.hpp"
#include "detail/facet_builder.hpp"
#include "detail/folds.hpp"
#include "detail/hanging_corners.hpp"
#include "detail/input_check.hpp"
#include "detail/joint_polygon.hpp"
#include "detail/prepared.hpp"
#include "detail/shared_corners.hpp"
#include "detail/sheets.hpp"
#include "detail/side_users.hpp"
#include "detail/snapping.hpp"
#include "detail/solids.hpp"

namespace cleave::topology::detail {
namespace {

using exact::LatticePoint;
using exact::Plane;
using exact::Sign;
using geometry::Vec3;

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

/// The same corners in the same order, from whichever and whichever way round.
bool same_ring(std::span<const LatticePoint> a, std::vector<LatticePoint> b) {
  if (a.size() != b.size()) return false;
  for (int way = 0; way < 2; ++way) {
    const auto start = std::ranges::find(b, a.front());
    if (start == b.end()) return false;
    std::ranges::rotate(b, start);
    if (std::ranges::equal(a, b)) return true;
    std::ranges::reverse(b);
  }
  return false;
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

/// Stage 1, step by step.
class Preparation {
 public:
  explicit Preparation(const CutInput& input)
      : input_{input},
        domain_{bounds_of(input.domain.vertices())},
        lattice_{covering()},
        out_{lattice_},
        snapper_{lattice_, input.snap.si()},
        builder_{out_} {}

  [[nodiscard]] std::expected<Prepared, CutError> run() && {
    builder_.adoption_margin_ = box_margin + 4 * input_.snap.si() / lattice_.pitch() * lattice_unit;
    out_.joint_count = static_cast<Index>(input_.joints.size());
    out_.excavation_count = static_cast<Index>(input_.excavations.size());
    weld();
    CLEAVE_CHECK(add_solids());
    CLEAVE_CHECK(add_window());
    CLEAVE_CHECK(add_persistent());
    CLEAVE_CHECK(collect_polygons());
    touch_domain();
    CLEAVE_CHECK(make_polygons());
    if (snapper_.active()) snap_planes();
    unite_sheets();
    CLEAVE_CHECK(add_polygons());
    CLEAVE_CHECK(terminate());
    builder_.finish();
    out_.keep_dangling = input_.keep_dangling;
    out_.largest_snap = snapper_.largest_move();
    out_.merged_planes = snapper_.merged_planes();
    out_.adopted_edges = snapper_.adopted_edges();
    out_.snapped = snapper_.changed();
    std::ranges::sort(out_.outside);
    return std::move(out_);
  }

 private:
  using Done = std::expected<void, CutError>;

  static Bounds bounds_of(std::span<const Vec3> points) {
    Bounds box;
    for (const Vec3& p : points) box.add(p);
    return box;
  }
  [[nodiscard]] CutError collapsed(std::size_t joint) const {
    return JointCollapsed{JointId{joint}, metres(lattice_.pitch())};
  }
  [[nodiscard]] bool ended_on(std::size_t joint) const {  // its plane is needed wherever it lies
    return std::ranges::find(input_.terminations, JointId{joint}, &Termination::at) != input_.terminations.end();
  }
  /// Wholly outside the domain: it cuts nothing, whatever its corners become.
  [[nodiscard]] bool left_out(std::size_t joint, const Bounds& polygon) const {
    return far_apart(polygon, domain_, 4 * input_.snap.si()) && !ended_on(joint);
  }
  [[nodiscard]] bool left_out(std::size_t joint, const PersistentJoint& plane) const {
    const Vec3 p = point_of(plane),
               size{domain_.hi[0] - domain_.lo[0], domain_.hi[1] - domain_.lo[1], domain_.hi[2] - domain_.lo[2]};
    const std::array c{p.x, p.y, p.z};
    double off = 0;
    for (std::size_t k = 0; k < 3; ++k) off = std::max(off, std::abs(c[k] - (domain_.lo[k] + domain_.hi[k]) / 2));
    return off > 16 * geometry::norm(size) && !ended_on(joint);
  }
  /// Of a box whose sides are those of the domain: for others nothing is known.
  [[nodiscard]] bool well_inside(const Bounds& polygon) const {
    if (!boxed_) return false;
    const double reach = 2 * touch_->reach();
    for (std::size_t k = 0; k < 3; ++k) {
      if (polygon.lo[k] < domain_.lo[k] + reach || polygon.hi[k] > domain_.hi[k] - reach) return false;
    }
    return true;
  }
  /// A persistent joint's point, or one nearer to the domain where that is far away.
  [[nodiscard]] Vec3 point_of(const PersistentJoint& joint) const {
    const Vec3 lo{domain_.lo[0], domain_.lo[1], domain_.lo[2]}, hi{domain_.hi[0], domain_.hi[1], domain_.hi[2]};
    const Vec3 middle = lo + 0.5 * (hi - lo), size = hi - lo, off = joint.through - middle;
    if (std::abs(off.x) <= 2 * size.x && std::abs(off.y) <= 2 * size.y && std::abs(off.z) <= 2 * size.z)
      return joint.through;
    const Vec3 n = geometry::normalized(joint.normal);
    return middle + dot(n, off) * n;
  }

  /// How far corners may be off the side that they were given on: roundings of the coordinates, or `snap`; sites.
  [[nodiscard]] double reach_of_corners() const {
    const double roundings = roundings_of_corners * (1 + farthest_ * 0x1p-52 / lattice_.pitch());
    return std::max(roundings, input_.snap.si() / lattice_.pitch());
  }

  exact::Lattice covering() const;
  void weld();
  Done add_solid(const geometry::Solid& solid, Owner owner, Index index, std::optional<std::uint32_t> excavation);
  Done add_solids();
  Done add_window();
  Done add_persistent();
  Done collect_polygons();
  void share();
  void move(const Moves& moves);
  void touch_domain();
  Done make_polygons();
  Done make_polygon(std::size_t k);
  void set_fold(JointPolygon& entry) const;
  void drop_vanished();
  bool rim_shared(const JointPolygon& entry) const;
  void snap_planes();
  void unite_sheets();
  Done add_polygons();
  std::optional<Plane> behind(Index joint, LatticePoint middle) const;
  Done terminate();

  const CutInput& input_;
  Bounds domain_;
  exact::Lattice lattice_;
  Prepared out_;
  Snapper snapper_;
  FacetBuilder builder_;
  std::optional<DomainTouch> touch_;
  SharedCorners shared_;
  std::vector<JointPolygon> polygons_;
  std::vector<std::uint8_t> beside_;          ///< polygons that miss the window, or that snap has left nothing of
  std::vector<std::optional<Plane>> sheets_;  ///< of folded polygons and their neighbours: what stands for all pieces
  double farthest_ = 0;                       ///< coordinate of the domain, m
  bool boxed_ = false;                        ///< the domain is a box with its sides along the axes
  const LatticePolygon blank_{Plane::spanned({}, {1, 0, 0}, {0, 1, 0}).value(), {}, {}, true, true};
};

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
                              scene.add({box.lo[0], box.lo[1], box.lo[2]});
                              scene.add({box.hi[0], box.hi[1], box.hi[2]});
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
    if (!snapper_.active()) continue;
    std::vector<LatticePoint> corners;
    for (const std::uint32_t v : face.corners) corners.push_back(sites[v]);
    if (auto polygon = make_lattice_polygon(std::move(corners))) snapper_.remember(*polygon);
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

/// All polygons that reach the domain, on the lattice. Which corners they share is a matter of the whole domain; those
/// that miss the window are then left.
Preparation::Done Preparation::collect_polygons() {
  Bounds region = domain_;
  if (const auto& window = input_.window) {
    const std::array lo{window->min.x, window->min.y, window->min.z}, hi{window->max.x, window->max.y, window->max.z};
    for (std::size_t k = 0; k < 3; ++k) {
      region.lo[k] = std::max(region.lo[k], lo[k]);
      region.hi[k] = std::min(region.hi[k], hi[k]);
    }
  }
  const auto sites_of = [&](std::span<const Vec3> points, Index joint) {
    std::vector<LatticePoint> sites;
    sites.reserve(points.size());
    for (const Vec3& p : points) sites.push_back(snapper_.site(p, joint));
    return sites;
  };
  for (std::size_t j = 0; j < input_.joints.size(); ++j) {
    const auto* joint = std::get_if<Joint>(&input_.joints[j]);
    if (joint == nullptr) continue;
    const auto number = static_cast<Index>(j);
    Bounds own;
    for (std::size_t k = 0; k < joint->polygons.size(); ++k) {
      const auto corners = joint->polygons[k].corners();
      const Bounds box = bounds_of(corners);
      for (std::size_t i = 0; i < 3; ++i) {
        own.lo[i] = std::min(own.lo[i], box.lo[i]);
        own.hi[i] = std::max(own.hi[i], box.hi[i]);
      }
      if (left_out(j, box)) continue;
      JointPolygon entry{number, blank_, {}, {}};
      entry.corners = sites_of(corners, number);
      entry.at_border = touch_.has_value() && !well_inside(box);
      if (k < joint->holes.size()) {
        for (const auto& hole : joint->holes[k]) entry.holes.push_back(sites_of(hole.corners(), number));
      }
      beside_.push_back(!snapper_.active() && !ended_on(j) &&
                                (far_apart(box, region, 16 * lattice_.pitch()) ||
                                 (input_.window && beside(corners, region, lattice_.pitch())))
                            ? 1
                            : 0);
      polygons_.push_back(std::move(entry));
    }
    bool apart = joint->polygons.empty();
    for (std::size_t k = 0; k < 3; ++k) apart = apart || own.hi[k] < domain_.lo[k] || own.lo[k] > domain_.hi[k];
    if (apart) out_.outside.push_back(number);
  }
  share();
  if (shared_.any() && take_hanging_corners(polygons_, shared_, reach_of_corners())) share();
  return {};
}

void Preparation::share() {
  shared_.clear();
  for (const JointPolygon& entry : polygons_) shared_.add(entry.corners);
  shared_.finish();
}

void Preparation::move(const Moves& moves) {
  if (moves.empty()) return;
  for (JointPolygon& entry : polygons_) {
    std::ranges::transform(entry.corners, entry.corners.begin(), moves);
    for (auto& hole : entry.holes) std::ranges::transform(hole, hole.begin(), moves);
  }
  share();
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

Preparation::Done Preparation::make_polygon(std::size_t k) {
  JointPolygon& entry = polygons_[k];
  if (beside_[k] != 0) return {};
  const Index first = shared_.first_like(static_cast<Index>(k));
  if (first != k && beside_[first] == 0 && same_ring(polygons_[first].corners, entry.corners)) {
    entry.polygon = polygons_[first].polygon;  // the same plane, from whichever corner it was begun
    entry.corners = polygons_[first].corners;
  } else {
    auto made = make_lattice_polygon(entry.corners, shared_.among(entry.corners));
    if (!made && snapper_.active()) {
      beside_[k] = 1;  // nothing of it is left
      return {};
    }
    if (!made) return std::unexpected(collapsed(entry.joint));
    entry.polygon = *std::move(made);
  }
  set_fold(entry);
  return {};
}

void Preparation::set_fold(JointPolygon& entry) const {
  entry.folded = false;
  entry.bend = 0;
  if (entry.polygon.exactly_planar) return;
  const std::size_t count = entry.corners.size();
  for (std::size_t i = 0; i < count && !entry.folded; ++i) {
    const LatticePoint a = entry.corners[i], b = entry.corners[(i + 1) % count];
    if (a == b || !shared_.shared(a, b)) continue;
    const Plane& plane = entry.polygon.plane;
    entry.folded = plane.side_of(a) != Sign::zero || plane.side_of(b) != Sign::zero;
  }
  if (!entry.folded) return;
  for (const LatticePoint c : entry.corners) {
    entry.bend = std::max(entry.bend, distance_sites(entry.polygon.plane, c));
  }
}

Preparation::Done Preparation::make_polygons() {
  for (std::size_t k = 0; k < polygons_.size(); ++k) CLEAVE_CHECK(make_polygon(k));
  if (!snapper_.active()) return {};
  drop_vanished();
  move(snapper_.moves_through(polygons_, shared_));
  for (std::size_t k = 0; k < polygons_.size(); ++k) CLEAVE_CHECK(make_polygon(k));
  drop_vanished();
  return {};
}

void Preparation::drop_vanished() {
  std::vector<JointPolygon> kept;
  for (std::size_t k = 0; k < polygons_.size(); ++k) {
    if (beside_[k] == 0) kept.push_back(std::move(polygons_[k]));
  }
  const bool some = kept.size() < polygons_.size();
  polygons_ = std::move(kept);
  beside_.assign(polygons_.size(), 0);
  if (some) share();
}

bool Preparation::rim_shared(const JointPolygon& entry) const {
  bool all = shared_.any_side();
  SideUsers::for_each_side(entry, [&](LatticePoint a, LatticePoint b) { all = all && shared_.shared(a, b); });
  return all;
}

void Preparation::snap_planes() {
  snapper_.merge_planes(polygons_, shared_);
  for (JointPolygon& entry : polygons_) set_fold(entry);
}

Preparation::Done Preparation::add_polygons() {
  if (shared_.any()) {
    std::vector<LatticePoint> corners;
    for (const JointPolygon& entry : polygons_) {
      corners.insert(corners.end(), entry.corners.begin(), entry.corners.end());
      for (const auto& hole : entry.holes) corners.insert(corners.end(), hole.begin(), hole.end());
    }
    std::ranges::sort(corners);
    const auto again = std::ranges::unique(corners);
    corners.erase(again.begin(), again.end());
    builder_.number_corners(std::move(corners));
  }
  for (std::size_t k = 0; k < polygons_.size(); ++k) {
    JointPolygon& entry = polygons_[k];
    if (beside_[k] != 0) continue;
    Facet facet = blank_facet(Owner::joint, entry.joint, 0);
    if (sheets_[k]) facet.sheet = builder_.add_sheet(*sheets_[k]);
    facet.rim_shared = rim_shared(entry);
    if (entry.folded) {
      const auto triangles =
          entry.holes.empty() ? fold(entry.corners) : triangulate_with_holes(entry.polygon, std::move(entry.holes));
      if (triangles.empty()) return std::unexpected(collapsed(entry.joint));
      builder_.add_folded(triangles, facet);
      continue;
    }
    if (!entry.holes.empty()) {
      if (!builder_.add_with_holes(entry.polygon, std::move(entry.holes), facet)) {
        return std::unexpected(collapsed(entry.joint));
      }
      continue;
    }
    std::vector<std::optional<HalfSpace>> adopted;
    if (touch_ && entry.at_border) adopted = touch_->ends(entry.polygon);
    if (snapper_.active()) {
      const auto on_others =
          snapper_.adopt_edges(polygons_, k, shared_, [&](const Plane& plane) { return builder_.add_plane(plane); });
      adopted.resize(on_others.size());
      for (std::size_t i = 0; i < adopted.size(); ++i) {
        if (on_others[i]) adopted[i] = on_others[i];
      }
    }
    if (builder_.add_polygon(entry.polygon, facet, adopted, ended_on(entry.joint))) continue;
    if (!snapper_.active()) return std::unexpected(collapsed(entry.joint));
    builder_.add_folded(fold(entry.corners), facet);  // crossed itself once its corners were one
  }
  return {};
}

void Preparation::unite_sheets() {
  const double flat = std::max(flat_within, roundings_of_corners * farthest_ * 0x1p-52 / lattice_.pitch());
  sheets_ = find_sheets(polygons_, beside_, shared_, flat, out_.bend);
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

}  // namespace

bool HeldCorners::common(std::initializer_list<Index> planes, int count) const {
  const Index fewest = std::ranges::min(planes, {}, [&](Index p) { return of(p).size(); });
  for (const Index corner : of(fewest)) {
    const bool all = std::ranges::all_of(planes, [&](Index p) { return std::ranges::binary_search(of(p), corner); });
    if (all && --count == 0) return true;
  }
  return false;
}

std::expected<Prepared, CutError> prepare(const CutInput& input) {
  CLEAVE_CHECK(check_input(input));
  return Preparation{input}.run();
}

}  // namespace cleave::topology::detail
