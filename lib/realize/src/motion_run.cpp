#include "motion_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "cleave/assembly/groups.hpp"
#include "cleave/core/fields.hpp"
#include "cleave/core/parallel.hpp"
#include "cleave/motion/world.hpp"
#include "motion_bolts.hpp"
#include "motion_error.hpp"
#include "motion_loads.hpp"
#include "motion_notes.hpp"
#include "motion_recorder.hpp"

namespace cleave::scene {
namespace {

using geometry::Vec3;
using topology::BlockComplex;
using topology::BlockId;

double tangent(FrictionAngle angle) { return std::tan(angle.degrees() * std::numbers::pi / 180); }

/// Residual of the contact law up to which a step counts, about a micrometre a second: blocks wedged between nearly
/// parallel faces reach no less by rounding.
constexpr double accepted = 1e-5;
/// Where none is found: the best one up to here may be used, and is counted. Of blocks that fall some metres a second
/// through shafts it misses the law by millimetres a second.
constexpr double tolerated = 1e-3;

/// Numbers of equal strengths.
class Surfaces {
 public:
  explicit Surfaces(const MotionSettings& settings) : restitution_{settings.restitution} {
    static_cast<void>((*this)(tangent(settings.surface_friction)));
  }
  std::uint32_t operator()(double friction) {
    const auto [at, fresh] = number_.try_emplace(friction, static_cast<std::uint32_t>(list.size()));
    if (fresh) list.push_back({friction, restitution_});
    return at->second;
  }
  std::vector<motion::Surface> list;

