#include "out_folder.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <stdio.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "cleave/exchange/exports.hpp"

namespace cleave::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 40> result_files{
    "summary.json",      "blocks.vtu",      "dangling.vtu",       "dangling.obj",         "key_blocks.csv",
    "survey.json",       "bolts.csv",       "load_cases.csv",     "report.html",          "log.txt",
    "bodies.vtu",        "sets.toml",       "bodies.pvd",         "realizations.csv",     "realizations.csv.part",
    "scene.toml",        "points.csv",      "support_blocks.csv", "combined_blocks.csv",  "maximum_blocks.csv",
    "contact.pvd",       "history.csv",     "bodies.csv",         "section.toml",         "stress.csv",
    "key_groups.csv",    "motion.csv",      "motion.pvd",         "supported_groups.csv", "contact.state",
    "motion.state",      "block_sizes.csv", "border_blocks.csv",  "flow_joints.csv",      "flow.vtu",
    "mapped_joints.csv", "flow_mesh.inp",   "flow_mesh.uge",      "flow_mesh.in",         "flow_mesh_heads.csv"};
/// One time of a moving scene: bodies_0000.vtu or contact_0000.vtu and on.
bool is_frame(std::string_view name) {
  const std::size_t head = name.starts_with("bodies_")    ? 7
                           : name.starts_with("contact_") ? 8
                           : name.starts_with("motion_")  ? 7
                                                          : 0;
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

/// Whether what follows ".cleave-" is a name of ours: PROCESS-NUMBER, perhaps on its way to be removed.
bool is_temporary_tail(std::string_view tail) {
  if (tail.ends_with(".dead")) tail.remove_suffix(5);
  return !tail.empty() && tail.find_first_not_of("0123456789-") == std::string_view::npos;
}

/// Takes away all that is in an open folder. Nothing is allocated, here or in the calls: what reads folders for us
/// (nftw, opendir) wants memory of its own, and this is called where there is none.
void empty_folder(int folder) noexcept {
  alignas(dirent64) std::array<std::byte, 4096> entries{};
  bool removed = true;
  while (removed) {  // the list moves while it is shortened: read again until nothing goes
    removed = false;
    if (::lseek(folder, 0, SEEK_SET) != 0) return;
    for (;;) {
      const ssize_t bytes = ::getdents64(folder, entries.data(), entries.size());
      if (bytes <= 0) break;
      for (std::size_t at = 0; at < static_cast<std::size_t>(bytes);) {
        const auto* const entry = reinterpret_cast<const dirent64*>(&entries.at(at));
        at += entry->d_reclen;
        const char* const name = static_cast<const char*>(entry->d_name);
        if (std::strcmp(name, ".") == 0 || std::strcmp(name, "..") == 0) continue;
        if (::unlinkat(folder, name, 0) == 0) {
          removed = true;
          continue;
        }
        const int below = ::openat(folder, name, O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
        if (below < 0) continue;
        empty_folder(below);
        ::close(below);
        removed = ::unlinkat(folder, name, AT_REMOVEDIR) == 0 || removed;
      }
    }
  }
}

/// Without an allocation and without exceptions: the library's own way ends the program when memory runs out. False
/// when something stays.
bool remove_tree(const char* folder) noexcept {
  const int open = ::open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
  if (open < 0) return errno == ENOENT;
  empty_folder(open);
  ::close(open);
  return ::rmdir(folder) == 0;
}

/// A descriptor that holds the lock of a folder, or -1 where it cannot be had (somebody's, or no locks there).
int lock_of(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
  if (descriptor < 0 || ::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return descriptor;
  ::close(descriptor);
  return -1;
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
  if (exchange_folders(fresh, old)) {
    (void)remove_tree(fresh.c_str());
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
  (void)remove_tree(aside.c_str());
  return {};
}

}  // namespace

bool exchange_folders(const fs::path& a, const fs::path& b) noexcept {
  return ::renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0;
}

void remove_abandoned(const fs::path& parent, const std::string& name) {
  constexpr std::string_view mark = ".cleave-";
  std::error_code reason;
  std::vector<fs::path> found;
  for (fs::directory_iterator entry{parent, reason}; !reason && entry != fs::directory_iterator{};
       entry.increment(reason)) {
    const std::string here = entry->path().filename().string();
    const std::size_t at = here.rfind(mark);
    if (at == std::string::npos || !here.starts_with(name) || at < name.size()) continue;
    if (is_temporary_tail(std::string_view{here}.substr(at + mark.size()))) found.push_back(entry->path());
  }
  for (const fs::path& folder : found) {
    const int lock = lock_of(folder);
    if (lock < 0) continue;
    (void)remove_tree(folder.c_str());
    ::close(lock);
  }
}

std::expected<TemporaryFolder, std::error_code> TemporaryFolder::make(const fs::path& base) {
  remove_abandoned(base.parent_path(), base.filename().string());
  std::error_code reason;
  constexpr int enough = 1000;  // runs of one process number whose folders could not be removed
  for (int number = 0; number < enough; ++number) {
    // Whatever takes memory comes before the folder is there.
    TemporaryFolder folder{fmt::format("{}.cleave-{}-{}", base.string(), ::getpid(), number), -1};
    if (!fs::create_directory(folder.path_, reason)) {
      folder.release();
      if (reason) return std::unexpected(reason);
      continue;
    }
    folder.lock_ = lock_of(folder.path_);
    // Between the two calls another run may have taken it for abandoned.
    if (fs::is_directory(folder.path_, reason)) return folder;
    folder.release();
  }
  return std::unexpected(std::make_error_code(std::errc::file_exists));
}

TemporaryFolder::TemporaryFolder(fs::path path, int lock)
    : path_{std::move(path)}, dead_{path_.string() + ".dead"}, lock_{lock} {}

TemporaryFolder::TemporaryFolder(TemporaryFolder&& other) noexcept
    : path_{std::exchange(other.path_, {})},
      dead_{std::exchange(other.dead_, {})},
      lock_{std::exchange(other.lock_, -1)} {}

TemporaryFolder::~TemporaryFolder() {
  remove();
  if (lock_ >= 0) ::close(lock_);
}

void TemporaryFolder::remove() noexcept {
  if (path_.empty()) return;
  // Renamed first: a writer that is still at work then finds no folder and cannot bring the old name back. What stays
  // (a file was made meanwhile) may go with a second try; if not, the next run takes it away.
  const bool renamed = std::rename(path_.c_str(), dead_.c_str()) == 0;
  const char* const now = renamed ? dead_.c_str() : path_.c_str();
  if (!remove_tree(now)) (void)remove_tree(now);
}

bool is_result_file(const std::string& name) {
  if (std::ranges::find(result_files, name) != result_files.end() || is_export(name)) return true;
  if (name.starts_with("blocks_stage_") && name.ends_with(".vtu")) return true;
  if (name.starts_with("sets_") && name.ends_with(".csv")) return true;
  if (name.starts_with("section_") && name.ends_with(".toml")) return true;
  if (name.starts_with("flow_mesh_") && name.ends_with(".ex")) return true;
  constexpr std::string_view copy = "scene_file_";
  return name.starts_with(copy) && name.size() > copy.size() &&
         name.find_first_not_of("0123456789", copy.size()) == std::string::npos;
}

namespace {

/// A folder that is empty, or holds a finished result and no file of anybody else.
bool holds_a_result_only(const fs::path& folder) {
  std::error_code reason;
  bool any = false;
  for (fs::directory_iterator entry{folder, reason}; !reason && entry != fs::directory_iterator{};
       entry.increment(reason)) {
    if (!is_result_entry(*entry)) return false;
    any = true;
  }
  return !reason && (!any || has_our_summary(folder));
}

}  // namespace

bool is_result_entry(const fs::directory_entry& entry) {
  std::error_code reason;
  const std::string name = entry.path().filename().string();
  if (is_result_file(name)) return entry.is_regular_file(reason);
  constexpr std::string_view replay = "realization_";
  return name.starts_with(replay) && name.size() > replay.size() &&
         name.find_first_not_of("0123456789", replay.size()) == std::string::npos && entry.is_directory(reason) &&
         holds_a_result_only(entry.path());
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
    remove_abandoned(target, "");
    if (auto allowed = may_be_replaced(target, out); !allowed) return std::unexpected(std::move(allowed).error());
  } else if (reason && itself.type() != fs::file_type::not_found) {
    return std::unexpected(failed(out, "cannot be looked at", reason, "check the path"));
  }
  auto made = make_parents(out, target.parent_path());
  if (!made) return std::unexpected(std::move(made).error());

  const fs::path here = fs::current_path(reason);
  const bool beside = !(exists && target == here);  // the shell stands in it: it must stay the same folder
  auto first = TemporaryFolder::make(beside ? target : target / "");
  if (first) return OutFolder{target, *std::move(first), std::move(*made)};
  const std::error_code why = first.error();
  if (exists && beside) {
    if (auto inside = TemporaryFolder::make(target / ""))
      return OutFolder{target, *std::move(inside), std::move(*made)};
  }
  for (auto it = made->rbegin(); it != made->rend(); ++it) fs::remove(*it, reason);
  return std::unexpected(
      failed(out, "cannot be written", why, "check its permissions and the space left, or name another folder"));
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
  temporary_.remove();
  for (auto it = made_.rbegin(); it != made_.rend(); ++it) fs::remove(*it, ignored);
}

std::expected<void, OutError> OutFolder::publish_file_by_file(const fs::path& from) {
  std::error_code reason;
  std::vector<fs::path> names;
  for (const auto& entry : fs::directory_iterator{from, reason}) names.push_back(entry.path().filename());
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
    fs::rename(from / name, final_ / name, reason);
    if (reason)
      return std::unexpected(failed(final_, "the result cannot be put there", reason, "check its permissions"));
  }
  fs::remove(from, reason);
  return {};
}

std::string OutFolder::by_final_name(std::string message) const {
  const std::string now = folder().string();
  if (const std::size_t at = message.find(now); at != std::string::npos) {
    message.replace(at, now.size(), final_name().string());
  }
  return message;
}

std::expected<void, OutError> OutFolder::publish() {
  std::error_code reason;
  const fs::path fresh = temporary_.path();
  const auto done = [this](std::expected<void, OutError> moved) {
    if (moved) {
      open_ = false;
      temporary_.release();
    }
    return moved;
  };
  if (fresh.parent_path() == final_) return done(publish_file_by_file(fresh));
  if (fs::exists(final_, reason)) {
    // What came into the folder while we worked is not ours to take away.
    if (auto allowed = may_be_replaced(final_, final_); !allowed) return allowed;
    reason = replace_folder(fresh, final_);
  } else {
    fs::rename(fresh, final_, reason);
  }
  if (reason == std::errc::cross_device_link || reason == std::errc::device_or_resource_busy) {
    // The folder is a file system of its own (a mounted volume): its files are replaced one by one.
    const fs::path inside = final_ / fresh.filename();
    fs::copy(fresh, inside, fs::copy_options::recursive, reason);
    if (!reason) {
      temporary_.remove();
      return done(publish_file_by_file(inside));
    }
  }
  if (reason) return std::unexpected(failed(final_, "the result cannot be put there", reason, "check its permissions"));
  return done({});
}

}  // namespace cleave::cli
