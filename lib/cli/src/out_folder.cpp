#include "out_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "cleave/report/exports.hpp"

namespace cleave::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 24> result_files{
    "summary.json", "blocks.vtu",  "dangling.vtu",       "dangling.obj",        "key_blocks.csv",
    "survey.json",  "bolts.csv",   "load_cases.csv",     "report.html",         "log.txt",
    "bodies.vtu",   "sets.toml",   "bodies.pvd",         "realizations.csv",    "realizations.csv.part",
    "scene.toml",   "points.csv",  "support_blocks.csv", "combined_blocks.csv", "maximum_blocks.csv",
    "contact.pvd",  "history.csv", "bodies.csv",         "section.toml"};
/// One time of a moving scene: bodies_0000.vtu or contact_0000.vtu and on.
bool is_frame(std::string_view name) {
  const std::size_t head = name.starts_with("bodies_") ? 7 : name.starts_with("contact_") ? 8 : 0;
  if (head == 0 || !name.ends_with(".vtu") || name.size() < head + 8) return false;
  const std::string_view digits = name.substr(head, name.size() - head - 4);
  return digits.size() >= 4 && std::ranges::all_of(digits, [](char c) { return c >= '0' && c <= '9'; });
}
bool is_export(std::string_view name) {
  return is_frame(name) || std::ranges::any_of(report::export_names(), [&](const report::ExportName& format) {
           return name == "blocks" + std::string{format.ending};
         });
}

OutError wrong(const fs::path& out, std::string_view what, std::string_view remedy) {
  return {ExitCode::wrong_input, fmt::format("{}:1: -o: {}; {}", out.generic_string(), what, remedy)};
}
OutError failed(const fs::path& out, std::string_view what, const std::error_code& reason, std::string_view remedy) {
  return {ExitCode::machine_failed,
          fmt::format("{}:1: -o: {} ({}); {}", out.generic_string(), what, reason.message(), remedy)};
}

/// Whether summary.json (or survey.json) is one of ours. Only its head is looked at: it is written whole or not at all.
bool has_our_summary(const fs::path& folder) {
  std::error_code ignored;
  const bool survey = !fs::exists(folder / "summary.json", ignored);
  std::ifstream file{folder / (survey ? "survey.json" : "summary.json"), std::ios::binary};
  std::array<char, 256> head{};
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  const std::string_view text{head.data(), static_cast<std::size_t>(file.gcount())};
  return text.find("\"cleave\"") != std::string_view::npos;
}

std::expected<void, OutError> may_be_replaced(const fs::path& folder, const fs::path& out) {
  std::error_code reason;
  fs::directory_iterator entries{folder, reason};
  if (reason) return std::unexpected(failed(out, "the folder cannot be read", reason, "check its permissions"));
  bool any = false;
  for (; entries != fs::directory_iterator{}; entries.increment(reason)) {
    if (reason) return std::unexpected(failed(out, "the folder cannot be read", reason, "check its permissions"));
    any = true;
    const std::string name = entries->path().filename().string();
    if (is_result_entry(*entries)) continue;
    return std::unexpected(wrong(out, fmt::format("the folder holds \"{}\", which is not from cleave", name),
                                 "name a new or an empty folder with -o"));
  }
  if (any && !has_our_summary(folder)) {
    return std::unexpected(
        wrong(out, "the folder holds files but no finished result of cleave", "name a new or an empty folder with -o"));
  }
  return {};
}

/// Makes the missing folders above; the ones it made are listed so that they can be taken away again.
std::expected<std::vector<fs::path>, OutError> make_parents(const fs::path& out, const fs::path& parent) {
  std::vector<fs::path> missing;
  std::error_code reason;
  for (fs::path at = parent; !at.empty() && !fs::exists(at, reason); at = at.parent_path()) {
    missing.push_back(at);
    if (at == at.parent_path()) break;
  }
  std::ranges::reverse(missing);
  std::vector<fs::path> made;
  for (const fs::path& folder : missing) {
    if (fs::create_directory(folder, reason)) {
      made.push_back(folder);
      continue;
    }
    if (!reason) continue;  // somebody else made it meanwhile
    for (auto it = made.rbegin(); it != made.rend(); ++it) {
      std::error_code ignored;
      fs::remove(*it, ignored);
    }
    return std::unexpected(
        failed(out, "the folder above it cannot be made", reason, "check the path and its permissions"));
  }
  return made;
}

/// Swaps two names in one step; where the file system cannot, the old one steps aside for a moment.
std::error_code replace_folder(const fs::path& fresh, const fs::path& old) {
  if (::renameat2(AT_FDCWD, fresh.c_str(), AT_FDCWD, old.c_str(), RENAME_EXCHANGE) == 0) {
    std::error_code ignored;
    fs::remove_all(fresh, ignored);
    return {};
  }
  const fs::path aside = fresh.string() + ".old";
  std::error_code reason;
  fs::rename(old, aside, reason);
  if (reason) return reason;
  fs::rename(fresh, old, reason);
  std::error_code ignored;
  if (reason) {
    fs::rename(aside, old, ignored);
    return reason;
  }
  fs::remove_all(aside, ignored);
  return {};
}

}  // namespace

bool is_result_file(const std::string& name) {
  if (std::ranges::find(result_files, name) != result_files.end() || is_export(name)) return true;
  if (name.starts_with("blocks_stage_") && name.ends_with(".vtu")) return true;
  if (name.starts_with("sets_") && name.ends_with(".csv")) return true;
  if (name.starts_with("section_") && name.ends_with(".toml")) return true;
  constexpr std::string_view copy = "scene_file_";
  return name.starts_with(copy) && name.size() > copy.size() &&
         name.find_first_not_of("0123456789", copy.size()) == std::string::npos;
}