 private:
  double restitution_;
  std::map<double, std::uint32_t> number_;
};

/// When each block is let go: a number of a wave; none: never.
using Waves = std::vector<std::optional<std::uint32_t>>;

Waves waves_of(const Scene& scene, const Realization& made, const BlockComplex& complex) {
  Waves waves(complex.blocks().size());
  const auto may_move = [&](BlockId b) { return !complex.blocks()[b].fixed && !complex.blocks()[b].truncated; };
  const auto add = [&](BlockId b, std::uint32_t wave) {
    if (may_move(b)) waves[b.index()] = wave;
  };
  const Release release = scene.motion->release;
  if (release == Release::all) {
    for (std::uint32_t b = 0; b < waves.size(); ++b) add(BlockId{b}, 0);
    return waves;
  }
  if (release == Release::stage && made.sequence) {
    const auto& stages = scene.sequence->stages;
    for (std::uint32_t b = 0; b < waves.size() && b < made.sequence->stage_of_block.size(); ++b) {
      const auto stage = made.sequence->stage_of_block[b];
      const auto at = std::ranges::find(stages, stage.value_or(0));
      if (stage && at != stages.end()) add(BlockId{b}, static_cast<std::uint32_t>(at - stages.begin()));
    }
  }
  for (const stability::Batch& batch : made.analysis->batches) {
    for (const BlockId b : batch.blocks) {
      if (!waves[b.index()])
        add(b, release == Release::stage ? static_cast<std::uint32_t>(scene.sequence->stages.size() - 1) : 0);
    }
  }
  if (release == Release::groups && made.key_groups) {
    for (const stability::KeyGroup& group : made.key_groups->groups) {
      if (group.verdict != assembly::Verdict::certain && group.verdict != assembly::Verdict::unsafe) continue;
      for (const BlockId b : group.blocks) add(b, 0);
    }
  }
  return waves;
}

motion::Polyhedron shape_of(const BlockComplex& complex, BlockId block, const Realization& made, Surfaces& surfaces) {
  motion::Polyhedron shape;
  std::map<topology::VertexId, std::uint32_t> number;
  for (const topology::FaceId f : complex.blocks()[block].faces) {
    const topology::Face& face = complex.faces()[f];
    motion::Facet facet;
    if (face.role == topology::Role::joint) {
      double least = std::numeric_limits<double>::infinity();
      for (const topology::Patch& patch : complex.patches(face)) {
        if (patch.joint) least = std::min(least, tangent(made.joints[*patch.joint].strength.friction()));
      }
      if (std::isfinite(least)) facet.surface = surfaces(least);
    }
    for (const auto loop : complex.loops(face)) {
      auto& corners = facet.loops.emplace_back();
      for (const topology::VertexId v : loop) {
        const auto [at, fresh] = number.try_emplace(v, static_cast<std::uint32_t>(shape.vertices.size()));
        if (fresh) shape.vertices.push_back(complex.vertices()[v]);
        corners.push_back(at->second);
      }
    }
    shape.facets.push_back(std::move(facet));
  }
  return shape;
}

/// Where cohesion and tension of a patch act: spread over it, so that they resist twisting. Where a face shares several
/// patches with one neighbour what is known of each is its centroid, which resists none.
std::vector<motion::Bond::Share> shares_of(const BlockComplex& complex, const topology::Face& face,
                                           const topology::Patch& patch) {
  const auto same = [&](const topology::Patch& other) { return other.neighbour == patch.neighbour; };
  const bool alone = std::ranges::count_if(complex.patches(face), same) == 1;
  const auto points = alone ? stability::spread_of(complex, face, *patch.neighbour) : std::nullopt;
  if (!points) return {{patch.centroid - complex.origin(), patch.area.si()}};
  std::vector<motion::Bond::Share> out;
  for (const Vec3 point : *points) out.push_back({point - complex.origin(), 0.25 * patch.area.si()});
  return out;
}

/// Strength that counts in pull: up to the apex of its line.
double pull_of(const stability::JointStrength& s) {
  const double friction = tangent(s.friction());
  return friction > 0 ? std::min(s.tension().si(), s.cohesion().si() / friction) : s.tension().si();
}

/// All that a face shares with a neighbour as one bond with tension: its corners, and areas that have its moments.
/// None where its patches have several strengths: how they would share a pull is not known.
std::optional<motion::Bond> pulling_bond(const Realization& made, const BlockComplex& complex,
                                         const topology::Face& face, BlockId neighbour) {
  std::optional<stability::JointStrength> strength;
  double area = 0;
  for (const topology::Patch& patch : complex.patches(face)) {
    if (patch.neighbour != neighbour) continue;
    if (!patch.joint) return std::nullopt;
    const stability::JointStrength& own = made.joints[*patch.joint].strength;
    if (strength && (own.cohesion() != strength->cohesion() || own.tension() != strength->tension() ||
                     own.friction().degrees() != strength->friction().degrees())) {
      return std::nullopt;
    }
    strength = own;
    area += patch.area.si();
  }
  if (!strength || !(pull_of(*strength) > 0)) return std::nullopt;
  const auto points = stability::spread_of(complex, face, neighbour);
  if (!points) return std::nullopt;
  motion::Bond bond;
  bond.tension = strength->tension().si();
  const Vec3 middle = 0.5 * ((*points)[0] + (*points)[1]) - complex.origin();
  for (const Vec3 point : *points) {
    const Vec3 at = point - complex.origin();
    bond.shares.push_back({at, 0.25 * area});
    bond.patch.push_back({middle + std::numbers::sqrt2 / 1.2 * (at - middle), 0.25 * area});
  }
  for (const Vec3 corner : stability::shared_corners(complex, face, neighbour)) {
    bond.patch.push_back({corner - complex.origin(), 0});
  }
  return bond;
}

/// Cohesion and tension of the patches of blocks that are let go.
void add_bonds(const BlockComplex& complex, const Realization& made, const std::vector<std::uint32_t>& body,
               MotionCast& cast) {
  for (const BlockId b : cast.moving) {
    for (const topology::FaceId f : complex.blocks()[b].faces) {
      const topology::Face& face = complex.faces()[f];
      std::vector<BlockId> whole;  // neighbours whose bond is made
      for (const topology::Patch& patch : complex.patches(face)) {
        if (!patch.joint || !patch.neighbour) continue;
        const stability::JointStrength& strength = made.joints[*patch.joint].strength;
        if (strength.cohesion().si() <= 0 && strength.tension().si() <= 0) continue;
        const std::uint32_t own = body[b.index()], other = body[patch.neighbour->index()];
        if (other == static_cast<std::uint32_t>(-1) || (other < own && other < cast.moving.size())) continue;
        if (std::ranges::find(whole, *patch.neighbour) != whole.end()) continue;
        auto bond = pulling_bond(made, complex, face, *patch.neighbour);
        if (bond) {
          whole.push_back(*patch.neighbour);
        } else {
          bond.emplace().shares = shares_of(complex, face, patch);
        }
        bond->cohesion = strength.cohesion().si();
        bond->friction = tangent(strength.friction());
        bond->body = own;
        bond->other = other;
        bond->normal = geometry::normalized(-face.outward);
        cast.scene.bonds.push_back(*std::move(bond));
      }
    }
  }
}

/// What is there beside the blocks that are let go.
struct Around {
  std::vector<std::uint8_t> gone = {};  ///< by block; empty: none
  bool all_free = false;                ///< all that have a free face are walls: a block may fall on any
};

/// Whether a block has a fixed side of the domain with some of the domain before it: a block may come against it from
/// there. Of a convex domain none has.
class InnerSides {
 public:
  explicit InnerSides(const BlockComplex& complex) : complex_{complex} {
    const auto [low, high] = geometry::box_of(complex.vertices());
    for (const double x : {low.x, high.x}) {
      for (const double y : {low.y, high.y}) {
        for (const double z : {low.z, high.z}) ends_.push_back({x, y, z});
      }
    }
    near_ = 1e-9 * norm(high - low);
  }
  [[nodiscard]] bool of(const topology::Block& block) const {
    return block.fixed && std::ranges::any_of(block.faces, [&](topology::FaceId f) {
             const topology::Face& face = complex_.faces()[f];
             if (face.role != topology::Role::fixed) return false;
             const auto outer = *complex_.loops(face).begin();
             const Vec3 foot = complex_.vertices()[*outer.begin()];
             const auto before = [&](Vec3 p) { return dot(face.outward, p - foot) > near_ * norm(face.outward); };
             // Of most sides not even the box of the domain reaches before them.
             return std::ranges::any_of(ends_, before) && std::ranges::any_of(complex_.vertices(), before);
           });
  }

