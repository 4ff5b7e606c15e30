#include "flow_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <span>
#include <utility>

#include "cleave/core/expected.hpp"

namespace cleave::scene {

double FlowResult::share_at_openings() const {
  double sum = 0;
  for (const flow::Cluster& cluster : connectivity.clusters) {
    const bool reaches = std::ranges::any_of(cluster.surfaces, [&](std::uint32_t s) { return surfaces[s].opening; });
    if (reaches) sum += cluster.area.si();
  }
  return connectivity.area.si() > 0 ? sum / connectivity.area.si() : 0;
}

double FlowResult::share_of_backbone() const {
  double sum = 0;
  for (const flow::JointPart& part : connectivity.parts) sum += part.backbone ? part.area.si() : 0;
  return connectivity.area.si() > 0 ? sum / connectivity.area.si() : 0;
}

std::string note_on_flow(const Scene& scene) {
  std::string note =
      "[flow]: joints are taken as full of water, above the water table too, and the rock between them as tight";
  if (!acts_on_blocks(scene)) {
    note += "; the water pressures of [flow] do not act on blocks: with stability.water = { flow = true } they do";
  }
  return note;
}

namespace {

using flow::RockSurface;
using topology::Role;

/// Tags of fixed sides that an opening cuts, or that meet a free side, below a level.
std::set<std::uint32_t> cut_sides(const topology::BlockComplex& complex, double level) {
  std::vector<std::uint8_t> at_opening(complex.vertices().size(), 0);
  for (const topology::Face& face : complex.faces()) {
    if (face.role != Role::free) continue;
    for (const topology::VertexId v : complex.loops(face).all_corners()) at_opening[v.index()] = 1;
  }
  std::set<std::uint32_t> tags;
  for (const topology::Face& face : complex.faces()) {
    if (face.role != Role::fixed || !face.tag) continue;
    for (const topology::VertexId v : complex.loops(face).all_corners()) {
      if (at_opening[v.index()] != 0 && complex.position(v).z < level) tags.insert(*face.tag);
    }
  }
  return tags;
}

class FlowRun {
 public:
  FlowRun(const Scene& scene, const SampledScene& drawn, const topology::BlockComplex& complex, Detail detail)
      : scene_{scene},
        settings_{*scene.flow},
        writes_mesh_{settings_.pflotran && detail == Detail::shown},
        drawn_{drawn},
        complex_{complex},
        surfaces_{flow::surfaces_of(*complex.network())} {}

  std::expected<FlowResult, Problem> run() {
    out_.origin = complex_.origin();
    find_conditions();
    if (auto settled = flow::settle_edges(complex_, conditions_, surfaces_); !settled) {
      return std::unexpected(refused(settled.error()));
    }
    out_.connectivity = flow::connectivity(complex_, surfaces_);
    for (const topology::JointPiece& piece : complex_.network()->pieces) {
      out_.joint_of_part.push_back(piece.joints.front());
    }
    for (const auto& [a, b] : out_.connectivity.percolates) {
      out_.percolates.push_back({out_.surfaces[a].name, out_.surfaces[b].name});
      const auto tags = std::minmax(surfaces_.surfaces[a].tag, surfaces_.surfaces[b].tag);
      if (tags.first && tags.first != tags.second) out_.percolating_tags.emplace_back(*tags.first, *tags.second);
    }
    if (settings_.flows()) CLEAVE_CHECK(send_water());
    find_joints();
    return std::move(out_);
  }

 private:
  [[nodiscard]] std::string name_of(const RockSurface& surface) const {
    if (surface.excavation) return scene_.excavations[*surface.excavation].name;
    if (surface.tag && *surface.tag < scene_.domain.tags().size()) return scene_.domain.tags()[*surface.tag];
    return surface.role == Role::free ? "free surface" : "border";
  }

  void find_conditions() {
    const std::set<std::uint32_t> cut =
        settings_.level ? cut_sides(complex_, settings_.level->si()) : std::set<std::uint32_t>{};
    std::string closed;
    for (const RockSurface& surface : surfaces_.surfaces) {
      const auto own = surface.tag && !surface.excavation
                           ? std::ranges::find(settings_.sides, *surface.tag, &FlowSide::tag)
                           : settings_.sides.end();
      FlowSurface& row = out_.surfaces.emplace_back(FlowSurface{.name = name_of(surface), .condition = "closed"});
      row.opening = surface.role == Role::free;
      flow::Surface& condition = conditions_.emplace_back(flow::Closed{});
      std::optional<Length> level;
      if (own != settings_.sides.end()) {
        level = own->level;
      } else if (surface.role == Role::free) {
        condition = flow::Drained{};
        row.condition = "drained";
      } else if (settings_.level && surface.tag && !cut.contains(*surface.tag)) {
        level = settings_.level;
      } else if (settings_.level && surface.tag) {
        closed += (closed.empty() ? "" : ", ") + row.name;
      }
      if (!level) continue;
      condition = flow::Standing{*level - metres(complex_.origin().z)};
      row.condition = "standing water";
      row.level = level;
    }
    if (!closed.empty()) {
      out_.notes.push_back(fmt::format(
          "[flow]: no water passes the faces of the domain that an opening cuts below the water: {}. Name them in "
          "[[flow.side]] to give them a level",
          closed));
    }
  }

