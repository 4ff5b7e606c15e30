#include "motion_recorder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace cleave::scene {
namespace {

using geometry::Vec3;
using topology::BlockComplex;
using topology::BlockId;

constexpr double millimetre = 1e-3;
/// All slower than this for so many steps in a row: at rest.
constexpr double resting_speed = 1e-4;
constexpr std::uint32_t resting_steps = 20;
/// s; and for so long: steps may be short.
constexpr double resting_time = 0.1;
/// Of gravity: what gets faster by more than this does not rest, however slow it is yet.
constexpr double resting_acceleration = 1e-6;
/// m/s; what solvers leave of bodies at rest.
constexpr double resting_noise = 1e-7;
/// s; times that differ by less are one.
constexpr double at_once = 1e-9;

/// Whether it pulls across a place of the bolt, m from the collar.
bool crosses(const MotionCast::Tie& tie, double at) { return tie.leaves <= at && at < tie.anchored; }

bool share_a_face(const BlockComplex& complex, BlockId block, BlockId other) {
  for (const topology::FaceId face : complex.blocks()[block].faces) {
    for (const topology::Patch& patch : complex.patches(complex.faces()[face])) {
      if (patch.neighbour == other) return true;
    }
  }
  return false;
}

}  // namespace

std::string blocks_of(const MotionCast& cast, const std::vector<std::uint32_t>& bodies) {
  std::string out;
  for (const std::uint32_t body : bodies) {
    const auto at = std::ranges::find(cast.body, body);
    if (at == cast.body.end()) continue;
    const auto block = at - cast.body.begin();
    out += fmt::format("{}block {}", out.empty() ? ": " : ", ", block);
  }
  return out;
}

MotionRecorder::MotionRecorder(const Scene& scene, const BlockComplex& complex, const MotionCast& cast,
                               motion::World world)
    : scene_{scene}, settings_{*scene.motion}, complex_{complex}, cast_{cast}, world_{std::move(world)} {
  frame_ = between_frames(settings_);
  if (!cast.wave.empty()) waves_ = *std::ranges::max_element(cast.wave);
  const auto [lo, hi] = geometry::box_of(complex.vertices());
  const Vec3 margin = 0.25 * (hi - lo);
  low_ = lo - margin;
  high_ = hi + margin;
  lowest_ = lo.z - 0.05 * (hi.z - lo.z);
  for (const BlockId b : cast.moving) result_.blocks.push_back({.block = b, .centroid = {}});
  result_.walls = cast.walls;
  result_.supported = cast.supported;
  cut_.assign(cast.ties.size(), 0);
  for (const MotionCast::Tie& tie : cast.ties) {
    if (result_.bolts.empty() || result_.bolts.back().bolt != tie.bolt) result_.bolts.push_back({.bolt = tie.bolt});
    bolt_of_.push_back(static_cast<std::uint32_t>(result_.bolts.size() - 1));
  }
  result_.converged = true;
  record(0);
}

double MotionRecorder::between_frames(const MotionSettings& settings) {
  const double frame = settings.frame ? settings.frame->si() : settings.duration.si() / 50;
  return std::max(frame, settings.duration.si() / 1000);
}

void MotionRecorder::stop_because(std::string why) {
  result_.converged = false;
  result_.stopped_why = std::move(why);
}

void MotionRecorder::follow(const std::function<bool()>& stop) {
  const double duration = settings_.duration.si();
  std::uint64_t frame = 1;
  const auto skip_frames = [&] {
    while (static_cast<double>(frame) * frame_ <= world_.time() + at_once) ++frame;
  };
  skip_frames();
  while (world_.time() < duration - at_once && !result_.blocks.empty() && !(result_.at_rest && settings_.to_rest)) {
    if (stop && stop()) {
      result_.interrupted = true;
      return stop_because(fmt::format("interrupted at {:.6g} s", world_.time()));
    }
    const bool fresh = release() || result_.steps == 0;
    const double until = std::min(static_cast<double>(frame) * frame_, duration);
    const auto report = world_.step(until - world_.time());
    if (!report) return stop_because(describe(report.error()) + blocks_of(cast_, report.error().bodies));
    look_at(*report);
    if (fresh) look_at_tips();
    if (world_.time() >= until - at_once) {
      record(world_.time());
      skip_frames();
    }
    look_for_rest(*report);
  }
}

