#include "includes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "cleave/core/sha256.hpp"

namespace cleave::scene {
namespace {

/// Where something stands.
struct Place {
  std::string file;
  std::uint32_t line;
};

std::string text_of(const Place& place) { return fmt::format("{}:{}", place.file, place.line); }

/// The names that `include` lists, and takes out of the scene; empty where there are none (reported when wrong).
std::vector<std::string> take_names(TomlTable& scene, Problems& problems, std::uint32_t& line) {
  const auto entry = std::ranges::find(scene.entries, "include", &TomlEntry::key);
  if (entry == scene.entries.end()) return {};
  line = entry->line;
  std::vector<std::string> names;
  if (const auto* list = std::get_if<TomlArray>(&entry->node.value)) {
    for (const TomlNode& item : list->items) {
      if (const auto* name = std::get_if<std::string>(&item.value)) names.push_back(*name);
    }
    if (names.size() != list->items.size()) names.clear();
  } else if (const auto* name = std::get_if<std::string>(&entry->node.value)) {
    names.push_back(*name);
  }
  if (names.empty()) {
    problems.error(line, "include", "is no list of file names", "write include = [\"sets.toml\"]");
    return {};
  }
  scene.entries.erase(entry);
  return names;
}

/// Files that the included one names lie beside it.
void move_files(TomlTable& table, const std::string& folder) {
  for (TomlEntry& entry : table.entries) {
    if (auto* text = std::get_if<std::string>(&entry.node.value); text != nullptr && entry.key == "file") {
      *text = folder + *text;
    }
    if (auto* deeper = std::get_if<TomlTable>(&entry.node.value)) move_files(*deeper, folder);
    if (auto* array = std::get_if<TomlArray>(&entry.node.value)) {
      for (TomlNode& item : array->items) {
        if (auto* deeper = std::get_if<TomlTable>(&item.value)) move_files(*deeper, folder);
      }
    }
  }
}

/// Puts parts of included files into the scene, and knows where each part came from.
class Joiner {
 public:
  Joiner(TomlTable& scene, Problems& problems) : scene_{&scene}, problems_{&problems} {
    for (const TomlEntry& entry : scene.entries) remember(entry, problems.file());
  }

  void take(TomlTable file, const std::string& shown) {
    for (TomlEntry& part : file.entries) {
      if (part.key != "joint_set" && part.key != "joint" && part.key != "joints") {
        problems_->error_in(shown, part.line, part.key, "may not stand in an included file",
                            "only [[joint_set]], [[joint]] and [joints.NAME] may");
        continue;
      }
      take(std::move(part), shown);
    }
  }

 private:
  void take(TomlEntry part, const std::string& shown) {
    const auto own = std::ranges::find(scene_->entries, part.key, &TomlEntry::key);
    if (own == scene_->entries.end()) {
      remember(part, shown);
      scene_->entries.push_back(std::move(part));
      return;
    }
    auto *list = std::get_if<TomlArray>(&own->node.value), *more = std::get_if<TomlArray>(&part.node.value);
    auto *tables = std::get_if<TomlTable>(&own->node.value), *beside = std::get_if<TomlTable>(&part.node.value);
    if (list != nullptr && more != nullptr) {
      remember(part, shown);
      std::ranges::move(more->items, std::back_inserter(list->items));
    } else if (tables != nullptr && beside != nullptr) {
      for (TomlEntry& entry : beside->entries) take_strength(tables->entries, std::move(entry), shown);
    } else {
      problems_->error_in(
          shown, part.line, part.key,
          fmt::format("is {}, and in {} it is {}", kind_of(part.node), problems_->file(), kind_of(own->node)),
          part.key == "joints" ? "write [joints.NAME]" : fmt::format("write [[{}]]", part.key));
    }
  }

  /// What the scene says of a set goes before what an included file says; two included files that say it are refused.
  void take_strength(std::vector<TomlEntry>& entries, TomlEntry entry, const std::string& shown) {
    const auto known = strengths_.find(entry.key);
    if (known == strengths_.end()) {
      strengths_.emplace(entry.key, Place{shown, entry.line});
      entries.push_back(std::move(entry));
      return;
    }
    const std::string path = "joints." + entry.key;
    if (known->second.file == problems_->file()) {
      problems_->note_in(shown, entry.line, path, fmt::format("is not used: {} states it too", text_of(known->second)),
                         "the scene goes before the files that it includes; remove one");
    } else {
      problems_->error_in(shown, entry.line, path, fmt::format("stands in {} as well", text_of(known->second)),
                          "keep one of them, or state it in the scene, which goes before both");
    }
  }

  void remember(const TomlEntry& part, const std::string& file) {
    if (part.key == "joint_set") remember_sets(part, file);
    if (part.key != "joints") return;
    const auto* tables = std::get_if<TomlTable>(&part.node.value);
    if (tables == nullptr) return;
    for (const TomlEntry& entry : tables->entries) strengths_.try_emplace(entry.key, Place{file, entry.line});
  }

  /// Joints of two sets of one name could not be told apart: neither by mean orientation nor by strength.
  void remember_sets(const TomlEntry& part, const std::string& file) {
    const auto* list = std::get_if<TomlArray>(&part.node.value);
    if (list == nullptr) return;
    for (const TomlNode& item : list->items) {
      ++sets_;
      const auto* table = std::get_if<TomlTable>(&item.value);
      if (table == nullptr) continue;
      const auto entry = std::ranges::find(table->entries, "name", &TomlEntry::key);
      const auto* name = entry == table->entries.end() ? nullptr : std::get_if<std::string>(&entry->node.value);
      if (name == nullptr) continue;
      const auto [known, fresh] = names_.try_emplace(*name, Place{file, entry->line});
      if (fresh) continue;
      problems_->error_in(
          file, entry->line, fmt::format("joint_set[{}].name", sets_),
          fmt::format("\"{}\" is the name of another joint set, {}", name->substr(0, 60), text_of(known->second)),
          "give each set a name of its own");
    }
  }

  TomlTable* scene_;
  Problems* problems_;
  std::map<std::string, Place> strengths_, names_;
  std::size_t sets_ = 0;
};

}  // namespace

std::vector<InputFile> take_includes(TomlTable& scene, Problems& problems, const ReadFile& read_file) {
  std::vector<InputFile> files;
  std::uint32_t line = 1;
  const std::vector<std::string> names = take_names(scene, problems, line);
  Joiner joiner{scene, problems};
  for (const std::string& name : names) {
    const auto file = read_file(name);
    if (!file) {
      problems.error(line, "include", file.error().what, file.error().remedy);
      continue;
    }
    const std::string sum = sha256_hex(file->bytes);
    if (const auto same = std::ranges::find(files, sum, &InputFile::sha256); same != files.end()) {
      problems.error(line, "include",
                     same->name == name ? fmt::format("names {} twice: each of its joints would be there twice", name)
                                        : fmt::format("{} and {} hold the same", same->name, name),
                     "name it once");
      continue;
    }
    files.push_back({name, sum, file->bytes.size()});
    auto tree = read_toml(file->bytes);
    if (!tree) {
      problems.error_in(file->shown, tree.error().line, "TOML", tree.error().what, tree.error().remedy);
      continue;
    }
    const std::size_t slash = name.find_last_of('/');
    move_files(*tree, slash == std::string::npos ? "" : name.substr(0, slash + 1));
    joiner.take(std::move(*tree), file->shown);
  }
  return files;
}

}  // namespace cleave::scene
