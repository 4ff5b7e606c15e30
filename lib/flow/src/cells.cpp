#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "discretisation.hpp"
#include "shape.hpp"
#include "space.hpp"

// Cells about the corners of a mesh: what programs of two-point fluxes take.

namespace cleave::flow {
namespace {

/// What is left of cotangents that cancel, of the sum of their sizes.
constexpr double rounding = 1e-12;

/// m2/s between the ends of a side, and the sum of the sizes of what adds up to it.
struct Conductance {
  double sum = 0, sizes = 0;
  void add(double part) {
    sum += part;
    sizes += std::abs(part);
  }
  [[nodiscard]] double value() const { return std::abs(sum) > rounding * sizes ? sum : 0; }
};

class CellMaker {
 public:
  CellMaker(const Flow& flow, const Network& network, std::span<const Length> openings)
      : flow_{flow}, mesh_{flow.mesh}, network_{network}, openings_{openings}, sides_{mesh_} {}

  FlowCells make() && {
    number_corners();
    connect();
    hold();
    balance();
    return std::move(out_);
  }

 private:
  void number_corners() {
    const Space corners = corners_of(mesh_, sides_);
    std::vector<Index> number(corners.count, none);
    for (Index t = 0; t < mesh_.triangles.size(); ++t) {
      if (flow_.wet[t] == 0) continue;
      auto& own = out_.triangles.emplace_back();
      out_.triangle_of.push_back(t);
      const double third = openings_[mesh_.part[t]].si() * shape_of(mesh_, t).area / 3;
      for (std::size_t k = 0; k < 3; ++k) {
        Index& cell = number[corners.of[t][k]];
        if (cell == none) {
          cell = static_cast<Index>(out_.cells.size());
          out_.cells.push_back({.at = mesh_.points[mesh_.triangles[t][k]], .head = flow_.head[t][k]});
        }
        own[k] = cell;
        out_.cells[cell].volume += Volume::from_si(third);
      }
    }
  }

  /// A side has the same two cells in all triangles at it.
  void connect() {
    std::vector<Conductance> of_side(sides_.count());
    std::vector<std::array<Index, 2>> cells(sides_.count());
    for (std::size_t n = 0; n < out_.triangles.size(); ++n) {
      const Index t = out_.triangle_of[n];
      const double transmissivity = network_.transmissivity()[mesh_.part[t]].si();
      const Stiffness stiffness = shape_of(mesh_, t).stiffness;
      for (std::size_t k = 0; k < 3; ++k) {
        const Index side = sides_.of(t)[k];
        of_side[side].add(-transmissivity * stiffness[k]);
        const auto [a, b] = std::minmax(out_.triangles[n][(k + 1) % 3], out_.triangles[n][(k + 2) % 3]);
        cells[side] = {a, b};
      }
    }
    double all = 0, below = 0;
    for (Index side = 0; side < sides_.count(); ++side) {
      if (flow_.wet[sides_.triangles(side).front()] == 0) continue;
      const double value = of_side[side].value();
      out_.connections.push_back({cells[side], Transmissivity::from_si(value)});
      all += std::abs(value);
      if (value >= 0) continue;
      below -= value;
      ++out_.negative;
    }
    std::ranges::sort(out_.connections, {}, &FlowConnection::cells);
    out_.negative_share = all > 0 ? below / all : 0;
  }

  /// Of surfaces that share a cell one with standing water has it, as in the bounds of what comes out.
  void hold() {
    const auto drained = [&](Index surface) { return std::holds_alternative<Drained>(network_.surfaces()[surface]); };
    const auto rank = [&](Index surface) { return std::pair{drained(surface), surface}; };
    std::vector<Index> triangle_number(mesh_.triangles.size(), none);
    for (Index n = 0; n < out_.triangle_of.size(); ++n) triangle_number[out_.triangle_of[n]] = n;
    std::vector<Index> surface(out_.cells.size(), none);
    for (std::size_t b = 0; b < mesh_.borders.size(); ++b) {
      const Index t = flow_.triangle_of_border[b];
      const Border& border = mesh_.borders[b];
      if (flow_.wet[t] == 0 || (flow_.open[b] == 0 && !drained(border.surface))) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const Index point = mesh_.triangles[t][k];
        if (flow_.held[t][k] == 0 || (point != border.ends[0] && point != border.ends[1])) continue;
        Index& own = surface[out_.triangles[triangle_number[t]][k]];
        if (own == none || rank(border.surface) < rank(own)) own = border.surface;
      }
    }
    for (Index c = 0; c < surface.size(); ++c) {
      if (surface[c] != none) out_.held.push_back({.cell = c, .surface = surface[c]});
    }
  }

  void balance() {
    std::vector<double> in(out_.cells.size(), 0), through(out_.cells.size(), 0);
    for (const FlowConnection& c : out_.connections) {
      const auto [a, b] = c.cells;
      const double to_a = c.conductance.si() * (out_.cells[b].head - out_.cells[a].head).si();
      in[a] += to_a;
      in[b] -= to_a;
      for (const Index cell : c.cells) through[cell] += std::abs(to_a);
    }
    for (HeldCell& held : out_.held) {
      held.out = FlowRate::from_si(in[held.cell]);
      in[held.cell] = 0;
    }
    const double most = through.empty() ? 0 : std::ranges::max(through);
    for (const double rest : in) out_.imbalance = std::max(out_.imbalance, most > 0 ? std::abs(rest) / most : 0);
  }

  const Flow& flow_;
  const Mesh& mesh_;
  const Network& network_;
  std::span<const Length> openings_;
  Sides sides_;
  FlowCells out_;
};

/// Triangles whose longest side has a conductance below 0: their angle across from it is obtuse.
std::vector<std::uint8_t> obtuse_at_negative(const Mesh& mesh, const Network& network) {
  const Sides sides{mesh};
  std::vector<Conductance> of_side(sides.count());
  std::vector<Index> across(mesh.triangles.size(), none);  // from an obtuse angle
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Stiffness stiffness = shape_of(mesh, t).stiffness;
    for (std::size_t k = 0; k < 3; ++k) {
      of_side[sides.of(t)[k]].add(-network.transmissivity()[mesh.part[t]].si() * stiffness[k]);
      if (stiffness[k] > 0) across[t] = sides.of(t)[k];
    }
  }
  std::vector<std::uint8_t> marked(mesh.triangles.size(), 0);
  for (std::size_t t = 0; t < marked.size(); ++t) {
    if (across[t] != none && of_side[across[t]].value() < 0) marked[t] = 1;
  }
  return marked;
}

}  // namespace

FlowCells cells_of(const Flow& flow, const Network& network, std::span<const Length> openings) {
  return CellMaker{flow, network, openings}.make();
}

void make_two_point(Mesh& mesh, const Network& network, std::vector<std::uint8_t>& states, std::size_t most_triangles) {
  constexpr int most = 12;
  flip_sides(mesh);
  for (int pass = 0; pass < most && mesh.triangles.size() < most_triangles; ++pass) {
    const std::vector<std::uint8_t> marked = obtuse_at_negative(mesh, network);
    if (std::ranges::find(marked, 1) == marked.end()) return;
    refine(mesh, marked, states);
    flip_sides(mesh);
  }
}

}  // namespace cleave::flow
