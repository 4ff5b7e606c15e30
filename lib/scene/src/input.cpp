#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "cleave/core/nearest.hpp"
#include "cleave/core/sha256.hpp"
#include "cleave/scene/common_keys.hpp"

namespace cleave::scene {

std::optional<LoadedFile> InputContext::file(const TableReader& table, std::string_view key) {
  const auto name = table.need_text(key);
  if (!name) return std::nullopt;
  if (name->empty() || name->find('\0') != std::string::npos) {
    table.error(key, "is not a file name", "give the name of a file, relative to the folder of the scene");
    return std::nullopt;
  }
  auto loaded = read_file(*name);
  if (!loaded) {
    table.error(key, loaded.error().what, loaded.error().remedy);
    return std::nullopt;
  }
  if (std::ranges::find(files, *name, &InputFile::name) == files.end()) {
    files.push_back({*name, sha256_hex(loaded->bytes), loaded->bytes.size()});
  }
  return std::move(*loaded);
}

DipDirection InputContext::turned(double dip_direction) const {
  const double sum = std::fmod(dip_direction + north, 360.0);
  return DipDirection::degrees(sum < 0 ? sum + 360.0 : sum);
}

Key declination_key() {
  static constexpr NumberRule rule{-180, false, 180, false, " degrees"};
  return {
      "declination", key::number(rule), "0",
      "degrees, added to all trends, strikes and dip directions of the file: of compasses that show magnetic north, "
      "positive to the east"};
}

void report_unused_joints(Problems& problems, std::uint32_t line, const std::string& name,
                          const std::vector<std::string_view>& names, std::string what, std::string otherwise) {
  const auto guess = nearest(name, names);
  problems.error(line, "joints." + name, std::move(what),
                 guess ? fmt::format("did you mean \"{}\"?", *guess) : std::move(otherwise));
}

std::string file_name_of(const std::string& shown) {
  const std::size_t slash = shown.find_last_of('/');
  return slash == std::string::npos ? shown : shown.substr(slash + 1);
}

}  // namespace cleave::scene