/// At rest: all slow for so long, none of them getting faster, nothing to be let go and the ground at rest.
void MotionRecorder::look_for_rest(const motion::StepReport& report) {
  const double now = world_.time();
  const bool may_rest =
      report.max_speed < resting_speed && place_.released == waves_ && !world_.options().ground.moves_at(now + at_once);
  if (!may_rest) place_.quiet = 0;
  std::vector<double> speed(cast_.moving.size(), 0);
  for (std::size_t k = 0; may_rest && k < speed.size(); ++k) {
    speed[k] = norm(world_.velocity(k)) + std::cbrt(world_.volume(k)) * norm(world_.spin(k));
  }
  const double faster = resting_acceleration * norm(world_.options().gravity) * (now - place_.quiet_from);
  for (std::size_t k = 0; place_.quiet > 0 && k < speed.size(); ++k) {
    place_.slowest[k] = std::min(place_.slowest[k], speed[k]);
    if (speed[k] > place_.slowest[k] + std::max(resting_noise, faster)) place_.quiet = 0;
  }
  if (may_rest && place_.quiet == 0) {
    place_.quiet_from = now;
    place_.slowest = std::move(speed);
  }
  place_.quiet = may_rest ? place_.quiet + 1 : 0;
  result_.at_rest = place_.quiet >= resting_steps && now - place_.quiet_from >= resting_time - at_once;
}

/// Wave k of n goes at k/n of the duration. Whether one went.
bool MotionRecorder::release() {
  const double each = settings_.duration.si() / (waves_ + 1);
  bool any = false;
  while (place_.released < waves_ && world_.time() >= each * (place_.released + 1) - at_once) {
    ++place_.released;
    any = true;
    for (std::size_t k = 0; k < cast_.wave.size(); ++k) {
      if (cast_.wave[k] == place_.released) world_.set_fixed(k, false);
    }
  }
  return any;
}

void MotionRecorder::look_at(const motion::StepReport& report) {
  ++result_.steps;
  result_.contacts = std::max<std::uint64_t>(result_.contacts, report.contacts);
  result_.residual = std::max(result_.residual, report.residual);
  result_.rough_steps += report.rough > 0 ? 1 : 0;
  if (report.rough > 0) result_.missed_speed = std::max(result_.missed_speed, report.missed_speed);
  result_.may_be_locked = std::max<std::uint64_t>(result_.may_be_locked, report.may_be_locked);
  result_.penetration = std::max(result_.penetration, metres(report.max_penetration));
  result_.overlap = std::max(result_.overlap, report.overlap);
  look_at_bolts();
  for (std::size_t k = 0; k < result_.blocks.size(); ++k) {
    MotionBlock& block = result_.blocks[k];
    if (block.left) continue;
    block.fastest = std::max(block.fastest, norm(world_.velocity(k)));
    if (!block.first_motion && norm(world_.displacement(k)) > millimetre) {
      block.first_motion = Time::from_si(world_.time());
    }
    look_at_fronts(k);
    const Vec3 c = world_.centroid(k);
    const bool inside = c.x > low_.x && c.y > low_.y && c.x < high_.x && c.y < high_.y && c.z > lowest_;
    if (inside) continue;
    block.left = true;
    block.leaving_speed = norm(world_.velocity(k));
    world_.set_fixed(k, true);
    // It hangs on nothing, and nothing on it.
    for (std::size_t t = 0; t < cut_.size(); ++t) {
      const motion::Tie& tie = cast_.scene.ties[t];
      if ((tie.body != k && tie.other != k) || world_.tie(t).broken) continue;
      world_.cut(t);
      cut_[t] = 1;
    }
  }
}

void MotionRecorder::look_at_fronts(std::size_t k) {
  if (world_.asleep(k) || world_.fixed(k)) return;
  const Vec3 shift = world_.displacement(k), start = world_.centroid(k) - shift;
  const motion::Turn turn = world_.turn(k);
  for (const Vec3 corner : cast_.scene.bodies[k].shape.vertices) {
    const Vec3 arm = corner - start;
    const Vec3 way = shift + (turn * arm - arm);
    result_.blocks[k].front = std::max(result_.blocks[k].front, metres(std::hypot(way.x, way.y)));
  }
}

void MotionRecorder::look_at_bolts() {
  for (std::size_t t = 0; t < cut_.size(); ++t) {
    MotionBolt& bolt = result_.bolts[bolt_of_[t]];
    // All that a bolt carries where it leaves a block.
    double force = 0;
    for (std::size_t other = t; other < cut_.size() && bolt_of_[other] == bolt_of_[t]; ++other) {
      if (crosses(cast_.ties[other], cast_.ties[t].leaves)) force += world_.tie(other).force.si();
    }
    for (std::size_t other = t; other-- > 0 && bolt_of_[other] == bolt_of_[t];) {
      if (crosses(cast_.ties[other], cast_.ties[t].leaves)) force += world_.tie(other).force.si();
    }
    bolt.largest = std::max(bolt.largest, newtons(force));
    if (world_.tie(t).broken && cut_[t] == 0 && !bolt.broken_at) bolt.broken_at = Time::from_si(world_.time());
  }
}

