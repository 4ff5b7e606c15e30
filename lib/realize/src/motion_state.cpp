#include <algorithm>
#include <cmath>
#include <utility>

#include "cleave/core/sha256.hpp"
#include "cleave/motion/archive.hpp"
#include "cleave/scene/saved_run.hpp"
#include "motion_recorder.hpp"

/// The state of a run of blocks in motion as bytes, and back.
namespace cleave {

template <class A, class Q>
  requires requires(Q q) { Q::from_si(q.si()); }
void archive(A& a, Q& quantity) {
  double value = quantity.si();
  a(value);
  if constexpr (!std::is_const_v<Q>) quantity = Q::from_si(value);
}

namespace scene {

template <class A>
void archive(A& a, Archived<MotionPlace> auto& p) {
  a(p.released, p.quiet, p.quiet_from, p.slowest);
}
template <class A>
void archive(A& a, Archived<MotionFrame::Place> auto& p) {
  a(p.shift, p.turn, p.velocity);
}
template <class A>
void archive(A& a, Archived<MotionFrame> auto& f) {
  a(f.time, f.places);
}
/// What grows from step to step of a block; where it lies in the end follows from the world.
struct BlockSoFar {
  std::optional<Time> first_motion = {};
  double fastest = 0;
  Length front = {};
  bool left = false;
  double leaving_speed = 0;
};
template <class A>
void archive(A& a, Archived<BlockSoFar> auto& b) {
  a(b.first_motion, b.fastest, b.front, b.left, b.leaving_speed);
}
template <class A>
void archive(A& a, Archived<MotionBolt> auto& b) {
  a(b.bolt, b.largest, b.broken_at);
}
template <class A>
void archive(A& a, Archived<MotionTip> auto& t) {
  std::uint32_t block = t.block.value(), rock = t.rock.value();
  a(block, rock);
  if constexpr (!std::is_const_v<std::remove_reference_t<decltype(t)>>) {
    t = {topology::BlockId{block}, topology::BlockId{rock}};
  }
}
template <class A>
void archive(A& a, Archived<MotionResult> auto& r) {
  a(r.at_rest, r.steps, r.contacts, r.may_be_locked, r.rough_steps, r.missed_speed, r.residual, r.penetration,
    r.overlap, r.frames, r.bolts, r.at_tips);
}

namespace {

constexpr std::string_view state_kind = "cleave-motion-state";
constexpr std::uint32_t version_of_state = 4;
constexpr StateKind kind_of_state{.run = "a run of blocks in motion",
                                  .file = motion_state_name,
                                  .ties = "its blocks, joints, frames, ground or when blocks are let go"};

}  // namespace

/// What must be the same beside the world: when blocks go, when they are written down, and where they leave.
std::string MotionRecorder::identity() const {
  ArchiveWriter a;
  for (const topology::BlockId b : cast_.moving) a(b.value());
  for (const MotionCast::Tie& tie : cast_.ties) a(tie.bolt, tie.leaves, tie.anchored);
  a(settings_.ground, cast_.wave, waves_ > 0 ? settings_.duration.si() / (waves_ + 1) : 0.0);
  a(low_, high_, lowest_, frame_);
  return sha256_hex(a.bytes());
}

bool MotionRecorder::is_sound(const MotionResult& read, const MotionPlace& place) const {
  const auto finite = [](const MotionFrame::Place& p) {
    return geometry::is_finite(p.shift) && geometry::is_finite(p.velocity) && std::isfinite(motion::angle_of(p.turn));
  };
  const auto sound = [&](const MotionFrame& f) {
    return std::isfinite(f.time.si()) && f.places.size() == cast_.moving.size() &&
           std::ranges::all_of(f.places, finite);
  };
  const auto time = [](const MotionFrame& f) { return f.time.si(); };
  const auto same_bolt = [](const MotionBolt& a, const MotionBolt& b) {
    return a.bolt == b.bolt && std::isfinite(a.largest.si());
  };
  return std::ranges::equal(read.bolts, result_.bolts, same_bolt) && !read.frames.empty() &&
         std::ranges::all_of(read.frames, sound) && std::ranges::is_sorted(read.frames, {}, time) &&
         place.released <= waves_ && std::isfinite(place.quiet_from) &&
         (place.quiet == 0 || place.slowest.size() == cast_.moving.size());
}

std::string MotionRecorder::state() const {
  std::vector<BlockSoFar> blocks;
  for (const MotionBlock& b : result_.blocks) {
    blocks.push_back({b.first_motion, b.fastest, b.front, b.left, b.leaving_speed});
  }
  ArchiveWriter a;
  a(identity(), world_.saved(), place_, result_, blocks, cut_);
  return sealed(state_kind, version_of_state, a.bytes());
}

std::optional<Problem> MotionRecorder::go_on_from(const SavedRun& saved) {
  const auto because = [&](SavedFault fault) { return refused(saved, kind_of_state, fault); };
  auto opened = unsealed_of(identity(), state_kind, version_of_state, saved.bytes);
  if (!opened) return because(opened.error());
  ArchiveReader& a = *opened;
  std::string world_bytes;
  MotionPlace place;
  MotionResult read;
  std::vector<BlockSoFar> blocks;
  std::vector<std::uint8_t> cut;
  a(world_bytes, place, read, blocks, cut);
  if (!a.complete() || blocks.size() != cast_.moving.size() || cut.size() != cut_.size() || !is_sound(read, place))
    return because(SavedFault::damaged);
  motion::World world = world_;
  if (const auto restored = world.restore(world_bytes); !restored) {
    return because(restored.error() == SavedFault::foreign ? SavedFault::damaged : restored.error());
  }
  const double duration = settings_.duration.si();
  if (world.time() > duration * (1 + 1e-12)) {
    return too_far(saved, scene_.shown, "motion.duration", duration, world.time());
  }
  read.blocks = std::move(result_.blocks);
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    read.blocks[k].first_motion = blocks[k].first_motion;
    read.blocks[k].fastest = blocks[k].fastest;
    read.blocks[k].front = blocks[k].front;
    read.blocks[k].left = blocks[k].left;
    read.blocks[k].leaving_speed = blocks[k].leaving_speed;
  }
  read.walls = cast_.walls;
  read.supported = cast_.supported;
  read.converged = true;
  result_ = std::move(read);
  place_ = place;
  cut_ = std::move(cut);
  world_ = std::move(world);
  return std::nullopt;
}

}  // namespace scene
}  // namespace cleave
