#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "cleave/facets/gaps.hpp"
#include "detail/as_vec3.hpp"
#include "detail/folds.hpp"
#include "detail/hanging_corners.hpp"
#include "detail/open_rims.hpp"
#include "detail/overlaps.hpp"
#include "detail/preparation.hpp"
#include "detail/rounded_corners.hpp"
#include "detail/sheets.hpp"
#include "detail/side_users.hpp"

/// Joints of polygons: corners on the lattice, sides shared, planes, facets.
namespace cleave::topology::detail {
namespace {

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

}  // namespace

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
      snapper_.compare(corners, number);
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
  unite_corners();
  part_overlaps();
  hang_corners();
  return {};
}

/// Corners that differ by roundings become one, unless `snap` has done so.
void Preparation::unite_corners() {
  share();
  if (snapper_.active() && input_.snap.si() > computed_twice() * lattice_.pitch()) return;
  const Moves moves = unite_rounded_corners(polygons_, computed_twice());
  for (std::size_t k = 0; k < polygons_.size(); ++k) {
    const auto moved = [&](LatticePoint c) { return moves(c) != c; };
    polygons_[k].moved = !moves.empty() && std::ranges::any_of(polygons_[k].corners, moved);
  }
  move(moves);
}

/// Corners on longer sides. Where no polygons have a corner in common, only if sides come to be shared by it: else
/// nothing was drawn side by side, and what merely ends near another one's rim stays as it is.
void Preparation::hang_corners() {
  const bool any = shared_.any();
  if (!any && !some_lie_in_one_plane(polygons_)) return;
  std::vector<JointPolygon> before;
  if (!any) before = polygons_;
  if (!take_hanging_corners(polygons_, shared_, reach_of_corners())) return;
  share();
  if (any || shared_.any_side()) return;
  polygons_ = std::move(before);
  share();
}

void Preparation::share() {
  shared_.clear();
  for (const JointPolygon& entry : polygons_) shared_.add(entry.corners);
  shared_.finish();
}

/// Polygons that lie on one another become their common parts, so that each part is there once, whoever gave it.
void Preparation::part_overlaps() {
  std::vector<std::pair<JointPolygon, std::uint8_t>> parts;
  std::vector<std::uint8_t> parted(polygons_.size(), 0);
  Moves moves;
  for (const Overlapping& group : find_overlaps(polygons_, shared_, roundings())) {
    std::vector<std::vector<LatticePoint>> rings;
    for (const std::size_t k : group.polygons) rings.push_back(polygons_[k].corners);
    const auto laid = overlay(std::move(rings), group.axis, roundings());
    if (!laid) continue;
    for (const auto& [from, to] : laid->moved) moves.add(from, to);
    for (const std::size_t k : group.polygons) parted[k] = 1;
    for (const Overlay::Part& part : laid->parts) {
      Index before = none;
      for (const std::size_t of : part.of) {
        const std::size_t k = group.polygons[of];
        const JointPolygon& whole = polygons_[k];
        if (std::exchange(before, whole.joint) == whole.joint) continue;
        parts.push_back({{whole.joint, blank_, part.corners, {}, whole.at_border}, beside_[k]});
      }
    }
  }
  if (std::ranges::find(parted, 1) == parted.end()) return;
  moves.finish();
  move(moves);
  for (std::size_t k = 0; k < polygons_.size(); ++k) {
    if (parted[k] == 0) parts.emplace_back(std::move(polygons_[k]), beside_[k]);
  }
  std::ranges::stable_sort(parts, {}, [](const auto& part) { return part.first.joint; });
  polygons_.clear();
  beside_.clear();
  for (auto& [part, beside] : parts) {
    polygons_.push_back(std::move(part));
    beside_.push_back(beside);
  }
  share();
}

void Preparation::move(const Moves& moves) {
  if (moves.empty()) return;
  for (JointPolygon& entry : polygons_) {
    std::ranges::transform(entry.corners, entry.corners.begin(), moves);
    for (auto& hole : entry.holes) std::ranges::transform(hole, hole.begin(), moves);
  }
  share();
}

