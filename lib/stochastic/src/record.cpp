#include "cleave/stochastic/record.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <memory>
#include <span>
#include <system_error>
#include <utility>

#include "record_parts.hpp"

namespace cleave::stochastic {
namespace {

/// CRC-32 (IEEE 802.3), bit by bit: lines are short.
std::uint32_t crc32(std::string_view text) {
  std::uint32_t crc = ~0U;
  for (const char c : text) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0xedb88320U : 0U);
  }
  return ~crc;
}

template <class Number>
void append(std::string& out, Number value) {
  std::array<char, 32> text{};
  const auto done = std::to_chars(text.data(), std::to_address(text.end()), value);
  out.append(text.data(), done.ptr);
}

class Writer final {
 public:
  template <class Number>
  void number(Number value) {
    if (!out_.empty()) out_ += ',';
    append(out_, value);
  }
  template <class Number>
  void list(std::span<const Number> values) {
    if (!out_.empty()) out_ += ',';
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (i > 0) out_ += ' ';
      append(out_, values[i]);
    }
  }
  /// "bin:count" of what is not zero.
  void sizes(const SizeHistogram& histogram) {
    out_ += ',';
    bool first = true;
    for (std::size_t bin = 0; bin < SizeHistogram::bins; ++bin) {
      const std::uint32_t count = histogram.counts()[bin];
      if (count == 0) continue;
      if (!std::exchange(first, false)) out_ += ' ';
      append(out_, bin);
      out_ += ':';
      append(out_, count);
    }
  }
  void tally(const Tally& t) {
    number(t.count);
    number(t.volume_m3);
    number(t.largest_m3);
    number(t.support_n);
    number(t.support_transferred_n);
    for (const auto mode : t.modes) number(mode);
    for (const auto shape : t.shapes) number(shape);
    number(t.concave);
    number(t.sphericity_sum);
    sizes(t.sizes);
  }
  [[nodiscard]] std::string finish() && {
    std::array<char, 16> text{};
    const auto done = std::to_chars(text.data(), std::to_address(text.end()), crc32(out_), 16);
    out_ += ',';
    out_.append(text.data(), done.ptr);
    return std::move(out_);
  }

 private:
  std::string out_;
};

class Reader final {
 public:
  explicit Reader(std::string_view text) : rest_{text} {}
  template <class Number>
  void number(Number& value) {
    parse(field(), value);
  }
  template <class Number>
  void list(std::vector<Number>& values) {
    std::string_view text = field();
    while (good_ && !text.empty()) {
      const std::size_t blank = std::min(text.find(' '), text.size());
      values.emplace_back();
      parse(text.substr(0, blank), values.back());
      text.remove_prefix(std::min(blank + 1, text.size()));
    }
  }
  void sizes(SizeHistogram& histogram) {
    std::string_view text = field();
    while (good_ && !text.empty()) {
      const std::size_t blank = std::min(text.find(' '), text.size());
      const std::string_view item = text.substr(0, blank);
      const std::size_t colon = item.find(':');
      std::size_t bin = 0;
      std::uint32_t count = 0;
      good_ = colon != std::string_view::npos;
      if (good_) {
        parse(item.substr(0, colon), bin);
        parse(item.substr(colon + 1), count);
      }
      good_ = good_ && bin < SizeHistogram::bins;
      if (good_) histogram.set(bin, count);
      text.remove_prefix(std::min(blank + 1, text.size()));
    }
  }
  void tally(Tally& t) {
    number(t.count);
    number(t.volume_m3);
    number(t.largest_m3);
    number(t.support_n);
    number(t.support_transferred_n);
    for (auto& mode : t.modes) number(mode);
    for (auto& shape : t.shapes) number(shape);
    number(t.concave);
    number(t.sphericity_sum);
    sizes(t.sizes);
  }
  [[nodiscard]] bool good() const { return good_ && ended_; }

