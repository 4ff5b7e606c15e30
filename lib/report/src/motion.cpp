#include "motion.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "cleave/exchange/csv.hpp"
#include "cleave/exchange/exports.hpp"
#include "cleave/exchange/text.hpp"
#include "cleave/exchange/vtu_writer.hpp"
#include "html_parts.hpp"
#include "html_table.hpp"
#include "tables.hpp"

namespace cleave::report {
namespace {

using detail::fact;

using geometry::Vec3;

constexpr std::size_t most_rows = 200;

}  // namespace

std::string motion_csv(const scene::MotionResult& motion) {
  return csv_table(scene::MotionBlock{.block = topology::BlockId{0U}, .centroid = {}}, motion.blocks);
}

std::string motion_vtu(const scene::RunResult& result, std::size_t frame) {
  const topology::BlockComplex& complex = result.complex->complex();
  const scene::MotionResult& motion = *result.motion;
  const Cells cells = make_cells(complex);
  std::vector<std::int64_t> place(complex.blocks().size(), -1);
  for (std::size_t k = 0; k < motion.blocks.size(); ++k) {
    place[motion.blocks[k].block.index()] = static_cast<std::int64_t>(k);
  }
  std::vector<Vec3> points, velocity, displacement;
  std::vector<std::int64_t> connectivity, ends, faces, face_ends, block;
  std::vector<double> speed;
  std::size_t begin = 0;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const std::span<const std::int64_t> own =
        std::span{cells.connectivity}.subspan(begin, static_cast<std::size_t>(cells.ends[c]) - begin);
    begin = static_cast<std::size_t>(cells.ends[c]);
    const std::int64_t k = place[cells.block[c].index()];
    if (k < 0) continue;
    const auto& at = motion.frames[frame].places[static_cast<std::size_t>(k)];
    const Vec3 centre = motion.blocks[static_cast<std::size_t>(k)].centroid -
                        motion.frames.back().places[static_cast<std::size_t>(k)].shift;
    const auto first = static_cast<std::int64_t>(points.size());
    for (const std::int64_t p : own) {
      connectivity.push_back(static_cast<std::int64_t>(points.size()));
      points.push_back(centre + at.shift + at.turn * (cells.points[static_cast<std::size_t>(p)] - centre));
    }
    const auto number = [&](std::int64_t p) { return first + (std::ranges::lower_bound(own, p) - own.begin()); };
    const std::span<const std::int64_t> stream = cells.faces_of(c);
    faces.push_back(stream[0]);
    for (std::size_t i = 1; i < stream.size();) {
      const auto corners = static_cast<std::size_t>(stream[i]);
      faces.push_back(stream[i]);
      for (std::size_t j = 1; j <= corners; ++j) faces.push_back(number(stream[i + j]));
      i += corners + 1;
    }
    ends.push_back(static_cast<std::int64_t>(connectivity.size()));
    face_ends.push_back(static_cast<std::int64_t>(faces.size()));
    block.push_back(cells.block[c].value());
    velocity.push_back(at.velocity);
    displacement.push_back(at.shift);
    speed.push_back(norm(at.velocity));
  }
  VtuWriter vtu{VtuFormat::binary, "cleave; blocks let go, metres; velocity of the centroid"};
  vtu.begin_piece(points.size(), ends.size());
  vtu.points(points);
  vtu.polyhedra(connectivity, ends, faces, face_ends);
  vtu.begin("CellData");
  vtu.array("block", block);
  vtu.array("speed", speed);
  vtu.vectors("velocity", velocity);
  vtu.vectors("displacement", displacement);
  vtu.end("CellData");
  return std::move(vtu).finish();
}