bool is_result_entry(const fs::directory_entry& entry) {
  std::error_code reason;
  const std::string name = entry.path().filename().string();
  if (is_result_file(name)) return entry.is_regular_file(reason);
  constexpr std::string_view replay = "realization_";
  return name.starts_with(replay) && name.size() > replay.size() &&
         name.find_first_not_of("0123456789", replay.size()) == std::string::npos && entry.is_directory(reason) &&
         (has_our_summary(entry.path()) || fs::is_empty(entry.path(), reason));
}

std::expected<OutFolder, OutError> OutFolder::prepare(const fs::path& out) {
  std::error_code reason;
  if (out.empty()) return std::unexpected(wrong("-o", "the name is empty", "name a folder"));
  const fs::file_status itself = fs::symlink_status(out, reason);
  const bool exists = fs::exists(itself);
  fs::path target = fs::absolute(out, reason).lexically_normal();
  if (!target.has_filename()) target = target.parent_path();  // "out/" is "out"
  if (exists) {
    target = fs::canonical(out, reason);
    if (reason) return std::unexpected(wrong(out, "is a link to nothing", "name a folder"));
    if (!fs::is_directory(target, reason))
      return std::unexpected(wrong(out, "is not a folder", "name a new folder with -o"));
    if (auto allowed = may_be_replaced(target, out); !allowed) return std::unexpected(std::move(allowed).error());
  } else if (reason && itself.type() != fs::file_type::not_found) {
    return std::unexpected(failed(out, "cannot be looked at", reason, "check the path"));
  }
  auto made = make_parents(out, target.parent_path());
  if (!made) return std::unexpected(std::move(made).error());

  const std::string tag = fmt::format(".cleave-{}", ::getpid());
  const fs::path here = fs::current_path(reason);
  const bool beside = !(exists && target == here);  // the shell stands in it: it must stay the same folder
  const fs::path first = beside ? fs::path{target.string() + tag} : target / tag;
  if (fs::create_directory(first, reason)) return OutFolder{target, first, std::move(*made)};
  const std::error_code first_reason = reason;
  if (exists && beside && fs::create_directory(target / tag, reason))
    return OutFolder{target, target / tag, std::move(*made)};
  OutFolder nothing{target, {}, std::move(*made)};  // takes the folders above away again
  return std::unexpected(failed(out, "cannot be written",
                                first_reason ? first_reason : std::make_error_code(std::errc::file_exists),
                                "check its permissions and the space left, or name another folder"));
}

OutFolder::OutFolder(OutFolder&& other) noexcept
    : final_{std::move(other.final_)},
      temporary_{std::move(other.temporary_)},
      made_{std::move(other.made_)},
      open_{std::exchange(other.open_, false)} {}

OutFolder::~OutFolder() { discard(); }

void OutFolder::discard() noexcept {
  if (!std::exchange(open_, false)) return;
  std::error_code ignored;
  if (!temporary_.empty()) {
    // Renamed first: a writer that is still at work then finds no folder and cannot bring the old name back.
    fs::path dead = temporary_;
    dead += ".dead";
    fs::rename(temporary_, dead, ignored);
    fs::remove_all(ignored ? temporary_ : dead, ignored);
  }
  for (auto it = made_.rbegin(); it != made_.rend(); ++it) fs::remove(*it, ignored);
}

std::expected<void, OutError> OutFolder::publish_file_by_file() {
  std::error_code reason;
  std::vector<fs::path> names;
  for (const auto& entry : fs::directory_iterator{temporary_, reason}) names.push_back(entry.path().filename());
  // The summary says that a result is whole: the old one goes first, the new one comes last.
  std::ranges::sort(names, {}, [](const fs::path& name) {
    return std::pair{name == "summary.json" || name == "survey.json", name.string()};
  });
  fs::remove(final_ / "summary.json", reason);
  fs::remove(final_ / "survey.json", reason);
  std::vector<fs::path> old;
  for (const auto& entry : fs::directory_iterator{final_, reason}) {
    if (is_result_entry(entry)) old.push_back(entry.path());
  }
  for (const fs::path& path : old) fs::remove_all(path, reason);
  for (const fs::path& name : names) {
    fs::rename(temporary_ / name, final_ / name, reason);
    if (reason)
      return std::unexpected(failed(final_, "the result cannot be put there", reason, "check its permissions"));
  }
  fs::remove(temporary_, reason);
  return {};
}

std::expected<void, OutError> OutFolder::publish() {
  std::error_code reason;
  if (temporary_.parent_path() == final_) {
    auto moved = publish_file_by_file();
    if (moved) open_ = false;
    return moved;
  }
  if (fs::exists(final_, reason)) {
    // What came into the folder while we worked is not ours to take away.
    if (auto allowed = may_be_replaced(final_, final_); !allowed) return allowed;
    reason = replace_folder(temporary_, final_);
  } else {
    fs::rename(temporary_, final_, reason);
  }
  if (reason == std::errc::cross_device_link || reason == std::errc::device_or_resource_busy) {
    // The folder is a file system of its own (a mounted volume): its files are replaced one by one.
    const fs::path inside = final_ / temporary_.filename();
    fs::copy(temporary_, inside, fs::copy_options::recursive, reason);
    if (!reason) {
      fs::remove_all(std::exchange(temporary_, inside), reason);
      auto moved = publish_file_by_file();
      if (moved) open_ = false;
      return moved;
    }
  }
  if (reason) return std::unexpected(failed(final_, "the result cannot be put there", reason, "check its permissions"));
  open_ = false;
  return {};
}

}  // namespace cleave::cli
