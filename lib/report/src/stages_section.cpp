#include "stages_section.hpp"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cleave/exchange/text.hpp"
#include "html_table.hpp"

namespace cleave::report {
namespace {

std::string numbers(const std::vector<std::uint32_t>& stages) {
  std::string out;
  for (const std::uint32_t stage : stages) out += (out.empty() ? "" : " → ") + std::to_string(stage);
  return out;
}

struct OrderRow {
  const scene::OrderResult& order;
  std::string_view remark = {};
};
template <class V>
void fields(V& v, const OrderRow& x) {
  fields(v, x.order);
  v("order", Html{numbers(x.order.stages)});
  v("remark", Html{std::string{x.remark}});
}

struct StageRow {
  const scene::StageResult& stage;
};
template <class V>
void fields(V& v, const StageRow& x) {
  fields(v, x.stage);
  v("blocks", x.stage.passed() ? Html{display_count(x.stage.blocks.count)} : Html{"certificate did not pass"});
  v("key_block_count", x.stage.key_blocks.count);
}

}  // namespace

std::string stages_section(const scene::SequenceResult& sequence) {
  std::string out =
      "<section id=\"stages\"><h2>Excavation in stages</h2>\n<p class=\"small\">The rock after each stage. Key blocks "
      "that leave in a stage ";
  out += sequence.fallen == scene::Fallen::stay_out ? "stay out: the next stage finds their room empty."
                                                    : "are held in place: the next stage finds them where they were.";
  out += " A block that left in part in an earlier stage is not new.</p>\n";
  const scene::StageResult no_stage{};
  HtmlTable stages{{{"stage"},
                    {"excavations", "Taken out"},
                    {"blocks"},
                    {"block_volume_m3", "Rock (m³)"},
                    {"key_block_count", "Key blocks"},
                    {"new_key_block_count", "of them new"},
                    {"new_key_block_volume_m3", "New (m³)"}},
                   StageRow{no_stage}};
  for (const scene::StageResult& stage : sequence.stages) stages.add(StageRow{stage});
  out += std::move(stages).html();
  if (sequence.orders.size() > 1) {
    const scene::OrderResult no_order{};
    HtmlTable orders{{{"order", "Order of the stages"},
                      {"key_block_count", "Key blocks"},
                      {"key_block_volume_m3", "Volume (m³)"},
                      {"remark", " "}},
                     OrderRow{no_order}};
    for (std::size_t i = 0; i < sequence.orders.size(); ++i) {
      orders.add(OrderRow{sequence.orders[i], i == sequence.best ? "smallest volume" : i == 0 ? "the scene's" : ""});
    }
    out += "<h3>Orders of excavation</h3>\n" + std::move(orders).html();
  }
  return out + "</section>\n";
}

}  // namespace cleave::report
