#pragma once

#include <array>
#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <vector>

#include "cleave/core/id.hpp"
#include "cleave/core/quantity.hpp"
#include "cleave/geometry/vec3.hpp"
#include "cleave/scene/plan.hpp"
#include "cleave/scene/scene.hpp"
#include "cleave/stability/maximum_blocks.hpp"
#include "cleave/stability/result.hpp"
#include "cleave/stability/sensitivity.hpp"
#include "cleave/stability/support.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut_input.hpp"
#include "cleave/topology/ids.hpp"

namespace cleave::scene {

/// What one stage cost. CPU time is that of all threads; the peak is the process's high-water mark at the stage's end.
struct StageCost {
  Stage stage;
  double wall_s = 0;
  double cpu_s = 0;
  double peak_rss_mb = 0;
};

/// What the run cost so far. `stages` holds only stages that ran, in order.
struct RunCost {
  double wall_s = 0;
  double cpu_s = 0;
  double peak_rss_mb = 0;
  unsigned threads = 1;
  std::vector<StageCost> stages;
};

struct Strength {
  FrictionAngle friction;
  Stress cohesion;
  Stress tension;
  double jrc = 0;  ///< > 0: Barton-Bandis, friction is the residual angle
  Stress jcs = {};
};

/// The blocks judged under one named load case.
struct CaseResult {
  std::string name;
  stability::Analysis analysis;
};

/// The support checked under one named load case.
struct CaseSupport {
  std::string name;
  stability::SupportResult support;
};

/// A largest key block of block theory.
struct MaximumRow {
  std::array<std::string, 3> sets;  ///< names
  stability::MaximumKeyBlock block;
  std::string where;  ///< "roof", "floor", "right wall", "left wall" (looking along the axis)
};

/// What the search for a pattern found for one length of bolt.
struct DesignResult {
  double length;
  bool found = false;
  double scale = 0;  ///< on the scene's spacings
  std::size_t bolts = 0;
  double cost = 0;
  /// Of the first pattern, m: along a tunnel's axis and around its section, or across and down a grid.
  std::array<double, 2> spacing{};
  std::size_t rings = 0;  ///< of the first pattern; 0: a grid
  /// Offsets drawn at random in both directions, and how many of them fail.
  std::uint64_t offsets = 0, failing = 0;
  std::array<double, 2> failing_share{};  ///< Clopper-Pearson, 95 %
  /// The block that decides: misses its target at the most of these offsets; where none fails, with the least factor
  /// over target. Where no pattern is found, of the tightest one.
  std::optional<topology::BlockId> governing = {};
};

enum class JointOrigin : std::uint8_t { measured, drawn };

/// A joint as it went into the cutter; its polygon(s) or plane are RunResult::input.joints[id.index()].
struct JointInfo {
  SetId set;
  JointOrigin origin;
  std::string source;  ///< "joints.obj:120", "scene.toml:14"; for drawn joints "A #7" (set, number from 1)
  Strength strength;
  geometry::Vec3 normal;  ///< upward unit normal (z >= 0); of the first polygon when the joint has several
  Dip dip;
  DipDirection dip_direction;  ///< clockwise from +y
};

struct SetInfo {
  std::string name;
  std::uint64_t joints = 0;
};

/// The part of the rock that was cut when only key blocks were asked for.
struct WindowInfo {
  geometry::Vec3 min, max;      ///< m
  unsigned rounds = 1;          ///< how many windows were cut before this one was large enough
  std::uint64_t truncated = 0;  ///< blocks that go on outside it
};

struct ExcavationInfo {
  std::string name;
  std::uint32_t stage = 1;
};

/// Everything that is known at the end of `scene::run`, and all that the writers need: they take it by const reference
/// and compute nothing but layout from it. How it is filled:
/// - after a finished run `complex` holds the audited block system; when the certificate did not pass it holds that
/// certificate, and
///   `analysis` is empty: summary.json is written all the same (certificate.passed = false) and the program ends with
///   4;
/// - `analysis` is present exactly when plan.runs(Stage::stability) and the certificate passed. Sections of stages that
/// did not run are
///   absent from summary.json;
/// - free faces of the complex index `excavations` by topology::Face::excavation; faces of role joint index `joints` by
/// their JointId;
/// - `cost` covers read .. stability when `run` returns. The program adds `write` (VTU, CSV) and `report` (HTML) as
///   it does them, and writes summary.json last, so that all costs are in it but its own few milliseconds. report.html
///   shows the costs known when it is written.
struct RunResult {
  std::string title;
  std::uint64_t seed = 1;
  std::string scene_file;    ///< name without folder
  std::string scene_sha256;  ///< of the scene file's bytes, hex
  std::vector<InputFile> files;
  double north =
      0;  ///< degrees from +y to true north, clockwise: add nothing to dip directions, turn only the north arrow

  Plan plan;
  RunCost cost;
  OutputSettings output;
  Rock rock;
  std::optional<StabilitySettings> stability;

  topology::CutInput input;                       ///< domain, joints and excavations as cut, for drawing
  IdVector<SetId, SetInfo> sets;                  ///< only sets with at least one joint have `joints` > 0
  IdVector<topology::JointId, JointInfo> joints;  ///< as many as input.joints, same order
  std::vector<ExcavationInfo> excavations;        ///< as many as input.excavations, same order

  std::expected<topology::AuditedComplex, topology::Certificate> complex;
  std::string block_hash;  ///< topology::canonical_hash; empty when the certificate failed
  /// The same of the blocks of all batches: equal whether all the rock was cut or only that near free faces; empty
  /// without analysis.
  std::string key_block_hash;
  std::optional<WindowInfo> window;  ///< when not all the rock was cut
  std::optional<stability::Analysis> analysis;
  /// Stage by stage, where excavations have different stages; `complex` and `analysis` then are those of the rock when
  /// all are out and no block has left before.
  std::optional<SequenceResult> sequence;

  MicroBlocks micro_blocks;  ///< the scene's policy
  /// Where the scene has [field_stress] and something is judged.
  std::optional<FieldStressResult> field_stress;
  std::optional<stability::SupportResult> support;
  std::vector<CaseSupport> support_cases;  ///< of [[load]], in scene order
  std::vector<std::string> bolt_groups;    ///< names, by Bolt::group
  std::vector<DesignResult> designs;
  std::vector<MaximumRow> maximum_blocks;
  double tunnel_length = 0;                         ///< m, of all tunnels
  std::vector<stability::Sensitivity> sensitivity;  ///< of the blocks of the first batch
  std::vector<CaseResult> load_cases;               ///< of [[load]], in scene order; the base case is `analysis`

  std::vector<std::string> notes;  ///< what a user should know: joints outside the domain, what was left out
};

}  // namespace cleave::scene