void MotionRecorder::record(double time) {
  MotionFrame frame{.time = Time::from_si(time), .places = {}};
  for (std::size_t k = 0; k < result_.blocks.size(); ++k) {
    frame.places.push_back({world_.displacement(k), world_.turn(k), world_.velocity(k)});
  }
  result_.frames.push_back(std::move(frame));
}

/// Of each block: the bolts that tied it to other rock, and those of them that broke.
void MotionRecorder::count_bolts() {
  constexpr std::uint32_t none = static_cast<std::uint32_t>(-1);
  std::vector<std::uint32_t> last(result_.blocks.size(), none), last_broken(result_.blocks.size(), none);
  for (std::size_t t = 0; t < cut_.size(); ++t) {
    for (const std::uint32_t b : {cast_.scene.ties[t].body, cast_.scene.ties[t].other}) {
      if (b >= result_.blocks.size()) continue;
      if (std::exchange(last[b], bolt_of_[t]) != bolt_of_[t]) ++result_.blocks[b].bolts;
      if (!world_.tie(t).broken || cut_[t] != 0) continue;
      if (std::exchange(last_broken[b], bolt_of_[t]) != bolt_of_[t]) ++result_.blocks[b].bolts_broken;
    }
  }
}

MotionResult MotionRecorder::close() {
  // The state at which it stopped is shown.
  if (result_.frames.back().time.si() < world_.time()) record(world_.time());
  result_.end = Time::from_si(world_.time());
  const motion::Energy& e = world_.energy();
  result_.potential_lost = e.start - e.potential;
  result_.kinetic = e.kinetic;
  result_.dissipated = e.friction + e.lost;
  result_.carried_out = e.carried;
  result_.lifted = e.projected;
  if (settings_.ground) result_.work_of_ground = e.ground;
  if (cast_.loaded) {
    MotionLoads& loads = result_.loads.emplace();
    loads.work = e.loads;
    for (std::size_t k = 0; k < cast_.scene.loads.size(); ++k) {
      (cast_.scene.loads[k].other ? loads.in_joints : loads.on_faces) += 1;
      loads.drained += world_.load_gone(k) ? 1U : 0U;
    }
    loads.still_water = cast_.scene.water.has_value();
  }
  result_.energy_error = e.closing_error;
  result_.momentum_error = world_.momentum_error();
  for (std::size_t t = 0; t < cut_.size(); ++t) {
    MotionBolt& bolt = result_.bolts[bolt_of_[t]];
    bolt.lengthened = std::max(bolt.lengthened, world_.tie(t).lengthened);
  }
  count_bolts();
  for (std::size_t k = 0; k < result_.blocks.size(); ++k) {
    MotionBlock& block = result_.blocks[k];
    const Vec3 shift = world_.displacement(k);
    block.moved = norm(shift) > millimetre;
    block.locked = !block.moved && !block.left && norm(world_.velocity(k)) < resting_speed && world_.may_be_locked(k);
    block.fall = metres(-shift.z);
    block.runout = metres(std::hypot(shift.x, shift.y));
    block.centroid = complex_.origin() + world_.centroid(k);
  }
  return std::move(result_);
}

/// What blocks lean on without a face in common, in the step after they were let go: later they may sleep.
void MotionRecorder::look_at_tips() {
  std::vector<std::optional<BlockId>> block(world_.size());
  for (std::uint32_t b = 0; b < cast_.body.size(); ++b) {
    if (cast_.body[b] < block.size()) block[cast_.body[b]] = BlockId{b};
  }
  for (const motion::Contact& contact : world_.contacts()) {
    if (!(norm(contact.force) > 0)) continue;
    for (const auto& [own, other] : {std::pair{contact.body, contact.other}, std::pair{contact.other, contact.body}}) {
      if (own >= result_.blocks.size() || !block[own] || !block[other]) continue;
      if (!share_a_face(complex_, *block[own], *block[other])) result_.at_tips.push_back({*block[own], *block[other]});
    }
  }
  std::ranges::sort(result_.at_tips);
  const auto repeated = std::ranges::unique(result_.at_tips);
  result_.at_tips.erase(repeated.begin(), repeated.end());
}

}  // namespace cleave::scene
