/// Small lattice scenes (three sets of joints around a tunnel, or degenerate on purpose) under any gravity, earthquake,
/// water, strength: key blocks in batches. All figures are finite; forces balance; a block that leaves does not run
/// into what holds it; turning the scene turns the answer; and a part of the rock that decides
/// (`Settings::only_key_blocks`), whatever its size, decides as the whole rock does.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "byte_source.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"
#include "fuzz_target.hpp"
#include "integer_scene.hpp"
#include "integer_scene_input.hpp"
#include "keep_readable.hpp"
#include "scene_to_toml.hpp"

namespace {

using cleave::geometry::Vec3;
using cleave::testing::IntegerPoint;
using cleave::testing::IntegerScene;
using namespace cleave::stability;
namespace topology = cleave::topology;

/// Everything but the geometry. Strengths are such that no force balances by accident: tan(friction) is no fraction.
struct Choices {
  Vec3 gravity, seismic;
  std::optional<double> level;  ///< of the water, up along -gravity
  double friction, cohesion, tension;
  std::uint8_t free_sides;  ///< bit k: side k of the box is free
  bool strict, transfer;
  std::array<int, 6> margin;  ///< of the window, beyond the free faces
};

Choices choose(cleave::support::ByteSource& bytes) {
  Choices c{};
  const auto digit = [&] { return static_cast<double>(bytes.between(-3, 3)); };
  c.gravity = {digit(), digit(), digit()};
  if (c.gravity == Vec3{} || bytes.between(0, 2) > 0) c.gravity = {0, 0, -9.81};
  if (bytes.between(0, 2) == 2) c.seismic = {0.0371 * digit(), 0.0413 * digit(), 0.0291 * digit()};
  if (bytes.between(0, 3) == 3) c.level = 0.0173 + 2 * digit();
  c.friction = 0.0137 + 11.0913 * static_cast<double>(bytes.between(0, 8));
  c.cohesion = bytes.between(0, 2) == 2 ? 713.7 * static_cast<double>(bytes.between(0, 20)) : 0;
  c.tension = c.cohesion > 0 && bytes.between(0, 1) == 1 ? 0.37 * c.cohesion : 0;
  c.free_sides = bytes.between(0, 3) == 3 ? static_cast<std::uint8_t>(1 << bytes.between(0, 5)) : 0;
  c.strict = bytes.between(0, 7) == 7;
  c.transfer = bytes.between(0, 1) == 1;
  for (int& m : c.margin) m = static_cast<int>(bytes.between(1, 7));
  return c;
}

/// A box with a tunnel in it and three sets of joints, some of which end in the rock: blocks that can leave are common.
IntegerScene jointed_rock(cleave::support::ByteSource& bytes) {
  const auto digit = [&](int lo, int hi) { return static_cast<std::int32_t>(bytes.between(lo, hi)); };
  IntegerScene scene{.min = {-8, -8, -8}, .max = {8, 8, 8}, .joints = {}, .excavations = {}, .domain = {}};
  const IntegerPoint lo{digit(-4, 0), digit(-9, 0), digit(-4, 0)};
  scene.excavations.push_back(
      cleave::testing::integer_box(lo, lo + IntegerPoint{digit(1, 4), digit(1, 18), digit(1, 4)}));
  for (int set = 0; set < 3; ++set) {
    IntegerPoint normal{digit(-2, 2), digit(-2, 2), digit(-2, 2)};
    (set == 0 ? normal.x : set == 1 ? normal.y : normal.z) += 3;
    for (int n = digit(1, 5); n > 0; --n) {
      // One after the other: arguments of a call may be read in any order.
      const IntegerPoint through{digit(-6, 6), digit(-6, 6), digit(-6, 6)};
      const int reach = digit(0, 2) == 0 ? digit(2, 6) : 30;
      auto joint = cleave::testing::covering_plane(through, normal, reach);
      if (cleave::testing::is_valid_polygon(joint)) scene.joints.push_back(std::move(joint));
    }
  }
  return scene;
}

Vec3 turned(Vec3 v) { return {v.z, v.x, v.y}; }  // as axes_rotated

topology::CutInput input_of(const IntegerScene& scene, std::uint8_t free_sides, int turns) {
  // Sides by (axis, end), so that they turn with the scene; a box carries the tags of its sides in that order.
  topology::CutInput input = cleave::testing::to_cut_input(scene);
  for (std::uint32_t side = 0; side < 6; ++side) {
    if ((free_sides >> side & 1U) == 0) continue;
    const std::size_t axis = (side / 2 + static_cast<std::uint32_t>(turns)) % 3;
    Vec3 outward{};
    (axis == 0 ? outward.x : axis == 1 ? outward.y : outward.z) = side % 2 == 0 ? -1 : 1;
    for (const auto& face : input.domain.faces()) {
      const auto corner = [&](std::size_t k) { return input.domain.vertices()[face.corners[k]]; };
      if (dot(cross(corner(1) - corner(0), corner(2) - corner(1)), outward) >
          0.5 * norm(cross(corner(1) - corner(0), corner(2) - corner(1)))) {
        input.free_domain_tags.push_back(face.tag);
      }
    }
  }
  return input;
}

Settings settings_of(const Choices& c, Vec3 gravity, Vec3 seismic) {
  Settings s{.rock = RockMass::make(cleave::kilograms_per_cubic_metre(2700)).value(),
             .strengths = StrengthTable{JointStrength::make(cleave::FrictionAngle::degrees(c.friction),
                                                            cleave::pascals(c.cohesion), cleave::pascals(c.tension))
                                            .value()},
             .loads = Loads::make(gravity, seismic).value()};
  s.strict = c.strict;
  s.force_transfer = c.transfer;
  if (c.level) s.actions = Actions::make({.water = WaterTable{.level = *c.level}}).value();
  return s;
}

/// What must not depend on how the blocks were found: batch by batch how many leave, their volume and their force.
struct Answer {
  std::vector<std::array<double, 4>> rows;  ///< batch, volume, net force, net force after transfer
  std::string hash;
};

Answer answer(const topology::BlockComplex& complex, const Analysis& analysis) {
  Answer out;
  std::vector<topology::BlockId> leaving;
  for (const Batch& batch : analysis.batches) leaving.insert(leaving.end(), batch.blocks.begin(), batch.blocks.end());
  out.hash = topology::canonical_hash(complex, leaving);
  for (const Judgement& j : analysis.judgements) {
    if (!j.batch) continue;
    out.rows.push_back({static_cast<double>(*j.batch), complex.blocks()[j.block].volume.si(), j.net.si(),
                        j.transferred ? j.transferred->net.si() : 0.0});
  }
  std::ranges::sort(out.rows);
  return out;
}

/// Rows are sorted by figures that rounding may turn over (congruent blocks), so each looks for its own among all that
/// are left.
std::string difference(const Answer& a, const Answer& b, double scale) {
  if (a.rows.size() != b.rows.size()) return fmt::format("{} and {} key blocks", a.rows.size(), b.rows.size());
  std::vector<std::array<double, 4>> left = b.rows;
  for (std::size_t i = 0; i < a.rows.size(); ++i) {
    const auto same = std::ranges::find_if(left, [&](const std::array<double, 4>& row) {
      for (std::size_t k = 0; k < 4; ++k) {
        const double size = k < 2 ? a.rows[i][k] : scale;
        if (!(std::abs(a.rows[i][k] - row[k]) <= 1e-9 * size)) return false;
      }
      return true;
    });
    if (same == left.end()) {
      return fmt::format("key block {} of batch {}, volume {}, forces {} and {}: not among the others", i, a.rows[i][0],
                         a.rows[i][1], a.rows[i][2], a.rows[i][3]);
    }
    left.erase(same);
  }
  return {};
}

/// What is wrong with the figures themselves, or nothing.
std::string nonsense(const topology::BlockComplex& complex, const Analysis& analysis) {
  if (!(analysis.equilibrium_residual <= 1e-9)) {
    return fmt::format("forces do not balance: {}", analysis.equilibrium_residual);
  }
  for (const Judgement& j : analysis.judgements) {
    const std::string name = fmt::format("block {}: ", j.block.value());
    for (const double v : {j.weight.si(), j.driving.si(), j.resistance.si(), j.net.si(), norm(j.direction)}) {
      if (!std::isfinite(v)) return name + "a figure is not finite";
    }
    if (!(j.driving.si() >= 0 && j.resistance.si() >= 0 && j.factor_of_safety >= 0)) return name + "a negative figure";
    if (j.key != (j.net.si() > 0 && moves(j.mode))) return name + "key, but no net force";
    if (j.batch && !j.key) return name + "leaves, but is stable";
    if (moves(j.mode) && std::abs(norm(j.direction) - 1) > 1e-9) return name + "its direction is no unit vector";
    if (j.batch != 1U) continue;  // others move past what has left
    for (const topology::FaceId id : complex.blocks()[j.block].faces) {
      const topology::Face& face = complex.faces()[id];
      if (face.role == topology::Role::free) continue;
      if (dot(face.outward, j.direction) > 1e-9) return name + "runs into its own joint";
    }
  }
  return {};
}

/// Around all free faces, with the margins chosen; none where there is nothing free.
std::optional<topology::Window> window_of(const topology::CutInput& input, const Choices& c) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  std::array<double, 3> lo{inf, inf, inf}, hi{-inf, -inf, -inf}, least = lo, most = hi;
  const auto add = [](std::array<double, 3>& from, std::array<double, 3>& to, Vec3 p) {
    const std::array<double, 3> at{p.x, p.y, p.z};
    for (std::size_t k = 0; k < 3; ++k) {
      from[k] = std::min(from[k], at[k]);
      to[k] = std::max(to[k], at[k]);
    }
  };
  for (const Vec3& v : input.domain.vertices()) add(least, most, v);
  for (const auto& excavation : input.excavations) {
    for (const Vec3& v : excavation.vertices()) add(lo, hi, v);
  }
  for (const auto& face : input.domain.faces()) {
    if (std::ranges::find(input.free_domain_tags, face.tag) == input.free_domain_tags.end()) continue;
    for (const std::uint32_t corner : face.corners) add(lo, hi, input.domain.vertices()[corner]);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(lo[k] <= hi[k])) return std::nullopt;
    lo[k] = std::max(least[k], lo[k] - c.margin[2 * k]);
    hi[k] = std::min(most[k], hi[k] + c.margin[2 * k + 1]);
    if (!(lo[k] < hi[k])) return std::nullopt;
  }
  return topology::Window{{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}};
}

