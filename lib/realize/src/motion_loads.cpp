#include "motion_loads.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "judge.hpp"

namespace cleave::scene {
namespace {

using geometry::Vec3;
using stability::FlowWater;
using topology::BlockComplex;
using topology::BlockId;

/// Whether water stands before one of its sides.
bool before_standing(const BlockComplex& complex, BlockId block, const stability::Actions& actions) {
  const auto& flow = actions.spec().flow;
  if (!flow || flow->standing.empty()) return false;
  for (const topology::FaceId id : complex.blocks()[block].faces) {
    const topology::Face& face = complex.faces()[id];
    if (face.role != topology::Role::free || face.excavation) continue;
    const auto same = [&](const FlowWater::Standing& side) { return side.tag == face.tag; };
    if (std::ranges::any_of(flow->standing, same)) return true;
  }
  return false;
}

/// Load cases of which motion has less than they say.
std::string cases_left_out(const Scene& scene) {
  std::vector<std::string> out;
  for (const LoadCase& load : scene.stability->cases) {
    const std::string loads = left_out_of(load.loads, {.loads = false});
    if (!loads.empty()) out.push_back(fmt::format("\"{}\" ({})", load.name, loads));
  }
  return fmt::format("{}", fmt::join(out, ", "));
}

}  // namespace

void add_loads(const Scene& scene, const MotionSettings& settings, const Realization& made, const BlockComplex& complex,
               const std::vector<std::uint8_t>& gone, MotionCast& cast) {
  if (!settings.loads || cast.moving.empty()) return;
  const stability::Settings judged = settings_of(scene, made);
  const Vec3 gravity = judged.loads.gravity();
  const auto moving = static_cast<std::uint32_t>(cast.moving.size());
  for (const stability::LoadOnBlock& load : loads_on(complex, judged.actions, gravity, cast.moving)) {
    motion::Load made_load{
        .body = cast.body[load.block.index()], .at = load.at - complex.origin(), .force = load.force};
    if (load.neighbour) {
      if (!gone.empty() && gone[load.neighbour->index()] != 0) continue;
      const std::uint32_t other = cast.body[load.neighbour->index()];
      // Listed for each of the two.
      if (other < moving && *load.neighbour < load.block) continue;
      // Any wall stands for the rock that stays: all of it is where it was.
      if (other < cast.scene.bodies.size()) {
        made_load.other = other;
      } else if (cast.walls > 0) {
        made_load.other = moving;
      }
      const bool stands = before_standing(complex, load.block, judged.actions) ||
                          before_standing(complex, *load.neighbour, judged.actions);
      if (!stands) {
        made_load.opens = settings.drains_at;
        made_load.slides = std::max(settings.drains_at, metres(std::sqrt(load.contact.si())));
      }
    }
    cast.scene.loads.push_back(made_load);
  }
  const auto& table = judged.actions.spec().water;
  if (const double g = norm(gravity); table && table->on_free_faces && g > 0) {
    const Vec3 up = -gravity / g;
    cast.scene.water = {
        .level = metres(table->level - dot(up, complex.origin())), .up = up, .unit_weight = table->unit_weight};
  }
  cast.loaded = !cast.scene.loads.empty() || cast.scene.water;
}

std::string left_out_of(const LoadSet& loads, const MotionSettings& settings) {
  const stability::ActionSpec& actions = loads.actions.spec();
  std::vector<std::string_view> out;
  if (!settings.loads) {
    if (!loads.dry()) out.emplace_back("water on joints");
    if (!actions.surcharges.empty()) out.emplace_back("surcharge");
    if (!actions.points.empty()) out.emplace_back("point forces");
    if (!actions.lines.empty()) out.emplace_back("line forces");
  }
  if (!settings.seismic && norm(loads.body.seismic()) > 0) out.emplace_back("seismic");
  return fmt::format("{}", fmt::join(out, ", "));
}

void add_load_notes(const Scene& scene, MotionResult& result) {
  const MotionSettings& settings = *scene.motion;
  const LoadSet& loads = scene.stability->loads;
  if (const std::string out = left_out_of(loads, settings); !out.empty()) {
    std::string note = "motion: of the loads of [stability] these are left out: " + out;
    note += settings.ground ? "; the ground moves in its place" : ". A block that only these bring down stands";
    if (!settings.loads) note += "; motion.loads is false";
    result.notes.push_back(std::move(note));
  }
  if (settings.seismic && norm(loads.body.seismic()) > 0) {
    result.notes.emplace_back(
        "motion: the static force of stability.seismic pushes for the whole run, as no earthquake does: what it sets "
        "moving goes too far");
  }
  if (result.loads && result.loads->drained > 0) {
    result.notes.push_back(fmt::format(
        "motion: water presses no more in {} of {} contacts of blocks, which have come apart by more than {:g} m "
        "(motion.drains_at) or slid by more than their size",
        result.loads->drained, result.loads->in_joints, settings.drains_at.si()));
  }
  if (const std::string cases = cases_left_out(scene); !cases.empty()) {
    result.notes.push_back("motion: the loads of [stability] alone act on blocks in motion, not the load cases " +
                           cases);
  }
}

}  // namespace cleave::scene
