#include "cleave/stability/analyse.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "cleave/core/overloaded.hpp"
#include "cleave/geometry/box_tree.hpp"

namespace cleave::stability {
namespace {

using geometry::Vec3;
using Corner = std::array<double, 3>;

struct Bounds : geometry::Extents {
  [[nodiscard]] bool empty() const { return !(lo[0] <= hi[0]); }
  [[nodiscard]] double volume() const { return (hi[0] - lo[0]) * (hi[1] - lo[1]) * (hi[2] - lo[2]); }
};

Bounds common(const Bounds& a, const Bounds& b) {
  Bounds c;
  for (std::size_t k = 0; k < 3; ++k) {
    c.lo[k] = std::max(a.lo[k], b.lo[k]);
    c.hi[k] = std::min(a.hi[k], b.hi[k]);
    if (c.lo[k] > c.hi[k]) return Bounds{};
  }
  return c;
}

/// Area of a joint polygon that may lie in the box, m2: scaled by how much of its own box does.
double area_in(const geometry::Polygon& polygon, const Bounds& box) {
  Bounds own;
  Vec3 twice{};
  const auto corners = polygon.corners();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    own.add(corners[i]);
    if (i >= 2) twice += geometry::cross(corners[i - 1] - corners[0], corners[i] - corners[0]);
  }
  double share = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    const double from = std::max(own.lo[k], box.lo[k]), to = std::min(own.hi[k], box.hi[k]);
    if (from > to) return 0;
    if (own.hi[k] > own.lo[k]) share = std::min(share, (to - from) / (own.hi[k] - own.lo[k]));
  }
  return 0.5 * geometry::norm(twice) * share;
}

/// A typical distance from joint to joint, m: three sets with spacing s have 3 / s of joint area in a unit of volume.
double spacing(const topology::CutInput& input, const Bounds& domain) {
  double area = 0;
  for (const auto& entry : input.joints) {
    std::visit(overloaded{[&](const topology::Joint& joint) {
                            for (const auto& polygon : joint.polygons) area += area_in(polygon, domain);
                          },
                          [&](const topology::PersistentJoint&) { area += std::cbrt(std::pow(domain.volume(), 2)); }},
               entry);
  }
  return area > 0 ? 3 * domain.volume() / area : std::numeric_limits<double>::infinity();
}

}  // namespace

std::optional<NearField> NearField::around_free_faces(const topology::CutInput& input, double depth) {
  Bounds domain, free;
  for (const Vec3& v : input.domain.vertices()) domain.add(v);
  for (const geometry::Solid& excavation : input.excavations) {
    Bounds own;
    for (const Vec3& v : excavation.vertices()) own.add(v);
    const Bounds part = common(own, domain);
    if (part.empty()) continue;
    free.add(part.lo);
    free.add(part.hi);
  }
  for (const geometry::SolidFace& face : input.domain.faces()) {
    if (std::ranges::find(input.free_domain_tags, face.tag) == input.free_domain_tags.end()) continue;
    for (const std::uint32_t corner : face.corners) free.add(input.domain.vertices()[corner]);
  }
  if (free.empty()) return std::nullopt;
  NearField near;
  near.free_min_ = free.lo;
  near.free_max_ = free.hi;
  near.domain_min_ = domain.lo;
  near.domain_max_ = domain.hi;
  near.margin_.fill(std::max(depth, 1.5 * spacing(input, domain)));
  if (!near.worth_while()) return std::nullopt;
  return near;
}

topology::Window NearField::window() const noexcept {
  Corner lo{}, hi{};
  for (std::size_t k = 0; k < 3; ++k) {
    lo[k] = std::max(domain_min_[k], free_min_[k] - margin_[2 * k]);
    hi[k] = std::min(domain_max_[k], free_max_[k] + margin_[2 * k + 1]);
  }
  return {{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}};
}

bool NearField::worth_while() const noexcept {
  const topology::Window w = window();
  double share = 1;
  const Corner size{w.max.x - w.min.x, w.max.y - w.min.y, w.max.z - w.min.z};
  for (std::size_t k = 0; k < 3; ++k) share *= size[k] / (domain_max_[k] - domain_min_[k]);
  return share < 0.5;
}

bool NearField::grow(const topology::BlockComplex& complex, std::span<const topology::BlockId> undecided) {
  std::array<bool, 6> reached{};
  for (const topology::BlockId block : undecided) {
    for (const topology::FaceId id : complex.blocks()[block].faces) {
      const topology::Face& face = complex.faces()[id];
      if (face.role != topology::Role::window) continue;
      const Corner n{face.outward.x, face.outward.y, face.outward.z};
      for (std::size_t k = 0; k < 3; ++k) {
        if (n[k] < -0.5) reached[2 * k] = true;
        if (n[k] > 0.5) reached[2 * k + 1] = true;
      }
    }
  }
  for (std::size_t side = 0; side < 6; ++side) {
    if (reached[side]) margin_[side] *= 2;
  }
  return worth_while();
}

std::expected<NearKeyBlocks, NearError> analyse_near_field(const topology::CutInput& input, const Settings& settings,
                                                           const topology::CutOptions& options, StageTimer& timer,
                                                           const NearFieldOptions& more) {
  topology::CutInput part = input;
  Settings only_key = settings;
  only_key.only_key_blocks = true;
  std::optional<NearField> near = NearField::around_free_faces(input, more.depth.si());
  for (unsigned round = 1;; ++round) {
    part.window = near ? std::optional{near->window()} : std::nullopt;
    auto cut = timer.run("cut", [&] { return topology::cut(part, options); });
    if (!cut) return std::unexpected(NearError{std::move(cut).error()});
    auto audited = timer.run("audit", [&] { return topology::audit(*std::move(cut), options.threads); });
    if (!audited) return std::unexpected(NearError{std::move(audited).error()});
    Analysis analysis = timer.run("stability", [&] { return analyse(*audited, only_key); });
    std::vector<topology::BlockId> undecided = analysis.undecided;
    if (undecided.empty() && more.undecided) undecided = more.undecided(*audited, analysis);
    if (undecided.empty() || !near) {
      return NearKeyBlocks{*std::move(audited), std::move(analysis), part.window, round};
    }
    if (!near->grow(audited->complex(), undecided)) near.reset();
  }
}

}  // namespace cleave::stability
