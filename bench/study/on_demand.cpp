/// Study "on_demand": what key blocks cost when only the rock near free faces is cut. Networks of one density are drawn
/// for domains of 1, 8, 27 and 64 times the volume of the tunnel scene of Fu (2014, 4.5.2), with the same 80 m of
/// tunnel in the middle of each; beside the largest stands the 80 x 80 x 60 m box cut out of it, same joints. Methods:
/// `near` (windows around the tunnel) and `whole` (all blocks, then key blocks). `error` is 0 when both methods find
/// the same key blocks in the same batches (by hash), else 1; where all of the rock is not cut it is 0 when the windows
/// end decided. `condition` is how many windows were cut, summed over the seeds.

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cleave/realize/run.hpp"
#include "cleave/scene3d/scene.hpp"
#include "cleave/stability/analyse.hpp"
#include "study.hpp"

namespace cleave {
namespace {

using geometry::Vec3;

/// Sets of the thesis at an intensity that gives about 4,458 blocks in 80 x 80 x 60 m.
std::string scene_text(double scale, std::uint64_t seed) {
  const Vec3 size = scale * Vec3{80, 80, 60}, middle = 0.5 * size;
  std::string text = fmt::format("schema = 1\nseed = {}\n[domain]\nbox = {{ min = [0, 0, 0], max = [{}, {}, {}] }}\n",
                                 seed, size.x, size.y, size.z);
  const std::vector<std::pair<int, int>> orientations{{30, 30}, {45, 150}, {60, 270}};
  for (std::size_t set = 0; set < orientations.size(); ++set) {
    text += fmt::format(
        "[[joint_set]]\nname = \"{}\"\nshape = \"rectangle\"\nintensity = {{ p32 = 0.195 }}\n"
        "orientation = {{ dip = {}, dip_direction = {}, distribution = \"uniform\", dip_range = 20, "
        "dip_direction_range = 20 }}\n"
        "size = {{ distribution = \"normal\", mean = 100, std = 30, min = 1, max = 300 }}\n",
        set == 0   ? "A"
        : set == 1 ? "B"
                   : "C",
        orientations[set].first, orientations[set].second);
  }
  text += fmt::format(
      "[[excavation]]\nname = \"tunnel\"\nkind = \"tunnel\"\nsection = {{ shape = \"horseshoe\", width = 10, height = "
      "10 }}\n"
      "axis = [[{0}, {1}, {3}], [{0}, {2}, {3}]]\n",
      middle.x, middle.y - 40, middle.y + 40, middle.z);
  return text;
}

topology::CutInput network(double scale, std::uint64_t seed) {
  const auto scene = scene::parse(scene_text(scale, seed), "study", [](const std::string&) {
    return std::expected<scene::LoadedFile, scene::FileRefusal>{std::unexpect, "no files here", ""};
  });
  if (!scene) std::abort();
  auto drawn = scene::sample(*scene);
  if (!drawn) std::abort();
  return std::move(drawn->input);
}

/// The 80 x 80 x 60 m around the tunnel, same joints.
topology::CutInput middle_of(topology::CutInput input, double scale) {
  const Vec3 size = scale * Vec3{80, 80, 60}, middle = 0.5 * size, half{40, 40, 30};
  input.domain = geometry::make_box(middle - half, middle + half).value();
  return input;
}

stability::Settings settings() {
  return {.rock = stability::RockMass::make(kilograms_per_cubic_metre(2700)).value(),
          .strengths = stability::StrengthTable{stability::JointStrength::make(FrictionAngle::degrees(25)).value()},
          .loads = stability::Loads::make({0, 0, -9.81}).value()};
}

struct Found {
  std::string hash;
  std::size_t key_blocks = 0, blocks = 0;
  unsigned windows = 0;
  friend bool operator==(const Found& a, const Found& b) { return a.hash == b.hash && a.key_blocks == b.key_blocks; }
};

Found found(const topology::BlockComplex& complex, const stability::Analysis& analysis, unsigned windows) {
  std::vector<topology::BlockId> leaving;
  for (const stability::Batch& batch : analysis.batches) {
    leaving.insert(leaving.end(), batch.blocks.begin(), batch.blocks.end());
  }
  return {topology::canonical_hash(complex, leaving), leaving.size(), complex.blocks().size(), windows};
}

std::optional<Found> near(const topology::CutInput& input) {
  StageTimer timer;
  const auto result = stability::analyse_near_field(input, settings(), {}, timer);
  if (!result) return std::nullopt;
  return found(result->complex.complex(), result->analysis, result->rounds);
}

std::optional<Found> whole(const topology::CutInput& input) {
  auto complex = topology::cut(input);
  if (!complex) return std::nullopt;
  const auto audited = topology::audit(*std::move(complex));
  if (!audited) return std::nullopt;
  return found(audited->complex(), stability::analyse(*audited, settings()), 0);
}

/// The same scenes with both methods; several seeds together, as one network is a matter of luck.
class Scenes {
 public:
  Scenes(study::Study& study, std::string name, std::vector<topology::CutInput> inputs)
      : study_{study}, name_{std::move(name)}, inputs_{std::move(inputs)} {}

