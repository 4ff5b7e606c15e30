#include "load_notes.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "judge.hpp"

namespace cleave::scene {
namespace {

/// Blocks that move, ascending.
std::vector<topology::BlockId> moving(const stability::Analysis& analysis) {
  std::vector<topology::BlockId> out;
  for (const stability::Batch& batch : analysis.batches)
    out.insert(out.end(), batch.blocks.begin(), batch.blocks.end());
  std::ranges::sort(out);
  return out;
}

/// Key blocks that water lifts out of free faces below its level: what drains the face may drain the joint, too.
void add_lifted_note(const stability::Analysis& analysis, const LoadSet& loads, const topology::BlockComplex& complex,
                     std::string_view where, std::vector<std::string>& notes) {
  if (loads.dry()) return;
  std::size_t count = 0;
  Volume volume;
  for (const stability::Judgement& j : analysis.judgements) {
    if (!j.key || j.mode != stability::Mode::lifting) continue;
    ++count;
    volume += complex.blocks()[j.block].volume;
  }
  if (count == 0) return;
  notes.push_back(
      note_on_lifted(where, fmt::format("{} key {} ({:.4g} m3)", count, count == 1 ? "block" : "blocks", volume.si())));
}

/// What key blocks of all batches lack, one by one; what turns may lack nothing along its way.
Force net_force_of(const stability::Analysis& analysis) {
  Force sum{};
  for (const stability::Judgement& j : analysis.judgements) {
    if (j.key && j.net > Force{}) sum += j.net;
  }
  return sum;
}

/// Whether the same blocks move together, or are in doubt, at the same factor.
bool same_groups(const std::optional<stability::KeyGroups>& a, const std::optional<stability::KeyGroups>& b) {
  if (!a || !b) return true;
  return std::ranges::equal(a->groups, b->groups, [](const stability::KeyGroup& x, const stability::KeyGroup& y) {
    return x.blocks == y.blocks && x.verdict == y.verdict && x.factor_move == y.factor_move;
  });
}

}  // namespace

void add_stage_case_notes(const SequenceResult& sequence, std::vector<std::string>& notes) {
  for (const StageResult& row : sequence.stages) {
    if (&row == &sequence.stages.back()) break;
    if (row.cases.empty()) continue;
    const std::vector<topology::BlockId> without = moving(*row.analysis);
    for (const StageCase& under : row.cases) {
      std::size_t more = 0;
      Volume volume;
      for (const topology::BlockId block : moving(under.analysis)) {
        if (std::ranges::binary_search(without, block)) continue;
        ++more;
        volume += (*row.complex)->complex().blocks()[block].volume;
      }
      if (more == 0) continue;
      notes.push_back(fmt::format("after stage {}, load case {}: {} ({:.4g} m3) that would not without the load",
                                  row.stage, under.name,
                                  more == 1 ? "1 block moves" : fmt::format("{} blocks move", more), volume.si()));
    }
  }
}

void add_lifted_notes(const Scene& scene, const Realization& made, std::vector<std::string>& notes) {
  const topology::BlockComplex& complex = made.complex->complex();
  add_lifted_note(*made.analysis, scene.stability->loads, complex, "", notes);
  for (std::size_t k = 0; k < made.load_cases.size(); ++k) {
    const CaseResult& load = made.load_cases[k];
    add_lifted_note(load.analysis, scene.stability->cases[k].loads, complex, fmt::format("load case {}: ", load.name),
                    notes);
  }
}

void add_case_notes(const Scene& scene, const Realization& made, std::vector<std::string>& notes) {
  const stability::Analysis& base = *made.analysis;
  const LoadSet& loads = scene.stability->loads;
  const auto same = [](const stability::Judgement& a, const stability::Judgement& b) {
    return a.block == b.block && a.factor_of_safety == b.factor_of_safety && a.driving.si() == b.driving.si();
  };
  for (std::size_t k = 0; k < made.load_cases.size(); ++k) {
    const CaseResult& load = made.load_cases[k];
    const LoadCase& stated = scene.stability->cases[k];
    const LoadSet& own = stated.loads;
    if (!base.judgements.empty() && std::ranges::equal(load.analysis.judgements, base.judgements, same) &&
        same_groups(load.groups, made.key_groups)) {
      const auto& water = own.actions.spec().water;
      const bool wet = water && (!loads.actions.spec().water || loads.actions.spec().water->level != water->level);
      if (stated.target && !wet) continue;  // it may be there for its targets
      notes.push_back(fmt::format(
          "load case {} changes the factor of safety of no block{}", load.name,
          wet ? fmt::format(": its water (table = {:g}) reaches no joint of theirs; the table is a level in the "
                            "coordinates of the scene, not a depth",
                            water->level)
              : ""));
      continue;
    }
    if (own.body.seismic() == loads.body.seismic()) continue;
    const double before = count_key_blocks(base).lowest_factor_of_safety;
    const double after = count_key_blocks(load.analysis).lowest_factor_of_safety;
    constexpr std::string_view sign = "`seismic` is the direction in which the rock is pushed; check its sign";
    if (after > before) {
      notes.push_back(
          fmt::format("load case {}: with its earthquake the lowest factor of safety is {:.4g}, more than {:.4g} in "
                      "the base case: {}",
                      load.name, after, before, sign));
    } else if (const Force needed = net_force_of(load.analysis), less = net_force_of(base); needed < less) {
      notes.push_back(fmt::format(
          "load case {}: with its earthquake all that moves lacks {:.4g} kN, less than {:.4g} kN in the base case: {}",
          load.name, needed.si() / 1000, less.si() / 1000, sign));
    }
  }
}

void add_sign_notes(const Scene& scene, const Realization& made, std::vector<std::string>& notes) {
  if (made.window) return;
  const topology::AuditedComplex& complex = *made.complex;
  const LoadSet& loads = scene.stability->loads;
  if (loads.body.seismic() != geometry::Vec3{}) {
    stability::Settings calm = settings_on(complex.complex(), scene, made, loads);
    calm.loads = calm.loads.with_seismic_times(0);
    calm.rotation = stability::RotationCheck::off;
    const double before = count_key_blocks(stability::analyse(complex, calm)).lowest_factor_of_safety;
    const double after = count_key_blocks(*made.analysis).lowest_factor_of_safety;
    if (after > before * (1 + 1e-9)) {
      notes.push_back(
          fmt::format("with the earthquake of [stability] the lowest factor of safety is {:.4g}, more than {:.4g} "
                      "without it: `seismic` is the direction in which the rock is pushed; check its sign",
                      after, before));
    }
  }
  const auto look = [&](const LoadSet& own, std::size_t known, const std::string& where) {
    for (const std::size_t i : stability::pulling_surcharges(complex.complex(), own.actions)) {
      // What a case takes over from the base case comes first in its lists and was said there.
      if (i < known) continue;
      notes.push_back(fmt::format(
          "{}surcharge[{}] pulls at the faces it acts on: `traction` is the force on the rock, z upward, and "
          "a weight on level ground has a negative z; check its sign",
          where, i + 1));
    }
  };
  look(loads, 0, "");
  for (const LoadCase& load : scene.stability->cases) {
    look(load.loads, loads.actions.spec().surcharges.size(), "load case " + load.name + ": ");
  }
}

std::string note_on_lifted(std::string_view where, std::string_view how_many) {
  return fmt::format(
      "{}water lifts {}: it presses in the joints behind them, not on their free faces; where the rock is drained, "
      "state a lower level of the water, or `pressures`; where the opening is flooded, free_faces = true",
      where, how_many);
}

void add_case_counts(const Realization& made, std::vector<std::string>& notes) {
  for (const CaseResult& load : made.load_cases) {
    std::size_t leaving = 0, base = 0;
    for (const stability::Batch& batch : load.analysis.batches) leaving += batch.blocks.size();
    for (const stability::Batch& batch : made.analysis->batches) base += batch.blocks.size();
    if (leaving != base) {
      notes.push_back(fmt::format("load case {}: {} key blocks, {} in the base case", load.name, leaving, base));
    }
  }
}

}  // namespace cleave::scene
