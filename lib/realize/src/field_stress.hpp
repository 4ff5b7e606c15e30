#pragma once

#include <array>
#include <expected>
#include <optional>
#include <vector>

#include "cleave/bem/antiplane.hpp"
#include "cleave/bem/statics.hpp"
#include "cleave/realize/run.hpp"
#include "cleave/stability/analyse.hpp"

namespace cleave::scene {

/// The elastic field around a tunnel, in the section at right angles to its axis, seen from the rock.
class TunnelField final {
 public:
  [[nodiscard]] static std::expected<TunnelField, bem::SolveError> make(const TunnelLine& line,
                                                                        const FieldStressSettings& settings,
                                                                        unsigned threads);
  /// Traction (Pa) on a plane with this unit normal at a point of the rock, of the side that the normal points to on
  /// the other; zero in the opening.
  [[nodiscard]] geometry::Vec3 traction(geometry::Vec3 at, geometry::Vec3 normal) const;
  [[nodiscard]] const bem::Refined& section() const noexcept { return *section_; }

 private:
  geometry::Vec3 origin_, right_, up_, axis_;
  std::optional<bem::Refined> section_;
  std::optional<bem::Antiplane> along_;
  std::array<double, 6> far_{}, slope_{};  // in the section's axes: right, up, axis; at v = 0, per metre of v
  double poisson_ = 0.25;
};

/// The fields around all tunnels of [field_stress], each as if the others were not there: the same in every realization
/// of a scene.
class TunnelFields final {
 public:
  [[nodiscard]] static std::expected<TunnelFields, bem::SolveError> make(const Scene& scene, unsigned threads);
  /// In the order of FieldStressSettings::tunnels.
  [[nodiscard]] const std::vector<TunnelField>& of_tunnels() const noexcept { return fields_; }

 private:
  std::vector<TunnelField> fields_;
};

/// Integral of the traction over a face, N: the force of the rock outside on the block. Smooth fields to about 1e-3.
[[nodiscard]] geometry::Vec3 force_on(const topology::BlockComplex& complex, const topology::Face& face,
                                      const TunnelField& field);

/// Factors of safety with the field's stress across the joints of each block at a tunnel. Blocks near another opening,
/// a heading or the ground are counted and left without: the section says nothing of them.
[[nodiscard]] FieldStressResult clamp_blocks(const Scene& scene, const TunnelFields& fields, const Realization& made,
                                             const stability::Settings& settings, unsigned threads);

}  // namespace cleave::scene
