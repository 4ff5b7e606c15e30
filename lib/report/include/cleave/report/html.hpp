#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cleave/report/key_blocks.hpp"
#include "cleave/report/stereonet.hpp"
#include "cleave/report/summary.hpp"
#include "cleave/stability/key_groups.hpp"
#include "cleave/stability/result.hpp"
#include "cleave/stability/sensitivity.hpp"
#include "cleave/stability/support.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::report {

/// Text that report.html may hold for the 3D view, by the number of blocks: 25 MB for 5,000 blocks and more, less for
/// fewer. What does not fit is left out of the picture, never out of the figures, and the page says so.
inline constexpr std::size_t view_budget_bytes = 20'000'000;

struct FileRow {
  std::string name, sha256;
  std::uint64_t bytes;
};

/// Everything of report.html, as values. The pointers are observers and may be null: no blocks (the certificate did not
/// pass), no stability stage.
struct Page {
  Summary summary;
  std::string scene_file;
  std::vector<FileRow> files;
  std::vector<std::string> notes;
  double north = 0;          ///< degrees from +y, clockwise
  std::vector<NetSet> sets;  ///< by set number
  std::vector<Pole> joints;
  std::vector<std::string> excavations;  ///< names
  std::optional<std::string> loads;      ///< one sentence on gravity, seismic load and rock density
  const topology::BlockComplex* complex = nullptr;
  const stability::Analysis* analysis = nullptr;
  const stability::KeyGroups* key_groups = nullptr;
  const stability::SupportResult* support = nullptr;
  const scene::FieldStressResult* field_stress = nullptr;
  std::vector<NamedSupport> support_cases;  ///< of [[load]]
  std::vector<MaximumBlockRow> maximum_blocks;
  std::vector<stability::Sensitivity> sensitivity;  ///< of the first batch
  std::vector<double> tan_friction;                 ///< by joint number
  geometry::Vec3 gravity{0, 0, -9.81};              ///< m/s2: which way weight is drawn
};

/// report.html: one file, nothing is ever loaded from elsewhere. Same page, same bytes.
[[nodiscard]] std::string report_html(const Page& page);

}  // namespace cleave::report
