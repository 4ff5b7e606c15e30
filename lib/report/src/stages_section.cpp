#include "stages_section.hpp"

#include "cleave/exchange/text.hpp"

namespace cleave::report {
namespace {

std::string numbers(const std::vector<std::uint32_t>& stages) {
  std::string out;
  for (const std::uint32_t stage : stages) out += (out.empty() ? "" : " → ") + std::to_string(stage);
  return out;
}

std::string order_rows(const scene::SequenceResult& sequence) {
  std::string out;
  for (std::size_t i = 0; i < sequence.orders.size(); ++i) {
    const scene::OrderResult& order = sequence.orders[i];
    const char* remark = i == sequence.best ? "smallest volume" : i == 0 ? "the scene's" : "";
    out += "<tr><td>" + numbers(order.stages) + "</td><td>" + display_count(order.key_blocks) + "</td><td>" +
           display(order.key_volume.si()) + "</td><td>" + remark + "</td></tr>\n";
  }
  return out;
}

}  // namespace

std::string stages_section(const scene::SequenceResult& sequence) {
  std::string out =
      "<section id=\"stages\"><h2>Excavation in stages</h2>\n<p class=\"small\">The rock after each stage. Key blocks "
      "that leave in a stage ";
  out += sequence.fallen == scene::Fallen::stay_out ? "stay out: the next stage finds their room empty."
                                                    : "are held in place: the next stage finds them where they were.";
  out +=
      " A block that left in part in an earlier stage is not new.</p>\n<table><thead><tr><th>Stage</th><th>Taken "
      "out</th><th>Blocks</th><th>Rock (m³)</th><th>Key blocks</th><th>of them new</th><th>New (m³)</th></tr></thead>"
      "<tbody>\n";
  for (const scene::StageResult& stage : sequence.stages) {
    std::string names;
    for (const std::string& name : stage.excavations) names += (names.empty() ? "" : ", ") + escape_xml(name);
    out += "<tr><td>" + std::to_string(stage.stage) + "</td><td>" + names + "</td><td>" +
           (stage.passed() ? display_count(stage.blocks.count) : std::string{"certificate did not pass"}) +
           "</td><td>" + display(stage.blocks.volume_m3) + "</td><td>" + display_count(stage.key_blocks.count) +
           "</td><td>" + display_count(stage.new_key_blocks) + "</td><td>" + display(stage.new_key_volume.si()) +
           "</td></tr>\n";
  }
  out += "</tbody></table>\n";
  if (sequence.orders.size() > 1) {
    out +=
        "<h3>Orders of excavation</h3>\n<table><thead><tr><th>Order of the stages</th><th>Key blocks</th><th>Volume "
        "(m³)</th><th></th></tr></thead><tbody>\n" +
        order_rows(sequence) + "</tbody></table>\n";
  }
  return out + "</section>\n";
}

}  // namespace cleave::report
