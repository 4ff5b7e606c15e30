#include "cleave/core/archive.hpp"

#include <fmt/format.h>

#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/core/sha256.hpp"

namespace cleave {

std::string sealed(std::string_view kind, std::uint32_t version, std::string_view bytes) {
  return fmt::format("{} {}\n{}\n{}", kind, version, sha256_hex(bytes), bytes);
}

std::expected<std::string_view, SavedFault> unsealed(std::string_view kind, std::uint32_t version,
                                                     std::string_view text) {
  constexpr std::size_t digits = 64;
  if (!text.starts_with(kind) || text.size() <= kind.size() || text[kind.size()] != ' ') {
    return std::unexpected(SavedFault::foreign);
  }
  text.remove_prefix(kind.size() + 1);
  const std::size_t line = text.substr(0, digits).find('\n');
  if (line == std::string_view::npos) return std::unexpected(SavedFault::damaged);
  if (text.substr(0, line) != fmt::format("{}", version)) return std::unexpected(SavedFault::other_version);
  text.remove_prefix(line + 1);
  if (text.size() <= digits || text[digits] != '\n') return std::unexpected(SavedFault::damaged);
  const std::string_view sum = text.substr(0, digits);
  text.remove_prefix(digits + 1);
  if (sha256_hex(text) != sum) return std::unexpected(SavedFault::damaged);
  return text;
}

std::expected<ArchiveReader, SavedFault> unsealed_of(std::string_view name, std::string_view kind,
                                                     std::uint32_t version, std::string_view text) {
  CLEAVE_TRY(const std::string_view bytes, unsealed(kind, version, text));
  ArchiveReader a{bytes};
  std::string own;
  a(own);
  if (!a.good()) return std::unexpected(SavedFault::damaged);
  if (own != name) return std::unexpected(SavedFault::other_world);
  return a;
}

std::string describe(SavedFault fault) {
  switch (fault) {
    case SavedFault::foreign: return "is no saved world";
    case SavedFault::other_version: return "was saved by another version";
    case SavedFault::damaged: return "is cut short or damaged";
    case SavedFault::inconsistent: return "names parts that it does not have";
    case SavedFault::other_world: return "is of a world of other bodies, laws or gravity";
  }
  std::unreachable();
}

}  // namespace cleave
