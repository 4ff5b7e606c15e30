#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "cleave/realize/figures.hpp"
#include "cleave/stability/result.hpp"
#include "cleave/topology/block_complex.hpp"

/// The still drawings of report.html: inline SVG, readable without scripts and on paper.
namespace cleave::report {

/// Colour of a batch (from 1), differing for colour-blind readers; batches from 9 on share one.
[[nodiscard]] std::string batch_colour(std::uint32_t batch);

/// Parallel view from the south-east and above: key blocks by batch, the excavation's walls with the block traces;
/// without key blocks the outside of the block system. At most `max_polygons`, the largest ones.
[[nodiscard]] std::string still_picture(const topology::BlockComplex& complex, const stability::Analysis* analysis,
                                        std::size_t max_polygons = 4000);

/// One block, parallel, seen from the side of its free faces: those light, joints in the colour of its batch, hidden
/// edges dashed, an arrow the way it moves.
[[nodiscard]] std::string block_picture(const topology::BlockComplex& complex, const stability::Judgement& judgement);

/// Block volumes (m3, > 0): share of the rock volume in blocks smaller than V, against V on a logarithmic axis.
[[nodiscard]] std::string size_curve(std::vector<double> volumes);

/// Volume and number of the key blocks, one bar a batch.
[[nodiscard]] std::string batch_bars(std::span<const scene::BatchFigures> batches);

}  // namespace cleave::report
