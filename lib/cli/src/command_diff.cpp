#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string_view>
#include <type_traits>
#include <vector>

#include "commands.hpp"
#include "say.hpp"

namespace cleave::cli {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

/// A row of key_blocks.csv: what is compared of it.
struct KeyRow {
  std::string block, mode, key, batch;
  double volume = 0;
  std::string factor;
  std::array<std::string, 3> place = {};  ///< of the centroid; empty in results of older programs
};
template <class V, class Row>
  requires std::same_as<std::remove_const_t<Row>, KeyRow>
void fields(V& v, Row& x) {
  v("block", x.block);
  v("mode", x.mode);
  v("key", x.key);
  v("batch", x.batch);
  v("volume_m3", x.volume);
  v("factor_of_safety", x.factor);
  v("x_m", x.place[0]);
  v("y_m", x.place[1]);
  v("z_m", x.place[2]);
}

/// What the order of sums does to the last digits is no change.
bool same_number(double a, double b) {
  constexpr double last_digits = 1e-9;
  if (!std::isfinite(a) || !std::isfinite(b)) return a == b;
  return std::abs(a - b) <= last_digits * std::max(std::abs(a), std::abs(b));
}
bool same_number(const std::string& a, const std::string& b) {
  return a == b ||
         (!a.empty() && !b.empty() && same_number(std::strtod(a.c_str(), nullptr), std::strtod(b.c_str(), nullptr)));
}

struct Result {
  std::string name;
  Json summary;
  std::vector<KeyRow> rows;
};

std::optional<std::string> text_of(const fs::path& path) {
  std::error_code reason;
  if (!fs::is_regular_file(path, reason)) return std::nullopt;
  std::ifstream file{path, std::ios::binary};
  if (!file) return std::nullopt;
  std::string text{std::istreambuf_iterator<char>{file}, std::istreambuf_iterator<char>{}};
  if (file.bad()) return std::nullopt;
  return text;
}

std::vector<std::string> split(std::string_view line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else if (c != '\r') {
      fields.back() += c;
    }
  }
  return fields;
}

/// Fills a row from a line of a table, by the names in its header; what the table has not stays as it is.
struct RowReader {
  const std::vector<std::string>& header;
  const std::vector<std::string>& line;

  void operator()(std::string_view name, std::string& x) const {
    const auto at = static_cast<std::size_t>(std::ranges::find(header, name) - header.begin());
    if (at < std::min(header.size(), line.size())) x = line[at];
  }
  void operator()(std::string_view name, double& x) const {
    std::string text;
    (*this)(name, text);
    x = std::strtod(text.c_str(), nullptr);
  }
};

std::vector<KeyRow> key_rows(std::string_view csv) {
  std::vector<KeyRow> rows;
  std::vector<std::string> header;
  while (!csv.empty()) {
    const std::size_t end = std::min(csv.find('\n'), csv.size());
    const auto line = split(csv.substr(0, end));
    csv.remove_prefix(std::min(end + 1, csv.size()));
    if (header.empty()) {
      header = line;
      continue;
    }
    KeyRow row;
    const RowReader reader{header, line};
    fields(reader, row);
    if (!row.block.empty()) rows.push_back(std::move(row));
  }
  return rows;
}

std::optional<Result> read_result(const std::string& name) {
  const fs::path folder{name};
  const auto refuse = [&](const std::string& what) {
    print_error(fmt::format("{}:1: OUT: {}; name the folder of a finished run of cleave", name, what));
    return std::nullopt;
  };
  const auto text = text_of(folder / "summary.json");
  if (!text) return refuse("holds no summary.json that can be read");
  Result result{name, Json::parse(*text, nullptr, false), {}};
  if (result.summary.is_discarded() || !result.summary.is_object() || !result.summary.contains("cleave")) {
    return refuse("summary.json is not one of cleave");
  }
  if (const auto csv = text_of(folder / "key_blocks.csv")) result.rows = key_rows(*csv);
  return result;
}

const Json& member(const Json& object, std::string_view key) {
  static const Json nothing;
  const auto at = object.find(key);
  return at == object.end() ? nothing : *at;
}

