#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <expected>
#include <optional>
#include <span>
#include <vector>

#include "cleave/core/expected.hpp"
#include "cleave/facets/prepared.hpp"
#include "detail/domain_touch.hpp"
#include "detail/extents.hpp"
#include "detail/facet_builder.hpp"
#include "detail/folds.hpp"
#include "detail/joint_polygon.hpp"
#include "detail/shared_corners.hpp"
#include "detail/snapping.hpp"
#include "detail/surface_touch.hpp"

namespace cleave::topology::detail {

using exact::LatticePoint;
using exact::Plane;
using exact::Sign;
using geometry::Vec3;

/// Phase 1, step by step.
class Preparation {
 public:
  Preparation(const CutInput& input, std::span<const Ending> endings)
      : input_{input},
        endings_{endings},
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
    touch_surfaces();
    touch_joints();
    CLEAVE_CHECK(make_polygons());
    if (snapper_.active()) snap_planes();
    unite_sheets();
    CLEAVE_CHECK(add_polygons());
    CLEAVE_CHECK(terminate());
    builder_.finish();
    out_.roundings = roundings();
    out_.draw_outlines = input_.keep_dangling || input_.keep_network;
    out_.largest_snap = metres(std::max(snapper_.largest_move(), farthest_move_));
    out_.coarse_snap = snapper_.coarse();
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

  /// How far corners may be off where they were meant to be by roundings of the coordinates, sites.
  [[nodiscard]] double roundings() const { return roundings_of_corners * (1 + farthest_ * 0x1p-52 / lattice_.pitch()); }
  /// How far apart one corner may come to lie when it is computed twice: on sites next to each other, and in scenes far
  /// from the origin of coordinates as many roundings as above; sites.
  [[nodiscard]] double computed_twice() const {
    return 2 + roundings_of_corners * farthest_ * 0x1p-52 / lattice_.pitch();
  }
  /// How far they may be off the side that they were given on: by roundings, or `snap`; sites.
  [[nodiscard]] double reach_of_corners() const { return std::max(roundings(), input_.snap.si() / lattice_.pitch()); }

  exact::Lattice covering() const;
  void weld();
  Done add_solid(const geometry::Solid& solid, Owner owner, Index index, std::optional<std::uint32_t> excavation);
  Done add_solids();
  Done add_window();
  Done add_persistent();
  Done collect_polygons();
  void unite_corners();
  void hang_corners();
  void share();
  void part_overlaps();
  void move(const Moves& moves);
  void touch_domain();
  void touch_surfaces();
  void touch_joints();
  void move_beyond(SurfaceTouch& surfaces);
  [[nodiscard]] std::vector<std::size_t> fixing(const JointPolygon& entry) const;
  Done make_polygons();
  Done make_polygon(std::size_t k);
  void set_fold(JointPolygon& entry) const;
  void drop_vanished();
  bool rim_shared(const JointPolygon& entry) const;
  void snap_planes();
  void unite_sheets();
  std::vector<std::optional<HalfSpace>> adopted_sides(std::size_t k);
  Done add_polygons();
  std::optional<Plane> behind(Index joint, LatticePoint middle) const;
  Done terminate();

  const CutInput& input_;
  std::span<const Ending> endings_;
  Bounds domain_;
  exact::Lattice lattice_;
  Prepared out_;
  Snapper snapper_;
  FacetBuilder builder_;
  std::optional<DomainTouch> touch_;
  SurfaceFaces surfaces_;                    ///< of excavations, and of a domain that is not convex
  std::optional<SurfaceTouch> on_surfaces_;  ///< within roundings
  std::optional<SurfaceTouch> within_snap_;  ///< with `snap`, for polygons whose sides cannot all adopt planes
  std::vector<LatticePoint> beyond_;         ///< corners that were moved beyond these, sorted
  SharedCorners shared_;
  std::vector<JointPolygon> polygons_;
  std::vector<std::uint8_t> beside_;          ///< polygons that miss the window, or that snap has left nothing of
  std::vector<std::optional<Plane>> sheets_;  ///< of folded polygons and their neighbours: what stands for all pieces
  double farthest_ = 0;                       ///< coordinate of the domain, m
  double farthest_move_ = 0;                  ///< of a corner beyond what it was drawn to end on, m
  bool boxed_ = false;                        ///< the domain is a box with its sides along the axes
  const LatticePolygon blank_{Plane::spanned({}, {1, 0, 0}, {0, 1, 0}).value(), {}, {}, true, true};
};

}  // namespace cleave::topology::detail
