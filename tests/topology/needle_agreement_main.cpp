/// Needles and plates: boxes cut by pairs of planes that nearly coincide.
///
///     needle_agreement [COUNT [SEED]]        (default 1000 scenes, seed 1)
///
/// Two or three pairs of planes, each 1e-2 to 1e-13 of the box apart, parallel or tilted by as much, some as plane
/// joints and some as rectangles, at the origin and at 5e6 m. Every scene must be cut and pass its certificate, and
/// have as many blocks as its planes make by integers alone (but for planes that meet in one line or point, and
/// rectangles a rounding apart that became one). What does not is printed; the program then ends with 1.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "agreement.hpp"
#include "cleave/core/rng.hpp"
#include "cleave/exact/predicates.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"

namespace {

using namespace cleave;
using geometry::Vec3;

void add_plane(topology::CutInput& input, Vec3 through, Vec3 normal, double size, bool whole) {
  if (whole) {
    input.joints.emplace_back(topology::PersistentJoint{through, normal});
    return;
  }
  const Vec3 helper = std::abs(normal.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 u = 4 * size * geometry::normalized(cross(normal, helper)), v = cross(normal, u);
  auto polygon = geometry::Polygon::make({through - u - v, through + u - v, through + u + v, through - u + v});
  if (polygon) input.joints.emplace_back(topology::Joint{{*std::move(polygon)}});
}

/// The planes that blocks show: sides of the box, with which side of each is inside, and joints.
struct Planes {
  std::vector<exact::Plane> sides, joints;
  std::vector<exact::Sign> inside;
};

Planes planes_of(const topology::BlockComplex& complex) {
  std::map<topology::PlaneId, exact::Sign> sides;
  std::set<topology::PlaneId> joints;
  for (const topology::Face& face : complex.faces()) {
    if (face.role == topology::Role::joint) {
      joints.insert(face.plane);
    } else {
      sides[face.plane] = face.block_on_positive_side ? exact::Sign::positive : exact::Sign::negative;
    }
  }
  Planes planes;
  for (const auto& [plane, inside] : sides) {
    planes.sides.push_back(complex.planes()[plane]);
    planes.inside.push_back(inside);
  }
  for (const topology::PlaneId plane : joints) planes.joints.push_back(complex.planes()[plane]);
  return planes;
}

/// Counts what planes make of a convex body by integers alone, knowing nothing of the cutter: one part, and one more
/// for each plane, for each line of two planes and for each point of three planes inside it.
class Counter {
 public:
  explicit Counter(const Planes& planes) : planes_{planes} {}

  /// None where more planes meet in a line or a point than those two or three, or meet on a side.
  std::optional<std::size_t> parts() {
    const auto& joints = planes_.joints;
    std::size_t count = 1 + joints.size();
    for (std::size_t i = 0; i < joints.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (joints[i].parallel_to(joints[j])) continue;
        if (line_meets_inside(joints[i], joints[j])) ++count;
        for (std::size_t k = 0; k < j; ++k) {
          if (point_inside(joints[i], joints[j], joints[k])) ++count;
        }
      }
    }
    return generic_ ? std::optional{count} : std::nullopt;
  }

 private:
  using Sign = exact::Sign;

  bool is_inside(Sign side, std::size_t s) {
    generic_ = generic_ && side != Sign::zero;
    return side == planes_.inside[s];
  }
  /// The line is cut by each side it is not parallel to; it enters through some and leaves through the others. It meets
  /// the inside if each point where it leaves lies beyond each where it enters.
  bool line_meets_inside(const exact::Plane& p, const exact::Plane& q) {
    const auto& sides = planes_.sides;
    std::vector<Sign> entered;
    bool meets = true;
    for (std::size_t s = 0; s < sides.size(); ++s) {
      entered.push_back(exact::det3_exact(p, q, sides[s]) * planes_.inside[s]);
      if (entered[s] == Sign::zero) meets = is_inside(exact::side_of_parallel_line(p, q, sides[s]), s) && meets;
    }
    for (std::size_t s = 0; s < sides.size(); ++s) {
      for (std::size_t t = 0; t < sides.size(); ++t) {
        if (entered[s] != Sign::positive || entered[t] != Sign::negative) continue;
        meets = is_inside(exact::side_exact(p, q, sides[t], sides[s]), s) && meets;
      }
    }
    return meets;
  }
  bool point_inside(const exact::Plane& p, const exact::Plane& q, const exact::Plane& r) {
    if (exact::det3_exact(p, q, r) == Sign::zero) {
      if (!p.parallel_to(r) && !q.parallel_to(r) && exact::side_of_parallel_line(p, q, r) == Sign::zero)
        generic_ = false;
      return false;
    }
    bool inside = true;
    for (std::size_t s = 0; s < planes_.sides.size(); ++s) {
      inside = is_inside(exact::side_exact(p, q, r, planes_.sides[s]), s) && inside;
    }
    if (!inside) return false;
    for (const exact::Plane& other : planes_.joints) {
      const bool own = other == p || other == q || other == r;
      if (!own && exact::side_exact(p, q, r, other) == Sign::zero) generic_ = false;
    }
    return true;
  }

  const Planes& planes_;
  bool generic_ = true;
};

/// What was found in one scene.
struct Found {
  std::string fault;     ///< empty: none
  bool counted = false;  ///< the number of blocks was compared
};

/// `distinct`: so many joints are farther apart than roundings, and each must be there.
Found look_at(const topology::CutInput& input, std::size_t distinct) {
  auto complex = topology::cut(input);
  if (!complex) return {describe(complex.error())};
  const auto audited = topology::audit(*std::move(complex));
  if (!audited) return {"certificate: " + describe(audited.error())};
  const topology::BlockComplex& cut = audited->complex();
  const std::size_t blocks = cut.blocks().size();
  const Planes planes = planes_of(cut);
  if (planes.joints.size() > input.joints.size() || planes.joints.size() < distinct) {
    return {std::to_string(planes.joints.size()) + " planes of " + std::to_string(input.joints.size()) + " joints"};
  }
  if (cut.report().bend_m > 0) return {};  // faces are not quite where their planes are
  const auto parts = Counter{planes}.parts();
  if (!parts || *parts == blocks) return {"", parts.has_value()};
  return {fmt::format("{} blocks, {} are right", blocks, *parts), true};
}

}  // namespace

