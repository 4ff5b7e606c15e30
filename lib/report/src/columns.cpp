#include <string>
#include <string_view>

#include "cleave/report/key_blocks.hpp"
#include "cleave/report/monte_carlo_fields.hpp"
#include "flow.hpp"
#include "tables.hpp"
#include "tables2d.hpp"

namespace cleave::report {
namespace {

/// A visitor that writes what each column says; columns without words of their own join the one before.
class ColumnHelp final {
 public:
  template <class T>
  void operator()(std::string_view name, const T& /*value*/, std::string_view help = {}) {
    if (help.empty() && !names_.empty()) {
      names_.append(", `").append(name).append("`");
      return;
    }
    flush();
    names_ = "`" + std::string{name} + "`";
    help_ = help;
  }
  [[nodiscard]] std::string rows() && {
    flush();
    return std::move(out_);
  }

 private:
  void flush() {
    if (!names_.empty()) out_ += "| " + names_ + " | " + help_ + " |\n";
  }
  std::string out_, names_, help_;
};

template <class Row>
std::string table(std::string_view file, const Row& sample) {
  ColumnHelp help;
  fields(help, sample);
  return "### " + std::string{file} + "\n| column | meaning |\n|---|---|\n" + std::move(help).rows() + "\n";
}

}  // namespace

std::string columns_of_tables() {
  const stability::Judgement judgement{.block = topology::BlockId{0U}};
  const stability::SupportedBlock supported{.block = topology::BlockId{0U}};
  const stability::BoltResult bolt{};
  const stability::CombinedBlock combined{};
  const stability::KeyGroup group{};
  return table("key_blocks.csv", KeyBlockRow{.j = judgement, .parts = all_parts}) +
         table("load_cases.csv", LoadCaseRow{"", judgement}) +
         table("border_blocks.csv", BorderBlockRow{.load = "", .block = topology::BlockId{0U}}) +
         table("bolts.csv", BoltRow{.pattern = {}, .b = bolt}) +
         table("support_blocks.csv", SupportBlockRow{"", supported}) +
         table("combined_blocks.csv", CombinedBlockRow{.load = "", .b = combined}) +
         table("key_groups.csv", KeyGroupRow{group}) + table("supported_groups.csv", SupportedGroupRow{group}) +
         table("motion.csv", scene::MotionBlock{.block = topology::BlockId{0U}, .centroid = {}}) +
         table("mapped_joints.csv", scene::MappedJointResult{}) + table("flow_joints.csv", scene::FlowJoint{}) +
         table("flow_mesh_heads.csv", FlowMeshHead{}) + table("maximum_blocks.csv", scene::MaximumRow{}) +
         table("points.csv", StressPointRow{}) + table("block_sizes.csv", stochastic::SizeShare{}) +
         table("history.csv", scene::ContactHistory{}) + table("bodies.csv", scene::ContactBodyResult{});
}

}  // namespace cleave::report