  std::expected<void, Problem> send_water() {
    std::vector<Length> openings;
    flow::NetworkSpec spec{.mesh = flow::mesh_of(complex_, surfaces_), .transmissivity = {}, .surfaces = conditions_};
    for (const topology::JointPiece& piece : complex_.network()->pieces) {
      Transmissivity sum;
      Length widest, together;
      for (const topology::JointId joint : piece.joints) {
        const Length aperture = drawn_.joints[joint].aperture.value_or(Length{});
        sum += transmissivity(aperture);
        widest = std::max(widest, aperture);
        together += aperture;
      }
      spec.transmissivity.push_back(sum);
      out_.aperture_of_part.push_back(widest);
      openings.push_back(together);
    }
    auto network = flow::Network::make(std::move(spec));
    if (!network)
      return std::unexpected(problem(describe(network.error()), "report this scene: it is a bug in cleave"));
    auto solved = flow::solve(*network, {.tolerance = settings_.tolerance,
                                         .pressures = acts_on_blocks(scene_),
                                         .most_triangles = settings_.most_triangles});
    if (!solved) return std::unexpected(refused(solved.error()));
    out_.flow = *std::move(solved);
    for (std::size_t s = 0; s < out_.surfaces.size(); ++s) out_.surfaces[s].passed = out_.flow->surfaces[s];
    if (writes_mesh_) CLEAVE_CHECK(make_mesh(*network, std::move(openings)));
    note_flow();
    return {};
  }

  std::expected<void, Problem> make_mesh(const flow::Network& network, std::vector<Length> openings) {
    if (!(out_.flow->wet_area > Area{})) return {};
    auto made = flow::solve_for_two_points(network, *out_.flow, settings_.most_triangles);
    if (!made) return std::unexpected(refused(made.error()));
    FlowMesh& mesh = out_.mesh.emplace(FlowMesh{.flow = *std::move(made), .viscosity = settings_.viscosity});
    mesh.cells = flow::cells_of(mesh.flow, network, openings);
    mesh.permeability = reference_permeability(mesh.flow, network, openings);
    mesh.opening_of_part = std::move(openings);
    mesh.transmissivity_of_part = network.transmissivity();
    FlowMeshBoundary drained{.file = "flow_mesh_drained.ex", .surfaces = {}, .level = {}};
    for (std::size_t s = 0; s < out_.surfaces.size(); ++s) {
      FlowMeshBoundary own{
          .file = fmt::format("flow_mesh_standing_{}.ex", s), .surfaces = {}, .level = out_.surfaces[s].level};
      FlowMeshBoundary& boundary = own.level ? own : drained;
      const std::size_t before = boundary.held.size();
      for (std::uint32_t h = 0; h < mesh.cells.held.size(); ++h) {
        if (mesh.cells.held[h].surface != s) continue;
        boundary.held.push_back(h);
        boundary.out += mesh.cells.held[h].out;
      }
      if (boundary.held.size() > before) boundary.surfaces.push_back(out_.surfaces[s].name);
      if (!own.held.empty()) mesh.boundaries.push_back(std::move(own));
    }
    if (!drained.held.empty()) mesh.boundaries.push_back(std::move(drained));
    return {};
  }
  /// The mean of a^2 / 12 over the water in wet joints: areas are those of the joints where all are alike.
  [[nodiscard]] Area reference_permeability(const flow::Flow& f, const flow::Network& network,
                                            std::span<const Length> openings) const {
    double passes = 0, volume = 0;
    for (std::size_t t = 0; t < f.mesh.triangles.size(); ++t) {
      if (f.wet[t] == 0) continue;
      const auto& [a, b, c] = f.mesh.triangles[t];
      const auto& at = f.mesh.points;
      const double area = 0.5 * norm(cross(at[b] - at[a], at[c] - at[a]));
      passes += area * network.transmissivity()[f.mesh.part[t]].si();
      volume += area * openings[f.mesh.part[t]].si();
    }
    return square_metres(passes / volume * settings_.viscosity.si() / flow::earth_gravity.si());
  }

  [[nodiscard]] Transmissivity transmissivity(Length aperture) const {
    return Transmissivity::from_si(flow::cubic_law(aperture.si(), settings_.viscosity.si(), flow::earth_gravity.si()));
  }
  [[nodiscard]] Problem problem(std::string what, std::string remedy) const {
    return {scene_.shown, settings_.line, "flow", std::move(what), std::move(remedy)};
  }
  [[nodiscard]] Problem refused(const flow::FlowError& error) const {
    const auto* meet = std::get_if<flow::HeadsMeet>(&error);
    if (meet == nullptr) return problem(describe(error), "change the tolerance");
    const geometry::Vec3 at = complex_.origin() + meet->at;
    return problem(
        fmt::format(
            "the heads of \"{}\" ({:.6g} m) and \"{}\" ({:.6g} m) meet at ({:.6g}, {:.6g}, {:.6g}): any amount of "
            "water passes between them",
            out_.surfaces[meet->surface].name, complex_.origin().z + meet->head, out_.surfaces[meet->other].name,
            complex_.origin().z + meet->other_head, at.x, at.y, at.z),
        "close one of the two: [[flow.side]] face = \"...\", closed = true");
  }