std::string shown(const Json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); }

/// One line a difference, by path. Numbers with the change; costs are not compared.
void compare(const std::string& path, const Json& a, const Json& b, std::vector<std::string>& lines) {
  if (a == b || path == "monte_carlo.notes") return;  // those stand among the notes of the result
  if (a.is_object() && b.is_object()) {
    for (const auto& [key, value] : a.items()) {
      const std::string inner = path.empty() ? key : path + "." + key;
      if (b.contains(key)) {
        compare(inner, value, b.at(key), lines);
      } else {
        lines.push_back(fmt::format("  {:<44} only in the first", inner));
      }
    }
    for (const auto& [key, value] : b.items()) {
      if (!a.contains(key)) {
        lines.push_back(fmt::format("  {:<44} only in the second", path.empty() ? key : path + "." + key));
      }
    }
    return;
  }
  if (a.is_array() && b.is_array()) {
    const std::size_t common = std::min(a.size(), b.size());
    for (std::size_t i = 0; i < common; ++i) compare(fmt::format("{}[{}]", path, i + 1), a[i], b[i], lines);
    if (a.size() != b.size()) {
      lines.push_back(fmt::format("  {:<44} {} entries -> {}", path, a.size(), b.size()));
    }
    return;
  }
  if (a.is_number() && b.is_number()) {
    const double x = a.get<double>(), y = b.get<double>();
    if ((a.is_number_float() || b.is_number_float()) && same_number(x, y)) return;
    // Both are rounding beside the whole.
    if ((path.contains("relative") || path.contains("residual")) && same_number(1 + x, 1 + y)) return;
    const std::string share = x != 0 ? fmt::format(", {:+.3g} %", 100 * (y - x) / std::abs(x)) : std::string{};
    lines.push_back(fmt::format("  {:<44} {} -> {} ({:+.6g}{})", path, a.dump(), b.dump(), y - x, share));
    return;
  }
  lines.push_back(fmt::format("  {:<44} {} -> {}", path, shown(a), shown(b)));
}

/// Files of the same name whose bytes differ.
std::string changed_files(const Json& a, const Json& b) {
  std::string text;
  for (const Json& file : member(a, "files")) {
    for (const Json& other : member(b, "files")) {
      if (member(file, "path") != member(other, "path") || member(file, "sha256") == member(other, "sha256")) continue;
      text += fmt::format("  {} is not the same file in both\n", shown(member(file, "path")));
    }
  }
  return text;
}

std::string compare_plans(const Json& a, const Json& b) {
  const auto entries = [](const Json& plan) {
    std::map<std::string, std::pair<bool, std::string>> out;
    if (!plan.is_array()) return out;
    for (const Json& row : plan) {
      if (row.is_object() && row.contains("stage")) {
        out[shown(row["stage"])] = {member(row, "run") == true, shown(member(row, "why"))};
      }
    }
    return out;
  };
  std::string text;
  const auto first = entries(a), second = entries(b);
  for (const auto& [stage, left] : first) {
    const auto at = second.find(stage);
    if (at == second.end() || at->second == left) continue;
    const auto said = [](const std::pair<bool, std::string>& p) {
      return fmt::format("{} ({})", p.first ? "runs" : "left out", p.second);
    };
    text += fmt::format("  {:<12} {} -> {}\n", stage, said(left), said(at->second));
  }
  return text;
}

/// The notes of a result. Older ensembles have theirs in `monte_carlo`; what has none at all is of an older program.
std::optional<std::vector<std::string>> notes_in(const Json& summary) {
  const Json* list = &member(summary, "notes");
  if (list->is_null()) list = &member(member(summary, "monte_carlo"), "notes");
  if (!list->is_array()) return std::nullopt;
  std::vector<std::string> notes;
  for (const Json& note : *list) notes.push_back(shown(note));
  return notes;
}