std::string motion_section(const scene::MotionResult& motion) {
  std::string out = "<section id=\"motion\"><h2>Blocks in motion</h2>\n";
  if (motion.refused) {
    return out + "<p class=\"note\">Nothing ran; " + escape_xml(motion.stopped_why) + ".</p></section>\n";
  }
  if (!motion.converged) {
    out += "<p class=\"note\">The run stopped: " + escape_xml(motion.stopped_why) + ".</p>\n";
  }
  std::string told = fact("Ended", display(motion.end.si(), 4) + (motion.at_rest ? " s, at rest" : " s, not at rest"));
  told += facts({{"released", "Let go"},
                 {"moved"},
                 {"key_blocks_standing", "Key blocks that stand"},
                 {"standing_by_locked_forces", "Stand by locked forces, or may"},
                 {"steps"},
                 {"residual", "Residual of the contact law", 2}},
                motion);
  if (motion.rough_steps > 0) {
    told += fact("Steps that missed the law",
                 display_count(motion.rough_steps) + ", by at most " + display(motion.missed_speed, 2) + " m/s");
  }
  told += facts({{"max_penetration_m", "Deepest penetration", 2}}, motion);
  if (motion.supported) {
    told += fact("Bolts", display_count(motion.bolts.size()) + " tie blocks that are let go, " +
                              display_count(motion.bolts_broken()) + " of them broke; largest force " +
                              display(motion.largest_bolt_force().si() / 1000, 4) + " kN");
  }
  if (motion.loads) {
    const scene::MotionLoads& loads = *motion.loads;
    told += fact("Loads", "water in " + display_count(loads.in_joints) + " contacts of blocks, drained in " +
                              display_count(loads.drained) + " of them; " + display_count(loads.on_faces) +
                              " forces on free faces" + (loads.still_water ? "; water stands about the blocks" : ""));
  }
  if (motion.left() > 0) {
    told += fact("Left the domain",
                 display_count(motion.left()) + ", at most " + display(motion.fastest_left(), 3) + " m/s");
  }
  told += fact("Farthest run-out of a corner", display(motion.front_runout().si(), 3) + " m");
  told += fact("Potential energy lost", display(motion.potential_lost / 1000, 4) + " kJ");
  if (motion.work_of_ground) {
    told +=
        fact("Work of the ground's motion", display(*motion.work_of_ground / 1000, 4) + " kJ, seen from the ground");
  }
  if (motion.loads) told += fact("Work of the loads", display(motion.loads->work / 1000, 4) + " kJ");
  told += fact("Kinetic energy at the end", display(motion.kinetic / 1000, 4) + " kJ");
  told += fact("Dissipated", display(motion.dissipated / 1000, 4) + " kJ");
  if (motion.left() > 0) told += fact("Carried out of the domain", display(motion.carried_out / 1000, 4) + " kJ");
  told += fact("Lifted by parting overlaps", display(motion.lifted / 1000, 4) + " kJ");
  told += fact("Error of the energy balance", display(motion.energy_error, 2) + " (relative)");
  if (motion.error) {
    told += fact("Estimated error of the path",
                 display(motion.error->si(), 2) + " m until " + display(motion.determined->si(), 3) + " s");
  }
  out += "<div class=\"scroll\">" + detail::facts_table(told) + "</div>\n";
  std::vector<const scene::MotionBlock*> rows;
  for (const scene::MotionBlock& b : motion.blocks) {
    if (b.moved) rows.push_back(&b);
  }
  std::ranges::stable_sort(rows, std::ranges::greater{}, [](const scene::MotionBlock* b) { return b->fall.si(); });
  HtmlTable table{{{"block"},
                   {"first_motion_s", {}, 3},
                   {"fall_m", {}, 3},
                   {"runout_m", "Run-out (m)", 3},
                   {"front_runout_m", "Of its farthest corner (m)", 3},
                   {"speed_m_s", "Speed, largest (m/s)", 3}},
                  scene::MotionBlock{.block = topology::BlockId{0U}, .centroid = {}},
                  "class=\"sortable\""};
  for (std::size_t k = 0; k < std::min(rows.size(), most_rows); ++k) table.add(*rows[k]);
  out += std::move(table).html();
  if (rows.size() > most_rows) {
    out += "<p class=\"small\">The " + display_count(most_rows) + " that fell farthest; all are in motion.csv.</p>\n";
  }
  return out + "<p class=\"small\">Positions in time: motion.pvd, for ParaView.</p></section>\n";
}

}  // namespace cleave::report
