#include "cleave/dfn/sample.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "cleave/core/assert.hpp"
#include "cleave/core/overloaded.hpp"
#include "cleave/core/rng.hpp"
#include "models.hpp"
#include "orientation.hpp"
#include "outline.hpp"
#include "poisson.hpp"
#include "shape.hpp"

namespace cleave::dfn {

using geometry::Polygon;
using geometry::Vec3;

namespace {

constexpr double most_joints = 1e7;  // of one set: some gigabytes

/// Models whose joints lie on planes through the whole domain.
bool on_planes_model(const JointSet& set) {
  const Model& model = set.spec().model;
  return std::holds_alternative<Veneziano>(model) || std::holds_alternative<Dershowitz>(model) ||
         std::holds_alternative<Hierarchical>(model) || std::holds_alternative<Mit>(model);
}
bool is_persistent(const JointSet& set) {
  return std::holds_alternative<Persistent>(set.spec().shape) || on_planes_model(set);
}

double volume(const DomainBox& box) {
  const Vec3 s = box.size();
  return s.x * s.y * s.z;
}

/// Where centres are drawn, and their mean number (exact number for Count).
struct Region {
  DomainBox box;    // of centres
  double ball = 0;  // > 0: planes at an offset in (-ball, ball) from the box's centre instead
  double joints = 0;
  bool exact = false;
};

DomainBox scaled(const DomainBox& box, double times) {
  const Vec3 middle = (box.min + box.max) / 2, half = times / 2 * box.size();
  return {middle - half, middle + half};
}

Region region_of(const JointSet& set, const DomainBox& domain) {
  const double buffer = set.spec().buffer.value_or(1);
  if (const auto* count = std::get_if<Count>(&set.spec().intensity)) {
    const DomainBox box = buffer > 1 ? scaled(domain, buffer) : domain;
    const double times = count->in_buffer ? 1 : buffer * buffer * buffer;
    return {box, 0, std::round(static_cast<double>(count->joints) * times), true};
  }
  const double p32 = set.expected_p32(volume(domain));
  if (!(p32 > 0)) return {domain, 0, 0, true};
  if (is_persistent(set)) {
    // A plane with normal n meets the ball when its offset along n is within the radius: area per volume is offsets per
    // length.
    const DomainBox box = domain.grown(detail::reach_of_moves(set));
    const double radius = norm(box.size()) / 2;
    return {box, radius, 2 * radius * p32 / set.area_share(), false};
  }
  const DomainBox box = set.spec().buffer ? scaled(domain, buffer) : domain.grown(set.reach());
  return {box, 0, p32 / (set.area_share() * set.mean_area()) * volume(box), false};
}

class Sampler final {
 public:
  Sampler(const JointSet& set, std::size_t number, const DomainBox& domain, std::uint64_t seed,
          std::uint64_t realization)
      : set_{set},
        number_{number},
        domain_{domain},
        seed_{seed},
        realization_{realization},
        region_{region_of(set, domain)},
        size_{set.spec().shape},
        two_draws_{size_.two_draws()},
        mean_{detail::mean_frame(set.spec().orientation)},
        unit_{detail::unit_corners(size_.sides())} {}

  [[nodiscard]] std::expected<std::vector<SampledJoint>, SampleError> run();

 private:
  [[nodiscard]] Rng stream(Draw what, std::uint32_t index) const {
    return Rng{{.seed = seed_, .realization = realization_, .purpose = stream_purpose(number_, what), .index = index}};
  }
  [[nodiscard]] std::uint32_t count() const;
  [[nodiscard]] Vec3 centre(std::uint32_t i) const;
  [[nodiscard]] std::optional<SampledJoint> plane(std::uint32_t i) const;
  /// By (1 + 2e-9) of its half sizes in each direction.
  [[nodiscard]] bool may_meet(std::uint32_t i, Vec3 centre, std::optional<detail::HalfAxes>& half);
  [[nodiscard]] detail::HalfAxes half_axes(double u, std::uint32_t i) const {
    return size_.draw(u, two_draws_ ? stream(Draw::aspect, i).uniform() : 0.5);
  }
  [[nodiscard]] double reach_of(const detail::HalfAxes& half) const {
    return (1 + 2e-9) * (size_.sides() == 0 ? std::hypot(half.first, half.second) : std::max(half.first, half.second));
  }
  [[nodiscard]] JointOutline outline(std::uint32_t i, const detail::Frame& frame, const detail::HalfAxes& half) const;
  /// Whether the box around the corners meets the domain's.
  [[nodiscard]] bool corners_meet(const JointOutline& outline, Vec3 centre) const;

