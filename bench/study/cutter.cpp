/// Study "cutter": what the blocks cost. Problems are the workloads of growing size; `error` is the relative error of
/// the sum of the blocks' volumes; `condition` is the domain's extent over the thinnest block. Methods: `cut` alone,
/// `certificate` alone, and `cut_and_certificate` on one and two threads.

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"
#include "study.hpp"
#include "workloads.hpp"

namespace cleave {
namespace {

struct Size {
  double blocks = 0, joints = 0, intersections = 0;
};

double extent_of(const topology::CutInput& input) {
  double extent = 0;
  for (const auto& v : input.domain.vertices()) extent = std::max(extent, norm(v - input.domain.vertices()[0]));
  return extent;
}

struct Points {
  std::vector<std::pair<double, double>> time_blocks, time_joints, time_intersections, memory_blocks,
      memory_intersections, certificate_blocks;
};

void add_workload(study::Study& study, const std::string& family, std::uint32_t size,
                  std::map<std::string, Points>& all) {
  const auto workload = support::workload_named(fmt::format("{}-{}", family, size));
  if (!workload) std::abort();
  const topology::CutInput input = support::cut_input(*workload);
  Size of{0, static_cast<double>(input.joints.size()), 0};
  bool counted = true;
  double error = 0, thinnest = 0;
  bool passed = true;
  const auto once = [&](unsigned threads) {
    auto complex = topology::cut(input, {.threads = threads});
    if (!complex) {
      passed = false;
      return;
    }
    const auto audited = topology::audit(*std::move(complex));
    passed = passed && audited.has_value();
    if (!audited || !counted) return;
    counted = false;
    of.blocks = static_cast<double>(audited->complex().blocks().size());
    of.intersections = static_cast<double>(audited->complex().report().intersections);
    error = audited->certificate().volume_relative_error;
    thinnest = INFINITY;
    for (const topology::Block& b : audited->complex().blocks()) thinnest = std::min(thinnest, b.thickness.si());
  };
  const auto whole = study.measure([&] { once(1); });
  const auto row = [&](std::string method, unsigned threads, study::Cost cost) {
    study.add({.problem = workload->name,
               .method = std::move(method),
               .setting = fmt::format("threads={} blocks={} joints={} intersections={}", threads, of.blocks, of.joints,
                                      of.intersections),
               .error = passed ? std::optional{error} : std::nullopt,
               .cost = cost,
               .condition = thinnest > 0 ? std::optional{extent_of(input) / thinnest} : std::nullopt,
               .status = passed ? study::Status::converged : study::Status::stopped});
  };
  row("cut_and_certificate", 1, whole);
  const auto cutting = study.measure([&] { passed = topology::cut(input).has_value() && passed; });
  row("cut", 1, cutting);
  const study::Cost certificate{std::max(0.0, whole.wall_s - cutting.wall_s),
                                std::max(0.0, whole.cpu_s - cutting.cpu_s), whole.peak_mb};
  row("certificate", 1, certificate);
  row("cut_and_certificate", 2, study.measure([&] { once(2); }));

  Points& points = all[family];
  points.time_blocks.emplace_back(of.blocks, whole.cpu_s);
  points.time_joints.emplace_back(of.joints, whole.cpu_s);
  points.time_intersections.emplace_back(of.intersections, whole.cpu_s);
  points.memory_blocks.emplace_back(of.blocks, whole.peak_mb);
  points.memory_intersections.emplace_back(of.intersections, whole.peak_mb);
  points.certificate_blocks.emplace_back(of.blocks, certificate.cpu_s);
}

void plot(study::Study& study, const std::map<std::string, Points>& all, const std::string& file, const std::string& x,
          const std::string& y, std::vector<std::pair<double, double>> Points::* which) {
  study::Plot plot{.title = y + " against " + x, .x_label = x, .y_label = y, .series = {}};
  for (const auto& [family, points] : all) {
    plot.series.push_back({.name = family, .points = points.*which, .line = false, .fit = true});
  }
  study.plot(file, plot);
}

void study_cutter(study::Study& study) {
  const std::vector<std::pair<std::string, std::vector<std::uint32_t>>> families =
      study.quick()
          ? std::vector<std::pair<std::string, std::vector<std::uint32_t>>>{{"grid", {3, 5}}, {"rect", {13, 16}}}
          : std::vector<std::pair<std::string, std::vector<std::uint32_t>>>{{"grid", {5, 10, 20, 40, 60}},
                                                                            {"persist", {8, 13, 20, 26, 39}},
                                                                            {"rect", {13, 20, 30, 50, 75, 100}},
                                                                            {"disc", {500, 1000, 2000, 5000, 10000}}};
  std::map<std::string, Points> all;
  for (const auto& [family, sizes] : families) {
    for (const std::uint32_t size : sizes) add_workload(study, family, size, all);
  }
  const std::string seconds = "processor time of cut and certificate (s)";
  plot(study, all, "time-blocks", "blocks", seconds, &Points::time_blocks);
  plot(study, all, "time-joints", "joints", seconds, &Points::time_joints);
  plot(study, all, "time-intersections", "intersections of joints", seconds, &Points::time_intersections);
  plot(study, all, "memory-blocks", "blocks", "peak memory (MB)", &Points::memory_blocks);
  plot(study, all, "memory-intersections", "intersections of joints", "peak memory (MB)",
       &Points::memory_intersections);
  plot(study, all, "certificate-blocks", "blocks", "processor time of the certificate (s)",
       &Points::certificate_blocks);
}

}  // namespace
}  // namespace cleave

int main(int argc, char** argv) { return cleave::study::run("cutter", argc, argv, cleave::study_cutter); }
