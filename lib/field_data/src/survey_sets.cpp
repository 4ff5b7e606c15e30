#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "cleave/core/text.hpp"
#include "cleave/field_data/survey_file.hpp"
#include "cleave/geometry/orientation.hpp"
#include "survey_laws.hpp"

namespace cleave::scene {
namespace {

/// Of text without control characters, as names in surveys are.
std::string in_quotes(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

/// A name that may stand in a file name.
std::string plain(std::string_view name) {
  std::string out;
  for (const char c : name) {
    const bool good = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    out += good ? c : '_';
  }
  return out.empty() ? "set" : out;
}

/// Sets "A 1" and "A-1" need a file each; names that differ in case alone are one to some file systems.
std::string unused_name(const SetsFile& sets, const std::string& plain_name) {
  const auto used = [&](const std::string& name) {
    return std::ranges::any_of(sets.files, [&](const auto& f) { return lower(f.first) == lower(name); });
  };
  std::string name = fmt::format("sets_{}.csv", plain_name);
  for (std::size_t k = 2; used(name); ++k) name = fmt::format("sets_{}_{}.csv", plain_name, k);
  return name;
}

std::string size_text(const survey::SetResult& set) {
  const survey::SizeOfJoints& law = *set.size;
  std::string text = fmt::format("{{ distribution = \"{}\"", name_of(law.family));
  if (law.family == survey::Family::power) {
    return text + fmt::format(", exponent = {}, min = {}, max = {} }}", law.exponent, law.min, law.max);
  }
  text += fmt::format(", mean = {}", law.mean);
  if (law.family == survey::Family::constant) return text + " }";
  if (law.family != survey::Family::exponential) text += fmt::format(", std = {}", law.std);
  if (law.family == survey::Family::gamma) text += fmt::format(", min = {}", smallest_size(set));
  return text + fmt::format(", max = {} }}", largest_size(set));
}

std::string shape_text(const survey::SetResult& set) {
  const std::string name{name_of(set.shape.shape)};
  if (set.shape.shape == survey::JointShape::disc) {
    return "shape = \"disc\"\nsize = " + size_text(set) + "   # diameter, m\n";
  }
  return fmt::format("shape = \"{}\"\nsize = {}   # long {}, m\naspect = {}\nrotation = {}\n", name, size_text(set),
                     set.shape.shape == survey::JointShape::ellipse ? "axis" : "side", set.shape.aspect,
                     set.shape.rotation);
}

/// Why a set has no size, as a comment.
std::string reason_of_no_size(const survey::SurveyInput& input, const survey::SetResult& set) {
  if (set.traces + set.traces_on_lines == 0) return "no trace lengths were measured";
  double truncation = 0;
  if (set.traces > 0) {
    for (const survey::WindowSurvey& window : input.windows) truncation = std::max(truncation, window.truncation.si());
  } else {
    for (const survey::LineSurvey& line : input.lines) truncation = std::max(truncation, line.truncation.si());
  }
  if (std::ranges::all_of(set.seen_lengths, [&](double length) { return length < truncation; })) {
    return fmt::format("all traces are shorter than the truncation, {} m: their lengths count for nothing", truncation);
  }
  return "no end of a trace was seen: longer than what was looked at";
}

}  // namespace

SetsFile sets_file(const SurveyScene& survey, const survey::SurveyResult& result) {
  SetsFile file;
  file.toml = fmt::format(
      "# Joint sets of {} (sha256 {}), by cleave survey. A scene takes them with include = [\"sets.toml\"].\n",
      on_one_line(survey.file_name), survey.sha256);
  if (survey.input.north.degrees() != 0) {
    file.toml += fmt::format(
        "# Dip directions are from true north, {0} degrees from the y axis of the survey: the scene needs north = "
        "{0}.\n",
        survey.input.north.degrees());
  }
  for (const survey::SetResult& set : result.sets) {
    file.toml += "\n";
    if (!usable(set)) {
      file.toml += fmt::format("# {}: left out, its {} not known\n", set.name,
                               set.joints > 0 || set.orientation_stated ? "intensity is" : "orientation is");
      continue;
    }
    const geometry::Attitude mean = survey::compass_attitude(set.orientation.mean, set.north);
    file.toml += fmt::format("[[joint_set]]\nname = {}\nmodel = \"baecher\"\n", in_quotes(set.name));
    const bool fisher = set.orientation.fisher && std::isfinite(set.orientation.kappa);
    if (fisher || set.orientation_stated) {
      file.toml +=
          fmt::format("orientation = {{ dip = {}, dip_direction = {}, distribution = \"fisher\", kappa = {} }}",
                      mean.dip.degrees(), mean.direction.degrees(), set.orientation.kappa);
      file.toml += set.orientation_stated ? "   # dip stated\n"
                                          : fmt::format("   # kappa {:.3g} to {:.3g}, mean within {:.1f} degrees\n",
                                                        set.orientation.kappa_low, set.orientation.kappa_high,
                                                        set.orientation.cone_degrees.value_or(90));
    } else if (set.joints == 1 || std::isinf(set.orientation.kappa)) {
      file.toml += fmt::format("orientation = {{ dip = {}, dip_direction = {} }}   # all parallel\n",
                               mean.dip.degrees(), mean.direction.degrees());
    } else {
      const std::string name = unused_name(file, plain(set.name));
      // Each pole as often as its weight says, in quarters of the smallest.
      const double least = *std::ranges::min_element(set.weights);
      std::string csv = "dip,dip_direction\n";
      for (std::size_t i = 0; i < set.normals.size(); ++i) {
        const geometry::Attitude a = survey::compass_attitude(set.normals[i], set.north);
        const auto times = std::clamp(std::lround(4 * set.weights[i] / least), 1L, 400L);
        for (long t = 0; t < times; ++t) csv += fmt::format("{},{}\n", a.dip.degrees(), a.direction.degrees());
      }
      file.files.emplace_back(name, std::move(csv));
      file.toml += fmt::format("orientation = {{ distribution = \"bootstrap\", file = \"{}\", jitter = 200 }}\n", name);
    }
    if (set.size) {
      file.toml += shape_text(set);
    } else {
      file.toml += fmt::format("size = \"persistent\"   # {}\n", reason_of_no_size(survey.input, set));
    }
    for (const std::string& caution : set.cautions) file.toml += "# " + on_one_line(caution) + "\n";
    file.toml += fmt::format("intensity = {{ p32 = {} }}   # 1/m, {:.3g} to {:.3g}; {}\n", *set.p32->value,
                             set.p32->low, set.p32->high, set.p32->method);
  }
  return file;
}

}  // namespace cleave::scene