 private:
  std::string_view field() {
    if (ended_) good_ = false;
    const std::size_t comma = rest_.find(',');
    const std::string_view text = rest_.substr(0, comma);
    ended_ = comma == std::string_view::npos;
    rest_ = ended_ ? std::string_view{} : rest_.substr(comma + 1);
    return text;
  }
  template <class Number>
  void parse(std::string_view text, Number& value) {
    const char* const end = std::to_address(text.end());
    const auto [stop, failed] = std::from_chars(std::to_address(text.begin()), end, value);
    good_ = good_ && failed == std::errc{} && stop == end;
  }

  std::string_view rest_;
  bool good_ = true, ended_ = false;
};

}  // namespace

std::size_t SizeHistogram::bin_of(double volume) noexcept {
  const double at = volume > 0 ? std::floor((std::log10(volume) - lowest_exponent) * per_decade) : 0.0;
  return static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(bins - 1)));
}

void SizeHistogram::add(double volume) noexcept { ++counts_[bin_of(volume)]; }

double SizeHistogram::edge(std::size_t bin) noexcept {
  return std::pow(10.0, lowest_exponent + static_cast<double>(bin) / per_decade);
}

std::string_view record_columns() noexcept {
  return "realization,outcome,joints,blocks,rock_m3,concave_blocks,batches,stopped_at_max_batches,surface_blocks,"
         "surface_blocks_fixed,key_beside_fixed_m3,free_m2,free_fixed_m2,middle_m2,middle_fixed_m2,largest_pressure_pa,"
         "factors,"
         "count,volume_m3,largest_m3,support_n,support_transferred_n,falling,lifting,sliding,wedge,tetrahedral,"
         "pentahedral,hexahedral,higher,other,concave,sphericity_sum,sizes,"
         "first_count,first_volume_m3,first_largest_m3,first_support_n,first_support_transferred_n,first_falling,"
         "first_lifting,first_sliding,first_wedge,first_tetrahedral,first_pentahedral,first_hexahedral,first_higher,"
         "first_other,first_concave,first_sphericity_sum,first_sizes,above,chainage_m3,support,orders,groups,clamped,"
         "border,whole,whole_bins,sets,lines,cases,tapered,at_parts,cases_lifting,flow,supported_stages,"
         "turning,at_target,crc32";
}

std::string line_of(const Record& r) {
  Writer w;
  w.number(r.realization);
  w.number(static_cast<unsigned>(r.outcome));
  w.number(r.joints);
  w.number(r.blocks);
  w.number(r.rock_m3);
  w.number(r.concave_blocks);
  w.number(r.batches);
  w.number(r.stopped_at_max_batches ? 1U : 0U);
  w.number(r.surface_blocks);
  w.number(r.surface_blocks_fixed);
  w.number(r.key_beside_fixed_m3);
  for (const double value : {r.free_m2, r.free_fixed_m2, r.middle_m2, r.middle_fixed_m2, r.largest_pressure_pa})
    w.number(value);
  w.list(std::span{r.factors});
  w.tally(r.all);
  w.tally(r.first);
  w.list(std::span{r.above});
  w.list(std::span{r.chainage_m3});
  for (const std::vector<double>& numbers : {numbers_of(r.support), numbers_of(r.orders), numbers_of(r.groups),
                                             numbers_of(r.clamped), numbers_of(r.border)}) {
    w.list(std::span{numbers});
  }
  const std::vector<double> whole = numbers_of(r.whole), sets = numbers_of(r.sets), lines = numbers_of(r.lines),
                            cases = numbers_of(r.cases), tapered = numbers_of(r.tapered),
                            at_parts = numbers_of(r.at_parts), flow = numbers_of(r.flow),
                            stages = numbers_of(r.supported_stages);
  const std::vector<float> bins = bins_of(r.whole);
  w.list(std::span{whole});
  w.list(std::span{bins});
  w.list(std::span{sets});
  w.list(std::span{lines});
  w.list(std::span{cases});
  w.list(std::span{tapered});
  w.list(std::span{at_parts});
  std::vector<std::uint64_t> lifting;
  for (const CaseTally& c : r.cases) lifting.push_back(c.lifting);
  w.list(std::span{std::as_const(lifting)});
  w.list(std::span{flow});
  w.list(std::span{stages});
  // Of the base case and of each load case, where it was asked.
  std::vector<std::uint64_t> turning;
  if (r.turning) turning.push_back(*r.turning);
  for (const CaseTally& c : r.cases) {
    if (c.turning) turning.push_back(*c.turning);
  }
  w.list(std::span{std::as_const(turning)});
  std::vector<double> at_target = numbers_of(r.at_target);
  for (const CaseTally& c : r.cases) std::ranges::copy(numbers_of(c.at_target), std::back_inserter(at_target));
  w.list(std::span{std::as_const(at_target)});
  return std::move(w).finish();
}

