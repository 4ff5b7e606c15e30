#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "cleave/geometry/orientation.hpp"
#include "cleave/geometry/predicates.hpp"
#include "cleave/io/joint_csv.hpp"
#include "cleave/scene/file_input.hpp"
#include "cleave/scene3d/bounds.hpp"
#include "mapped.hpp"

namespace cleave::scene {

using geometry::Vec3;
using std::string_view;

namespace {

/// The nearest point of a segment.
Vec3 nearest_on(Vec3 p, Vec3 from, Vec3 to) {
  const Vec3 along = to - from;
  const double square = dot(along, along);
  return from + (square > 0 ? std::clamp(dot(p - from, along) / square, 0.0, 1.0) : 0.0) * along;
}

double height_over(const dfn::MappedFace& face, Vec3 p) {
  return dot(normal_of(face), p - face.outline.corners().front());
}

}  // namespace

Vec3 normal_of(const dfn::MappedFace& face) { return normalized(area_vector(face.outline)); }

Length distance_to_border(const dfn::MappedFace& face, Vec3 p) {
  const auto corners = face.outline.corners();
  double nearest = norm(p - corners.front());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    nearest = std::min(nearest, norm(p - nearest_on(p, corners[i], corners[(i + 1) % corners.size()])));
  }
  return metres(nearest);
}

bool holds(const dfn::MappedFace& face, Vec3 p) {
  const Vec3 n = normal_of(face), some = std::abs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 right = normalized(cross(n, some)), up = cross(n, right);
  std::vector<Vec2> flat;
  for (const Vec3 corner : face.outline.corners()) flat.push_back({dot(corner - p, right), dot(corner - p, up)});
  return geometry::encloses(flat, {});
}

namespace {

/// What a plane may lie off its trace without a word.
constexpr double askew_degrees = 15;

/// Shorter traces are points.
constexpr Length shortest_trace = metres(1e-6);

class Rows final {
 public:
  Rows(Context& context, const TableReader& table, const std::vector<RandomSet>& joint_sets, MappedSettings& settings)
      : context_{context}, table_{table}, joint_sets_{joint_sets}, settings_{settings}, seen_{settings.seen} {
    for (const RandomSet& set : joint_sets_) {
      names_.emplace_back(context_.sets[set.set].name);
      longest_.push_back(dfn::longest_trace(set.law));
    }
    for (const std::string& name : settings_.faces) faces_.emplace_back(name);
    for (const std::string& name : settings_.holes) holes_.emplace_back(name);
  }

  void run() {
    const std::size_t before = context_.problems.errors();
    if (table_.has("traces")) read_traces();
    if (table_.has("picks")) read_picks();
    if (context_.problems.errors() == before) join();
  }

 private:
  void error(std::uint32_t line, string_view key, std::string what, std::string remedy) {
    context_.problems.error_in(file_, line, std::string{key}, std::move(what), std::move(remedy));
  }
  void note(std::uint32_t line, string_view key, std::string what, std::string remedy) {
    context_.problems.note_in(file_, line, std::string{key}, std::move(what), std::move(remedy));
  }
  static std::string cut(const std::string& name) { return name.substr(0, 60); }

  /// The rows of a file; what is wrong with it, and how its columns were read, is said.
  template <class Parse>
  auto rows_of(string_view key, Parse&& parse) {
    using Table = decltype(parse(string_view{}, string_view{}))::value_type;
    const auto loaded = context_.file(table_, key);
    if (!loaded) return std::optional<Table>{};
    file_ = loaded->shown;
    auto table = parse(loaded->bytes, loaded->shown);
    if (!table) {
      for (const io::ReadError& error : table.error()) report_read_error(context_.problems, error);
      return std::optional<Table>{};
    }
    for (const std::string& what : table->notes) note(1, "header", what, "");
    return std::optional<Table>{*std::move(table)};
  }

  /// Empty: not known. False after a report.
  bool set_of(const std::string& name, std::uint32_t line, std::optional<std::size_t>& set) {
    if (name.empty()) return true;
    const auto at = std::ranges::find(names_, name);
    if (at == names_.end()) {
      error(line, "set", fmt::format("\"{}\" is no [[joint_set]]", cut(name)),
            nearest_of(name, names_, "sets") + "; where the set is not known, leave the cell empty");
      return false;
    }
    set = static_cast<std::size_t>(at - names_.begin());
    if (settings_.sets[*set] != 0) return true;
    error(line, "set", fmt::format("\"{}\" is not among mapped.sets", cut(name)),
          "add it there, or leave out the row: joints of that set are drawn as if nothing had been seen");
    return false;
  }

