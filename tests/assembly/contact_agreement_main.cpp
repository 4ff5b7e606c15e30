/// Verdicts on groups against motion from rest, on as many random assemblies of the plane as one likes:
///
///     contact_agreement [COUNT [SEED [each]]]        (default 500 assemblies, seed 1; `each`: a line for each)
///
/// Every assembly is run twice: as a scene of rock, whose key groups say what moves, and as its section, a scene of
/// rigid bodies in contact that starts from rest. They share no code behind the cutter. A body moves when a corner has
/// gone 1 mm in the time, from rest: 2e-4 of free fall. Blocks that set off at once must be in a group of some state,
/// be it in doubt. One that is in none was called stable and moves: the program then prints its scene and ends with 1.

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "agreement.hpp"
#include "cleave/realize/run.hpp"
#include "cleave/report/write.hpp"
#include "cleave/scene2d/contact.hpp"
#include "cleave/scene3d/scene.hpp"
#include "random_sections.hpp"

namespace cleave::testing {
namespace {

constexpr double duration = 1, early = 0.1;               ///< s
constexpr double moved_far = 1e-3, moved_at_once = 1e-5;  ///< m: 2e-4 of free fall in either time
constexpr double sliver = 1e-4;                           ///< m3
constexpr std::size_t least_blocks = 2, most_blocks = 20;

enum class Says : std::uint8_t { moves, doubt, stays };

struct Judged {
  Says says = Says::stays;
  std::size_t blocks = 0;              ///< that may move
  std::vector<std::uint32_t> grouped;  ///< in a group of any state, ascending
  std::vector<std::uint32_t> moving;   ///< in one that moves
  double factor = std::numeric_limits<double>::infinity();
  std::string section;  ///< the scene of contact
};

std::expected<scene::LoadedFile, scene::FileRefusal> no_files(const std::string&) {
  return std::unexpected(scene::FileRefusal{"no files here", ""});
}

std::string content(const std::filesystem::path& path) {
  std::ifstream in{path, std::ios::binary};
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

/// The blocks of a scene, judged by groups unless `groups` is false; empty, with a message, when it is wrong.
std::optional<scene::RunResult> run_of(const std::string& text, bool groups) {
  auto scene = scene::parse(text, "s.toml", no_files);
  if (!scene) {
    for (const scene::Problem& problem : scene.error()) fmt::print("{}\n", describe(problem));
    return std::nullopt;
  }
  if (!groups) scene->stability->groups = stability::GroupsCheck::off;
  StageTimer timer;
  Progress progress{ProgressStyle::quiet};
  auto result = scene::run(*scene, {.threads = 1}, timer, progress);
  if (!result || !result->complex) return std::nullopt;
  return std::move(*result);
}

/// Its section, a scene of contact; empty when there is none.
std::string section_of(const scene::RunResult& result, const std::filesystem::path& folder) {
  if (!report::write_sections(result, folder)) return {};
  return content(folder / "section.toml");
}
std::string section_of(const std::string& text, const std::filesystem::path& folder) {
  const auto result = run_of(text, false);
  return result ? section_of(*result, folder) : std::string{};
}

/// Empty: not as many blocks as asked for.
std::optional<Judged> judged(const std::string& text, const std::filesystem::path& folder) {
  const auto result = run_of(text, true);
  if (!result || !result->key_groups) return std::nullopt;
  Judged out;
  for (const topology::Block& block : result->complex->complex().blocks()) {
    out.blocks += block.fixed ? 0U : 1U;
    // Sections leave slivers out.
    if (block.volume.si() < sliver) return std::nullopt;
  }
  if (out.blocks < least_blocks || out.blocks > most_blocks) return std::nullopt;
  out.section = section_of(*result, folder);
  for (const stability::KeyGroup& group : result->key_groups->groups) {
    const bool moves = group.verdict != assembly::Verdict::in_doubt;
    if (moves) out.says = Says::moves;  // of the first state: only then are there others
    if (!moves && out.says == Says::stays) out.says = Says::doubt;
    out.factor = std::min(out.factor, group.factor_move);
    for (const topology::BlockId id : group.blocks) {
      out.grouped.push_back(id.value());
      if (moves) out.moving.push_back(id.value());
    }
  }
  std::ranges::sort(out.grouped);
  std::ranges::sort(out.moving);
  return out;
}

struct Seen {
  double farthest = 0;                 ///< m, of any corner
  std::vector<std::uint32_t> at_once;  ///< blocks that set off at once, ascending
};

/// "block 12" or "block 12 part 2".
std::uint32_t number_in(const std::string& name) {
  std::uint32_t value = 0;
  const std::string digits = name.substr(6);
  (void)std::from_chars(digits.data(), std::to_address(digits.end()), value);
  return value;
}

/// Empty: the run stopped.
std::optional<Seen> seen(const std::string& text) {
  auto scene = scene::parse_contact(text, "section.toml");
  if (!scene) return std::nullopt;
  scene->settings.duration = duration;
  scene->settings.step = scene->settings.max_step = 0.005;
  scene->settings.rigidity = scene::Rigidity::rigid;
  StageTimer timer;
  Progress progress{ProgressStyle::quiet};
  const auto result = scene::run(*scene, 1, timer, progress);
  if (!result || !result->converged || result->end_time < 0.99 * duration) return std::nullopt;
  Seen out;
  std::size_t soon = 0;
  while (soon + 1 < result->frames.size() && result->frames[soon].time < early) ++soon;
  for (std::size_t b = 0; b < result->bodies.size(); ++b) {
    const scene::ContactBodyResult& body = result->bodies[b];
    if (body.fixed) continue;
    out.farthest = std::max(out.farthest, body.largest);
    const auto corners = scene::corners_at(*result, soon, b);
    double gone = 0;
    for (std::size_t k = 0; k < corners.size(); ++k) gone = std::max(gone, norm(corners[k] - body.outline[k]));
    const double time = result->frames[soon].time / early;
    if (gone > moved_at_once * time * time) out.at_once.push_back(number_in(body.name));
  }
  std::ranges::sort(out.at_once);
  return out;
}

/// About the least share of its strengths at which an assembly stays; 1 where it moves or stays at any.
double limit(std::uint64_t seed, std::uint32_t trial, const std::filesystem::path& folder) {
  const auto moves = [&](double strength) -> std::optional<bool> {
    const auto happened = seen(section_of(random_section(seed, trial, strength).scene, folder));
    if (!happened) return std::nullopt;
    return happened->farthest > moved_far;
  };
  double low = 0.1, high = 3;
  if (moves(low) != true || moves(high) != false) return 1;
  for (int k = 0; k < 7; ++k) {
    const double middle = std::sqrt(low * high);
    const auto found = moves(middle);
    if (!found) return middle;
    (*found ? low : high) = middle;
  }
  return high;
}

struct Count {
  int agreed = 0, doubt_moves = 0, doubt_stays = 0, too_careful = 0, missed = 0, stopped = 0;
  [[nodiscard]] int all() const { return agreed + doubt_moves + doubt_stays + too_careful + missed; }
};

class Comparison final {
 public:
  explicit Comparison(bool each) : each_{each} {}

  /// False when the scene has not as many blocks as asked for.
  bool one(std::uint64_t seed, std::uint32_t trial, const std::filesystem::path& folder) {
    RandomSection section = random_section(seed, trial);
    auto said = judged(section.scene, folder);
    if (!said) return false;
    // One of two near the limit between motion and rest, within a tenth.
    if (trial / 8 % 2 == 1) {
      const double at = limit(seed, trial, folder) * (0.9 + 0.2 * (trial / 16 % 21) / 20.0);
      section = random_section(seed, trial, at);
      said = judged(section.scene, folder);
      if (!said) return false;
    }
    const auto happened = seen(said->section);
    if (!happened) {
      ++counts_[section.family].stopped;
      if (each_) fmt::print("{} {}: contact stopped\n", trial, section.family);
      return true;
    }
    const bool moves = happened->farthest > moved_far;
    std::vector<std::uint32_t> alone;
    std::ranges::set_difference(happened->at_once, said->grouped, std::back_inserter(alone));
    const bool missed = !alone.empty() || (moves && said->says == Says::stays);
    Count& count = counts_[section.family];
    const char* word = "agrees";
    if (missed) {
      ++count.missed;
      word = "CALLED STABLE AND MOVES";
    } else if (said->says == Says::doubt) {
      ++(moves ? count.doubt_moves : count.doubt_stays);
      word = moves ? "doubt, moves" : "doubt, stays";
    } else if (moves != (said->says == Says::moves)) {
      ++count.too_careful;
      word = "called moving and stays";
    } else {
      ++count.agreed;
    }
    if (missed || (each_ && word != std::string_view{"agrees"})) {
      fmt::print("# trial {} of seed {}\n{}\n", trial, seed, section.scene);
    }
    if (each_ || missed) {
      fmt::print("{} {}: {} blocks, factor {:.6g}, gone {:.3g} m, {} in groups, {} set off, {} not in a group: {}\n",
                 trial, section.family, said->blocks, said->factor, happened->farthest, said->grouped.size(),
                 happened->at_once.size(), alone.size(), word);
      std::fflush(stdout);
    }
    return true;
  }

  /// Whether none was called stable that moves.
  [[nodiscard]] bool summary() const {
    fmt::print("{:10} {:>6} {:>7} {:>12} {:>12} {:>15} {:>16} {:>8}\n", "family", "scenes", "agreed", "doubt, moves",
               "doubt, stays", "moving, stays", "stable, moves", "stopped");
    Count sum;
    const auto line = [](const std::string& name, const Count& c) {
      fmt::print("{:10} {:6} {:7} {:12} {:12} {:15} {:16} {:8}\n", name, c.all(), c.agreed, c.doubt_moves,
                 c.doubt_stays, c.too_careful, c.missed, c.stopped);
    };
    for (const auto& [name, c] : counts_) {
      line(name, c);
      sum.agreed += c.agreed;
      sum.doubt_moves += c.doubt_moves;
      sum.doubt_stays += c.doubt_stays;
      sum.too_careful += c.too_careful;
      sum.missed += c.missed;
      sum.stopped += c.stopped;
    }
    line("all", sum);
    const double all = std::max(1, sum.all());
    fmt::print("agreed {:.1f} %, in doubt {:.1f} %, disagreed {:.1f} %\n", 100 * sum.agreed / all,
               100 * (sum.doubt_moves + sum.doubt_stays) / all, 100 * (sum.too_careful + sum.missed) / all);
    return sum.missed == 0;
  }

 private:
  bool each_;
  std::map<std::string, Count> counts_;
};

}  // namespace
}  // namespace cleave::testing

int main(int argc, char** argv) {
  const auto arguments = cleave::support::agreement_arguments(argc, argv, "contact_agreement", 500, "each");
  if (!arguments) return 2;
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("cleave_contact_agreement_{}", ::getpid());
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  cleave::testing::Comparison comparison{arguments->word};
  std::uint64_t found = 0;
  for (std::uint32_t trial = 0; found < arguments->count && trial < 20 * arguments->count; ++trial) {
    found += comparison.one(arguments->seed, trial, folder) ? 1U : 0U;
  }
  std::filesystem::remove_all(folder, failure);
  return comparison.summary() ? 0 : 1;
}
