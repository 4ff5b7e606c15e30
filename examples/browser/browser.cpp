// The cutter and key blocks for a page: three sets of discs and a tunnel in a cube of rock.
// Run: ./x browser, then open build/browser/index.html.    You will see: the blocks, and which of them move.
//
// Built with clang-19 for WebAssembly, without exceptions, threads and run-time types. A page (or Node) writes numbers
// into `scene()`, calls `cut_scene()`, and reads arrays by pointer and length.
#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <expected>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "cleave/core/overloaded.hpp"
#include "cleave/dfn/sample.hpp"
#include "cleave/geometry/tunnel.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"
#include "workloads.hpp"

using namespace cleave;

namespace boost {
// What Boost calls instead of throwing; numbers of fixed width never do.
[[noreturn]] void throw_exception(const std::exception&) { __builtin_trap(); }
struct source_location;
[[noreturn]] void throw_exception(const std::exception&, const source_location&) { __builtin_trap(); }
}  // namespace boost

namespace {

/// What the page sets, in this order; all doubles.
struct Set {
  double dip, dip_direction;  ///< degrees
  double kappa;               ///< of Fisher's law
  double p32;                 ///< m2/m3
  double diameter;            ///< m, mean of an exponential law; 0: planes without end
  double friction;            ///< degrees
};
struct Input {
  std::array<Set, 3> sets;
  double side;           ///< of the cube of rock, m
  double width, height;  ///< of the horseshoe along y through its middle, m
  double density;        ///< kg/m3
  double seed;
};
static_assert(sizeof(Input) == 23 * sizeof(double));

/// What the page reads.
struct Output {
  std::string message, hash;
  std::vector<float> points;  ///< x, y, z, m, from the middle of the cube
  std::vector<std::uint32_t> corners, loop_begin, face_loop_begin, face_block;
  std::vector<std::uint8_t> face_role;
  std::vector<double> volume, factor;
  std::vector<std::uint32_t> batch;  ///< 0: stays
  std::vector<std::uint8_t> mode;    ///< as stability::Mode; 255: not judged
  std::vector<std::uint8_t> key;
};

Input input;
Output output;

template <class Error>
std::unexpected<std::string> told(const Error& error) {
  return std::unexpected{describe(error)};
}

std::expected<dfn::JointSet, std::string> joint_set(const Set& set) {
  dfn::JointSetSpec spec{
      .orientation = dfn::FisherOrientation{Dip::degrees(set.dip), DipDirection::degrees(set.dip_direction), set.kappa},
      .shape = dfn::Persistent{},
      .intensity = dfn::P32{set.p32}};
  if (set.diameter > 0) {
    auto size = dfn::SizeLaw::make({.distribution = dfn::SizeDistribution::exponential, .mean = metres(set.diameter)});
    if (!size) return told(size.error());
    spec.shape = dfn::Disc{*size, 12};
  }
  auto made = dfn::JointSet::make(std::move(spec));
  if (!made) return told(made.error());
  return *std::move(made);
}

std::variant<topology::Joint, topology::PersistentJoint> joint_of(dfn::SampledJoint drawn) {
  using Out = std::variant<topology::Joint, topology::PersistentJoint>;
  return std::visit(
      overloaded{
          [](geometry::Polygon& polygon) -> Out { return topology::Joint{{std::move(polygon)}}; },
          [](const dfn::InfinitePlane& plane) -> Out { return topology::PersistentJoint{plane.through, plane.normal}; },
          [](std::vector<geometry::Polygon>& polygons) -> Out { return topology::Joint{std::move(polygons)}; },
          [](const dfn::JointOutline&) -> Out { std::unreachable(); }},  // all were written out
      drawn.shape);
}

void store(const topology::BlockComplex& complex) {
  output.points.reserve(3 * complex.vertices().size());
  const geometry::Vec3 shift = complex.origin();
  for (const geometry::Vec3& vertex : complex.vertices()) {
    const geometry::Vec3 p = vertex + shift;
    for (const double x : {p.x, p.y, p.z}) output.points.push_back(static_cast<float>(x));
  }
  for (const topology::Face& face : complex.faces()) {
    output.face_loop_begin.push_back(static_cast<std::uint32_t>(output.loop_begin.size()));
    for (const auto loop : complex.loops(face)) {
      output.loop_begin.push_back(static_cast<std::uint32_t>(output.corners.size()));
      for (const topology::VertexId v : loop) output.corners.push_back(static_cast<std::uint32_t>(v.index()));
    }
    output.face_block.push_back(static_cast<std::uint32_t>(face.block.index()));
    output.face_role.push_back(static_cast<std::uint8_t>(face.role));
  }
  output.face_loop_begin.push_back(static_cast<std::uint32_t>(output.loop_begin.size()));
  output.loop_begin.push_back(static_cast<std::uint32_t>(output.corners.size()));
  for (const topology::Block& block : complex.blocks()) output.volume.push_back(block.volume.si());
}

void store(const stability::Analysis& analysis, std::size_t blocks) {
  output.factor.assign(blocks, 0);
  output.batch.assign(blocks, 0);
  output.mode.assign(blocks, 255);
  output.key.assign(blocks, 0);
  for (const stability::Judgement& judged : analysis.judgements) {
    const std::size_t b = judged.block.index();
    output.factor[b] = judged.factor_of_safety;
    output.batch[b] = judged.batch.value_or(0);
    output.mode[b] = static_cast<std::uint8_t>(judged.mode);
    output.key[b] = judged.key ? 1 : 0;
  }
}

std::expected<void, std::string> run() {
  output = {};
  const double half = input.side / 2;
  auto rock = geometry::make_box({-half, -half, -half}, {half, half, half});
  if (!rock) return told(rock.error());
  topology::CutInput cut_input{.domain = *std::move(rock)};
  auto tunnel = geometry::make_tunnel(geometry::HorseshoeSection{metres(input.width), metres(input.height)},
                                      {{0, -half, 0}, {0, half, 0}});
  if (!tunnel) return told(tunnel.error());
  cut_input.excavations.push_back(*std::move(tunnel));
  std::vector<stability::JointStrength> frictions;
  std::vector<std::size_t> set_of;
  for (std::size_t s = 0; s < input.sets.size(); ++s) {
    const Set& set = input.sets[s];
    const auto friction = stability::JointStrength::make(FrictionAngle::degrees(set.friction));
    if (!friction) return told(friction.error());
    frictions.push_back(*friction);
    if (set.p32 == 0) continue;
    auto law = joint_set(set);
    if (!law) return std::unexpected{"set " + std::to_string(s + 1) + ": " + law.error()};
    auto drawn =
        dfn::sample(*law, s, {{-half, -half, -half}, {half, half, half}}, static_cast<std::uint64_t>(input.seed), 0);
    if (!drawn) return told(drawn.error());
    for (dfn::SampledJoint& joint : dfn::with_polygons(*std::move(drawn))) {
      cut_input.joints.push_back(joint_of(std::move(joint)));
      set_of.push_back(s);
    }
  }
  auto complex = topology::cut(cut_input);
  if (!complex) return told(complex.error());
  auto audited = topology::audit(*std::move(complex));
  if (!audited) return told(audited.error());
  stability::StrengthTable strengths{frictions.front()};
  for (std::size_t j = 0; j < set_of.size(); ++j) {
    strengths.set(topology::JointId{static_cast<std::uint32_t>(j)}, frictions[set_of[j]]);
  }
  const auto rock_mass = stability::RockMass::make(kilograms_per_cubic_metre(input.density));
  if (!rock_mass) return told(rock_mass.error());
  const auto loads = stability::Loads::make({0, 0, -9.81});
  if (!loads) return told(loads.error());
  const auto analysis = stability::analyse(*audited, {.rock = *rock_mass, .strengths = strengths, .loads = *loads});
  store(audited->complex());
  store(analysis, audited->complex().blocks().size());
  output.hash = topology::canonical_hash(audited->complex());
  return {};
}

template <class Value>
const void* array(const std::vector<Value>& values, std::uint32_t& length) {
  length = static_cast<std::uint32_t>(values.size());
  return values.data();
}

std::uint32_t last_length = 0;

}  // namespace