  /// Processor time of all the seeds, s.
  double run(const std::string& method, bool only_near) {
    std::vector<std::optional<Found>> results;
    const auto cost = study_.measure(
        [&] {
          results.clear();
          for (const auto& input : inputs_) results.push_back(only_near ? near(input) : whole(input));
        },
        0.5, 5);
    std::size_t blocks = 0, keys = 0, joints = 0;
    unsigned windows = 0;
    bool good = true;
    for (std::size_t i = 0; i < results.size(); ++i) {
      good = good && results[i].has_value();
      if (!results[i]) continue;
      blocks += results[i]->blocks;
      keys += results[i]->key_blocks;
      windows += results[i]->windows;
      joints += inputs_[i].joints.size();
      if (!reference_.empty()) good = good && *results[i] == *reference_[i];
    }
    if (reference_.empty() && good) reference_ = results;
    study_.add(
        {.problem = name_,
         .method = method,
         .setting = fmt::format("seeds={} joints={} blocks={} key_blocks={}", inputs_.size(), joints, blocks, keys),
         .error = good ? 0.0 : 1.0,
         .cost = cost,
         .condition = windows > 0 ? std::optional{static_cast<double>(windows)} : std::nullopt,
         .status = good ? study::Status::converged : study::Status::stopped});
    return cost.cpu_s;
  }

 private:
  study::Study& study_;
  std::string name_;
  std::vector<topology::CutInput> inputs_;
  std::vector<std::optional<Found>> reference_;
};

void study_on_demand(study::Study& study) {
  const std::uint64_t seeds = study.quick() ? 1 : 8;
  const std::vector<double> scales = study.quick() ? std::vector<double>{1, 2} : std::vector<double>{1, 2, 3, 4};
  std::vector<std::pair<double, double>> near_cost, whole_cost;
  for (const double scale : scales) {
    std::vector<topology::CutInput> inputs;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) inputs.push_back(network(scale, seed));
    const double volume = 384000 * scale * scale * scale;
    if (scale == scales.back()) {
      std::vector<topology::CutInput> parts;
      for (const auto& input : inputs) parts.push_back(middle_of(input, scale));
      Scenes box{study, "box-cut-out", std::move(parts)};
      static_cast<void>(box.run("whole", false));
      static_cast<void>(box.run("near", true));
    }
    Scenes scenes{study, fmt::format("volume-{}", scale * scale * scale), std::move(inputs)};
    // All blocks of the largest are several hundred thousand a seed.
    if (scale <= 2) whole_cost.emplace_back(volume, scenes.run("whole", false));
    near_cost.emplace_back(volume, scenes.run("near", true));
  }
  study.plot("volume", {.title = "key blocks of 80 m of tunnel: cost against the volume of the network",
                        .x_label = "volume of the domain (m3)",
                        .y_label = fmt::format("processor time of {} networks (s)", seeds),
                        .series = {{.name = "near", .points = near_cost, .line = true, .fit = true},
                                   {.name = "whole", .points = whole_cost, .line = true, .fit = true}}});
}

}  // namespace
}  // namespace cleave

int main(int argc, char** argv) { return cleave::study::run("on_demand", argc, argv, cleave::study_on_demand); }
