#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "cleave/core/fields.hpp"
#include "cleave/topology/ids.hpp"

/// Stress of the rock around a tunnel, and what it does to key blocks: [field_stress].
namespace cleave::scene {

struct FieldStressSettings {
  std::uint32_t excavation = 0;      ///< a straight tunnel
  std::array<double, 6> stress{};    ///< Pa at `level`: xx, yy, zz, xy, yz, zx; compression negative
  std::array<double, 6> gradient{};  ///< Pa per metre upwards
  double level = 0;                  ///< z, m
  std::optional<double> surface;     ///< z of the free ground surface; empty: infinite rock
  double poisson = 0.25;
  double tolerance = 1e-3;  ///< of displacements of the section, relative
  std::uint32_t line = 1;   ///< in the scene file
};

/// Joint faces of a block on one plane.
struct ClampedPlane {
  topology::FaceId face;    ///< the first one
  double area = 0;          ///< m2, still in contact
  double normal_force = 0;  ///< N, of the field; compression positive
};

/// A block of key_blocks.csv with the stress of the rock across its joints.
struct ClampedBlock {
  topology::BlockId block;
  double factor_of_safety = 0;  ///< of the same motion; infinite when nothing drives it
  double compression = 0;       ///< N, sum over planes in compression
  double tension = 0;           ///< N, sum over planes in tension, >= 0: counted as no stress
  std::vector<ClampedPlane> planes = {};
};

struct FieldStressResult {
  std::string tunnel;
  std::size_t elements = 0;
  double error = 0;  ///< estimate, relative, of the section's displacements
  bool reached = true;
  double condition = 0, residual = 0;
  std::vector<ClampedBlock> blocks = {};  ///< in order of block; those that lie at the tunnel
  std::uint64_t held = 0;                 ///< unstable without, stable with the stress

  /// Infinite when no block has a finite one.
  [[nodiscard]] double lowest_factor_of_safety() const {
    double lowest = std::numeric_limits<double>::infinity();
    for (const ClampedBlock& block : blocks) lowest = std::min(lowest, block.factor_of_safety);
    return lowest;
  }
};
template <class V>
void fields(V& v, const FieldStressResult& x) {
  v("tunnel", x.tunnel);
  v("elements", x.elements);
  v("error", x.error, "estimate from two meshes, of displacement, relative");
  v("condition", x.condition);
  v("residual", x.residual);
  v("blocks", x.blocks.size(), "blocks at the tunnel that were judged");
  v("held", x.held, "unstable without this stress, stable with it");
  v("lowest_factor_of_safety", or_null(x.lowest_factor_of_safety()), "with it; null: none is finite");
}

}  // namespace cleave::scene