  /// The joint that a row is of; empty after a report.
  std::optional<std::size_t> joint_of(const std::string& id, const std::optional<std::size_t>& set,
                                      std::uint32_t line) {
    const auto made = [&] {
      seen_.joints.push_back({.set = set});
      settings_.sources.push_back({id.empty() ? fmt::format("{}:{}", file_, line) : id, {}});
      return seen_.joints.size() - 1;
    };
    if (id.empty()) return made();
    const auto [at, added] = by_id_.try_emplace(id, seen_.joints.size());
    if (added) return made();
    std::optional<std::size_t>& known = seen_.joints[at->second].set;
    if (known && set && *known != *set) {
      const MappedRow& first = settings_.sources[at->second].rows.front();
      error(line, "joint",
            fmt::format("\"{}\" is of the set \"{}\", and of \"{}\" in {}:{}", cut(id), names_[*set], names_[*known],
                        first.file, first.line),
            "correct one of the sets, or give the joints different ids");
      return std::nullopt;
    }
    if (!known) known = set;
    return at->second;
  }

  [[nodiscard]] Vec3 normal_of_plane(const geometry::Attitude& plane) const {
    const DipDirection direction = context_.turned(plane.direction.degrees() + table_.value("declination"));
    return geometry::upward_normal({plane.dip, direction});
  }

  // ---- traces

  void read_traces() {
    const auto table =
        rows_of("traces", [](string_view bytes, string_view name) { return io::parse_trace_csv(bytes, name); });
    if (!table) return;
    for (const io::TraceRow& row : table->rows) add_trace(row);
    if (short_ > 0) {
      note(first_short_, "x1",
           fmt::format("{} of {} traces are shorter than mapped.shortest = {:g} m (this is the first) and left out",
                       short_, table->rows.size(), seen_.shortest.si()),
           "");
    }
    if (askew_ > 0) {
      note(first_askew_, "dip",
           fmt::format("{} of {} planes lie more than {:g} degrees off their traces (this is the first): they are "
                       "turned so that they hold them",
                       askew_, table->rows.size(), askew_degrees),
           "correct the plane or the trace; declination turns all planes");
    }
    if (at_border_ > 0) {
      note(1, "end1",
           fmt::format(
               "{} of {} ends of traces lie within {:g} m of the border of their face: their joints are taken to "
               "go on there",
               at_border_, 2 * table->rows.size(), seen_.error.si()),
           "say otherwise in the columns end1 and end2: ends or goes_on");
    }
  }

  /// By its name, or the one it lies on; empty after a report.
  std::optional<std::size_t> face_of(const io::TraceRow& row) {
    if (!row.face.empty()) {
      const auto at = std::ranges::find(faces_, row.face);
      if (at != faces_.end()) return static_cast<std::size_t>(at - faces_.begin());
      error(row.line, "face", fmt::format("\"{}\" is no [[mapped.face]]", cut(row.face)),
            nearest_of(row.face, faces_, "faces"));
      return std::nullopt;
    }
    const Vec3 middle = 0.5 * (row.ends[0] + row.ends[1]);
    const double error_m = seen_.error.si();
    std::optional<std::size_t> found;
    for (std::size_t f = 0; f < seen_.faces.size(); ++f) {
      const dfn::MappedFace& face = seen_.faces[f];
      const auto off = [&](Vec3 p) { return std::abs(height_over(face, p)) > error_m; };
      if (off(row.ends[0]) || off(row.ends[1])) continue;
      const Vec3 flat = middle - height_over(face, middle) * normal_of(face);
      if (!holds(face, flat) && distance_to_border(face, flat) > seen_.error) continue;
      if (found) {
        error(row.line, "face", fmt::format("lies on the faces \"{}\" and \"{}\"", faces_[*found], faces_[f]),
              "name one in the column face");
        return std::nullopt;
      }
      found = f;
    }
    if (!found) {
      error(row.line, "face", fmt::format("lies on no face within {:g} m", error_m),
            "name its face in the column face, correct the ends, or raise mapped.error");
    }
    return found;
  }

