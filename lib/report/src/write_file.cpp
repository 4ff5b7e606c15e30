#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/core/overloaded.hpp"
#include "cleave/exchange/vtu_writer.hpp"
#include "cleave/report/write.hpp"

namespace cleave::report {
namespace {

namespace fs = std::filesystem;

std::string reason_of(int code) { return std::generic_category().message(code); }

WriteError begun_error(const fs::path& path, int code) {
  if (code == ENOSPC || code == EDQUOT || code == EFBIG) return NoSpace{path, reason_of(code)};
  return CannotWrite{path, reason_of(code)};
}

// Closes the descriptor and removes the file unless it was kept.
class Temporary final {
 public:
  Temporary(int descriptor, fs::path path) : descriptor_{descriptor}, path_{std::move(path)} {}
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;
  ~Temporary() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!path_.empty()) ::unlink(path_.c_str());
  }
  // 0, or the error number.
  [[nodiscard]] int write(std::string_view content) const {
    while (!content.empty()) {
      const ssize_t written = ::write(descriptor_, content.data(), content.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) return errno;
      content.remove_prefix(static_cast<std::size_t>(written));
    }
    return 0;
  }
  // Late errors (a full disk behind a cache) show up here at the latest.
  [[nodiscard]] int flush_and_close() {
    // Pipes and some network file systems have nothing to flush.
    if (::fsync(descriptor_) != 0 && errno != EINVAL && errno != EROFS) return errno;
    return ::close(std::exchange(descriptor_, -1)) == 0 ? 0 : errno;
  }
  void keep() { path_.clear(); }

 private:
  int descriptor_;
  fs::path path_;
};

}  // namespace

std::expected<void, WriteError> write_file(const fs::path& path, std::string_view content) {
  fs::path part = path;
  part += ".part";
  const int descriptor = ::open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    const int code = errno;
    if (code == ENOSPC || code == EDQUOT) return std::unexpected(NoSpace{path, reason_of(code)});
    return std::unexpected(CannotCreate{path, reason_of(code)});
  }
  Temporary file{descriptor, part};
  if (const int code = file.write(content)) return std::unexpected(begun_error(path, code));
  if (const int code = file.flush_and_close()) return std::unexpected(begun_error(path, code));
  if (std::rename(part.c_str(), path.c_str()) != 0) return std::unexpected(CannotCreate{path, reason_of(errno)});
  file.keep();
  return {};
}

std::string describe(const WriteError& error) {
  return std::visit(overloaded{
                        [](const CannotCreate& e) {
                          return e.path.string() + ": cannot be created (" + e.reason +
                                 "); choose a folder that you may write to, and move away what stands in its place";
                        },
                        [](const NoSpace& e) {
                          return e.path.string() + ": no room left to write it (" + e.reason +
                                 "); free some space or choose another disk";
                        },
                        [](const CannotWrite& e) {
                          return e.path.string() + ": cannot be written (" + e.reason +
                                 "); check the disk, or choose another one";
                        },
                    },
                    error);
}

std::expected<void, WriteError> write_frames(const fs::path& folder, const std::string& name, std::size_t frames,
                                             const std::function<double(std::size_t)>& time_of,
                                             const std::function<std::string(std::size_t)>& frame_vtu) {
  std::vector<std::pair<double, std::string>> series;
  for (std::size_t f = 0; f < frames; ++f) {
    series.emplace_back(time_of(f), frame_file(name, f));
    CLEAVE_CHECK(write_file(folder / series.back().second, frame_vtu(f)));
  }
  return write_file(folder / (name + ".pvd"), pvd(series));
}

}  // namespace cleave::report