extern "C" {
// What -fstack-protector asks for.
std::uintptr_t __stack_chk_guard = 0x595e9fbd;
[[noreturn]] void __stack_chk_fail() { __builtin_trap(); }

[[clang::export_name("scene")]] double* scene() { return &input.sets.front().dip; }
/// 0, or 1: `message` says why.
[[clang::export_name("cut_scene")]] std::int32_t cut_scene() {
  const auto done = run();
  if (!done) output.message = done.error();
  return done ? 0 : 1;
}
/// Array number `which`; its length is then `length()`.
[[clang::export_name("array")]] const void* array_of(std::int32_t which) {
  switch (which) {
    case 0: return array(output.points, last_length);
    case 1: return array(output.corners, last_length);
    case 2: return array(output.loop_begin, last_length);
    case 3: return array(output.face_loop_begin, last_length);
    case 4: return array(output.face_block, last_length);
    case 5: return array(output.face_role, last_length);
    case 6: return array(output.volume, last_length);
    case 7: return array(output.factor, last_length);
    case 8: return array(output.batch, last_length);
    case 9: return array(output.mode, last_length);
    case 10: return array(output.key, last_length);
    default: last_length = 0; return nullptr;
  }
}
[[clang::export_name("length")]] std::uint32_t length() { return last_length; }
[[clang::export_name("message")]] const char* message() { return output.message.c_str(); }
[[clang::export_name("hash")]] const char* hash() { return output.hash.c_str(); }
/// The hash of a scene of tests/golden/hashes.txt, by the letters written to `name_of_workload`.
std::array<char, 64> workload_name{};
[[clang::export_name("name_of_workload")]] char* name_of_workload() { return workload_name.data(); }
[[clang::export_name("hash_of_workload")]] const char* hash_of_workload() {
  const auto workload = support::workload_named(workload_name.data());
  if (!workload) return "";
  auto complex = topology::cut(support::cut_input(*workload));
  output.hash = complex ? topology::canonical_hash(*complex) : describe(complex.error());
  return output.hash.c_str();
}
}
