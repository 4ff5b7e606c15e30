#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string>
#include <vector>

#include "cleave/core/expected.hpp"
#include "cleave/exchange/csv.hpp"
#include "cleave/exchange/text.hpp"
#include "flow.hpp"

// The mesh of the joints for other programs: AVS UCD (LaGriT's and dfnWorks' .inp) and PFLOTRAN's explicit grids.

namespace cleave::report {
namespace {

namespace fs = std::filesystem;
using geometry::Vec3;

constexpr double gravity = flow::earth_gravity.si();
constexpr double density = 1000;         ///< kg/m3: pressures hang on it, rates do not
constexpr double air_pressure = 101325;  ///< Pa
/// A head is imposed beside its cell, through this many times what conducts to the cells around.
constexpr double firm = 1e6;

void add(std::string& line, std::initializer_list<double> values) {
  for (const double value : values) {
    line += ' ';
    append_number(line, value);
  }
}

class MeshText {
 public:
  explicit MeshText(const scene::FlowResult& flow)
      : flow_{flow}, mesh_{*flow.mesh}, cells_{flow.mesh->cells}, conductivity_{mesh_.conductivity().si()} {}

  [[nodiscard]] std::string ucd() const {
    std::string out = std::to_string(cells_.cells.size()) + ' ' + std::to_string(cells_.triangles.size()) + " 1 3 0\n";
    for (std::size_t c = 0; c < cells_.cells.size(); ++c) {
      out += std::to_string(c + 1);
      add_point(out, place(c));
      out += '\n';
    }
    for (std::size_t n = 0; n < cells_.triangles.size(); ++n) {
      out += std::to_string(n + 1) + ' ' + std::to_string(joint_of(n) + 1) + " tri";
      for (const std::uint32_t cell : cells_.triangles[n]) out += ' ' + std::to_string(cell + 1);
      out += '\n';
    }
    out += "1 1\nhead_m, m\n";
    for (std::size_t c = 0; c < cells_.cells.size(); ++c) {
      out += std::to_string(c + 1);
      add(out, {head(c)});
      out += '\n';
    }
    out += "3 1 1 1\njoint, number\naperture_m, m\ntransmissivity_m2_s, m2/s\n";
    for (std::size_t n = 0; n < cells_.triangles.size(); ++n) {
      const std::uint32_t part = part_of(n);
      out += std::to_string(n + 1) + ' ' + std::to_string(joint_of(n));
      add(out, {mesh_.opening_of_part[part].si(), mesh_.transmissivity_of_part[part].si()});
      out += '\n';
    }
    return out;
  }

  [[nodiscard]] std::string grid() const {
    std::string out = "CELLS " + std::to_string(cells_.cells.size()) + '\n';
    for (std::size_t c = 0; c < cells_.cells.size(); ++c) {
      out += std::to_string(c + 1);
      add_point(out, place(c));
      add(out, {cells_.cells[c].volume.si()});
      out += '\n';
    }
    out += "CONNECTIONS " + std::to_string(cells_.connections.size()) + '\n';
    for (const flow::FlowConnection& c : cells_.connections) {
      const Vec3 a = place(c.cells[0]), b = place(c.cells[1]);
      out += std::to_string(c.cells[0] + 1) + ' ' + std::to_string(c.cells[1] + 1);
      add_point(out, 0.5 * (a + b));
      add(out, {c.conductance.si() * norm(b - a) / conductivity_});
      out += '\n';
    }
    return out;
  }

  /// The face of a cell is moved to the side, so that its z is that of the cell.
  [[nodiscard]] std::string connections_of(const scene::FlowMeshBoundary& boundary,
                                           const std::vector<double>& around) const {
    std::string out = "CONNECTIONS " + std::to_string(boundary.held.size()) + '\n';
    const double aside = thousandth_of_a_side();
    for (const std::uint32_t h : boundary.held) {
      const std::uint32_t cell = cells_.held[h].cell;
      Vec3 face = place(cell);
      const double before = face.x;
      face.x += aside;
      out += std::to_string(cell + 1);
      add_point(out, face);
      add(out, {firm * around[cell] * (face.x - before) / conductivity_});
      out += '\n';
    }
    return out;
  }
  /// m2/s, of each cell: the sizes of all conductances there.
  [[nodiscard]] std::vector<double> around() const {
    std::vector<double> sum(cells_.cells.size(), 0);
    for (const flow::FlowConnection& c : cells_.connections) {
      for (const std::uint32_t cell : c.cells) sum[cell] += std::abs(c.conductance.si());
    }
    return sum;
  }

  [[nodiscard]] std::string heads() const {
    std::vector<FlowMeshHead> rows;
    for (const scene::FlowMeshBoundary& boundary : mesh_.boundaries) {
      for (const std::uint32_t h : boundary.held) {
        const flow::HeldCell& held = cells_.held[h];
        rows.push_back({.node = held.cell + 1,
                        .surface = flow_.surfaces[held.surface].name,
                        .file = boundary.file,
                        .head = metres(head(held.cell)),
                        .pressure = metres(head(held.cell) - place(held.cell).z)});
      }
    }
    std::ranges::sort(rows, {}, &FlowMeshHead::node);
    return csv_table(FlowMeshHead{}, rows);
  }

