#include "unoriented.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "cleave/core/special.hpp"

namespace cleave::survey::detail {

double SharedOut::effective(std::size_t set) const {
  const auto own = static_cast<double>(known[set]);
  const auto all = static_cast<double>(std::accumulate(known.begin(), known.end(), std::size_t{0}));
  return 1 / (1 / own - 1 / all + 1 / (all + static_cast<double>(unknown) - left));
}

SharedOut share_out(const std::vector<SetsOnLine>& lines, const std::vector<std::vector<double>>& length) {
  const std::size_t sets = length.size();
  SharedOut out{std::vector<std::size_t>(sets), std::vector<double>(sets)};
  std::vector<double> unknown(lines.size());
  for (std::size_t l = 0; l < lines.size(); ++l) {
    for (const auto& set : lines[l]) {
      if (set) {
        ++out.known[*set];
      } else {
        unknown[l] += 1;
        ++out.unknown;
      }
    }
  }
  if (out.unknown == 0) return out;
  std::vector<double> whole(sets);
  for (std::size_t k = 0; k < sets; ++k) whole[k] = std::accumulate(length[k].begin(), length[k].end(), 0.0);
  constexpr int most_rounds = 2000;
  for (int round = 0; round < most_rounds; ++round) {
    std::vector<double> next(sets);
    out.left = 0;
    for (std::size_t l = 0; l < lines.size(); ++l) {
      if (unknown[l] == 0) continue;
      std::vector<double> met(sets);
      for (std::size_t k = 0; k < sets; ++k) {
        if (whole[k] > 0) met[k] = (static_cast<double>(out.known[k]) + out.shared[k]) / whole[k] * length[k][l];
      }
      const double all = std::accumulate(met.begin(), met.end(), 0.0);
      if (!(all > 0)) out.left += unknown[l];
      for (std::size_t k = 0; k < sets && all > 0; ++k) next[k] += unknown[l] * met[k] / all;
    }
    double change = 0;
    for (std::size_t k = 0; k < sets; ++k) change = std::max(change, std::abs(next[k] - out.shared[k]));
    out.shared = std::move(next);
    if (change < 1e-9 * static_cast<double>(out.unknown)) break;
  }
  return out;
}

std::optional<std::string> unoriented_note(const LineSurvey& line, const SetsOnLine& sets, const SharedOut& shared) {
  std::size_t without = 0, of_a_set = 0;
  for (std::size_t i = 0; i < line.positions.size(); ++i) {
    if (i < line.joints.size() && line.joints[i]) continue;
    ++without;
    of_a_set += sets[i] ? 1U : 0U;
  }
  if (without == 0) return std::nullopt;
  std::string note = fmt::format("line {}: {} of {} joints have no orientation: they count for its frequency and RQD",
                                 line.name, without, line.positions.size());
  if (of_a_set > 0) note += fmt::format("; {} of them for the set that is stated or the only one", of_a_set);
  if (of_a_set == without) return note;
  const bool any = std::ranges::any_of(shared.shared, [](double share) { return share > 0; });
  return note + (any ? fmt::format("; {} are shared out among the sets", without - of_a_set)
                     : fmt::format("; {} of them for no set: none of known set was met", without - of_a_set));
}

Estimate counted(double joints, double effective, double confidence) {
  const double tail = (1 - confidence) / 2, scale = joints / (2 * effective);
  return {"",
          joints,
          scale * special::chi_squared_quantile(tail, 2 * effective),
          scale * special::chi_squared_quantile(1 - tail, 2 * effective + 2),
          "",
          ""};
}

}  // namespace cleave::survey::detail
