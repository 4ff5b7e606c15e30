/// Surfaces that are closed on paper, in rounded doubles, against how many parts they are known to make:
///
///     closed_agreement [COUNT [SEED [snap]]]        (default 1000 sets, seed 1)
///
/// Each set is turned, scaled by 1e-3 to 1e6, and for a third of them shifted by 5e6 m. Half of the scenes are cut out
/// of a box, half fill it to its sides or reach beyond. With `snap` all are cut with it too, and with a copy of the set
/// moved by less. A count that is wrong and a certificate that does not pass are printed; the program then ends with 1.

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>

#include "cleave/core/rng.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"
#include "closed_sets.hpp"

namespace {

using namespace cleave;
using geometry::Vec3;
using support::ClosedSet;
using support::Placement;

std::optional<std::uint64_t> number_of(const char* text) {
  std::uint64_t value = 0;
  const std::string word{text};
  const auto [end, failure] = std::from_chars(word.data(), std::to_address(word.end()), value);
  if (failure != std::errc{} || end != std::to_address(word.end())) return std::nullopt;
  return value;
}

enum class Outcome : std::uint8_t { right, not_valid, wrong };

/// What comes of the polygons in a cube about the placed origin.
Outcome tried(const std::string& what, const std::vector<support::Corners>& polygons, const Placement& at, double half,
              std::size_t expected, double snap, bool convex) {
  const double h = half * at.scale;
  auto domain = geometry::make_box(at.shift - Vec3{h, h, h}, at.shift + Vec3{h, h, h});
  if (!domain) return Outcome::not_valid;
  topology::CutInput input{.domain = *std::move(domain)};
  input.snap = metres(snap);
  for (const auto& corners : polygons) {
    auto polygon = geometry::Polygon::make(corners);
    if (!polygon) return Outcome::not_valid;  // its corners have come too close, or off one plane
    input.joints.emplace_back(topology::Joint{{*std::move(polygon)}});
  }
  auto complex = topology::cut(input);
  if (!complex) {
    std::printf("%s, snap %g: %s\n", what.c_str(), snap, describe(complex.error()).c_str());
    return Outcome::wrong;
  }
  const std::size_t blocks = complex->blocks().size();
  std::size_t round = 0;
  for (const topology::Block& block : complex->blocks()) round += block.convex ? 1 : 0;
  const auto audited = topology::audit(*std::move(complex));
  if (!audited || blocks != expected || (convex && round + 1 < expected)) {
    std::printf("%s, snap %g: %zu blocks, %zu convex, %zu expected, certificate %s\n", what.c_str(), snap, blocks,
                round, expected, audited ? "passed" : "failed");
    return Outcome::wrong;
  }
  return Outcome::right;
}

}  // namespace

int main(int argc, char** argv) {
#ifdef __clang__
#pragma clang unsafe_buffer_usage begin
#endif
  const std::span arguments{argv, static_cast<std::size_t>(argc)};
#ifdef __clang__
#pragma clang unsafe_buffer_usage end
#endif
  const auto count = arguments.size() > 1 ? number_of(arguments[1]) : std::uint64_t{1000};
  const auto seed = arguments.size() > 2 ? number_of(arguments[2]) : std::uint64_t{1};
  const bool snapping = arguments.size() > 3 && std::string_view{arguments[3]} == "snap";
  if (!count || !seed || arguments.size() > 4) {
    std::fputs("usage: closed_agreement [COUNT [SEED [snap]]]\n", stderr);
    return 2;
  }
  std::uint64_t right = 0, not_valid = 0, wrong = 0;
  const auto add = [&](Outcome outcome) {
    ++(outcome == Outcome::right ? right : outcome == Outcome::wrong ? wrong : not_valid);
  };
  for (std::uint64_t trial = 0; trial < *count; ++trial) {
    Rng rng{{.seed = *seed, .realization = 0, .purpose = 8, .index = static_cast<std::uint32_t>(trial)}};
    const auto uniform = [&] { return rng.uniform(); };
    const ClosedSet set = support::any_closed_set(uniform);
    Placement at{{6 * uniform(), 6 * uniform(), 6 * uniform()}, std::pow(10, 9 * uniform() - 3), {}};
    if (trial % 3 == 0) at.shift = {5e6, -3e6, 1e3};
    const std::string what = std::to_string(trial) + ": " + set.name + ", scale " + std::to_string(at.scale);
    const auto polygons = support::placed(set, at).polygons;
    add(tried(what, polygons, at, 1.2, set.parts + 1, 0, set.convex));
    if (!snapping) continue;
    for (const double snap : {1e-9, 1e-6}) add(tried(what, polygons, at, 1.2, set.parts + 1, snap * at.scale, false));
  }
  std::printf("%llu right, %llu wrong, %llu of no valid polygons\n", static_cast<unsigned long long>(right),
              static_cast<unsigned long long>(wrong), static_cast<unsigned long long>(not_valid));
  return wrong == 0 ? 0 : 1;
}
