/// Study "mapped": networks that honour what a tunnel has shown so far, against the networks it was mapped in. Problems
/// are what was mapped; methods what is foretold of the face 2 m ahead; `error` is the distance from 0.95 of the share
/// of truths that lie within the 95 % interval of 39 draws (from the least to the greatest), `condition` the mean width
/// of that interval over that of networks for which nothing was mapped. Times are those of one network drawn.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "cleave/dfn/sample.hpp"
#include "study.hpp"

namespace cleave {
namespace {

using geometry::Vec3;

constexpr std::size_t draws_per_truth = 39;  // 38 of 40 places of the truth among them lie within

geometry::Polygon polygon(std::vector<Vec3> corners) { return geometry::Polygon::make(std::move(corners)).value(); }
dfn::MappedFace wall(double y, double from, double to) {
  return {polygon({{from, y, 0}, {to, y, 0}, {to, y, 5}, {from, y, 5}})};
}
dfn::MappedFace roof(double from, double to) { return {polygon({{from, 3, 5}, {to, 3, 5}, {to, 7, 5}, {from, 7, 5}})}; }
dfn::MappedFace face_at(double x) { return {polygon({{x, 3, 0}, {x, 7, 0}, {x, 7, 5}, {x, 3, 5}})}; }

/// A tunnel 4 m wide and 5 m high that has come to x = 8.
struct Mapped {
  std::string name;
  dfn::Mapping mapping;
  bool joints_known = true;  ///< which traces are of one joint; else only those that meet at corners are joined
};
std::vector<Mapped> problems() {
  const auto tunnel = [](double from) {
    return dfn::Mapping{.faces = {wall(3, from, 8), wall(7, from, 8), roof(from, 8), face_at(8)}};
  };
  dfn::Mapping drilled = tunnel(2);
  drilled.holes.push_back({{8, 5, 2}, {14, 5, 3}});
  return {{"nothing", {}},
          {"face", {.faces = {face_at(8)}}},
          {"tunnel_6m", tunnel(2)},
          {"tunnel_6m_and_hole", drilled},
          {"tunnel_6m_joints_not_known", tunnel(2), false}};
}

dfn::JointSet truth_set() {
  dfn::SizeSpec size;
  size.distribution = dfn::SizeDistribution::exponential;
  size.mean = metres(3);
  size.max = metres(12);
  return dfn::JointSet::make({.orientation = dfn::FisherOrientation{Dip::degrees(60), DipDirection::degrees(70), 15},
                              .shape = dfn::Disc{dfn::SizeLaw::make(size).value()},
                              .intensity = dfn::P32{0.5}})
      .value();
}
const dfn::DomainBox domain{{0, 0, 0}, {12, 10, 8}};

using Shown = std::array<double, 2>;  ///< joints on the face ahead, and metres of trace
Shown ahead(std::span<const dfn::SampledJoint> joints) {
  dfn::Mapping face{.faces = {face_at(10)}};
  dfn::map(joints, 0, face);
  Shown shown{static_cast<double>(face.joints.size()), 0};
  for (const dfn::MappedJoint& joint : face.joints) {
    for (const dfn::MappedTrace& trace : joint.traces) shown[1] += norm(trace.ends[1] - trace.ends[0]);
  }
  return shown;
}

std::vector<dfn::SampledJoint> network(const dfn::JointSet& set, const dfn::Mapping& mapping,
                                       std::uint64_t realization) {
  auto joints = dfn::unseen(dfn::sample(set, 0, domain, 12, realization).value(), mapping);
  const std::array<const dfn::JointSet*, 1> sets{&set};
  auto drawn = dfn::honour(sets, mapping, 12, realization).value();
  for (auto& honoured : drawn) joints.push_back(std::move(honoured.joint));
  return joints;
}

/// One trace or pick a joint, but for those that meet at corners.
dfn::Mapping taken_apart(const dfn::Mapping& mapping) {
  dfn::Mapping apart = mapping;
  apart.joints.clear();
  for (const dfn::MappedJoint& joint : mapping.joints) {
    for (const auto& trace : joint.traces) apart.joints.push_back({.set = joint.set, .traces = {trace}});
    for (const auto& pick : joint.picks) apart.joints.push_back({.set = joint.set, .picks = {pick}});
  }
  dfn::join_round_corners(apart);
  return apart;
}

struct Found {
  std::array<int, 2> held{};
  std::array<double, 2> width{};
};

void foretell(const Shown& exact, std::vector<Shown> drawn, std::uint64_t truth, Found& found) {
  for (std::size_t k = 0; k < exact.size(); ++k) {
    std::vector<double> values;
    for (const Shown& shown : drawn) values.push_back(shown.at(k));
    const auto [low, high] = std::ranges::minmax(values);
    found.width.at(k) += high - low;
    // Counts that are equal are put in order by chance, or intervals would hold more than they say.
    const auto ties = [&](double v) { return static_cast<std::uint64_t>(std::ranges::count(values, v)); };
    const bool below = exact.at(k) < low || (exact.at(k) == low && truth % (ties(low) + 1) == 0);
    const bool above = exact.at(k) > high || (exact.at(k) == high && truth % (ties(high) + 1) == 1);
    found.held.at(k) += below || above ? 0 : 1;
  }
}

void study_mapped(study::Study& study) {
  const dfn::JointSet set = truth_set();
  const std::uint64_t truths = study.quick() ? 3 : 400;
  std::array<double, 2> plain{};
  for (const Mapped& problem : problems()) {
    Found found;
    std::size_t seen = 0, honoured = 0;
    const std::array<const dfn::JointSet*, 1> sets{&set};
    for (std::uint64_t truth = 0; truth < truths; ++truth) {
      const auto joints = dfn::sample(set, 0, domain, 11, truth).value();
      dfn::Mapping mapping = problem.mapping;
      dfn::map(joints, 0, mapping);
      if (!problem.joints_known) mapping = taken_apart(mapping);
      std::vector<Shown> drawn;
      for (std::uint64_t k = 0; k < draws_per_truth; ++k) {
        drawn.push_back(ahead(network(set, mapping, truth * draws_per_truth + k)));
      }
      const auto once = dfn::honour(sets, mapping, 13, truth).value();
      for (const auto& joint : once) honoured += joint.honours ? 1U : 0U;
      seen += mapping.joints.size();
      foretell(ahead(joints), std::move(drawn), truth, found);
    }
    dfn::Mapping mapping = problem.mapping;
    dfn::map(dfn::sample(set, 0, domain, 11, 0).value(), 0, mapping);
    const auto cost = study.measure([&] { static_cast<void>(network(set, mapping, 0)); });
    if (problem.name == "nothing") plain = found.width;
    const std::array<std::string, 2> methods{"joints_ahead", "trace_length_ahead"};
    for (std::size_t k = 0; k < methods.size(); ++k) {
      const double coverage = found.held.at(k) / static_cast<double>(truths);
      study.add({.problem = problem.name,
                 .method = methods.at(k),
                 .setting = fmt::format("truths={} joints_mapped={} honoured={}", truths, seen, honoured),
                 .error = std::abs(coverage - 0.95),
                 .cost = cost,
                 .condition = found.width.at(k) / plain.at(k)});
      const double noise = 2.5 * std::sqrt(0.95 * 0.05 / static_cast<double>(truths));
      if (problem.joints_known && std::abs(coverage - 0.95) > 0.02 + noise) {
        study.broken(fmt::format("{} {} covers {:.3f}", problem.name, methods.at(k), coverage));
      }
    }
  }
}

}  // namespace
}  // namespace cleave

int main(int argc, char** argv) { return cleave::study::run("mapped", argc, argv, cleave::study_mapped); }
