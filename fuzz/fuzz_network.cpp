/// Random networks of every model, shape and orientation law through the cutter and its certificate: a few joints in a
/// small box, so that many networks fit in a second. What is cut is certified, fills the box, and is the same for the
/// joints in another order, for two threads, drawn again, saved and read back, or holds the middles of its blocks.

#include <array>
#include <cmath>
#include <cstdint>
#include <ranges>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "byte_source.hpp"
#include "cleave/core/assert.hpp"
#include "cleave/dfn/sample.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"
#include "fuzz_target.hpp"

namespace cleave {
namespace {

using support::ByteSource;

constexpr double side = 10;
constexpr std::size_t most_joints = 12;

double share_of(ByteSource& source) { return static_cast<double>(source.up_to(16)) / 16; }

dfn::OrientationLaw orientation(ByteSource& source) {
  const auto dip = Dip::degrees(static_cast<double>(5 * source.up_to(18)));
  const auto direction = DipDirection::degrees(static_cast<double>(15 * source.up_to(23)));
  switch (source.up_to(4)) {
    case 0: return dfn::FisherOrientation{dip, direction, source.pick(std::array{0.0, 10.0, 1e3, 1e9})};
    case 1: return dfn::UniformOrientation{dip, direction, Dip::degrees(10), DipDirection::degrees(20)};
    case 2: return dfn::NormalOrientation{dip, direction, Dip::degrees(5), DipDirection::degrees(10), 0.5};
    case 3: return dfn::BootstrapOrientation::make({{0, 0, 1}, {1, 0, 0}}, {1, 2}, 50.0);
    default: return dfn::BinghamOrientation::make(dip, direction, -20, -2, dfn::Rotation::degrees(30));
  }
}

dfn::Shape shape(ByteSource& source) {
  const dfn::SizeLaw size = dfn::SizeLaw::constant(metres(source.pick(std::array{8.0, 2.0, 15.0, 40.0})));
  const auto sides = static_cast<std::uint32_t>(3 + source.up_to(13));
  switch (source.up_to(5)) {
    case 0: return dfn::Square{size};
    case 1: return dfn::Rectangle{size, dfn::AspectRatio{3}};
    case 2: return dfn::Disc{size, sides};
    case 3: return dfn::Ellipse{size, dfn::AspectRatio{2}, sides};
    case 4: return dfn::RegularPolygon{size, sides};
    default: return dfn::Persistent{};
  }
}

dfn::Model model(ByteSource& source, std::size_t set) {
  std::vector<std::size_t> earlier;
  for (std::size_t k = 0; k < set; ++k) earlier.push_back(k);
  // Mit's model draws 8,000 points before its first joint: seldom, so that others have their turn.
  const std::size_t kind = source.up_to(99);
  if (kind == 99) return dfn::Mit{.share = share_of(source), .zones = {}, .turn_kappa = {}};
  switch (kind % 7) {
    case 0: return dfn::Baecher{};
    case 1: return dfn::EnhancedBaecher{earlier, share_of(source)};
    case 2: return dfn::Veneziano{share_of(source)};
    case 3: return dfn::Dershowitz{share_of(source)};
    case 4:
      return dfn::Mosaic{
          source.pick(std::array{dfn::Mosaic::Seeds::poisson, dfn::Mosaic::Seeds::grid, dfn::Mosaic::Seeds::jittered}),
          share_of(source)};
    case 5: return dfn::Hierarchical{earlier};
    default: return dfn::Orthogonal{.bridge = {}};
  }
}

/// The joints of one to three sets; of what one set draws only the first few.
std::vector<dfn::SampledJoint> network(ByteSource source, const dfn::DomainBox& box) {
  std::vector<std::vector<dfn::SampledJoint>> drawn;
  const std::uint64_t seed = source.u64();
  const std::size_t sets = 1 + source.up_to(2);
  std::vector<dfn::SampledJoint> out;
  for (std::size_t k = 0; k < sets; ++k) {
    const auto count = 1 + source.up_to(5);
    dfn::Intensity intensity = dfn::Count{count};
    if (source.flip()) intensity = dfn::P32{0.02 * static_cast<double>(count)};
    auto set = dfn::JointSet::make({.orientation = orientation(source),
                                    .shape = shape(source),
                                    .intensity = intensity,
                                    .model = model(source, k),
                                    .buffer = {}});
    drawn.emplace_back();
    if (!set) continue;  // combinations that are refused
    std::vector<std::span<const dfn::SampledJoint>> older;
    for (const std::size_t other : dfn::terminates_at(*set)) older.emplace_back(drawn[other]);
    if (dfn::expected_draws(*set, box) > 400) continue;  // takes too long
    auto joints = dfn::sample(*set, k, box, seed, 0, older);
    if (!joints) continue;
    drawn.back() = dfn::with_polygons(*std::move(joints));
    for (const dfn::SampledJoint& joint : drawn.back() | std::views::take(most_joints / sets)) out.push_back(joint);
  }
  return out;
}

topology::AuditedComplex cut_of(const topology::CutInput& input, unsigned threads = 1) {
  auto blocks = topology::cut(input, {.threads = threads});
  CLEAVE_ASSERT(blocks.has_value());
  auto audited = topology::audit(*std::move(blocks), threads);
  CLEAVE_ASSERT(audited.has_value());
  return *std::move(audited);
}

void look(std::size_t what, topology::CutInput input, const topology::AuditedComplex& found) {
  const topology::BlockComplex& complex = found.complex();
  const std::string hash = topology::canonical_hash(complex);
  switch (what) {
    case 0:
      std::ranges::reverse(input.joints);
      CLEAVE_ASSERT(topology::canonical_hash(cut_of(input).complex()) == hash);
      break;
    case 1: CLEAVE_ASSERT(saved(cut_of(input, 2)) == saved(found)); break;
    case 2: {
      const auto again = topology::load_saved(saved(found));
      CLEAVE_ASSERT(again.has_value());
      CLEAVE_ASSERT(topology::canonical_hash(again->complex()) == hash);
      break;
    }
    case 3: {
      const topology::BlockLocator locator{complex};
      for (const topology::BlockId id : complex.blocks().ids()) {
        const topology::Block& block = complex.blocks()[id];
        if (block.convex && !block.sliver) CLEAVE_ASSERT(locator.block_at(block.centroid) == id);
      }
      break;
    }
    default: {
      // A joint twice is one joint.
      if (!input.joints.empty()) input.joints.push_back(input.joints.front());
      CLEAVE_ASSERT(topology::canonical_hash(cut_of(input).complex()) == hash);
      break;
    }
  }
}

}  // namespace
}  // namespace cleave

CLEAVE_FUZZ_TARGET(bytes) {
  using namespace cleave;
  support::ByteSource source{bytes};
  const std::size_t what = source.up_to(4);
  const double shift = source.pick(std::array{0.0, -5.0, 1e5, 4096.0});
  const geometry::Vec3 low{shift, -shift, shift}, high = low + geometry::Vec3{side, side, side};
  const auto joints = network(source, {low, high});
  topology::CutInput input{.domain = geometry::make_box(low, high).value()};
  for (const dfn::SampledJoint& joint : joints) input.joints.push_back(dfn::joint_of(joint));
  const auto found = cut_of(input);
  CLEAVE_ASSERT(std::abs(found.certificate().volume.si() - side * side * side) <= 1e-9 * side * side * side);
  look(what, std::move(input), found);
}
