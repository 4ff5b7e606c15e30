#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "cleave/bem/motion.hpp"
#include "cleave/bem/problem.hpp"
#include "cleave/bem/statics.hpp"

namespace cleave::bem {

/// Functions by which the dual reciprocity method (Nardini and Brebbia 1982) spreads the acceleration.
enum class Basis : std::uint8_t { one_plus_r, r, r_plus_linear };

struct UnstableStep {
  double step_s;
  double radius;             ///< by which the worst motion grows in a step
  double smallest_stable_s;  ///< estimate for Newmark (1/2, 1); infinite when a motion grows at any step
};
using DrbemError = std::variant<SolveError, BlockNeedsDensity, UnstableStep>;
[[nodiscard]] std::string describe(const DrbemError& error);

/// The elastodynamic operator of Fu (2014), M u'' + H u = G t with M = density (G T - H U) F^-1, for one region whose
/// sides are clamped or carry tractions. Kept as a reference: M and H are not symmetric, complex eigenvalues let
/// motions grow, so its spectral radius is computed before a run and an unstable step refused unless forced.
class Drbem final {
 public:
  [[nodiscard]] static std::expected<Drbem, DrbemError> make(const Region& region, const MeshSize& size, Basis basis,
                                                             const std::vector<Vec2>& inner);

  /// Squares of the angular frequencies of the supported body, by magnitude.
  [[nodiscard]] const std::vector<std::complex<double>>& eigenvalues() const noexcept { return eigenvalues_; }
  [[nodiscard]] double radius(const Scheme& scheme, double step) const;
  /// Smallest step at which Newmark (1/2, 1) does not grow: max of 4 sin(|angle|/2) / omega; infinite for a negative
  /// real eigenvalue.
  [[nodiscard]] double smallest_stable_step() const;
  [[nodiscard]] std::size_t freedoms() const noexcept { return free_.size(); }

  struct History {
    std::vector<double> time;
    std::vector<Vec2> displacement;  ///< of the watched node
    double radius = 0;
  };
  /// Tractions of the region's conditions times `factor`, from rest.
  [[nodiscard]] std::expected<History, DrbemError> run(const Scheme& scheme, double step, std::size_t steps,
                                                       const std::function<double(double)>& factor, Vec2 watch,
                                                       bool forced) const;

  /// Acceleration that the operator assigns to nodal accelerations, for manufactured solutions: M a on all freedoms.
  [[nodiscard]] std::vector<double> mass_times(const std::vector<double>& acceleration) const;
  [[nodiscard]] std::vector<double> stiffness_times(const std::vector<double>& displacement) const;
  /// G t of element-wise tractions.
  [[nodiscard]] std::vector<double> load_of(const std::vector<std::array<Vec2, 3>>& tractions) const;
  [[nodiscard]] const Mesh& mesh() const noexcept { return mesh_; }  ///< relative to `origin`
  [[nodiscard]] Vec2 origin() const noexcept { return origin_; }

 private:
  Mesh mesh_;
  Vec2 origin_;
  double scale_ = 1, mu_ = 1;
  std::vector<Vec2> points_;               // nodes, then inner
  DenseMatrix mass_, stiffness_, gather_;  // all freedoms; G
  DenseMatrix reduced_mass_, reduced_stiffness_;
  std::vector<double> load_;  // of the conditions' tractions, reduced
  std::vector<std::size_t> free_;
  std::vector<std::complex<double>> eigenvalues_;
};

}  // namespace cleave::bem
