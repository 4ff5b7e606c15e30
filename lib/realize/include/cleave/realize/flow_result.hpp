#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cleave/core/fields.hpp"
#include "cleave/core/quantity.hpp"
#include "cleave/flow/flow.hpp"

/// What [flow] came to.
namespace cleave::scene {

struct Scene;

/// A surface of the rock that joints reach.
struct FlowSurface {
  std::string name;                              ///< of the face of the domain, or of the excavation
  std::string condition;                         ///< "standing water", "drained", "closed"
  bool opening = false;                          ///< an excavation or a free side of the domain
  std::optional<Length> level = {};              ///< z, of standing water
  std::optional<flow::SurfaceFlow> passed = {};  ///< where water flows at all
};
template <class V>
void fields(V& v, const FlowSurface& x) {
  const flow::SurfaceFlow none{};
  const flow::SurfaceFlow& passed = x.passed ? *x.passed : none;
  const flow::Rate bounds = passed.bounds.value_or(flow::Rate{});
  v("name", x.name);
  v("condition", x.condition, "standing water, drained (open to the air) or closed");
  v("level_m", when(x.level.has_value(), x.level.value_or(Length{})), "z to which water stands");
  v("out_m3_s", when(x.passed.has_value(), passed.out), "out of the rock; below 0: into it");
  v("low_m3_s", when(passed.bounds.has_value(), bounds.low),
    "bound of the exact rate of this network; absent where the surface touches another that water passes");
  v("high_m3_s", when(passed.bounds.has_value(), bounds.high));
  v("open_m", when(x.passed.has_value(), passed.open_length), "of traces on it: where water passes");
  v("dry_m", when(x.passed.has_value(), passed.dry_length),
    "where none does: above the water, or where a drained surface would take it in");
}

/// A joint, in the water.
struct FlowJoint {
  topology::JointId joint = topology::JointId{0U};
  std::string_view source;
  std::string_view set;
  std::optional<Length> aperture;
  std::optional<Transmissivity> transmissivity;
  Area area = {}, wet_area = {};  ///< in the rock
  std::uint32_t cluster = 0;      ///< of its largest part
  bool backbone = false;
  FlowRate into_openings = {};
};
template <class V>
void fields(V& v, const FlowJoint& x) {
  v("joint", x.joint, "number, from 0");
  v("source", x.source, "file and line, or set and number");
  v("set", x.set);
  v("aperture_m", x.aperture);
  v("transmissivity_m2_s", x.transmissivity, "g a^3 / (12 viscosity)");
  v("area_m2", x.area, "in the rock");
  v("wet_area_m2", x.wet_area, "of it, what is connected with standing water");
  v("cluster", x.cluster, "number from 0, the largest first; of a joint in several parts that of the largest");
  v("backbone", x.backbone, "1: on a way from a fixed side of the domain to an opening that passes no joint twice");
  v("into_openings_m3_s", x.into_openings,
    "what leaves the rock through its traces on drained surfaces; they add up to somewhat less than `inflow_m3_s`, see "
    "[flow](flow.md#bounds-and-how-fast-they-close-in)");
}

/// What one cluster connects.
struct FlowPair {
  std::string from, to;
};
template <class V>
void fields(V& v, const FlowPair& x) {
  v("from", x.from);
  v("to", x.to);
}

/// A file of cells whose heads are given.
struct FlowMeshBoundary {
  std::string file;
  std::vector<std::string> surfaces;
  std::optional<Length> level;           ///< z; empty: drained
  std::vector<std::uint32_t> held = {};  ///< into FlowCells::held
  FlowRate out = {};
};
template <class V>
void fields(V& v, const FlowMeshBoundary& x) {
  v("file", x.file);
  v("surfaces", x.surfaces, "names");
  v("level_m", x.level, "head of its cells; absent: drained, the head is z");
  v("cells", x.held.size());
  v("out_m3_s", x.out, "out of the rock, of two-point fluxes: what another program should find; below 0: into it");
}

/// The mesh as cells, for programs of two-point fluxes.
struct FlowMesh {
  flow::Flow flow = {};  ///< on its triangles: heads alone
  flow::FlowCells cells = {};
  Area permeability = {};  ///< of all cells
  Transmissivity viscosity = {};
  std::vector<Length> opening_of_part = {};
  std::vector<Transmissivity> transmissivity_of_part = {};
  std::vector<FlowMeshBoundary> boundaries = {};  ///< standing water by surface, then all that is drained
  /// m/s: rate across a unit of area under a unit fall of the head.
  [[nodiscard]] auto conductivity() const { return flow::earth_gravity * permeability / viscosity; }
  [[nodiscard]] Volume volume() const {
    Volume sum;
    for (const flow::FlowCell& cell : cells.cells) sum += cell.volume;
    return sum;
  }
};
template <class V>
void fields(V& v, const FlowMesh& x) {
  v("triangles", x.flow.mesh.triangles.size(), "of joints, dry ones too");
  v("cells", x.cells.cells.size(), "about corners of triangles");
  v("connections", x.cells.connections.size());
  v("negative", x.cells.negative, "connections whose area is below 0");
  v("negative_share", x.cells.negative_share, "of the sum of the sizes of all conductances");
  v("volume_m3", x.volume(), "of water in wet joints");
  v("permeability_m2", x.permeability, "of all cells: areas hold what apertures differ by");
  v("imbalance", x.cells.imbalance, "the largest of a cell, of the largest rate through one");
  v("boundaries", x.boundaries);
}

struct FlowResult {
  flow::Connectivity connectivity = {};
  std::vector<FlowSurface> surfaces = {};
  std::vector<FlowJoint> joints = {};  ///< that are in the rock, by number
  std::vector<FlowPair> percolates = {};
  std::vector<std::pair<std::uint32_t, std::uint32_t>> percolating_tags = {};  ///< the same by tags of the domain
  std::optional<flow::Flow> flow = {};  ///< where water stands somewhere; points and heads relative to `origin`
  geometry::Vec3 origin = {};
  std::vector<topology::JointId> joint_of_part = {};  ///< of the parts of the mesh: the first joint there
  std::vector<Length> aperture_of_part = {};
  std::optional<FlowMesh> mesh = {};  ///< where it is asked for
  std::vector<std::string> notes = {};

