#include "cleave/stochastic/record.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <fstream>
#include <memory>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/core/overloaded.hpp"

namespace cleave::stochastic {
namespace {

SystemFailure failure() { return {std::generic_category().message(errno)}; }

std::expected<void, RecordFileError> write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return std::unexpected(failure());
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return {};
}

bool take(std::string_view& text, std::string_view word) {
  if (!text.starts_with(word)) return false;
  text.remove_prefix(word.size());
  return true;
}
std::string_view take_word(std::string_view& text) {
  const std::size_t end = std::min(text.find(' '), text.size());
  const std::string_view word = text.substr(0, end);
  text.remove_prefix(end);
  return word;
}
bool take_number(std::string_view& text, std::uint64_t& value) {
  const char* const end = std::to_address(text.end());
  const auto [stop, failed] = std::from_chars(std::to_address(text.begin()), end, value);
  if (failed != std::errc{}) return false;
  text.remove_prefix(static_cast<std::size_t>(stop - text.data()));
  return true;
}

std::optional<RunIdentity> identity_of(std::string_view line) {
  RunIdentity id;
  if (!take(line, "# cleave ")) return std::nullopt;
  id.version = take_word(line);
  if (!take(line, " monte_carlo 2 scene ")) return std::nullopt;
  id.scene_sha256 = take_word(line);
  const bool good = take(line, " seed ") && take_number(line, id.seed) && take(line, " shard ") &&
                    take_number(line, id.shard.number) && take(line, "/") && take_number(line, id.shard.of) &&
                    line.empty() && id.shard.number >= 1 && id.shard.number <= id.shard.of;
  return good ? std::optional{id} : std::nullopt;
}

}  // namespace

std::string header_of(const RunIdentity& id) {
  return fmt::format("# cleave {} monte_carlo 2 scene {} seed {} shard {}/{}", id.version, id.scene_sha256, id.seed,
                     id.shard.number, id.shard.of);
}

std::expected<RecordFile, RecordFileError> RecordFile::open(const std::filesystem::path& path,
                                                            const RunIdentity& identity) {
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0) return std::unexpected(failure());
  RecordFile file{descriptor, identity.shard};
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) return std::unexpected(InUse{});
    return std::unexpected(failure());
  }
  // Whole lines from the front on are kept; the first that is not whole ends the file.
  std::ifstream in{path, std::ios::binary};
  const std::string header = header_of(identity), columns{record_columns()};
  std::string line;
  std::uint64_t kept = 0, number = 0;
  while (std::getline(in, line) && !in.eof()) {  // eof: no line end
    if (number == 0 && line != header) return std::unexpected(OtherRun{line, header});
    if (number == 1 && line != columns) break;
    if (number >= 2) {
      const auto record = record_of(line);
      if (!record || record->realization != file.next_realization()) break;
      ++file.records_;
    }
    kept += line.size() + 1;
    ++number;
  }
  if (number < 2) {
    // Nothing but perhaps a piece of the header: begin anew.
    kept = 0;
    file.records_ = 0;
  }
  if (::ftruncate(descriptor, static_cast<off_t>(kept)) != 0) return std::unexpected(failure());
  if (::lseek(descriptor, 0, SEEK_END) < 0) return std::unexpected(failure());
  if (kept == 0) CLEAVE_CHECK(write_all(descriptor, header + "\n" + columns + "\n"));
  return file;
}

RecordFile::RecordFile(RecordFile&& other) noexcept
    : descriptor_{std::exchange(other.descriptor_, -1)}, shard_{other.shard_}, records_{other.records_} {}

RecordFile::~RecordFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::expected<void, RecordFileError> RecordFile::append(const Record& record) {
  CLEAVE_CHECK(write_all(descriptor_, line_of(record) + "\n"));
  ++records_;
  return {};
}

std::expected<void, RecordFileError> RecordFile::flush_to_disk() const {
  if (::fsync(descriptor_) != 0 && errno != EINVAL && errno != EROFS) return std::unexpected(failure());
  return {};
}

std::expected<RunIdentity, RecordFileError> read_records(
    const std::filesystem::path& path, const std::function<bool(const Record&, std::string_view line)>& use) {
  std::ifstream in{path, std::ios::binary};
  if (!in) return std::unexpected(SystemFailure{path.string() + " cannot be opened"});
  std::string line;
  std::uint64_t number = 1;
  const auto next = [&] { return static_cast<bool>(std::getline(in, line)); };
  if (!next()) return std::unexpected(Unreadable{number});
  const auto identity = identity_of(line);
  if (!identity) return std::unexpected(Unreadable{number});
  ++number;
  if (!next() || line != record_columns()) return std::unexpected(Unreadable{number});
  while (next()) {
    ++number;
    const auto record = record_of(line);
    if (!record) return std::unexpected(Unreadable{number});
    if (!use(*record, line)) break;
  }
  return *identity;
}

std::string describe(const RecordFileError& error) {
  return std::visit(
      overloaded{
          [](const OtherRun& e) {
            return fmt::format(
                "holds an unfinished Monte Carlo run of another scene, seed, shard or version (\"{}\", not "
                "\"{}\"); name another folder, or remove this one",
                e.found.substr(0, 300), e.wanted);
          },
          [](InUse) {
            return std::string{"another cleave is at work in it; wait for its end, or name another folder"};
          },
          [](const Unreadable& e) {
            return fmt::format("line {} is not what cleave wrote; restore the file or run again", e.line);
          },
          [](const SystemFailure& e) {
            return fmt::format("the records cannot be read or written ({}); check the disk and its permissions",
                               e.reason);
          },
      },
      error);
}

}  // namespace cleave::stochastic