Preparation::Done Preparation::make_polygon(std::size_t k) {
  JointPolygon& entry = polygons_[k];
  if (beside_[k] != 0) return {};
  const Index first = shared_.first_like(static_cast<Index>(k));
  if (first != k && beside_[first] == 0 && same_ring(polygons_[first].corners, entry.corners)) {
    entry.polygon = polygons_[first].polygon;  // the same plane, from whichever corner it was begun
    entry.corners = polygons_[first].corners;
  } else {
    auto made = make_lattice_polygon(entry.corners, fixing(entry));
    if (!made && (snapper_.active() || entry.moved)) {
      beside_[k] = 1;  // nothing of it is left
      return {};
    }
    if (!made) return std::unexpected(collapsed(entry.joint));
    entry.polygon = *std::move(made);
  }
  set_fold(entry);
  return {};
}

/// The corners that come first in the choice of its plane.
std::vector<std::size_t> Preparation::fixing(const JointPolygon& entry) const {
  std::vector<std::size_t> found = shared_.among(entry.corners);
  if (beyond_.empty()) return found;
  for (std::size_t i = 0; i < entry.corners.size(); ++i) {
    if (std::ranges::binary_search(beyond_, entry.corners[i])) found.push_back(i);
  }
  std::ranges::sort(found);
  const auto again = std::ranges::unique(found);
  found.erase(again.begin(), again.end());
  return found;
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
  bool all = shared_.any_side(), any = false;
  SideUsers::for_each_side(entry, [&](LatticePoint a, LatticePoint b) {
    if (!all) return;
    const bool own = shared_.shared(a, b);
    Vec3 p = as_vec3(a), q = as_vec3(b);
    any = any || own;
    all = own || !clip_to_domain(out_, p, q);
  });
  return all && any;
}

void Preparation::snap_planes() {
  std::vector<LatticePolygon> own;
  for (const JointPolygon& entry : polygons_) own.push_back(entry.polygon);
  snapper_.merge_planes(polygons_, shared_);
  for (std::size_t k = 0; k < polygons_.size(); ++k) {
    JointPolygon& entry = polygons_[k];
    set_fold(entry);
    if (!entry.folded || entry.polygon.plane.coincides_with(own[k].plane)) continue;
    entry.polygon = std::move(own[k]);  // it is cut on its own corners after all
    set_fold(entry);
  }
}

/// Where the sides of a polygon end when not on its own corners.
std::vector<std::optional<HalfSpace>> Preparation::adopted_sides(std::size_t k) {
  const JointPolygon& entry = polygons_[k];
  std::vector<std::optional<HalfSpace>> adopted;
  if (touch_ && entry.at_border) adopted = touch_->ends(entry.polygon);
  if (!snapper_.active()) return adopted;
  const auto on_others =
      snapper_.adopt_edges(polygons_, k, shared_, [&](const Plane& plane) { return builder_.add_plane(plane); });
  adopted.resize(on_others.size());
  for (std::size_t i = 0; i < adopted.size(); ++i) {
    if (on_others[i]) adopted[i] = on_others[i];
  }
  return adopted;
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
    const auto adopted = adopted_sides(k);
    if (builder_.add_polygon(entry.polygon, facet, adopted, ended_on(entry.joint))) continue;
    if (!snapper_.active()) return std::unexpected(collapsed(entry.joint));
    builder_.add_folded(fold(entry.corners), facet);  // crossed itself once its corners were one
  }
  return {};
}

void Preparation::unite_sheets() {
  const double flat = std::max(flat_within, roundings_of_corners * farthest_ * 0x1p-52 / lattice_.pitch());
  sheets_ = find_sheets(polygons_, beside_, shared_, flat, out_.bend);
  double extent = 0;
  for (std::size_t k = 0; k < 3; ++k) extent = std::max(extent, domain_.hi[k] - domain_.lo[k]);
  out_.open_rims = find_open_rims(polygons_, beside_, sheets_, shared_, out_, near_miss * extent / lattice_.pitch());
}

}  // namespace cleave::topology::detail