int main(int argc, char** argv) {
  const auto arguments = support::agreement_arguments(argc, argv, "needle_agreement", 1000, "");
  if (!arguments) return 2;
  const auto& [count, seed, unused] = *arguments;
  std::uint64_t wrong = 0, counted = 0;
  for (std::uint64_t trial = 0; trial < count; ++trial) {
    Rng rng{{.seed = seed, .realization = 0, .purpose = 8, .index = static_cast<std::uint32_t>(trial)}};
    const auto uniform = [&] { return rng.uniform(); };
    const double size = std::pow(10, 4 * uniform() - 1), far = trial % 2 == 0 ? 0 : 5e6;
    const Vec3 lo{far, -far, 0}, extent{size, size, size};
    auto box = geometry::make_box(lo, lo + extent);
    if (!box) continue;
    topology::CutInput input{.domain = *std::move(box)};
    const int pairs = 2 + static_cast<int>(2 * uniform());
    const double rounding = 64 * std::max(size * 0x1p-46, far * 0x1p-52);
    std::size_t distinct = 0;
    for (int k = 0; k < pairs; ++k) {
      const Vec3 through = lo + size * Vec3{0.3 + 0.4 * uniform(), 0.3 + 0.4 * uniform(), 0.3 + 0.4 * uniform()};
      const Vec3 normal = geometry::normalized({uniform() - 0.5, uniform() - 0.5, uniform() - 0.5});
      const double gap = std::pow(10, -2 - 11 * uniform());
      const Vec3 tilt = uniform() < 0.5 ? Vec3{} : gap * Vec3{uniform(), uniform(), uniform()};
      const bool whole = uniform() < 0.5;
      distinct += gap * size > rounding ? 2U : 1U;
      add_plane(input, through, normal, size, whole);
      add_plane(input, through + gap * size * normal, geometry::normalized(normal + tilt), size, whole);
    }
    const auto [fault, was_counted] = look_at(input, distinct);
    counted += was_counted ? 1U : 0U;
    if (fault.empty()) continue;
    ++wrong;
    std::printf("%llu: %s\n", static_cast<unsigned long long>(trial), fault.c_str());
  }
  std::printf("%llu scenes, %llu of them counted by the planes, %llu wrong\n", static_cast<unsigned long long>(count),
              static_cast<unsigned long long>(counted), static_cast<unsigned long long>(wrong));
  return wrong == 0 ? 0 : 1;
}