  /// An end in the plane of its face; empty after a report.
  std::optional<Vec3> end_on(const io::TraceRow& row, std::size_t end, std::size_t f) {
    const dfn::MappedFace& face = seen_.faces[f];
    const Vec3 p = row.ends[end];
    const double off = height_over(face, p);
    const std::string key = fmt::format("x{}", end + 1);
    if (std::abs(off) > seen_.error.si()) {
      error(row.line, key,
            fmt::format("end {} lies {:.3g} m off the plane of face \"{}\"", end + 1, std::abs(off), faces_[f]),
            "correct it or the face's corners, or raise mapped.error");
      return std::nullopt;
    }
    const Vec3 flat = p - off * normal_of(face);
    const Length border = distance_to_border(face, flat);
    if (!holds(face, flat) && border > seen_.error) {
      error(row.line, key, fmt::format("end {} lies {:.3g} m outside of face \"{}\"", end + 1, border.si(), faces_[f]),
            "correct it, let the face reach so far, or raise mapped.error");
      return std::nullopt;
    }
    const std::optional<bool> stated = row.goes_on.at(end);
    if (stated == true && border > seen_.error) {
      error(row.line, fmt::format("end{}", end + 1),
            fmt::format("goes on {:.3g} m from the border of face \"{}\"", border.si(), faces_[f]),
            "what hides the joint there is no part of the face: give its corners round what was seen, or write ends");
      return std::nullopt;
    }
    return flat;
  }

  /// The longest that a trace can be.
  [[nodiscard]] Length longest_of(const std::optional<std::size_t>& set) const {
    if (set) return longest_[*set];
    Length longest;
    for (std::size_t i = 0; i < longest_.size(); ++i) {
      if (settings_.sets[i] != 0) longest = std::max(longest, longest_[i]);
    }
    return longest;
  }

  void add_trace(const io::TraceRow& row) {
    std::optional<std::size_t> set;
    if (!set_of(row.set, row.line, set)) return;
    const auto face = face_of(row);
    if (!face) return;
    const auto first = end_on(row, 0, *face), second = end_on(row, 1, *face);
    if (!first || !second) return;
    const Length length = metres(norm(*second - *first));
    if (length < shortest_trace) return error(row.line, "x2", "is where the trace begins", "give both ends");
    if (const Length longest = longest_of(set); length > longest + seen_.error) {
      return error(
          row.line, "x2",
          fmt::format("makes a trace of {:.4g} m, and joints of {} leave none longer than {:.4g} m", length.si(),
                      set ? fmt::format("set \"{}\"", names_[*set]) : "the mapped sets", longest.si()),
          "raise the largest size of the set (size.max), give the joint as a [[joint]], or correct the row");
    }
    if (length < seen_.shortest) {
      if (short_++ == 0) first_short_ = row.line;
      return;
    }
    const auto joint = joint_of(row.joint, set, row.line);
    if (!joint) return;
    dfn::MappedTrace trace{.face = *face, .ends = {*first, *second}};
    for (std::size_t e = 0; e < 2; ++e) {
      const bool near = distance_to_border(seen_.faces[*face], trace.ends.at(e)) <= seen_.error;
      trace.goes_on.at(e) = row.goes_on.at(e).value_or(near);
      if (!row.goes_on.at(e) && near) ++at_border_;
    }
    if (row.plane) {
      trace.normal = normal_of_plane(*row.plane);
      const double sine = std::abs(dot(*trace.normal, (*second - *first) / length.si()));
      if (sine > std::sin(dfn::Rotation::degrees(askew_degrees).radians()) && askew_++ == 0) first_askew_ = row.line;
    }
    const auto [same, added] = traces_.try_emplace(key_of(trace), MappedRow{file_, row.line});
    if (!added) {
      return error(row.line, "x1", fmt::format("is the trace of line {} again", same->second.line), "remove one");
    }
    seen_.joints[*joint].traces.push_back(trace);
    settings_.sources[*joint].rows.push_back({file_, row.line});
  }

  // ---- picks

  void read_picks() {
    const auto table =
        rows_of("picks", [](string_view bytes, string_view name) { return io::parse_pick_csv(bytes, name); });
    if (!table) return;
    for (const io::PickRow& row : table->rows) add_pick(row);
  }

  std::optional<std::size_t> hole_of(const io::PickRow& row) {
    if (row.hole.empty() && holes_.size() == 1) return 0;
    const auto at = std::ranges::find(holes_, row.hole);
    if (at != holes_.end()) return static_cast<std::size_t>(at - holes_.begin());
    error(row.line, "hole",
          row.hole.empty() ? "is not given" : fmt::format("\"{}\" is no [[mapped.hole]]", cut(row.hole)),
          nearest_of(row.hole, holes_, "holes"));
    return std::nullopt;
  }

