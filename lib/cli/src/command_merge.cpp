#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <utility>

#include "cleave/core/cost.hpp"
#include "cleave/realize/run.hpp"
#include "command_monte_carlo.hpp"
#include "problems.hpp"

namespace cleave::cli {
namespace {

namespace fs = std::filesystem;
using stochastic::Record;
using stochastic::RecordFile;
using stochastic::RunIdentity;

ExitCode wrong(const std::string& folder, const std::string& what) {
  print_error(fmt::format("{}:1: OUT: {}", folder, what));
  return ExitCode::wrong_input;
}

struct Part {
  std::string folder;
  RunIdentity identity;
  std::uint64_t records = 0;
};

/// The records of all parts in the order of their realizations, read side by side: memory does not grow with them.
class Parts final {
 public:
  explicit Parts(const std::vector<Part>& parts) {
    for (const Part& part : parts) {
      files_.emplace_back(fs::path{part.folder} / records_name, std::ios::binary);
      std::string line;
      std::getline(files_.back(), line);
      std::getline(files_.back(), line);
    }
  }
  [[nodiscard]] std::optional<Record> next(std::size_t part) {
    std::string line;
    if (!std::getline(files_[part], line)) return std::nullopt;
    return stochastic::record_of(line);
  }

 private:
  std::vector<std::ifstream> files_;
};

std::string list_of(const std::vector<std::uint64_t>& numbers) {
  std::string list;
  for (std::size_t i = 0; i < std::min<std::size_t>(numbers.size(), 20); ++i) {
    list += (list.empty() ? "" : ", ") + std::to_string(numbers[i]);
  }
  return list + (numbers.size() > 20 ? ", ..." : "");
}

/// Name, identity and number of records of every part; what is wrong has been said.
std::expected<std::vector<Part>, ExitCode> read_parts(const std::vector<std::string>& folders) {
  std::vector<Part> parts;
  for (const std::string& folder : folders) {
    Part part{folder, {}, 0};
    std::error_code ignored;
    if (!fs::exists(fs::path{folder} / records_name, ignored)) {
      const bool unfinished = fs::exists(fs::path{folder} / unfinished_name, ignored);
      return std::unexpected(
          wrong(folder, unfinished ? "the run in it is not finished; finish it with the same command"
                                   : "is no Monte Carlo result: it holds no realizations.csv; name the folder of a "
                                     "finished cleave run --shard K/N"));
    }
    auto read = stochastic::read_records(fs::path{folder} / records_name, [&](const Record&, std::string_view) {
      ++part.records;
      return true;
    });
    if (!read) return std::unexpected(wrong(folder, "realizations.csv: " + describe(read.error())));
    part.identity = *std::move(read);
    parts.push_back(std::move(part));
  }
  return parts;
}

/// All shards of one run, each once.
ExitCode check_shards(const std::vector<Part>& parts, const std::string& out) {
  const RunIdentity& first = parts.front().identity;
  const std::uint64_t of = first.shard.of;
  std::set<std::uint64_t> there;
  for (const Part& part : parts) {
    const RunIdentity& id = part.identity;
    if (id.version != first.version || id.scene_sha256 != first.scene_sha256 || id.seed != first.seed ||
        id.shard.of != of) {
      return wrong(part.folder, fmt::format("belongs to another run than {}: scene, seed, version and the number of "
                                            "shards must be the same; merge the parts of one run only",
                                            parts.front().folder));
    }
    if (!there.insert(id.shard.number).second) {
      return wrong(part.folder, fmt::format("shard {}/{} is there twice; name each once", id.shard.number, of));
    }
  }
  std::vector<std::uint64_t> missing;
  for (std::uint64_t k = 1; k <= of && missing.size() < 100; ++k) {
    if (!there.contains(k)) missing.push_back(k);
  }
  if (missing.empty()) return ExitCode::done;
  const bool one = missing.size() == 1;
  return wrong(out, fmt::format("{} {} of {} {} missing; run {} and merge again", one ? "shard" : "shards",
                                list_of(missing), of, one ? "is" : "are", one ? "it" : "them"));
}

/// Every part has all of its realizations, of `wanted` in groups of `group`.
ExitCode check_counts(const std::vector<Part>& parts, std::uint64_t wanted, std::uint64_t group) {
  for (const Part& part : parts) {
    const std::uint64_t number = part.identity.shard.number, of = part.identity.shard.of;
    const std::uint64_t geometries = wanted / group;
    const std::uint64_t own = geometries < number ? 0 : ((geometries - number) / of + 1) * group;
    if (part.records != own) {
      return wrong(part.folder, fmt::format("holds {} of its {} realizations: from number {} on they are missing; "
                                            "finish it with the same command",
                                            part.records, own,
                                            (number - 1 + part.records / group * of) * group + part.records % group));
    }
  }
  return ExitCode::done;
}

/// The scene and the files it names, as the first part keeps them.
std::vector<MonteCarloFolder::File> copies_of(const std::string& part) {
  std::vector<MonteCarloFolder::File> copies;
  for (const auto& entry : fs::directory_iterator{part}) {
    const std::string name = entry.path().filename().string();
    if (name != "scene.toml" && !name.starts_with("scene_file_")) continue;
    std::ifstream file{entry.path(), std::ios::binary};
    copies.push_back({name, std::string{std::istreambuf_iterator<char>{file}, std::istreambuf_iterator<char>{}}});
  }
  std::ranges::sort(copies, {}, &MonteCarloFolder::File::name);
  return copies;
}

}  // namespace

ExitCode merge_results(const std::vector<std::string>& folders, const std::string& out, bool quiet) {
  StageTimer timer;
  for (const std::string& folder : folders) {
    std::error_code ignored;
    if (!fs::equivalent(folder, out, ignored)) continue;
    return wrong(out, fmt::format("is {}, one of the parts; give another folder for the whole result", folder));
  }
  auto parts = read_parts(folders);
  if (!parts) return parts.error();
  const RunIdentity first = parts->front().identity;
  const std::uint64_t of = first.shard.of;
  if (const ExitCode end = check_shards(*parts, out); end != ExitCode::done) return end;
  auto scene = timer.run("read", [&] { return load_copied_scene(folders.front()); });
  if (!scene) return report_problems(scene.error());
  scene->seed = first.seed;
  if (!scene->monte_carlo || scene_and_files_sha256(*scene) != first.scene_sha256) {
    return wrong(folders.front(), "its copy of the scene is not the one its records come from; run it again");
  }
  std::ranges::sort(*parts, {}, [](const Part& p) { return p.identity.shard.number; });
  const std::uint64_t wanted = scene->monte_carlo->realizations, group = strengths_per_geometry(*scene);
  if (const ExitCode end = check_counts(*parts, wanted, group); end != ExitCode::done) return end;
  auto copies = copies_of(folders.front());
  const RunIdentity whole{first.version, first.scene_sha256, first.seed, {}};
  auto folder = MonteCarloFolder::prepare(out, header_of(whole));
  if (!folder) {
    print_error(folder.error().message);
    return folder.error().code;
  }
  const auto failed = [&](const stochastic::RecordFileError& error) {
    print_error(fmt::format("{}:1: -o: {}", out, describe(error)));
    return std::holds_alternative<stochastic::SystemFailure>(error) ? ExitCode::machine_failed : ExitCode::wrong_input;
  };
  auto result = timer.run("monte_carlo", [&]() -> std::expected<scene::MonteCarloResult, stochastic::RecordFileError> {
    auto file = RecordFile::open(folder->unfinished(), whole);
    if (!file) return std::unexpected(file.error());
    Parts readers{*parts};
    for (std::uint64_t k = 0; k < wanted; ++k) {
      const auto record = readers.next(k / group % of);
      if (!record || record->realization != k) return std::unexpected(stochastic::Unreadable{k / of + 3});
      if (k < file->records()) continue;  // an earlier merge was interrupted
      if (auto written = file->append(*record); !written) return std::unexpected(written.error());
    }
    if (auto flushed = file->flush_to_disk(); !flushed) return std::unexpected(flushed.error());
    return figures_of_records(*scene, folder->unfinished());
  });
  if (!result) return failed(result.error());
  return publish_monte_carlo(*scene, *std::move(result), *folder, std::move(copies), timer, 1, quiet, nullptr);
}

}  // namespace cleave::cli