  void note_flow() {
    const flow::Flow& f = *out_.flow;
    if (f.status == flow::FlowStatus::too_many_triangles) {
      const flow::FlowRound& last = f.rounds.back();
      out_.notes.push_back(
          last.width > settings_.tolerance
              ? fmt::format("[flow]: at {} triangles the bounds of the inflow are still {:.3g} % wide to either side, "
                            "not {:.3g} %: raise max_triangles, or the tolerance",
                            f.mesh.triangles.size(), 100 * last.width, 100 * settings_.tolerance)
              : fmt::format("[flow]: at {} triangles pressures on blocks are still uncertain (their measure is {:.3g}, "
                            "not {:.3g}): raise max_triangles, or the tolerance",
                            f.mesh.triangles.size(), last.pressures, settings_.tolerance));
    }
    if (f.status == flow::FlowStatus::unsettled ||
        (out_.mesh && out_.mesh->flow.status == flow::FlowStatus::unsettled)) {
      out_.notes.emplace_back(
          "[flow]: where water comes out of drained surfaces and where they stay dry was not settled: the rates are "
          "those "
          "of the last guess");
    }
    if (f.area > Area{} && !(f.wet_area > Area{})) {
      out_.notes.emplace_back("[flow]: no joint reaches standing water, so no water flows");
    }
    if (out_.mesh && out_.mesh->cells.negative > 0) {
      out_.notes.push_back(fmt::format(
          "[flow]: {} of the {} connections of flow_mesh.uge have an area below 0 ({:.2g} % of all conductance): "
          "across from them joints meet or end under sharp angles. With them fluxes are exactly those of the mesh; a "
          "program that sets them to 0 finds a little less",
          out_.mesh->cells.negative, out_.mesh->cells.connections.size(), 100 * out_.mesh->cells.negative_share));
    }
    out_.notes.push_back(note_on_flow(scene_));
  }

  void find_joints() {
    std::map<topology::JointId, FlowJoint> rows;
    std::map<topology::JointId, double> largest;
    const auto& network = *complex_.network();
    for (std::size_t p = 0; p < network.pieces.size(); ++p) {
      const flow::JointPart& part = out_.connectivity.parts[out_.connectivity.part_of[p]];
      for (const topology::JointId joint : network.pieces[p].joints) {
        FlowJoint& row = row_of(rows, joint);
        row.area += network.pieces[p].area;
        row.backbone = row.backbone || part.backbone;
        double& known = largest[joint];
        if (part.area.si() > known) {
          known = part.area.si();
          row.cluster = part.cluster;
        }
      }
    }
    if (out_.flow) add_water(rows);
    for (auto& [joint, row] : rows) out_.joints.push_back(std::move(row));
  }
  FlowJoint& row_of(std::map<topology::JointId, FlowJoint>& rows, topology::JointId joint) const {
    const auto [entry, fresh] = rows.try_emplace(joint);
    if (fresh) {
      const JointInfo& info = drawn_.joints[joint];
      entry->second.joint = joint;
      entry->second.source = info.source;
      entry->second.set = drawn_.sets[info.set].name;
      if (info.aperture) {
        entry->second.aperture = *info.aperture;
        entry->second.transmissivity = transmissivity(*info.aperture);
      }
    }
    return entry->second;
  }
  /// Where several joints lie on one another the first counts for all.
  void add_water(std::map<topology::JointId, FlowJoint>& rows) const {
    const flow::Flow& f = *out_.flow;
    for (std::size_t t = 0; t < f.mesh.triangles.size(); ++t) {
      if (f.wet[t] == 0) continue;
      const auto& [a, b, c] = f.mesh.triangles[t];
      rows[out_.joint_of_part[f.mesh.part[t]]].wet_area +=
          square_metres(0.5 * norm(cross(f.mesh.points[b] - f.mesh.points[a], f.mesh.points[c] - f.mesh.points[a])));
    }
    for (std::size_t b = 0; b < f.mesh.borders.size(); ++b) {
      if (!std::holds_alternative<flow::Drained>(conditions_[f.mesh.borders[b].surface])) continue;
      rows[out_.joint_of_part[f.mesh.part[f.triangle_of_border[b]]]].into_openings += f.out_of_border[b];
    }
  }

  const Scene& scene_;
  const FlowSettings& settings_;
  bool writes_mesh_;
  const SampledScene& drawn_;
  const topology::BlockComplex& complex_;
  flow::JointSurfaces surfaces_;
  std::vector<flow::Surface> conditions_;
  FlowResult out_;
};

}  // namespace

std::expected<FlowResult, Problem> run_flow(const Scene& scene, const SampledScene& drawn,
                                            const topology::BlockComplex& complex, Detail detail) {
  return FlowRun{scene, drawn, complex, detail}.run();
}

}  // namespace cleave::scene
