#include "cleave/core/archive.hpp"

#include <fmt/format.h>

#include "cleave/core/overloaded.hpp"
#include "cleave/core/sha256.hpp"

namespace cleave {

std::string sealed(std::string_view kind, std::uint32_t version, std::string_view bytes) {
  return fmt::format("{} {}\n{}\n{}", kind, version, sha256_hex(bytes), bytes);
}

std::expected<std::string_view, SealFault> unsealed(std::string_view kind, std::uint32_t version,
                                                    std::string_view text) {
  constexpr std::size_t digits = 64;
  if (!text.starts_with(kind) || text.size() <= kind.size() || text[kind.size()] != ' ') {
    return std::unexpected(SealFault::foreign);
  }
  text.remove_prefix(kind.size() + 1);
  const std::size_t line = text.substr(0, digits).find('\n');
  if (line == std::string_view::npos) return std::unexpected(SealFault::damaged);
  if (text.substr(0, line) != fmt::format("{}", version)) return std::unexpected(SealFault::other_version);
  text.remove_prefix(line + 1);
  if (text.size() <= digits || text[digits] != '\n') return std::unexpected(SealFault::damaged);
  const std::string_view sum = text.substr(0, digits);
  text.remove_prefix(digits + 1);
  if (sha256_hex(text) != sum) return std::unexpected(SealFault::damaged);
  return text;
}

std::string describe(const SavedError& error) {
  return std::visit(overloaded{[](NoSavedWorld) { return "is no saved world"; },
                               [](SavedByOtherVersion) { return "was saved by another version"; },
                               [](DamagedWorld) { return "is cut short or damaged"; },
                               [](SavedOfOtherWorld) { return "is of a world of other bodies, laws or gravity"; }},
                    error);
}

SavedError saved_error_of(SealFault fault) {
  switch (fault) {
    case SealFault::foreign: return NoSavedWorld{};
    case SealFault::other_version: return SavedByOtherVersion{};
    case SealFault::damaged: return DamagedWorld{};
  }
  return DamagedWorld{};
}

}  // namespace cleave