std::string problem_of(const IntegerScene& scene, const Choices& c) {
  const topology::CutInput input = input_of(scene, c.free_sides, 0);
  auto cut = topology::cut(input);
  if (!cut) return {};
  const auto whole = topology::audit(*std::move(cut));
  if (!whole) return "the certificate does not hold";
  const Settings settings = settings_of(c, c.gravity, c.seismic);
  const Analysis analysis = analyse(*whole, settings);
  if (!analysis.undecided.empty()) return "undecided blocks in the whole rock";
  if (std::string wrong = nonsense(whole->complex(), analysis); !wrong.empty()) return wrong;
  const Answer expected = answer(whole->complex(), analysis);
  double scale = 1;  // N: the weight of all of the rock
  for (const auto& block : whole->complex().blocks()) scale += 2700 * norm(c.gravity) * block.volume.si();

  // A part of the rock that holds all free faces tells the same, or says that it does not know.
  if (const auto window = window_of(input, c)) {
    topology::CutInput part = input;
    part.window = *window;
    auto near_cut = topology::cut(part);
    if (!near_cut) return "the whole can be cut, a window of it cannot";
    const auto near = topology::audit(*std::move(near_cut));
    if (!near) return "the certificate of the window does not hold";
    Settings only_key = settings;
    only_key.only_key_blocks = true;
    const Analysis known = analyse(*near, only_key);
    if (known.undecided.empty()) {
      const Answer found = answer(near->complex(), known);
      if (std::string wrong = difference(expected, found, scale); !wrong.empty()) return "window: " + wrong;
      if (found.hash != expected.hash) return "window: other key blocks";
    }
  }

  auto turned_cut = topology::cut(input_of(cleave::testing::axes_rotated(scene), c.free_sides, 1));
  if (!turned_cut) return "cannot be cut when turned";
  const auto other = topology::audit(*std::move(turned_cut));
  if (!other) return "the certificate does not hold when turned";
  const Analysis again = analyse(*other, settings_of(c, turned(c.gravity), turned(c.seismic)));
  if (std::string wrong = difference(expected, answer(other->complex(), again), scale); !wrong.empty()) {
    return "turned: " + wrong;
  }
  return {};
}

