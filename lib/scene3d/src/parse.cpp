#include "cleave/scene3d/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "cleave/core/sha256.hpp"
#include "cleave/scene3d/drawing_order.hpp"
#include "cleave/scene3d/key_tables.hpp"
#include "cleave/stochastic/ensemble.hpp"
#include "context.hpp"
#include "includes.hpp"

namespace cleave::scene {
namespace {

using std::string_view;

constexpr NumberRule snap_rule{0, false, 1e6, false, " m"};
constexpr std::array<string_view, 2> nonplanar_words{"refuse", "triangulate"};
constexpr std::array<string_view, 3> scene2d_sections{"body", "contact", "elastic"};

std::string stem_of(const std::string& shown) {
  const std::size_t slash = shown.find_last_of('/');
  return slash == std::string::npos ? shown : shown.substr(slash + 1);
}

/// Sections of scenes in two dimensions are named as such and taken out, so that the rest is still checked.
TomlTable without_scene2d_sections(TomlTable table, Problems& problems) {
  std::erase_if(table.entries, [&](const TomlEntry& entry) {
    for (const string_view section : scene2d_sections) {
      if (entry.key != section) continue;
      problems.error(entry.line, entry.key,
                     "belongs to scenes in two dimensions, which hold [[body]] and none of [domain], joints",
                     "remove the section, or put the bodies into a scene of their own");
      return true;
    }
    return false;
  });
  return table;
}

struct Header {
  std::string title;
  std::uint64_t seed = 1;
  Length snap;
  bool keep_dangling = false;
};

Header parse_header(const TableReader& root, Context& context, const std::string& shown) {
  Header header;
  if (const TomlEntry* schema = root.find("schema")) {
    const auto* number = std::get_if<std::int64_t>(&schema->node.value);
    if (number == nullptr || *number != 1) {
      root.error("schema", "is not a version that this program knows", "write schema = 1");
    }
  }
  header.title = root.text("title").value_or(stem_of(shown));
  header.seed = static_cast<std::uint64_t>(root.count("seed"));
  header.snap = metres(root.value("snap"));
  header.keep_dangling = root.flag("keep_dangling");
  context.triangulate = root.choice("nonplanar") == std::size_t{1};
  context.north = root.value("north");
  return header;
}

}  // namespace

const KeyTable& scene_keys() {
  static const KeyTable keys{
      .name = "scene",
      .keys =
          {{"schema", key::whole(1, 1), "1", "version of this format"},
           {"title", key::text(), "the file's name", "shown in the results"},
           {"project", key::table(&project_keys), "", "heads the report and `summary.json`; in no other file"},
           {"seed", key::whole(0, INT64_MAX), "1", "whole number from 0; `cleave run --seed` overrides it"},
           {"snap", key::number(snap_rule), "0",
            "m; above 0 corners closer than this become one, near-coincident planes of polygons merge and edges within "
            "this distance of another joint end on it, whatever the order of the joints; what is closed stays closed. "
            "Polygons that share corners divide the rock without it"},
           {"nonplanar", key::word(nonplanar_words), "\"refuse\"",
            "or `\"triangulate\"`: polygons (and faces of `domain.corners`) whose corners lie further than max(1e-6 of "
            "the "
            "size, 8 ulp of the largest coordinate) from their plane"},
           {"keep_dangling", key::flag(), "false",
            "true keeps the parts of joints that separate nothing (dangling ends, membranes, isolated joints): "
            "`dangling.vtu`, `dangling.obj` and `summary.json` say in which block each lies; the blocks are the same"},
           {"north", key::number(rule::turn), "0",
            "degrees from y to true north, clockwise. Dip directions, trends and azimuths count from true north (also "
            "those of "
            "slopes, bolts and sections); vectors, coordinates and results do not. A tunnel along y that trends 040: "
            "-40"},
           {"include", key::either({key::texts(), key::text()}), "[]",
            "files whose joints, joint sets and `[joints.NAME]` are taken as if they stood here; a table of the "
            "scene's own "
            "goes before an included one"},
           {"domain", key::table(&domain_keys), required, "the rock"},
           {"joint", key::tables(&joint_keys), "", "joints that are given"},
           {"joint_set", key::tables(&joint_set_keys), "", "joints drawn at random"},
           {"mapped", key::table(&mapped_keys), "", "what has been seen of the random joints"},
           {"joints", key::named(key::table(&strength_keys)), "", "strength by set; `[joints.default]` for the rest"},
           {"rock", key::table(&rock_keys), "", "properties of the rock"},
           {"scanline", key::tables(&scanline_keys), "", "lines and boreholes: joints, frequency and RQD along them"},
           {"excavation", key::tables(&excavation_keys), "", "what is taken out, in order"},
           {"stability", key::table(&stability_keys), "", "key blocks"},
           {"load", key::tables(&load_keys), "", "load cases"},
           {"field_stress", key::table(&field_stress_keys), "", "clamping by the stress around a tunnel"},
           {"support", key::table(&support_keys), "", "bolts and shotcrete"},
           {"sequence", key::table(&sequence_keys), "", "excavation in stages"},
           {"flow", key::table(&flow_keys), "", "which joints hang together, and water in them"},
           {"motion", key::table(&motion_keys), "", "blocks in motion"},
           {"micro_blocks", key::table(&micro_blocks_keys), "", "blocks thinner or smaller than a limit"},
           {"monte_carlo", key::table(&monte_carlo_keys), "", "many realizations instead of one run"},
           {"output", key::table(&output_keys), "", "files of the result"}},
      .steps = {{Step::read, {"include"}},
                {Step::draw, {"joint_set", "joints", "mapped"}},
                {Step::cut, {"domain", "joint", "excavation", "scanline"}},
                {Step::flow, {"flow", "joints"}},
                {Step::stability, {"rock", "joints", "stability", "load", "sequence", "micro_blocks"}},
                {Step::support, {"support"}},
                {Step::monte_carlo, {"monte_carlo"}},
                {Step::elastic, {"field_stress"}},
                {Step::contact, {"motion"}},
                {Step::write, {"output"}},
                {Step::report, {"project", "output"}}}};
  return keys;
}

namespace {

/// Says what the file is where it is none.
bool is_scene(const TomlTable& tree, const std::string& shown, Problems& problems) {
  const auto has = [&](string_view key) {
    return std::ranges::find(tree.entries, key, &TomlEntry::key) != tree.entries.end();
  };
  constexpr std::array<string_view, 5> of_surveys{"orientations", "scanline", "borehole", "window", "set"};
  if (!has("domain") && std::ranges::any_of(of_surveys, has)) {
    problems.error(1, "scene", "is a survey file, not a scene", "run cleave survey " + shown + " -o FOLDER");
    return false;
  }
  constexpr std::array<string_view, 2> of_sets{"joint_set", "joints"};
  const auto is_of_sets = [&](const TomlEntry& entry) {
    return std::ranges::find(of_sets, entry.key) != of_sets.end();
  };
  if (!tree.entries.empty() && std::ranges::all_of(tree.entries, is_of_sets)) {
    problems.error(1, "scene", "has joint sets alone: it is a part of scenes, not one",
                   fmt::format("write a scene with [domain] and include = [\"{}\"]", file_name_of(shown)));
    return false;
  }
  if (tree.entries.empty()) {
    problems.error(1, "domain", "the file is empty", "start from a scene that cleave init prints: cleave init tunnel");
    return false;
  }
  return true;
}

/// What a scene has that a quantity may be of.
struct Counted {
  bool judged, only_key_blocks, opened, has_own_opening, supported, in_stages, in_groups, stressed, joined, flows;
};

Counted counted_in(const std::optional<StabilitySettings>& stability, const OutputSettings& output,
                   const std::vector<Excavation>& excavations, const std::optional<SupportSettings>& support,
                   const std::optional<FieldStressSettings>& stress, const std::optional<FlowSettings>& flow,
                   bool in_stages) {
  return {.judged = stability.has_value(),
          .only_key_blocks = output.only_key_blocks,
          .opened = !excavations.empty(),
          .has_own_opening = has_own_opening(excavations),
          .supported = support.has_value(),
          .in_stages = in_stages,
          .in_groups = stability && stability->decides_by_groups(),
          .stressed = stress.has_value(),
          .joined = flow.has_value(),
          .flows = flow && flow->flows()};
}

/// What a run stops by is counted in it: else it would never stop by it.
void check_stop(const TableReader& root, const std::optional<MonteCarloSettings>& ensemble, const Counted& in) {
  if (!ensemble || !ensemble->stop || !root.problems().all_read()) return;
  const auto* quantity = stochastic::quantity_named(ensemble->stop->quantity);
  const auto refuse = [&](const char* what, const char* remedy) {
    root.problems().error(root.line_of("monte_carlo"), "monte_carlo.stop.quantity", what, remedy);
  };
  if (quantity->stability && !in.judged) {
    refuse("asks for key blocks, but nothing is free", "add an excavation or stability.free, or take block_count");
  } else if (quantity->openings && !in.opened) {
    refuse("is over the area of excavations, and there are none", "add an excavation, or take support_force");
  } else if (quantity->at_parts && !in.has_own_opening) {
    refuse("is of roof, walls or floor, and there are only cuts from above",
           "add a tunnel, shaft or cavern, or take the quantity of all key blocks");
  } else if (quantity->support && !in.supported) {
    refuse("is of a support design, and there is none", "add [support], or take key_block_volume");
  } else if (quantity->stages && !in.in_stages) {
    refuse("is of stages of the excavation, and there is one", "give excavations other `stage` numbers");
  } else if (quantity->groups && !in.in_groups) {
    refuse("is of blocks judged together, which do not decide here", "set stability.groups = \"decide\"");
  } else if (quantity->clamped && !in.stressed) {
    refuse("is of the stress across joints, and none is given", "add [field_stress], or take key_block_volume");
  } else if (quantity->flow && !in.joined) {
    refuse("is of joints that hang together, which are not looked for", "add [flow]");
  } else if (quantity->water && !in.flows) {
    refuse("is of water in joints, and none stands anywhere", "give flow.level");
  }
  if (quantity->whole_system && in.only_key_blocks && in.judged) {
    refuse("counts all blocks, but only key blocks are cut", "set output.blocks = \"all\"");
  }
}

std::set<SetId> sets_with_joints(const std::vector<MeasuredJoint>& joints, const std::vector<RandomSet>& joint_sets) {
  std::set<SetId> used;
  for (const MeasuredJoint& joint : joints) used.insert(joint.set);
  for (const RandomSet& set : joint_sets) used.insert(set.set);
  return used;
}

}  // namespace

std::expected<Scene, std::vector<Problem>> parse(string_view text, const std::string& shown,
                                                 const ReadFile& read_file) {
  Problems problems{shown};
  auto tree = read_toml(text);
  if (!tree) {
    problems.error(tree.error().line, "TOML", tree.error().what, tree.error().remedy);
    return std::unexpected(std::move(problems).take_errors());
  }
  if (!is_scene(*tree, shown, problems)) return std::unexpected(std::move(problems).take_errors());
  TomlTable table = without_scene2d_sections(std::move(*tree), problems);
  std::vector<InputFile> included = take_includes(table, problems, read_file);
  const TableReader root{table, 1, "", problems, scene_keys()};

  Context context{{.problems = problems, .read_file = read_file}};
  context.files = std::move(included);
  static_cast<void>(context.set_named("default"));
  const Header header = parse_header(root, context, shown);
  Project project = parse_project(root);
  std::optional<geometry::Solid> domain = parse_domain(context, root);
  std::vector<MeasuredJoint> joints;
  parse_joints(context, root, joints);
  std::vector<RandomSet> joint_sets;
  parse_joint_sets(context, root, joints, joint_sets);
  parse_properties(context, root);
  const Rock rock = parse_rock(root);
  std::vector<Excavation> excavations;
  parse_excavations(context, root, domain, excavations);
  std::optional<MappedSettings> mapped = parse_mapped(context, root, joint_sets, excavations, domain);
  std::vector<ScanLine> lines = parse_lines(context, root);
  ParsedStability stability = parse_stability(context, root, domain, excavations);
  std::optional<SupportSettings> support = parse_support(context, root, domain, excavations, stability);
  const std::set<SetId> used = sets_with_joints(joints, joint_sets);
  std::optional<FieldStressSettings> field_stress = parse_field_stress(root, context, used, rock, excavations);
  std::optional<FlowSettings> flow = parse_flow(root, context, used, domain);
  OutputSettings output = parse_output(root);
  std::optional<SequenceSettings> sequence = parse_sequence(root, excavations, support.has_value());
  const std::optional<MotionSettings> motion = parse_motion(root, stability.settings, sequence);
  const MicroBlocks micro_blocks = parse_micro_blocks(root);
  // What is asked for of all the rock needs all the rock.
  const bool together = stability.settings && stability.settings->group_factor;
  if (sequence || motion || flow || together || header.keep_dangling ||
      micro_blocks.policy == MicroBlockPolicy::exclude) {
    output.only_key_blocks = false;
  }
  std::optional<MonteCarloSettings> monte_carlo = parse_monte_carlo(root);
  check_flow_water(context, stability.settings, flow, sequence.has_value());
  check_maximum_blocks(context, stability.settings, used, joint_sets);
  check_stop(root, monte_carlo,
             counted_in(stability.settings, output, excavations, support, field_stress, flow, sequence.has_value()));
  if (problems.errors() != 0 || !domain) return std::unexpected(std::move(problems).take_errors());

  SceneHead head{.title = header.title,
                 .project = std::move(project),
                 .seed = header.seed,
                 .output = output,
                 .shown = shown,
                 .file_name = stem_of(shown),
                 .sha256 = sha256_hex(text)};
  for (const TomlEntry& entry : table.entries) head.given.push_back(entry.key);
  Scene scene{std::move(head),
              {.snap = header.snap,
               .north = context.north,
               .domain = std::move(*domain),
               .free_domain_tags = std::move(stability.free_domain_tags),
               .sets = std::move(context.sets),
               .joints = std::move(joints),
               .terminations = std::move(context.terminations),
               .keep_dangling = header.keep_dangling,
               .joint_sets = std::move(joint_sets),
               .mapped = std::move(mapped),
               .rock = rock,
               .excavations = std::move(excavations),
               .lines = std::move(lines),
               .support = std::move(support),
               .stability = stability.settings,
               .field_stress = field_stress,
               .sequence = std::move(sequence),
               .motion = motion,
               .flow = std::move(flow),
               .micro_blocks = micro_blocks,
               .monte_carlo = std::move(monte_carlo),
               .files = std::move(context.files)}};
  keep_intensities(scene, problems);
  find_notes(scene, root);
  scene.notes = std::move(problems).take_notes();
  return scene;
}

}  // namespace cleave::scene
