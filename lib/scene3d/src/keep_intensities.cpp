#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "cleave/core/overloaded.hpp"
#include "cleave/scene3d/bounds.hpp"
#include "cleave/scene3d/drawing_order.hpp"

namespace cleave::scene {
namespace {

using geometry::Vec3;

constexpr std::uint64_t trial_seed = 0x7472'6961'6c73ULL;
constexpr int least_trials = 20, most_trials = 2000;
constexpr double close_enough = 0.01;  // standard error of the share, relative
constexpr double most_joints = 2e5, most_pairs = 2e7;

bool by_area(const dfn::JointSet& set) {
  const dfn::Intensity& i = set.spec().intensity;
  return std::holds_alternative<dfn::EnhancedBaecher>(set.spec().model) && !std::holds_alternative<dfn::Count>(i) &&
         !std::holds_alternative<dfn::P30>(i);
}

/// The set as if nothing ended it: the same joints, whole.
dfn::JointSet unended(const dfn::JointSet& set) {
  dfn::JointSetSpec spec = set.spec();
  spec.model = dfn::Baecher{};
  return dfn::JointSet::make(std::move(spec)).value();
}

double area_of(const std::vector<dfn::SampledJoint>& joints, const Box& box) {
  double sum = 0;
  for (const dfn::SampledJoint& joint : joints) {
    if (const auto* polygon = std::get_if<geometry::Polygon>(&joint.shape)) {
      const auto corners = polygon->corners();
      sum += norm(area_within({corners.begin(), corners.end()}, box));
    }
  }
  return sum;
}

/// Trial draws of a scene's sets in a box in the middle of the domain.
class Trials final {
 public:
  explicit Trials(const Scene& scene) : scene_{scene}, given_(scene.sets.size()) {
    const Box box = box_of(scene.domain);
    middle_ = (box.min + box.max) / 2;
    half_ = (box.max - box.min) / 2;
  }

  /// Share of the area that is left to a set; 1 where none can be drawn.
  double share_of(std::size_t number) {
    const dfn::JointSet whole = unended(scene_.joint_sets[number].law);
    std::vector<std::size_t> order = needed(number);
    const double pairs = pairs_of(number, {middle_ - half_, middle_ + half_});
    // Pairs grow with the square of the volume.
    const double size = pairs > most_pairs ? std::pow(most_pairs / pairs, 1.0 / 6) : 1;
    const Box box{middle_ - size * half_, middle_ + size * half_};
    const dfn::DomainBox domain{box.min, box.max};
    double before = 0, after = 0, joints = 0;
    std::vector<std::pair<double, double>> areas;
    const auto settled = [&] {
      if (areas.size() < least_trials || !(after > 0)) return false;
      double squares = 0;
      for (const auto& [whole_area, left] : areas) squares += std::pow(left - after / before * whole_area, 2);
      return std::sqrt(squares) <= close_enough * after;
    };
    for (int trial = 0; trial < most_trials && joints < most_joints && !settled(); ++trial) {
      drawn_.assign(scene_.joint_sets.size(), {});
      for (const std::size_t i : order) {
        auto own = draw(scene_.joint_sets[i].law, i, domain, trial);
        if (!own) return 1;
        drawn_[i] = *std::move(own);
      }
      auto uncut = draw(whole, number, domain, trial);
      if (!uncut) return 1;
      areas.emplace_back(area_of(*uncut, box), area_of(drawn_[number], box));
      before += areas.back().first;
      after += areas.back().second;
      joints += static_cast<double>(uncut->size());
    }
    return before > 0 ? std::clamp(after / before, 0.01, 1.0) : 1;
  }

 private:
  /// The set and all that it ends at, in the order of drawing.
  std::vector<std::size_t> needed(std::size_t number) const {
    std::vector<std::size_t> wanted{number};
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      for (const std::size_t other : dfn::terminates_at(scene_.joint_sets[wanted[i]].law)) {
        if (other < scene_.joint_sets.size() && std::ranges::find(wanted, other) == wanted.end()) {
          wanted.push_back(other);
        }
      }
    }
    std::vector<std::size_t> order = drawing_order(scene_.joint_sets);
    std::erase_if(order, [&](std::size_t i) { return std::ranges::find(wanted, i) == wanted.end(); });
    return order;
  }

  double pairs_of(std::size_t number, const dfn::DomainBox& box) const {
    double older = 0;
    for (const std::size_t other : dfn::terminates_at(scene_.joint_sets[number].law)) {
      older += other < scene_.joint_sets.size() ? dfn::expected_draws(scene_.joint_sets[other].law, box)
                                                : static_cast<double>(scene_.joints.size());
    }
    return older * dfn::expected_draws(scene_.joint_sets[number].law, box);
  }

  std::expected<std::vector<dfn::SampledJoint>, dfn::SampleError> draw(const dfn::JointSet& set, std::size_t number,
                                                                       const dfn::DomainBox& domain, int trial) {
    std::vector<std::span<const dfn::SampledJoint>> older;
    for (const std::size_t other : dfn::terminates_at(set)) {
      if (other < scene_.joint_sets.size()) {
        older.emplace_back(drawn_[other]);
      } else {
        auto& joints = given_[other - scene_.joint_sets.size()];
        if (joints.empty()) joints = given_joints(scene_.joints, SetId{other - scene_.joint_sets.size()});
        older.emplace_back(joints);
      }
    }
    auto joints = dfn::sample(set, number, domain, trial_seed, static_cast<std::uint64_t>(trial), older);
    if (joints) joints = dfn::with_polygons(*std::move(joints));
    return joints;
  }

  const Scene& scene_;
  std::vector<std::vector<dfn::SampledJoint>> given_, drawn_;
  Vec3 middle_, half_;
};

}  // namespace

std::vector<dfn::SampledJoint> given_joints(const std::vector<MeasuredJoint>& given, SetId set) {
  std::vector<dfn::SampledJoint> joints;
  for (const MeasuredJoint& joint : given) {
    if (joint.set != set) continue;
    std::visit(overloaded{[&](const topology::Joint& polygons) {
                            for (const geometry::Polygon& polygon : polygons.polygons) {
                              const geometry::Vec3 normal = upward(geometry::normalized(area_vector(polygon)));
                              joints.push_back({polygon, polygon.corners().front(), normal, 0});
                            }
                          },
                          [&](const topology::PersistentJoint& plane) {
                            const geometry::Vec3 normal = upward(geometry::normalized(plane.normal));
                            joints.push_back({dfn::InfinitePlane{plane.through, normal}, plane.through, normal, 0});
                          }},
               joint.geometry);
  }
  return joints;
}

void keep_intensities(Scene& scene, Problems& problems) {
  for (const std::size_t number : drawing_order(scene.joint_sets)) {
    RandomSet& set = scene.joint_sets[number];
    if (!by_area(set.law)) continue;
    const double share = Trials{scene}.share_of(number);
    if (share >= 1) continue;
    set.law.set_area_share(share);
    problems.note(
        set.line, fmt::format("joint_set[{}].terminates_at", number + 1),
        fmt::format("joints of \"{}\" that end at others lose {:.0f} % of their area",
                    scene.sets[set.set].name.substr(0, 60), 100 * (1 - share)),
        fmt::format("{:.2f} times as many are drawn, so that what is left has the intensity asked for", 1 / share));
  }
}

}  // namespace cleave::scene