std::string text_of(const IntegerScene& scene, const Choices& c, const std::string& problem) {
  return cleave::testing::scene_to_toml(
      scene,
      fmt::format("fuzz_key_blocks: {}\nfree sides {:#x}, gravity {} {} {}, seismic {} {} {}, friction {}, cohesion "
                  "{}, tension {}, water level {}, strict {}, transfer {}, margins {} {} {} {} {} {}",
                  problem, c.free_sides, c.gravity.x, c.gravity.y, c.gravity.z, c.seismic.x, c.seismic.y, c.seismic.z,
                  c.friction, c.cohesion, c.tension, c.level ? fmt::to_string(*c.level) : "none", c.strict, c.transfer,
                  c.margin[0], c.margin[1], c.margin[2], c.margin[3], c.margin[4], c.margin[5]));
}

}  // namespace

CLEAVE_FUZZ_TARGET(bytes) {
  const std::size_t own = std::min<std::size_t>(bytes.size(), 24);
  cleave::support::ByteSource choices{bytes.first(own)};
  const Choices c = choose(choices);
  const bool degenerate = choices.between(0, 3) == 3;
  cleave::support::ByteSource rock{bytes.subspan(own)};
  const IntegerScene scene = degenerate
                                 ? cleave::testing::integer_scene_from_bytes(bytes.subspan(own), {.max_joints = 12})
                                 : jointed_rock(rock);
  cleave::support::keep_readable([&] { return text_of(scene, c, "ended here"); });  // before an assertion may abort
  const std::string problem = problem_of(scene, c);
  if (problem.empty()) return;
  const std::string text = text_of(scene, c, problem);
  cleave::support::keep_readable([&] { return text; });
  std::fputs(text.c_str(), stderr);
  std::abort();
}
