#include "cleave/report/monte_carlo.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

#include "cleave/exchange/csv.hpp"
#include "cleave/realize/run.hpp"
#include "cleave/report/monte_carlo_fields.hpp"

namespace cleave::report {

namespace {

/// Of key blocks that water lifts in some realization. `where`: the load case, before the note.
void add_lifted_note(const std::vector<stochastic::Estimate>& estimates, const scene::LoadSet& loads,
                     std::string_view where, std::vector<std::string>& notes) {
  const auto lifted = std::ranges::find(estimates, "lifted_count", &stochastic::Estimate::name);
  if (loads.actions.dry() || lifted == estimates.end() || !(lifted->mean > 0)) return;
  notes.push_back(
      scene::note_on_lifted(where, fmt::format("in the mean {:.3g} key blocks a realization", lifted->mean)));
}

void add_lifted_notes(const scene::Scene& scene, stochastic::Figures& figures) {
  if (!scene.stability) return;
  add_lifted_note(figures.estimates, scene.stability->loads, "", figures.notes);
  for (std::size_t k = 0; k < figures.cases.size(); ++k) {
    const stochastic::CaseEstimates& under = figures.cases[k];
    add_lifted_note(under.estimates, scene.stability->cases.at(k).loads, fmt::format("load case {}: ", under.name),
                    figures.notes);
  }
}

/// Of blocks that turn in some realization. `where`: the load case, before the note.
void add_turning_note(const std::vector<stochastic::Estimate>& estimates, bool decides, std::string_view where,
                      std::vector<std::string>& notes) {
  const auto turning = std::ranges::find(estimates, "probability_of_turning", &stochastic::Estimate::name);
  if (turning == estimates.end() || !(turning->mean > 0)) return;
  notes.push_back(
      fmt::format("{}in {:.3g} % of the realizations blocks turn or topple though they cannot slide: {}", where,
                  100 * turning->mean,
                  decides ? "they are key blocks, but factors and forces are those of translation, which are not "
                            "below 1, and 0, for them"
                          : "they count as key blocks only with rotation = \"decide\""));
}

void add_turning_notes(const scene::Scene& scene, stochastic::Figures& figures) {
  if (!scene.stability) return;
  const bool decides = scene.stability->rotation == stability::RotationCheck::decide;
  add_turning_note(figures.estimates, decides, "", figures.notes);
  for (const stochastic::CaseEstimates& under : figures.cases) {
    add_turning_note(under.estimates, decides, fmt::format("load case {}: ", under.name), figures.notes);
  }
}

void add_flow_notes(const scene::Scene& scene, stochastic::Figures& figures) {
  if (!scene.flow) return;
  if (scene.flow->flows()) {
    figures.notes.push_back(note_on_flow(scene));
    figures.notes.emplace_back(
        "[flow]: faces of the domain that an opening cuts below the water are closed; a replay of a realization names "
        "them");
  }
  for (const auto& estimate : figures.estimates) {
    if (estimate.name != "inflow_not_settled" || !(estimate.mean > 0)) continue;
    figures.notes.push_back(fmt::format(
        "[flow]: in {:.3g} % of the realizations the inflow is not known to the tolerance asked for: compare the means "
        "of inflow_low_m3_s and inflow_high_m3_s, and raise flow.max_triangles",
        100 * estimate.mean));
  }
  if (scene.domain.tags().size() > stochastic::most_sides) {
    figures.notes.push_back(fmt::format(
        "[flow]: the domain has more than {} sides: which of them joints connect is not counted; a replay says it",
        stochastic::most_sides));
  }
}

}  // namespace

MonteCarloPage monte_carlo_page(const scene::Scene& scene, const scene::RunCost& cost, scene::MonteCarloResult result) {
  MonteCarloPage page{head_of(scene, make_plan(scene)),
                      std::move(result),
                      scene.files,
                      {},
                      ensemble_options_of(scene).tunnel_length_m,
                      {},
                      orders_of(scene)};
  page.cost = cost;
  if (auto taken = scene::excavated(scene)) {
    page.excavations = std::move(taken->openings);
    std::ranges::move(taken->notes, std::back_inserter(page.result.figures.notes));
  }
  if (scene.stability && scene.stability->groups == stability::GroupsCheck::note) {
    page.result.figures.notes.push_back(
        "blocks were judged one by one: what only moves together (key groups) is not counted, so that more may fail; "
        "groups = \"decide\" counts it, a single run of a realization tells its groups");
  }
  if (scene.stability && !scene.stability->cases.empty()) {
    page.result.figures.notes.push_back(
        "quantities, quantiles, exceedance, factors and pressures are those of the base case; what moves under each "
        "[[load]] stands in load_cases");
  }
  if (scene.stability && scene.sequence) {
    page.result.figures.notes.push_back(fmt::format(
        "key blocks and support are those of the rock when all is excavated: what moves only in a stage before the "
        "last is not in these figures{}; a replay of a realization judges every stage",
        scene.support ? ", and what the support leaves after one is in support_fails_at_a_stage alone" : ""));
  }
  if (scene.stability && scene.stability->group_factor) {
    page.result.figures.notes.push_back(
        "group_factor is not looked for in ensembles; a replay of a realization looks for it");
  }
  if (scene.stability && scene.stability->decides_by_groups()) {
    page.result.figures.notes.push_back(
        "blocks of key groups are key blocks, but forces to be held and pressures are those of single blocks: what it "
        "takes to hold a group is not in them");
  }
  for (const auto& estimate : page.result.figures.estimates) {
    if (estimate.name == "slight_taper_count" && estimate.mean > 0) {
      page.result.figures.notes.push_back(fmt::format(
          "in the mean {:.3g} blocks a realization at free faces stay only because joints close on them by less than "
          "{:g} mm a metre and are not counted as key blocks: count on no such taper",
          estimate.mean, 1e3 * stability::slight_taper));
    }
    if (estimate.name == "domain_held_at_target_count" && estimate.mean > 0) {
      page.result.figures.notes.push_back(fmt::format(
          "in the mean {:.3g} blocks a realization at free faces reach the target for sliding only because of sides of "
          "the domain that are not free: enlarge the domain, or name these sides in `free`{}",
          estimate.mean, scene.support ? "; the support is not asked to hold them" : ""));
    }
    if (estimate.name == "slight_taper_at_target_count" && estimate.mean > 0) {
      page.result.figures.notes.push_back(
          fmt::format("in the mean {:.3g} blocks a realization at free faces reach the target for sliding only because "
                      "joints close "
                      "on them by less than {:g} mm a metre: count on no such taper{}",
                      estimate.mean, 1e3 * stability::slight_taper,
                      scene.support ? "; the support is not asked to hold them" : ""));
    }
    if (estimate.name != "domain_held_count" || !(estimate.mean > 0)) continue;
    page.result.figures.notes.push_back(fmt::format(
        "in the mean {:.3g} blocks a realization at free faces are held only by sides of the domain that are "
        "not free and not counted as key blocks: what lies beyond is unknown; enlarge the domain, or name "
        "these sides in `free`",
        estimate.mean));
  }
  add_lifted_notes(scene, page.result.figures);
  add_turning_notes(scene, page.result.figures);
  add_flow_notes(scene, page.result.figures);
  std::ranges::move(notes_on_lines(scene), std::back_inserter(page.result.figures.notes));
  std::ranges::copy(page.result.figures.notes, std::back_inserter(page.notes));
  if (scene.monte_carlo && scene.monte_carlo->stop) page.stop_quantity = scene.monte_carlo->stop->quantity;
  return page;
}

std::string block_sizes_csv(const MonteCarloPage& page) {
  const auto& sizes = page.result.figures.block_sizes;
  return sizes ? csv_table(stochastic::SizeShare{}, sizes->curve) : std::string{};
}

}  // namespace cleave::report