/// A note without the places in files ("scene.toml:12") that it names: the same note of another scene.
std::string without_places(std::string_view note) {
  std::string out;
  while (!note.empty()) {
    const std::string_view word = note.substr(0, note.find(' '));
    note.remove_prefix(std::min(word.size() + 1, note.size()));
    const std::size_t end = word.find_last_not_of(":),;") + 1,
                      digits = word.substr(0, end).find_last_not_of("0123456789");
    const bool place = digits != std::string_view::npos && digits + 1 < end && word[digits] == ':';
    if (!place) out.append(word) += ' ';
  }
  return out;
}

/// The same without its figures.
std::string words_of(std::string_view note) {
  std::string words;
  for (const char c : without_places(note)) {
    const bool digit = c >= '0' && c <= '9';
    if (!digit) words += c;
    if (digit && !words.ends_with('#')) words += '#';
  }
  return words;
}

/// Notes that came or went; those in which a figure alone is another stand as changed.
std::string compare_notes(const Json& a, const Json& b) {
  auto gone = notes_in(a), come = notes_in(b);
  if (!gone || !come) {
    if (!gone && !come) return {};
    return fmt::format("  only the {} was written with its notes\n", gone ? "first" : "second");
  }
  const auto take = [&](const auto& alike, std::string* changed) {
    std::erase_if(*gone, [&](const std::string& note) {
      const auto at = std::ranges::find_if(*come, [&](const std::string& other) { return alike(note, other); });
      if (at == come->end()) return false;
      if (changed != nullptr) *changed += fmt::format("    {}\n    -> {}\n", note, *at);
      come->erase(at);
      return true;
    });
  };
  std::string changed, text;
  take([](const std::string& x, const std::string& y) { return without_places(x) == without_places(y); }, nullptr);
  take([](const std::string& x, const std::string& y) { return words_of(x) == words_of(y); }, &changed);
  const auto list = [&](std::string_view what, const std::vector<std::string>& notes) {
    if (!notes.empty()) text += fmt::format("  {} ({}):\n", what, notes.size());
    for (const std::string& note : notes) text += fmt::format("    {}\n", note);
  };
  list("only in the first", *gone);
  list("only in the second", *come);
  if (!changed.empty()) text += "  with other figures:\n" + changed;
  return text;
}

/// One block by where its centroid lies: numbers of blocks hang on the order of the joints, and blocks of one volume
/// are many.
bool at_one_place(const KeyRow& a, const KeyRow& b) {
  for (std::size_t i = 0; i < a.place.size(); ++i) {
    if (a.place[i].empty() || b.place[i].empty()) continue;
    const double x = std::strtod(a.place[i].c_str(), nullptr), y = std::strtod(b.place[i].c_str(), nullptr);
    if (!same_number(x, y) && std::abs(x - y) > 1e-6 * std::cbrt(a.volume)) return false;
  }
  return true;
}

/// Rows of the second result that no block of the first has taken, by volume.
class Waiting final {
 public:
  explicit Waiting(const std::vector<KeyRow>& rows) {
    for (const KeyRow& row : rows) rows_.emplace(row.volume, &row);
  }
  /// The row of the same block; of several alike the one with its number.
  const KeyRow* take(const KeyRow& row) {
    auto found = rows_.end();
    for (auto at = rows_.lower_bound(row.volume * (1 - 2e-9)); at != rows_.end(); ++at) {
      if (at->first > row.volume && !same_number(at->first, row.volume)) break;
      if (!same_number(at->first, row.volume) || !at_one_place(row, *at->second)) continue;
      if (found == rows_.end() || at->second->block == row.block) found = at;
    }
    if (found == rows_.end()) return nullptr;
    const KeyRow* taken = found->second;
    rows_.erase(found);
    return taken;
  }
  [[nodiscard]] bool holds(const KeyRow& row) const {
    const auto [first, last] = rows_.equal_range(row.volume);
    return std::any_of(first, last, [&](const auto& entry) { return entry.second == &row; });
  }

 private:
  std::multimap<double, const KeyRow*> rows_;
};

