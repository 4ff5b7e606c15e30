#include "cleave/exchange/exports.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "cleave/core/version.hpp"
#include "cleave/exchange/vtu_writer.hpp"
#include "modes.hpp"

namespace cleave::report {
namespace {

void write_analysis(VtuWriter& vtu, const Cells& cells, const stability::Analysis& analysis) {
  struct Row {
    std::int32_t batch = -1;
    std::uint8_t mode = mode_not_judged;
    std::uint8_t key = 0;
    double factor = factor_when_unknown;
    std::uint8_t factor_known = 0;
    geometry::Vec3 net_force;
  };
  std::size_t blocks = 0;
  for (const topology::BlockId b : cells.block) blocks = std::max(blocks, b.index() + 1);
  std::vector<Row> rows(blocks);
  for (const stability::Judgement& j : analysis.judgements) {
    if (j.block.index() >= blocks) continue;
    Row& row = rows[j.block.index()];
    if (j.batch) row.batch = static_cast<std::int32_t>(*j.batch);
    row.mode = std::to_underlying(j.mode);
    row.key = j.key ? 1 : 0;
    row.net_force = j.net.si() * j.direction;
    if (!std::isnan(j.factor_of_safety)) {
      row.factor = std::isinf(j.factor_of_safety) ? factor_when_infinite : j.factor_of_safety;
      row.factor_known = std::isinf(j.factor_of_safety) ? 2 : 1;
    }
  }
  for (const topology::BlockId b : analysis.tapered) {
    if (b.index() < blocks) rows[b.index()].mode = std::to_underlying(stability::Mode::tapered);
  }
  const auto column = [&]<class T>(std::string_view name, T Row::* member) {
    std::vector<T> values;
    values.reserve(cells.size());
    for (const topology::BlockId b : cells.block) values.push_back(rows[b.index()].*member);
    vtu.array(name, values);
  };
  column("batch", &Row::batch);
  column("mode", &Row::mode);
  column("key", &Row::key);
  column("factor_of_safety", &Row::factor);
  column("factor_known", &Row::factor_known);
  std::vector<geometry::Vec3> forces;
  for (const topology::BlockId b : cells.block) forces.push_back(rows[b.index()].net_force);
  vtu.vectors("net_force", forces);
}

}  // namespace

std::string blocks_vtu(const Cells& cells, const stability::Analysis* analysis, const VtuText& text) {
  VtuWriter vtu{
      VtuFormat::binary,
      "cleave " CLEAVE_VERSION "; scene: " + text.title +
          "; metres, x east, y north, z up, no offset subtracted; `block` counts from 0. A block with "
          "cavities is several cells of one `block`. factor_of_safety: 1e9 = infinite, -1 = none (see "
          "factor_known)",
      11 * (3 * cells.points.size() + cells.face_stream.size() + cells.connectivity.size() + 5 * cells.size())};
  vtu.begin("FieldData");
  vtu.strings("title", {text.title});
  vtu.strings("scene_file", {text.scene_file});
  if (analysis != nullptr) {
    std::vector<std::string> names;
    for (const stability::Mode mode : all_modes) names.emplace_back(stability::name(mode));
    vtu.strings("mode_names", names);
  }
  vtu.end("FieldData");
  vtu.begin_piece(cells.points.size(), cells.size());
  vtu.points(cells.points);
  vtu.polyhedra(cells.connectivity, cells.ends, cells.face_stream, cells.face_ends);
  vtu.begin("CellData");
  std::vector<std::int64_t> blocks;
  blocks.reserve(cells.size());
  for (const topology::BlockId b : cells.block) blocks.push_back(b.value());
  vtu.array("block", blocks);
  vtu.array("volume", cells.volume);
  if (!text.stage_of_block.empty()) {
    std::vector<std::int32_t> stages;
    stages.reserve(cells.size());
    for (const topology::BlockId b : cells.block) {
      const auto stage = text.stage_of_block[b.index()];
      stages.push_back(stage ? static_cast<std::int32_t>(*stage) : -1);
    }
    vtu.array("stage", stages);
  }
  if (analysis != nullptr) write_analysis(vtu, cells, *analysis);
  vtu.end("CellData");
  return std::move(vtu).finish();
}

}  // namespace cleave::report