  /// Cards for PFLOTRAN. Pressures are raised by as much as keeps every cell above that of the air: there joints would
  /// empty.
  [[nodiscard]] std::string cards() const {
    double lowest = 0;
    for (std::size_t c = 0; c < cells_.cells.size(); ++c) lowest = std::min(lowest, head(c) - place(c).z);
    const double step = 1e5;
    const std::string datum = number(air_pressure + step * std::ceil(-lowest * density * gravity / step));
    std::string out =
        "# Cards that go with flow_mesh.uge: grid, water, joints and heads. What to solve (MODE RICHARDS), times and\n"
        "# output are left to you. Pressures are " +
        datum +
        " Pa, not those of the air, where the head is z.\n"
        "GRID\n  TYPE UNSTRUCTURED_EXPLICIT flow_mesh.uge\n  GRAVITY 0 0 " +
        number(-gravity) +
        "\nEND\n\n"
        "EOS WATER\n  DENSITY CONSTANT " +
        number(density) + "\n  VISCOSITY CONSTANT " + number(density * mesh_.viscosity.si()) +
        "\nEND\n\n"
        "MATERIAL_PROPERTY joints\n  ID 1\n  POROSITY 1\n  TORTUOSITY 1\n  CHARACTERISTIC_CURVES full\n"
        "  PERMEABILITY\n    PERM_ISO " +
        number(mesh_.permeability.si()) +
        "\n  /\nEND\n\n"
        "CHARACTERISTIC_CURVES full\n  SATURATION_FUNCTION VAN_GENUCHTEN\n    ALPHA 1e-4\n    M 0.5\n"
        "    LIQUID_RESIDUAL_SATURATION 0\n  /\n  PERMEABILITY_FUNCTION MUALEM_VG_LIQ\n    M 0.5\n"
        "    LIQUID_RESIDUAL_SATURATION 0\n  /\nEND\n\n"
        "REGION all\n  COORDINATES\n    -1e20 -1e20 -1e20\n    1e20 1e20 1e20\n  /\nEND\n\n"
        "STRATA\n  REGION all\n  MATERIAL joints\nEND\n";
    for (const scene::FlowMeshBoundary& boundary : mesh_.boundaries) {
      // "flow_mesh_standing_0.ex" is "standing_0".
      const std::string name = boundary.file.substr(10, boundary.file.size() - 13);
      out += "\nREGION " + name + "\n  FILE " + boundary.file + "\nEND\nFLOW_CONDITION " + name +
             "\n  TYPE\n    LIQUID_PRESSURE " + (boundary.level ? "HYDROSTATIC" : "DIRICHLET") + "\n  /\n";
      if (boundary.level) out += "  DATUM 0 0 " + number(boundary.level->si()) + '\n';
      out += "  LIQUID_PRESSURE " + datum + "\nEND\nBOUNDARY_CONDITION " + name + "\n  REGION " + name +
             "\n  FLOW_CONDITION " + name + "\nEND\n";
    }
    return out;
  }

 private:
  static void add_point(std::string& line, const Vec3& p) { add(line, {p.x, p.y, p.z}); }
  [[nodiscard]] Vec3 place(std::size_t cell) const { return flow_.origin + cells_.cells[cell].at; }
  [[nodiscard]] double head(std::size_t cell) const { return flow_.origin.z + cells_.cells[cell].head.si(); }
  [[nodiscard]] std::uint32_t part_of(std::size_t triangle) const {
    return mesh_.flow.mesh.part[cells_.triangle_of[triangle]];
  }
  [[nodiscard]] std::uint32_t joint_of(std::size_t triangle) const {
    return flow_.joint_of_part[part_of(triangle)].value();
  }
  /// m, on average.
  [[nodiscard]] double thousandth_of_a_side() const {
    double sum = 0;
    for (const flow::FlowConnection& c : cells_.connections) {
      sum += norm(cells_.cells[c.cells[1]].at - cells_.cells[c.cells[0]].at);
    }
    return 1e-3 * sum / static_cast<double>(cells_.connections.size());
  }

  const scene::FlowResult& flow_;
  const scene::FlowMesh& mesh_;
  const flow::FlowCells& cells_;
  double conductivity_;  ///< m/s
};

}  // namespace

std::expected<void, WriteError> write_flow_mesh(const scene::FlowResult& flow, const fs::path& folder) {
  const MeshText text{flow};
  CLEAVE_CHECK(write_file(folder / "flow_mesh.inp", text.ucd()));
  CLEAVE_CHECK(write_file(folder / "flow_mesh.uge", text.grid()));
  const std::vector<double> around = text.around();
  for (const scene::FlowMeshBoundary& boundary : flow.mesh->boundaries) {
    CLEAVE_CHECK(write_file(folder / boundary.file, text.connections_of(boundary, around)));
  }
  CLEAVE_CHECK(write_file(folder / "flow_mesh_heads.csv", text.heads()));
  return write_file(folder / "flow_mesh.in", text.cards());
}

}  // namespace cleave::report