/// Blocks are the same where volume and centroid are.
std::string compare_key_blocks(const Result& a, const Result& b) {
  Waiting waiting{b.rows};
  constexpr std::size_t shown_rows = 20;
  std::vector<std::string> gone, come, changed;
  const auto line = [](const KeyRow& row) {
    return say("    block {block}, {volume_m3:.6g} m3, {mode}, batch ", row) +
           (row.batch.empty() ? "none (stays)" : row.batch) + say(", factor of safety {factor_of_safety}\n", row);
  };
  const auto state = [](const KeyRow& row) {
    return say("{mode}, batch ", row) + (row.batch.empty() ? "none" : row.batch) +
           say(", factor {factor_of_safety}", row);
  };
  for (const KeyRow& row : a.rows) {
    const KeyRow* other = waiting.take(row);
    if (other == nullptr) {
      gone.push_back(line(row));
      continue;
    }
    if (row.mode == other->mode && row.key == other->key && row.batch == other->batch &&
        same_number(row.factor, other->factor)) {
      continue;
    }
    const std::string renumbered = row.block == other->block ? "" : fmt::format(" ({} in the second)", other->block);
    changed.push_back(say("    block {block}", row) + renumbered + say(", {volume_m3:.6g} m3: ", row) + state(row) +
                      " -> " + state(*other) + "\n");
  }
  for (const KeyRow& row : b.rows) {
    if (waiting.holds(row)) come.push_back(line(row));
  }
  std::string text;
  const auto list = [&](std::string_view what, const std::vector<std::string>& lines) {
    if (lines.empty()) return;
    text += fmt::format("  {} ({}):\n", what, lines.size());
    for (std::size_t i = 0; i < std::min(shown_rows, lines.size()); ++i) text += lines[i];
    if (lines.size() > shown_rows) text += fmt::format("    and {} more\n", lines.size() - shown_rows);
  };
  list("only in the first", gone);
  list("only in the second", come);
  list("changed", changed);
  return text;
}

}  // namespace

ExitCode diff_results(const std::string& first, const std::string& second) {
  const auto a = read_result(first), b = read_result(second);
  if (!a || !b) return ExitCode::wrong_input;
  std::string text = fmt::format("first   {}\nsecond  {}\n", first, second);
  bool differ = false;
  const auto section = [&](std::string_view title, const std::string& lines) {
    if (lines.empty()) return;
    differ = true;
    text += fmt::format("{}\n{}", title, lines);
  };
  // What has lines of its own, and what never says that results differ.
  std::set<std::string_view> seen{"plan", "cost", "realization_cost", "scene_file", "notes"};
  const auto figures = [&](std::string_view title, const std::vector<std::string_view>& keys) {
    std::string lines;
    for (const std::string_view key : keys) {
      seen.insert(key);
      std::vector<std::string> found;
      const Json &x = member(a->summary, key), &y = member(b->summary, key);
      if (x.is_null() != y.is_null()) {
        found.push_back(fmt::format("  {:<44} only in the {}", key, y.is_null() ? "first" : "second"));
      } else {
        compare(std::string{key}, x, y, found);
      }
      for (const std::string& line : found) lines += line + "\n";
    }
    section(title, lines);
  };
  figures("scene", {"cleave", "schema", "title", "seed", "scene_sha256", "input"});
  section("input files", changed_files(member(a->summary, "input"), member(b->summary, "input")));
  section("plan", compare_plans(member(a->summary, "plan"), member(b->summary, "plan")));
  figures("blocks", {"blocks", "dangling"});
  figures("key blocks", {"key_blocks"});
  section("key blocks, one by one", compare_key_blocks(*a, *b));
  figures("stages", {"sequence"});
  figures("support", {"support"});
  std::vector<std::string_view> others;
  for (const Json* summary : {&a->summary, &b->summary}) {
    for (const auto& [key, value] : summary->items()) {
      if (!seen.contains(key) && std::ranges::find(others, key) == others.end()) others.emplace_back(key);
    }
  }
  figures("other results", others);
  section("notes", compare_notes(a->summary, b->summary));
  if (!differ) text += "no difference in scene, plan, counts, volumes, key blocks and notes\n";
  print(text);
  return ExitCode::done;
}

}  // namespace cleave::cli
