#include "context.hpp"

#include <algorithm>
#include <cmath>

#include "cleave/core/sha256.hpp"

namespace cleave::scene {

SetId Context::set_named(const std::string& name) {
  for (const SetId id : sets.ids()) {
    if (sets[id].name == name) return id;
  }
  return sets.push_back(NamedSet{.name = name, .properties = {}});
}

std::optional<LoadedFile> Context::file(const TableReader& table, std::string_view key) {
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

DipDirection Context::turned(double dip_direction) const {
  const double sum = std::fmod(dip_direction + north, 360.0);
  return DipDirection::degrees(sum < 0 ? sum + 360.0 : sum);
}

}  // namespace cleave::scene
