#include "cleave/survey/analyse.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis.hpp"
#include "set_laws.hpp"

namespace cleave::survey {
namespace detail {

SurveyResult Analysis::run() {
  weigh();
  assign();
  for (std::size_t k = 0; k < out_.sets.size(); ++k) orient(k);
  assign_traces();
  assign_on_lines();
  for (std::size_t k = 0; k < out_.sets.size(); ++k) {
    if (const SetRule* rule = rule_of(out_.sets[k])) out_.sets[k].shape = rule->shape;
    lines(k);
    windows(k);
    caution_of_windows(out_.sets[k], truncation_of_windows(k));
    line_lengths(k);
    choose(k);
  }
  whole();
  return std::move(out_);
}

void Analysis::choose(std::size_t k) {
  SetResult& set = out_.sets[k];
  recorded_on_lines(set);
  if (set.size_mean && set.size_mean->value && !bounded(*set.size_mean)) {
    set.notes.push_back("size: " + (set.size_mean->note.empty() ? "no interval" : set.size_mean->note));
  }
  set.p32 = set.p32_windows && set.p32_windows->value ? set.p32_windows : set.p32_lines;
  if (set.p32_lines && set.p32_windows && set.p32_windows->value &&
      (set.p32_lines->low > set.p32_windows->high || set.p32_windows->low > set.p32_lines->high)) {
    set.notes.emplace_back(
        "P32 of lines and of windows disagree beyond their intervals: the disc model or the sets do "
        "not fit");
  }
  if (set.mean_length && set.mean_length->value && set.size_mean && set.size_mean->value) {
    const double traces = *set.mean_length->value, sizes = *set.size_mean->value;
    constexpr double far = 5;
    if (traces > far * sizes || sizes > far * traces) {
      set.notes.push_back(fmt::format(
          "the mean trace, {:.3g} m, and the mean size under the {} law, {:.3g} m, disagree {:.0f} times: most "
          "joints "
          "of that law are too small to be seen here, so mean size and P30 hang on the law alone; E L^2/E L does not",
          traces, name_of(set.size->family), sizes, std::max(traces / sizes, sizes / traces)));
    }
  }
  if (set.p32) return;
  set.notes.emplace_back(
      in_.lines.empty() && in_.windows.empty()
          ? "no [[scanline]], [[borehole]] or [[window]]: the intensity is not known, and sets.toml leaves the set out"
      : shared_.known[k] > 0
          ? "the lines run along the joints of this set (|n.l| = 0): they meet none but by chance; the intensity is "
            "not known, and sets.toml leaves the set out"
      : has_mean(set) ? "no joint on a line and no trace in a window is of this set: the intensity is not known, and "
                        "sets.toml leaves the set out"
                      : "its orientation is not known, so the intensity is not, and sets.toml leaves the set out");
}

void Analysis::whole() {
  for (std::size_t l = 0; l < in_.lines.size(); ++l) {
    out_.lines.push_back(result_of(in_.lines[l], in_.confidence));
    if (out_.sets.empty()) continue;
    if (auto note = unoriented_note(in_.lines[l], line_sets_[l], shared_)) {
      out_.notes.push_back(*std::move(note));
    }
  }
  for (std::size_t w = 0; w < in_.windows.size(); ++w) {
    out_.windows.push_back(result_of(in_.windows[w], seen_[w], in_.confidence));
    std::optional<std::string> of_no_set;
    if (!out_.sets.empty()) of_no_set = no_set_note(in_.windows[w], seen_[w], trace_set_[w]);
    for (auto note : {outside_note(in_.windows[w], seen_[w].size()), of_no_set, border_note(in_.windows[w])}) {
      if (note) out_.notes.push_back(*std::move(note));
    }
  }
}

Estimate Analysis::over_orientations(const SetResult& set,
                                     const std::function<double(geometry::Vec3, double)>& figure) const {
  return detail::over_orientations(set.orientation, figure, in_.confidence);
}

}  // namespace detail

SurveyResult analyse(const SurveyInput& input) { return detail::Analysis{input}.run(); }

}  // namespace cleave::survey