  /// Where in the hole it is; empty after a report.
  std::optional<Vec3> place_of(const io::PickRow& row, std::size_t h) {
    const dfn::MappedHole& hole = seen_.holes[h];
    const double length = norm(hole.to - hole.from), error_m = seen_.error.si();
    if (row.depth) {
      const double depth = row.depth->si();
      if (depth >= -error_m && depth <= length + error_m) {
        return hole.from + (std::clamp(depth, 0.0, length) / length) * (hole.to - hole.from);
      }
      error(row.line, "depth", fmt::format("is {:g} m, and hole \"{}\" is {:.6g} m long", depth, holes_[h], length),
            "correct it, or the ends of the hole");
      return std::nullopt;
    }
    const Vec3 at = nearest_on(*row.position, hole.from, hole.to);
    const double off = norm(*row.position - at);
    if (off <= error_m) return at;
    error(row.line, "x", fmt::format("lies {:.3g} m off hole \"{}\"", off, holes_[h]),
          "correct it or the hole, or raise mapped.error");
    return std::nullopt;
  }

  void add_pick(const io::PickRow& row) {
    std::optional<std::size_t> set;
    if (!set_of(row.set, row.line, set)) return;
    const auto hole = hole_of(row);
    if (!hole) return;
    const auto at = place_of(row, *hole);
    if (!at) return;
    const auto joint = joint_of(row.joint, set, row.line);
    if (!joint) return;
    std::vector<dfn::MappedPick>& picks = seen_.joints[*joint].picks;
    if (std::ranges::find(picks, *hole, &dfn::MappedPick::hole) != picks.end()) {
      return error(row.line, "joint",
                   fmt::format("\"{}\" was picked in hole \"{}\" before", cut(row.joint), holes_[*hole]),
                   "a plane meets a straight hole once: give the joints different ids");
    }
    dfn::MappedPick pick{.hole = *hole, .at = *at};
    if (row.plane) pick.normal = normal_of_plane(*row.plane);
    picks.push_back(pick);
    settings_.sources[*joint].rows.push_back({file_, row.line, true});
  }

  // ---- joints round corners

  /// Traces that meet at the border of two faces become those of one joint; the rows go with them.
  void join() {
    const std::vector<std::size_t> now = dfn::join_round_corners(seen_);
    const std::size_t joined = now.size() - seen_.joints.size();
    if (joined == 0) return;
    std::vector<MappedSettings::Source> sources(seen_.joints.size());
    for (std::size_t j = 0; j < now.size(); ++j) {
      MappedSettings::Source& into = sources[now[j]];
      MappedSettings::Source& own = settings_.sources[j];
      if (into.rows.empty()) into.name = own.name;
      std::ranges::move(own.rows, std::back_inserter(into.rows));
    }
    settings_.sources = std::move(sources);
    context_.problems.note_in(
        traces_.begin()->second.file, 1, "joint",
        fmt::format("{} at the border of two faces joined: those of one joint that goes round it",
                    joined == 1 ? "a pair of traces is" : fmt::format("{} pairs of traces are", joined)),
        "traces that end there say so in the columns end1 and end2: ends");
  }

  using Key = std::array<double, 7>;
  static Key key_of(const dfn::MappedTrace& t) {
    const auto& [a, b] = t.ends;
    return {static_cast<double>(t.face), a.x, a.y, a.z, b.x, b.y, b.z};
  }

  Context& context_;
  const TableReader& table_;
  const std::vector<RandomSet>& joint_sets_;
  MappedSettings& settings_;
  dfn::Mapping& seen_;
  std::vector<string_view> names_, faces_, holes_;
  std::vector<Length> longest_;
  std::string file_;
  std::map<std::string, std::size_t, std::less<>> by_id_;
  std::map<Key, MappedRow> traces_;
  std::size_t short_ = 0, at_border_ = 0, askew_ = 0;
  std::uint32_t first_short_ = 0, first_askew_ = 0;
};

}  // namespace

void parse_mapped_rows(Context& context, const TableReader& table, const std::vector<RandomSet>& joint_sets,
                       MappedSettings& settings) {
  Rows{context, table, joint_sets, settings}.run();
}

}  // namespace cleave::scene