  const JointSet& set_;
  std::size_t number_;
  const DomainBox& domain_;
  std::uint64_t seed_, realization_;
  Region region_;
  detail::SizeDrawer size_;
  bool two_draws_;
  detail::Frame mean_;
  std::vector<detail::FlatPoint> unit_;
  std::vector<double> farthest_;  ///< reach of the joints whose number for the size lies below (k + 1)/farthest_.size()
};

std::uint32_t Sampler::count() const {
  if (region_.exact) return static_cast<std::uint32_t>(region_.joints);
  Rng rng = stream(Draw::count, 0);
  return static_cast<std::uint32_t>(detail::poisson(region_.joints, rng));
}

Vec3 Sampler::centre(std::uint32_t i) const {
  Rng rng = stream(Draw::position, i);
  const Vec3 s = region_.box.size();
  Vec3 p;  // one after the other: the order of evaluation is part of the result
  p.x = region_.box.min.x + rng.uniform() * s.x;
  p.y = region_.box.min.y + rng.uniform() * s.y;
  p.z = region_.box.min.z + rng.uniform() * s.z;
  return p;
}

detail::Frame draw_frame(const OrientationLaw& law, const detail::Frame& mean, Rng rng) {
  const double u = rng.uniform(), v = rng.uniform();
  return detail::draw(law, mean, u, v);
}

std::optional<SampledJoint> Sampler::plane(std::uint32_t i) const {
  const Vec3 normal = draw_frame(set_.spec().orientation, mean_, stream(Draw::orientation, i)).normal;
  Vec3 through;
  if (region_.ball > 0) {
    const double offset = (2 * stream(Draw::position, i).uniform() - 1) * region_.ball;
    const Vec3 half = region_.box.size() / 2;
    const double width = std::abs(normal.x) * half.x + std::abs(normal.y) * half.y + std::abs(normal.z) * half.z;
    if (std::abs(offset) > width) return std::nullopt;
    through = (domain_.min + domain_.max) / 2 + offset * normal;
  } else {
    through = centre(i);
  }
  return SampledJoint{InfinitePlane{through, normal}, through, normal, i};
}

bool Sampler::corners_meet(const JointOutline& outline, Vec3 centre) const {
  return domain_.overlaps(geometry::box_of(detail::corners_of(outline, centre, unit_)));
}

/// Most joints of a grown region are too small to reach the box from where they lie: streams are keyed, so their
/// orientations need not be drawn, nor their sizes where a table says enough.
bool Sampler::may_meet(std::uint32_t i, Vec3 centre, std::optional<detail::HalfAxes>& half) {
  const auto meets_within = [&](double r) {
    return domain_.overlaps({centre - Vec3{r, r, r}, centre + Vec3{r, r, r}});
  };
  if (meets_within(0)) return true;
  const double u = stream(Draw::size, i).uniform();
  if (!farthest_.empty()) {
    const auto bins = static_cast<double>(farthest_.size());
    if (!meets_within(farthest_[static_cast<std::size_t>(u * bins)])) return false;
  }
  half = half_axes(u, i);
  return meets_within(reach_of(*half));
}

JointOutline Sampler::outline(std::uint32_t i, const detail::Frame& frame, const detail::HalfAxes& half) const {
  return detail::outline_of(frame, detail::draw_rotation(set_.spec().rotation, stream(Draw::rotation, i)), half,
                            size_.sides());
}

std::expected<std::vector<SampledJoint>, SampleError> Sampler::run() {
  if (!(region_.joints <= most_joints)) return std::unexpected(TooManyJoints{region_.joints, most_joints});
  const std::uint32_t n = count();
  std::vector<SampledJoint> joints;
  joints.reserve(n);
  const bool persistent = is_persistent(set_);
  if (!persistent && n >= 4096 && volume(region_.box) > 1.5 * volume(domain_)) {
    constexpr std::size_t bins = 256;
    for (std::size_t k = 1; k <= bins; ++k) {
      const double u = std::min(static_cast<double>(k) / bins, 1 - 0x1p-53);
      farthest_.push_back((1 + 1e-6) * reach_of(size_.draw(u, 1 - 0x1p-53)));
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    if (persistent) {
      if (auto joint = plane(i)) joints.push_back(std::move(*joint));
      continue;
    }
    const Vec3 at = centre(i);
    std::optional<detail::HalfAxes> axes;
    if (!may_meet(i, at, axes)) continue;
    if (!axes) axes = half_axes(stream(Draw::size, i).uniform(), i);
    const detail::Frame frame = draw_frame(set_.spec().orientation, mean_, stream(Draw::orientation, i));
    SampledJoint joint{outline(i, frame, *axes), at, frame.normal, i};
    const auto& drawn = std::get<JointOutline>(joint.shape);
    const Vec3 half = (1 + 1e-9) * detail::half_extents(drawn);
    if (!domain_.overlaps({at - half, at + half})) continue;
    if (!detail::surely_valid(drawn, at)) {
      auto polygon = Polygon::make(detail::corners_of(drawn, at, unit_));
      if (!polygon) return std::unexpected(JointTooSmall{i, polygon.error()});
    }
    // Of those that may touch the box with their ellipse alone the corners decide.
    if (domain_.overlaps({at, at}) || corners_meet(drawn, at)) joints.push_back(std::move(joint));
  }
  return joints;
}

}  // namespace

std::expected<std::vector<SampledJoint>, SampleError> sample(const JointSet& set, std::size_t set_index,
                                                             const DomainBox& domain, std::uint64_t seed,
                                                             std::uint64_t realization,
                                                             std::span<const std::span<const SampledJoint>> older) {
  CLEAVE_ASSERT(is_finite(domain.min) && is_finite(domain.max));
  CLEAVE_ASSERT(domain.min.x < domain.max.x && domain.min.y < domain.max.y && domain.min.z < domain.max.z);
  const detail::SetStreams streams{seed, realization, set_index};
  if (std::holds_alternative<Mosaic>(set.spec().model) || std::holds_alternative<Orthogonal>(set.spec().model)) {
    const double expected = expected_draws(set, domain);
    if (!(expected <= most_joints)) return std::unexpected(TooManyJoints{expected, most_joints});
    return std::holds_alternative<Mosaic>(set.spec().model) ? detail::mosaic(set, domain, streams)
                                                            : detail::orthogonal(set, domain, streams);
  }
  // Polygons that are moved far are drawn far around.
  const double expected = std::holds_alternative<Mit>(set.spec().model) ? expected_draws(set, domain) : 0;
  if (!(expected <= most_joints)) return std::unexpected(TooManyJoints{expected, most_joints});
  auto joints = Sampler{set, set_index, domain, seed, realization}.run();
  if (!joints) return joints;
  if (on_planes_model(set)) return detail::on_planes(set, *joints, older, domain, streams);
  if (const auto* enhanced = std::get_if<EnhancedBaecher>(&set.spec().model)) {
    joints = with_polygons(*std::move(joints));
    detail::terminate(*joints, older, enhanced->probability, streams);
  }
  return joints;
}

std::span<const std::size_t> terminates_at(const JointSet& set) noexcept {
  if (const auto* enhanced = std::get_if<EnhancedBaecher>(&set.spec().model)) return enhanced->terminate_at;
  if (const auto* hierarchical = std::get_if<Hierarchical>(&set.spec().model)) return hierarchical->terminate_at;
  return {};
}

double expected_draws(const JointSet& set, const DomainBox& domain) noexcept {
  const double p32 = set.expected_p32(volume(domain));
  if (const auto* mosaic = std::get_if<Mosaic>(&set.spec().model)) {
    // About 7.8 faces a cell of the grown box.
    const auto* count = std::get_if<Count>(&set.spec().intensity);
    const double density = count != nullptr ? static_cast<double>(count->joints) / volume(domain)
                                            : std::pow(p32 / mosaic->share / 2.91, 3);
    return density > 0 ? 7.8 * density * volume(domain.grown(4 * std::cbrt(1 / density))) : 0;
  }
  if (std::holds_alternative<Orthogonal>(set.spec().model)) {
    const double planes = norm(domain.size()) * p32 / set.area_share();
    return set.mean_area() > 0 ? p32 * volume(domain) / set.mean_area() + planes : planes;
  }
  const double planes = region_of(set, domain).joints;
  if (!on_planes_model(set)) return planes;
  // Joints on the planes: by their mean area; Dershowitz 16/(pi S^2).
  const double area = std::holds_alternative<Dershowitz>(set.spec().model) && p32 > 0
                          ? 16 / (std::numbers::pi * p32 * p32)
                          : set.mean_area();
  return area > 0 ? std::max(planes, p32 * volume(domain.grown(detail::reach_of_moves(set))) / area) : planes;
}

std::string describe(const SampleError& error) {
  return std::visit(
      overloaded{
          [](const TooManyJoints& e) {
            return fmt::format(
                "intensity: about {:.3g} joints to draw, at most {:.3g} are allowed; lower the intensity or the domain",
                e.expected, e.allowed);
          },
          [](const JointTooSmall& e) {
            return fmt::format("size: joint {} is too small to be drawn here ({}); raise size.min", e.index,
                               geometry::describe(e.reason));
          },
      },
      error);
}

std::variant<topology::Joint, topology::PersistentJoint> joint_of(SampledJoint joint) {
  using Out = std::variant<topology::Joint, topology::PersistentJoint>;
  return std::visit(
      overloaded{
          [](geometry::Polygon& polygon) -> Out {
            topology::Joint out;
            out.polygons.push_back(std::move(polygon));
            return out;
          },
          [](std::vector<geometry::Polygon>& polygons) -> Out { return topology::Joint{std::move(polygons)}; },
          [](const InfinitePlane& plane) -> Out { return topology::PersistentJoint{plane.through, plane.normal}; },
          [&](const JointOutline&) -> Out {
            std::vector<SampledJoint> one;
            one.push_back(std::move(joint));
            return joint_of(std::move(with_polygons(std::move(one)).front()));
          }},
      joint.shape);
}

}  // namespace cleave::dfn