 private:
  const BlockComplex& complex_;
  std::vector<Vec3> ends_;
  double near_ = 0;
};

MotionCast cast_of(const Scene& scene, const MotionSettings& settings, const Realization& made,
                   const BlockComplex& complex, const Waves& waves, const Around& around) {
  MotionCast cast;
  Surfaces surfaces{settings};
  const InnerSides inner{complex};
  std::vector<std::uint8_t> wall(waves.size(), 0);
  // Thinner than what rounding leaves of a block's corners: neither moves nor bars.
  const auto gone = [&](std::size_t b) {
    return complex.blocks()[BlockId{static_cast<std::uint32_t>(b)}].sliver ||
           (!around.gone.empty() && around.gone[b] != 0);
  };
  for (std::uint32_t b = 0; b < waves.size(); ++b) {
    const topology::Block& block = complex.blocks()[BlockId{b}];
    if (gone(b)) {
      cast.left_out += waves[b] ? 1U : 0U;
      continue;
    }
    if (!waves[b]) {
      wall[b] =
          std::max(wall[b], static_cast<std::uint8_t>(around.all_free && (block.free || inner.of(block)) ? 1 : 0));
      continue;
    }
    cast.moving.push_back(BlockId{b});
    cast.wave.push_back(*waves[b]);
    for (const topology::FaceId f : block.faces) {
      for (const topology::Patch& patch : complex.patches(complex.faces()[f])) {
        if (patch.neighbour) wall[patch.neighbour->index()] = 1;
      }
    }
  }
  std::vector<std::uint32_t>& body = cast.body;
  body.assign(waves.size(), static_cast<std::uint32_t>(-1));
  const auto add = [&](BlockId b, bool fixed) {
    body[b.index()] = static_cast<std::uint32_t>(cast.scene.bodies.size());
    cast.scene.bodies.push_back(
        {.shape = shape_of(complex, b, made, surfaces), .density = scene.rock.mass.density(), .fixed = fixed});
  };
  for (std::size_t k = 0; k < cast.moving.size(); ++k) add(cast.moving[k], cast.wave[k] > 0);
  for (std::uint32_t b = 0; b < waves.size() && !cast.moving.empty(); ++b) {
    if (gone(b) || waves[b] || wall[b] == 0) continue;
    add(BlockId{b}, true);
    ++cast.walls;
  }
  add_bonds(complex, made, body, cast);
  add_loads(scene, settings, made, complex, around.gone, cast);
  cast.scene.surfaces = std::move(surfaces.list);
  return cast;
}

motion::WorldOptions options_of(const Scene& scene, const MotionSettings& settings, const Realization& made) {
  const stability::Loads loads = scene.stability->loads.body.with_seismic_times(made.seismic_factor);
  motion::WorldOptions options{.gravity = loads.gravity(), .step = settings.step.si()};
  if (settings.seismic) options.gravity += norm(loads.gravity()) * loads.seismic();
  options.solver.accept = accepted;
  options.solver.tolerate = tolerated;
  if (settings.ground) {
    options.ground.mean = [ground = *settings.ground](double from, double to) { return ground.mean(from, to); };
    options.ground.peak = metres_per_second_squared(settings.ground->largest());
    options.ground.end = settings.ground->end();
  }
  return options;
}

}  // namespace

std::string_view name_of(LetGo outcome) noexcept { return enum_name(outcome); }

std::uint64_t MotionResult::moved() const noexcept {
  return static_cast<std::uint64_t>(std::ranges::count_if(blocks, &MotionBlock::moved));
}
std::uint64_t MotionResult::left() const noexcept {
  return static_cast<std::uint64_t>(std::ranges::count_if(blocks, &MotionBlock::left));
}
std::uint64_t MotionResult::locked() const noexcept {
  return static_cast<std::uint64_t>(std::ranges::count_if(blocks, &MotionBlock::locked));
}
double MotionResult::fastest_left() const noexcept {
  double out = 0;
  for (const MotionBlock& b : blocks) out = std::max(out, b.leaving_speed);
  return out;
}
Length MotionResult::front_runout() const noexcept {
  Length out;
  for (const MotionBlock& b : blocks) out = std::max(out, b.front);
  return out;
}
std::uint64_t MotionResult::bolts_broken() const noexcept {
  return static_cast<std::uint64_t>(
      std::ranges::count_if(bolts, [](const MotionBolt& b) { return b.broken_at.has_value(); }));
}
Force MotionResult::largest_bolt_force() const noexcept {
  Force largest;
  for (const MotionBolt& b : bolts) largest = std::max(largest, b.largest);
  return largest;
}

std::expected<MotionResult, Problem> run_motion(const Scene& scene, const Realization& made,
                                                const BlockComplex& complex, const MovingRun& how, unsigned threads) {
  MotionCast cast =
      cast_of(scene, *scene.motion, made, complex, waves_of(scene, made, complex), {.gone = {}, .all_free = true});
  motion::WorldOptions options = options_of(scene, *scene.motion, made);
  options.threads = threads;
  add_ties(scene, made, complex, options, cast);
  auto world = motion::World::make(cast.scene, options);
  if (!world) {
    MotionResult refused;
    refused.stopped_why = "refused: " + world.error().reason + blocks_of(cast, world.error().bodies);
    refused.refused = true;
    refused.notes.push_back("motion: " + refused.stopped_why);
    return refused;
  }
  MotionRecorder recorder{scene, complex, cast, *std::move(world)};
  if (how.from) {
    if (auto problem = recorder.go_on_from(*how.from)) return std::unexpected(*std::move(problem));
  }
  recorder.follow(how.stop);
  std::string state = recorder.state();
  MotionResult result = recorder.close();
  result.state = std::move(state);
  if (scene.motion->error && result.converged && !result.blocks.empty()) {
    estimate_error(scene, complex, cast, options, how.stop, result);
  }
  if (cast.left_out > 0) {
    result.notes.push_back(fmt::format("motion: {} {} thinner than 1e-6 of the domain {} left out", cast.left_out,
                                       cast.left_out == 1 ? "block" : "blocks", cast.left_out == 1 ? "is" : "are"));
  }
  mark_locked(scene, made, result);
  add_motion_notes(scene, made, accepted, result);
  add_support_notes(scene, made, cast, result, result.notes);
  return result;
}

namespace {

/// Of a group in doubt: layers of blocks around it that are let go with it, at most so many blocks in all, for so long.
constexpr int layers_let_go = 1;
constexpr std::size_t most_let_go = 16;
constexpr double long_enough = 0.2;
/// What 0.05 % of free fall is over after that.
constexpr double far_enough = 1e-4;
/// So many groups of one run: a step of such a group may take tens of milliseconds.
constexpr std::size_t most_groups_let_go = 10;

/// The blocks of a group and those within some layers of them that are there and may move.
Waves around(const stability::KeyGroup& group, const BlockComplex& complex, const std::vector<std::uint8_t>& gone) {
  Waves waves(complex.blocks().size());
  std::vector<BlockId> layer = group.blocks;
  for (const BlockId b : layer) waves[b.index()] = 0;
  for (int k = 0; k < layers_let_go; ++k) {
    std::vector<BlockId> next;
    for (const BlockId b : layer) {
      for (const topology::FaceId f : complex.blocks()[b].faces) {
        for (const topology::Patch& patch : complex.patches(complex.faces()[f])) {
          if (!patch.neighbour) continue;
          const topology::Block& block = complex.blocks()[*patch.neighbour];
          const std::size_t at = patch.neighbour->index();
          if (waves[at] || gone[at] != 0 || block.fixed || block.truncated) continue;
          waves[at] = 0;
          next.push_back(*patch.neighbour);
        }
      }
    }
    layer = std::move(next);
  }
  return waves;
}

LetGo let_go(const Scene& scene, const Realization& made, const BlockComplex& complex, const stability::KeyGroup& group,
             const std::vector<std::uint8_t>& gone) {
  MotionSettings settings = scene.motion.value_or(MotionSettings{});
  settings.ground.reset();
  settings.loads = settings.seismic = true;
  const Waves waves = around(group, complex, gone);
  if (static_cast<std::size_t>(std::ranges::count_if(waves, [](const auto& w) { return w.has_value(); })) > most_let_go)
    return LetGo::not_tried;
  const MotionCast cast = cast_of(scene, settings, made, complex, waves, {.gone = gone, .all_free = false});
  auto world = motion::World::make(cast.scene, options_of(scene, settings, made));
  if (!world) return LetGo::stopped;
  while (world->time() < long_enough - 1e-9) {
    if (!world->step(long_enough - world->time())) return LetGo::stopped;
    for (std::size_t k = 0; k < cast.moving.size(); ++k) {
      if (std::ranges::binary_search(group.blocks, cast.moving[k]) && norm(world->displacement(k)) > far_enough)
        return LetGo::moved;
    }
  }
  return LetGo::stayed;
}

}  // namespace

std::vector<std::optional<LetGo>> let_go(const Scene& scene, const Realization& made, const BlockComplex& complex,
                                         const stability::KeyGroups& groups, unsigned threads) {
  std::vector<std::optional<LetGo>> out(groups.groups.size());
  std::vector<std::size_t> tried;
  for (std::size_t k = 0; k < out.size(); ++k) {
    const stability::KeyGroup& group = groups.groups[k];
    if (group.verdict != assembly::Verdict::in_doubt) continue;
    // With partial factors motion has other strengths than the verdict.
    if (tried.size() >= most_groups_let_go || reduces_strength(*scene.stability)) {
      out[k] = LetGo::not_tried;
      continue;
    }
    tried.push_back(k);
  }
  parallel_for(tried.size(), ThreadLimit{threads}, [&](std::size_t i) {
    const stability::KeyGroup& group = groups.groups[tried[i]];
    std::vector<std::uint8_t> gone(complex.blocks().size(), 0);
    for (const stability::KeyGroup& other : groups.groups) {
      if (other.verdict == assembly::Verdict::in_doubt || other.batch >= group.batch) continue;
      for (const BlockId b : other.blocks) gone[b.index()] = 1;
    }
    out[tried[i]] = let_go(scene, made, complex, group, gone);
  });
  return out;
}

}  // namespace cleave::scene