std::optional<Record> record_of(std::string_view line) {
  const std::size_t last = line.rfind(',');
  if (last == std::string_view::npos) return std::nullopt;
  std::uint32_t stated = 0;
  const std::string_view sum = line.substr(last + 1);
  const char* const end = std::to_address(sum.end());
  const auto [stop, failed] = std::from_chars(std::to_address(sum.begin()), end, stated, 16);
  if (failed != std::errc{} || stop != end || stated != crc32(line.substr(0, last))) return std::nullopt;
  Reader r{line.substr(0, last)};
  Record record;
  unsigned outcome = 0, stopped = 0;
  r.number(record.realization);
  r.number(outcome);
  r.number(record.joints);
  r.number(record.blocks);
  r.number(record.rock_m3);
  r.number(record.concave_blocks);
  r.number(record.batches);
  r.number(stopped);
  r.number(record.surface_blocks);
  r.number(record.surface_blocks_fixed);
  r.number(record.key_beside_fixed_m3);
  for (double* value : {&record.free_m2, &record.free_fixed_m2, &record.middle_m2, &record.middle_fixed_m2,
                        &record.largest_pressure_pa})
    r.number(*value);
  r.list(record.factors);
  r.tally(record.all);
  r.tally(record.first);
  r.list(record.above);
  r.list(record.chainage_m3);
  std::vector<double> support, orders, groups, clamped, border, whole, sets, lines, cases, tapered, at_parts, flow,
      stages;
  std::vector<float> bins;
  std::vector<std::uint64_t> lifting, turning;
  std::vector<double> at_target;
  r.list(support);
  r.list(orders);
  r.list(groups);
  r.list(clamped);
  r.list(border);
  r.list(whole);
  r.list(bins);
  r.list(sets);
  r.list(lines);
  r.list(cases);
  r.list(tapered);
  r.list(at_parts);
  r.list(lifting);
  r.list(flow);
  r.list(stages);
  r.list(turning);
  r.list(at_target);
  if (!take(support, record.support) || !take(orders, record.orders) || !take(groups, record.groups) ||
      !take(clamped, record.clamped) || !take(border, record.border) || !take(whole, bins, record.whole) ||
      !take(sets, record.sets) || !take(lines, record.lines) || !take(cases, record.cases) ||
      !take(tapered, record.tapered) || !take(at_parts, record.at_parts) || !take(flow, record.flow) ||
      !take(stages, record.supported_stages) || lifting.size() != record.cases.size()) {
    return std::nullopt;
  }
  for (std::size_t k = 0; k < lifting.size(); ++k) record.cases[k].lifting = lifting[k];
  if (!turning.empty()) {
    if (turning.size() != record.cases.size() + 1) return std::nullopt;
    record.turning = turning.front();
    for (std::size_t k = 0; k < record.cases.size(); ++k) record.cases[k].turning = turning[k + 1];
  }
  if (!take(at_target, record)) return std::nullopt;
  if (!record.factors.empty() && record.factors.size() != factor_bins) return std::nullopt;
  if (!r.good() || outcome > static_cast<unsigned>(Outcome::refused) || stopped > 1) return std::nullopt;
  record.outcome = static_cast<Outcome>(outcome);
  record.stopped_at_max_batches = stopped == 1;
  return record;
}

}  // namespace cleave::stochastic
