#include "flow.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "cleave/exchange/csv.hpp"
#include "cleave/exchange/text.hpp"
#include "cleave/exchange/vtu_writer.hpp"
#include "cleave/flow/flow.hpp"
#include "html_parts.hpp"
#include "html_table.hpp"
#include "tables.hpp"

namespace cleave::report {
namespace {

using detail::fact;

constexpr std::size_t most_rows = 100;

/// "1.24e-06 m³/s (4.5 l/h)".
std::string rate(double cubic_metres_per_second) {
  return display(cubic_metres_per_second, 3) + " m³/s (" + display(cubic_metres_per_second * 60000, 3) + " l/min)";
}

}  // namespace

std::string flow_joints_csv(const scene::FlowResult& flow) { return csv_table(scene::FlowJoint{}, flow.joints); }

std::string flow_vtu(const scene::RunResult& result) {
  const scene::FlowResult& found = *result.flow;
  const topology::BlockComplex& complex = result.complex->complex();
  const flow::Mesh own = found.flow ? flow::Mesh{} : flow::mesh_of(complex, flow::surfaces_of(*complex.network()));
  const flow::Mesh& mesh = found.flow ? found.flow->mesh : own;
  // Heads may differ where joints touch in a point alone: each triangle has its own corners.
  std::vector<geometry::Vec3> points;
  std::vector<std::int64_t> connectivity, ends, joint, cluster;
  std::vector<std::uint8_t> backbone;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const std::uint32_t corner : mesh.triangles[t]) {
      connectivity.push_back(static_cast<std::int64_t>(points.size()));
      points.push_back(found.origin + mesh.points[corner]);
    }
    ends.push_back(static_cast<std::int64_t>(points.size()));
    const flow::JointPart& part = found.connectivity.parts[found.connectivity.part_of[mesh.part[t]]];
    joint.push_back(found.joint_of_part[mesh.part[t]].value());
    cluster.push_back(part.cluster);
    backbone.push_back(part.backbone ? 1 : 0);
  }
  VtuWriter vtu{VtuFormat::binary,
                "cleave; joints, metres; head_m and pressure_m (of water) at corners, rate_m2_s across a unit width"};
  vtu.begin_piece(points.size(), ends.size());
  vtu.points(points);
  vtu.cells(connectivity, ends, std::vector<std::uint8_t>(ends.size(), 5));  // VTK_TRIANGLE
  vtu.begin("CellData");
  vtu.array("joint", joint);
  vtu.array("cluster", cluster);
  vtu.array("backbone", backbone);
  if (found.flow) {
    std::vector<double> aperture;
    for (const std::uint32_t part : mesh.part) aperture.push_back(found.aperture_of_part[part].si());
    vtu.array("wet", found.flow->wet);
    vtu.array("aperture_m", aperture);
    vtu.vectors("rate_m2_s", found.flow->q);
  }
  vtu.end("CellData");
  if (found.flow) {
    std::vector<double> head, pressure;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const bool wet = found.flow->wet[t] != 0;
        const double above = found.flow->head[t][k].si() - mesh.points[mesh.triangles[t][k]].z;
        head.push_back(wet ? found.origin.z + found.flow->head[t][k].si() : std::nan(""));
        pressure.push_back(wet ? above : std::nan(""));
      }
    }
    vtu.begin("PointData");
    vtu.array("head_m", head);
    vtu.array("pressure_m", pressure);
    vtu.end("PointData");
  }
  return std::move(vtu).finish();
}

std::string flow_section(const scene::FlowResult& flow) {
  std::string out = "<section id=\"flow\"><h2>Water in the joints</h2>\n";
  std::string told = facts({{"clusters", "Clusters of joints"},
                            {"meetings", "Pairs of joints that meet"},
                            {"largest_cluster_joints", "Joints in the largest cluster"},
                            {"largest_cluster_share", "Its share of the area of joints", 3},
                            {"opening_share", "Share in clusters that reach an opening", 3},
                            {"backbone_share", "Share on ways from a fixed side to an opening", 3}},
                           flow);
  std::string pairs;
  for (const scene::FlowPair& pair : flow.percolates) {
    pairs += (pairs.empty() ? "" : ", ") + escape_xml(pair.from) + "–" + escape_xml(pair.to);
  }
  told += fact("Sides that one cluster connects", pairs.empty() ? "none" : pairs);
  if (flow.flow) {
    const flow::Rate& drained = flow.flow->drained;
    told += fact("Inflow, all drained surfaces", rate(drained.value));
    told += fact("Its bounds", display(drained.low, 3) + " … " + display(drained.high, 3) + " m³/s");
    told += facts({{"wet_share", "Share of the area of joints that standing water reaches", 3}}, flow);
  }
  out += "<div class=\"scroll\">" + detail::facts_table(told) + "</div>\n";
  if (!flow.flow) return out + "<p class=\"small\">No level of water is given: nothing flows.</p></section>\n";
  HtmlTable surfaces{{{"name", "Surface"},
                      {"condition"},
                      {"level_m", "Level (m)"},
                      {"out_m3_s", "Out of the rock (m³/s)", 3},
                      {"low_m3_s", "At least (m³/s)", 3},
                      {"high_m3_s", "At most (m³/s)", 3},
                      {"open_m", "Traces water passes (m)", 3},
                      {"dry_m", "Dry traces (m)", 3}},
                     scene::FlowSurface{}};
  for (const scene::FlowSurface& surface : flow.surfaces) surfaces.add(surface);
  out += std::move(surfaces).html();
  std::vector<const scene::FlowJoint*> rows;
  for (const scene::FlowJoint& joint : flow.joints) {
    if (joint.into_openings > FlowRate{}) rows.push_back(&joint);
  }
  std::ranges::stable_sort(rows, std::ranges::greater{}, &scene::FlowJoint::into_openings);
  if (!rows.empty()) {
    HtmlTable joints{{{"joint"},
                      {"source", {}, 4, false, "wide"},
                      {"set"},
                      {"aperture_m", "Aperture (m)", 3},
                      {"area_m2", "Area (m²)", 3},
                      {"into_openings_m3_s", "Into openings (m³/s)", 3}},
                     scene::FlowJoint{},
                     "class=\"sortable\""};
    for (std::size_t k = 0; k < std::min(rows.size(), most_rows); ++k) joints.add(*rows[k]);
    out += "<h3>Joints that bring water</h3>\n" + std::move(joints).html();
    if (rows.size() > most_rows) {
      out +=
          "<p class=\"small\">The " + display_count(most_rows) + " that bring most; all are in flow_joints.csv.</p>\n";
    }
  }
  return out +
         "<p class=\"small\">Bounds hold for this network of planes, whatever the mesh; joints are taken as full of "
         "water "
         "and the rock between them as tight. Heads and rates in space: flow.vtu, for ParaView.</p></section>\n";
}

}  // namespace cleave::report
