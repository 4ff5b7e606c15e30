#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

#include "readings.hpp"

namespace cleave::readings {
namespace {

using stochastic::Record;

constexpr double none = std::numeric_limits<double>::quiet_NaN();
double number(std::uint64_t n) { return static_cast<double>(n); }
double ratio(double a, double b) { return b > 0 ? a / b : none; }

double blocks(const Record& r) { return number(r.blocks); }
double block_volume(const Record& r) { return ratio(r.rock_m3, number(r.blocks)); }
double batches(const Record& r) { return r.batches; }
double keys(const Record& r) { return number(r.all.count); }
double key_volume(const Record& r) { return r.all.volume_m3; }
double mean_key(const Record& r) { return ratio(r.all.volume_m3, number(r.all.count)); }
double first(const Record& r) { return number(r.first.count); }
double first_volume(const Record& r) { return r.first.volume_m3; }
double mean_first(const Record& r) { return ratio(r.first.volume_m3, number(r.first.count)); }

/// Tables 5-1 to 5-4: mean and standard deviation of eight figures in their order.
std::vector<Printed> table(const std::array<std::array<double, 2>, 8>& v) {
  return {{"blocks", blocks, v[0][0], v[0][1]},
          {"mean volume of a block", block_volume, v[1][0], v[1][1]},
          {"key blocks", keys, v[2][0], v[2][1]},
          {"their volume", key_volume, v[3][0], v[3][1]},
          {"mean volume of a key block", mean_key, v[4][0], v[4][1]},
          {"first batch: key blocks", first, v[5][0], v[5][1]},
          {"first batch: volume", first_volume, v[6][0], v[6][1]},
          {"first batch: mean volume", mean_first, v[7][0], v[7][1]}};
}

std::string size_line(std::string_view scene_size, const Section& section, const Reading& reading) {
  // mean = 80 -> that of the reading; the law's own words stay.
  const auto value = [&](std::string_view key) -> double {
    const std::size_t at = scene_size.find(fmt::format("{} = ", key));
    if (at == std::string_view::npos) return none;
    return std::stod(std::string{scene_size.substr(at + key.size() + 3)});
  };
  const double times = reading.extent;
  const bool normal = scene_size.contains("normal");
  std::string out = fmt::format("size = {{ distribution = \"{}\", mean = {}", normal ? "normal" : "exponential",
                                times * value("mean"));
  if (normal) return out + fmt::format(", std = {} }}", times * value("std"));
  if (!section.limited) return out + " }";
  if (reading.limits == Limits::redrawn || reading.limits == Limits::clamped) {
    out += fmt::format(", min = {}", times * value("min"));
  }
  if (reading.limits != Limits::none) out += fmt::format(", max = {}", times * value("max"));
  if (reading.limits == Limits::clamped) out += ", clamp = true";
  return out + " }";
}

}  // namespace

std::string Reading::label() const {
  constexpr std::array<std::string_view, 4> limit_names{"redrawn", "clamped", "no limits", "upper limit"};
  return fmt::format("{}; box {}; {}; {}", extent > 1 ? "half sides and radii" : "sides and diameters", box,
                     limit_names.at(static_cast<std::size_t>(limits)),
                     density ? "number in the domain" : "number in the box");
}

const std::vector<Section>& sections() {
  static const std::vector<Section> all{
      {"4.5.2 tunnel",
       "tunnel/tunnel.toml",
       1,
       {},
       13,
       false,
       {{"blocks", blocks, 4458}, {"batches", batches, 5}, {"first batch: key blocks", first, 10}}},
      {"4.5.3 powerhouse",
       "powerhouse/powerhouse.toml",
       1,
       {},
       107,
       false,
       {{"blocks", blocks, 7511}, {"batches", batches, 6}, {"first batch: key blocks", first, 18}}},
      {"5.2.1 four tunnels",
       "four_tunnels/four_tunnels.toml",
       1,
       {},
       21,
       false,
       {{"batches", batches, 41}, {"key blocks", keys, 247}, {"first batch: key blocks", first, 19}}},
      {"5.3 small",
       "thesis_tunnel/small.toml",
       60,
       {13, 13, 13},
       0,
       true,
       table({{{1295, 257}, {191, 37}, {29, 24}, {313, 382}, {10, 13}, {7, 5}, {32, 35}, {5, 5}}})},
      {"5.3 medium",
       "thesis_tunnel/medium.toml",
       60,
       {13, 13, 13},
       0,
       true,
       table({{{2925, 411}, {83, 12}, {112, 126}, {1879, 3448}, {13, 13}, {13, 6}, {41, 42}, {3, 4}}})},
      {"5.4 Jinping",
       "jinping_entrance/jinping_entrance.toml",
       120,
       {80, 30},
       0,
       false,
       table({{{2358, 475}, {116, 28}, {418, 276}, {15698, 10095}, {41, 16}, {47, 47}, {580, 760}, {14, 14}}})},
  };
  return all;
}

std::string scene_text(const Section& section, const Reading& reading, const std::vector<double>& joints) {
  std::ifstream file{std::string{CLEAVE_SOURCE_DIR} + "/examples/" + std::string{section.scene}};
  std::string out, line;
  bool persistent = false;
  std::size_t set = 0;
  while (std::getline(file, line)) {
    if (line.starts_with("[support]") || line.starts_with("[monte_carlo]") || line.starts_with("[output]")) break;
    if (line.starts_with("force_transfer")) continue;  // none of the figures needs it
    if (line.starts_with("size = ")) {
      persistent = line.contains("persistent");
      if (!persistent) line = size_line(line, section, reading);
    } else if (line.starts_with("intensity = ") && !persistent) {
      const double n = joints.size() == 1 ? joints.front() : joints.at(set);
      ++set;
      const double all = reading.density ? n * reading.box * reading.box * reading.box : n;
      line = fmt::format("intensity = {{ count = {}{} }}", std::lround(all),
                         reading.box > 1 ? ", count_in = \"buffer\"" : "");
      if (reading.box > 1) line += fmt::format("\nbuffer = {}", reading.box);
    }
    out += line + "\n";
  }
  return out + "[output]\nblocks = \"all\"\n[monte_carlo]\nrealizations = 1000\n";
}

std::vector<Compared> compare(const Section& section, const std::vector<Record>& records) {
  std::vector<Compared> all;
  for (const Printed& figure : section.figures) {
    std::vector<double> values;
    for (const Record& r : records) {
      if (const double v = figure.of(r); r.outcome == stochastic::Outcome::done && std::isfinite(v))
        values.push_back(v);
    }
    const double n = number(values.size());
    if (values.size() < 2) continue;
    double mean = 0, second = 0, fourth = 0;
    for (const double v : values) mean += v / n;
    for (const double v : values) {
      second += (v - mean) * (v - mean) / (n - 1);
      fourth += std::pow(v - mean, 4) / n;
    }
    mean = std::max(mean, 1e-3);
    const double std = std::max(std::sqrt(second), 1e-3 * mean), variation = std * std / (mean * mean);
    // A single realization is one draw of the law, else a mean of so many.
    const double printed_variation =
        figure.std ? *figure.std * *figure.std / (figure.mean * figure.mean * section.realizations)
                   : std::log1p(variation);
    const double half = 1.96 * std::sqrt(variation / n);
    all.push_back({std::string{section.name}, std::string{figure.name}, figure.mean, mean, mean * std::exp(-half),
                   mean * std::exp(half), std::log(figure.mean / mean), std::sqrt(printed_variation + variation / n)});
    if (!figure.std) continue;
    const double kurtosis = std::max(3.0, fourth / (std * std * std * std));
    const double of_std = std::sqrt((kurtosis - 1) / 4 / n),
                 of_printed = std::sqrt((kurtosis - 1) / 4 / section.realizations);
    all.push_back({std::string{section.name}, std::string{figure.name} + ": standard deviation", *figure.std, std,
                   std * std::exp(-1.96 * of_std), std * std::exp(1.96 * of_std), std::log(*figure.std / std),
                   std::hypot(of_std, of_printed)});
  }
  return all;
}

Likelihood likelihood(const std::vector<Compared>& figures) {
  Likelihood best{-std::numeric_limits<double>::infinity(), 0};
  for (double apart = 0.01; apart < 10; apart *= 1.05) {
    double log = 0;
    for (const Compared& f : figures) {
      const double variance = f.error * f.error + apart * apart;
      log -= 0.5 * (std::log(variance) + f.difference * f.difference / variance);
    }
    if (log > best.log) best = {log, apart};
  }
  return best;
}

}  // namespace cleave::readings