  /// Shares of the joints' area.
  [[nodiscard]] double share_at_openings() const;
  [[nodiscard]] double share_of_backbone() const;
};
template <class V>
void fields(V& v, const FlowResult& x) {
  const flow::Connectivity& c = x.connectivity;
  const flow::Cluster none{};
  const flow::Cluster& largest = c.clusters.empty() ? none : c.clusters.front();
  const double area = c.area.si() > 0 ? c.area.si() : 1;
  v("joints_area_m2", c.area, "of all joints in the rock");
  v("meetings", c.meetings, "pairs of joints that meet in a line");
  v("meeting_length_m", c.meeting_length, "of all lines in which joints meet");
  v("clusters", c.clusters.size(), "sets of joints that hang together by lines");
  v("largest_cluster_joints", largest.joints.size());
  v("largest_cluster_share", largest.area.si() / area, "of the area of joints");
  v("opening_share", x.share_at_openings(), "of the area of joints: in clusters that reach an opening");
  v("backbone_share", x.share_of_backbone(),
    "of the area of joints: on ways from a fixed side of the domain to an opening that pass no joint twice");
  v("percolates", x.percolates, "pairs of sides of the domain that one cluster connects");
  v("surfaces", x.surfaces);
  const flow::Flow still{};
  const flow::Flow& f = x.flow ? *x.flow : still;
  v("status", when(x.flow.has_value(), one_of(f.status)),
    "converged; too_many_triangles: the bounds are wider than asked for; unsettled: where water comes out of drained "
    "surfaces was not settled");
  v("inflow_m3_s", when(x.flow.has_value(), f.drained.value), "out of all drained surfaces");
  v("inflow_low_m3_s", when(x.flow.has_value(), f.drained.low), "the exact rate of this network is not below");
  v("inflow_high_m3_s", when(x.flow.has_value(), f.drained.high), "nor above");
  v("wet_share", when(x.flow.has_value(), f.area > Area{} ? f.wet_area / f.area : 0.0),
    "of the area of joints: connected with standing water");
  v("triangles", when(x.flow.has_value(), f.mesh.triangles.size()));
  v("rounds", when(x.flow.has_value(), f.rounds.size()), "meshes");
  v("residual", when(x.flow.has_value(), f.residual), "of the equations, relative");
  v("imbalance", when(x.flow.has_value(), f.imbalance), "of all rates, relative");
  v("mesh", x.mesh, "for programs of two-point fluxes (`exports`)");
}

/// What [flow] takes for granted.
[[nodiscard]] std::string note_on_flow(const Scene& scene);

}  // namespace cleave::scene
