#include "saved_runs.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "cleave/load/load.hpp"
#include "interrupt.hpp"

namespace cleave::cli {
namespace {

namespace fs = std::filesystem;

FoundState read_state(const fs::path& path, std::string_view file) {
  auto bytes = scene::read_file(path);
  if (bytes) return scene::SavedRun{path.generic_string(), *std::move(bytes)};
  return std::unexpected(
      std::vector{scene::Problem{path.generic_string(), 1, "state", bytes.error().what,
                                 fmt::format("name a {}, or the folder of a result that holds one", file)}});
}

bool was_interrupted(const fs::path& out, const StateSought& sought) {
  const auto text = scene::read_file(out / "summary.json");
  if (!text) return false;
  const auto summary = nlohmann::json::parse(*text, nullptr, false);
  if (!summary.is_object() || summary.value("scene_sha256", "") != sought.sha256 ||
      summary.value("title", "") != sought.title) {
    return false;
  }
  const auto seed = summary.find("seed");
  if (sought.seed && seed != summary.end() && *seed != *sought.seed) return false;
  const auto section = summary.find(sought.section);
  return section != summary.end() && section->is_object() && section->value("reason", "").starts_with("interrupted at");
}

}  // namespace

FoundState find_state(const std::string& resume, const std::string& out, const StateSought& sought) {
  std::error_code reason;
  if (!resume.empty()) {
    const fs::path from{resume};
    return read_state(fs::is_directory(from, reason) ? from / sought.file : from, sought.file);
  }
  const fs::path folder{out};
  if (!was_interrupted(folder, sought)) return std::nullopt;
  return read_state(folder / sought.file, sought.file);
}

std::function<bool()> stop_between_steps(InterruptWatch& interrupts) {
  return [&interrupts, begun = false]() mutable {
    if (!std::exchange(begun, true)) interrupts.ask_first(std::string{stops_after_this_step});
    return interrupts.asked();
  };
}

void say_interrupted(const std::string& why, const std::string& out) {
  std::fputs(fmt::format("cleave: {}; what is done is in {}; the same command goes on from there\n", why, out).c_str(),
             stderr);
}

}  // namespace cleave::cli
