#include "record_parts.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace cleave::stochastic {
namespace {

bool is_count(double x) { return x >= 0 && x < 0x1p53 && x == std::floor(x); }

}  // namespace

std::vector<double> numbers_of(const std::optional<Supported>& s) {
  if (!s) return {};
  const auto number = [](std::uint64_t n) { return static_cast<double>(n); };
  std::vector<double> numbers{number(s->needing), number(s->not_held),   s->not_held_m3,
                              s->missing_n,       number(s->spot_bolts), number(s->failing_bodies)};
  for (const Stress pressure : s->pressures) numbers.push_back(pressure.si());
  if (s->groups) {
    const SupportedTogether& g = *s->groups;
    for (const double x : {number(g.not_held), number(g.in_doubt), g.not_held_volume.si(), g.too_many ? 1.0 : 0.0})
      numbers.push_back(x);
  }
  return numbers;
}
std::vector<double> numbers_of(const std::vector<PartTally>& at_parts) {
  std::vector<double> numbers;
  for (const PartTally& part : at_parts) {
    numbers.push_back(static_cast<double>(part.count));
    numbers.push_back(part.volume.si());
  }
  return numbers;
}
std::vector<double> numbers_of(const std::optional<Grouped>& g) {
  if (!g) return {};
  return {static_cast<double>(g->moving), static_cast<double>(g->in_doubt), g->moving_volume.si(),
          g->in_doubt_volume.si(), g->too_many ? 1.0 : 0.0};
}
std::vector<double> numbers_of(const std::optional<Clamped>& c) {
  if (!c) return {};
  return {static_cast<double>(c->held), static_cast<double>(c->undecided), c->held_volume.si()};
}
std::vector<double> numbers_of(const std::optional<Staying>& b) {
  if (!b) return {};
  return {static_cast<double>(b->count), b->volume.si()};
}
std::vector<double> numbers_of(const std::vector<OrderTally>& orders) {
  std::vector<double> numbers;
  for (const OrderTally& order : orders) {
    numbers.push_back(static_cast<double>(order.key_blocks));
    numbers.push_back(order.key_m3);
  }
  return numbers;
}

/// Each optional part with its length before it.
std::vector<double> numbers_of(const std::vector<CaseTally>& cases) {
  std::vector<double> numbers;
  for (const CaseTally& c : cases) {
    for (const double x : {static_cast<double>(c.count), c.volume.si(), c.largest.si(), c.net.si()})
      numbers.push_back(x);
    for (const auto& part : {numbers_of(c.support), numbers_of(c.groups), numbers_of(c.border), numbers_of(c.tapered),
                             numbers_of(c.at_parts)}) {
      numbers.push_back(static_cast<double>(part.size()));
      numbers.insert(numbers.end(), part.begin(), part.end());
    }
  }
  return numbers;
}

std::vector<double> numbers_of(const std::optional<WholeBlocks>& w) {
  if (!w) return {};
  std::vector<double> numbers{static_cast<double>(w->count), w->volume.si()};
  numbers.insert(numbers.end(), w->shapes.begin(), w->shapes.end());
  return numbers;
}
std::vector<float> bins_of(const std::optional<WholeBlocks>& w) {
  std::vector<float> numbers;
  if (!w) return numbers;
  for (const SizeBin& bin : w->bins) {
    for (const float x : {static_cast<float>(bin.bin), bin.number, bin.volume_m3}) numbers.push_back(x);
  }
  return numbers;
}
std::vector<double> numbers_of(const std::vector<SetTally>& sets) {
  std::vector<double> numbers;
  for (const SetTally& set : sets) {
    for (const double x : {static_cast<double>(set.joints), set.p32, set.p10, set.p21}) numbers.push_back(x);
  }
  return numbers;
}
std::vector<double> numbers_of(const std::vector<LineTally>& lines) {
  std::vector<double> numbers;
  for (const LineTally& line : lines) {
    for (const double x : {static_cast<double>(line.joints), line.length.si(), line.rqd}) numbers.push_back(x);
  }
  return numbers;
}

std::vector<double> numbers_of(const std::optional<FlowTally>& f) {
  if (!f) return {};
  std::vector<double> numbers{static_cast<double>(f->clusters), f->largest_share, f->opening_share, f->backbone_share,
                              f->water ? 1.0 : 0.0};
  if (f->water) {
    const WaterTally& w = *f->water;
    for (const double x : {w.inflow.si(), w.low.si(), w.high.si(), w.wet_share, w.settled ? 1.0 : 0.0})
      numbers.push_back(x);
  }
  for (const std::uint64_t pair : f->connected) numbers.push_back(static_cast<double>(pair));
  return numbers;
}

std::vector<double> numbers_of(const std::optional<SupportedStages>& s) {
  if (!s) return {};
  return {static_cast<double>(s->judged), static_cast<double>(s->failing)};
}

std::vector<double> numbers_of(const std::optional<StayingAtTarget>& s) {
  std::vector<double> numbers;
  if (!s) return numbers;
  for (const Staying& part : {s->border, s->tapered}) {
    numbers.push_back(static_cast<double>(part.count));
    numbers.push_back(part.volume.si());
  }
  return numbers;
}

bool take(const std::vector<double>& n, Record& record) {
  if (n.empty()) return true;
  if (n.size() != 4 * (1 + record.cases.size())) return false;
  for (std::size_t i = 0; i < n.size(); i += 2) {
    if (!is_count(n[i])) return false;
  }
  const auto staying = [&](std::size_t at) {
    return Staying{static_cast<std::uint64_t>(n[at]), cubic_metres(n[at + 1])};
  };
  record.at_target = StayingAtTarget{staying(0), staying(2)};
  for (std::size_t k = 0; k < record.cases.size(); ++k) {
    record.cases[k].at_target = StayingAtTarget{staying(4 * k + 4), staying(4 * k + 6)};
  }
  return true;
}

bool take(const std::vector<double>& n, std::optional<SupportedStages>& stages) {
  if (n.empty()) return true;
  if (n.size() != 2 || !is_count(n[0]) || !is_count(n[1]) || n[1] > n[0]) return false;
  stages = SupportedStages{static_cast<std::uint64_t>(n[0]), static_cast<std::uint64_t>(n[1])};
  return true;
}
bool take(const std::vector<double>& n, std::optional<Supported>& support) {
  if (n.empty()) return true;
  constexpr std::size_t own = 6 + part_count;
  if (n.size() != own && n.size() != own + 4) return false;
  if (!is_count(n[0]) || !is_count(n[1]) || !is_count(n[4]) || !is_count(n[5])) return false;
  const auto count = [](double x) { return static_cast<std::uint64_t>(x); };
  support = Supported{count(n[0]), count(n[1]), n[2], n[3], count(n[4]), count(n[5])};
  for (std::size_t part = 0; part < part_count; ++part) support->pressures.at(part) = pascals(n[6 + part]);
  if (n.size() == own) return true;
  const std::span<const double> g = std::span{n}.subspan(own);
  if (!is_count(g[0]) || !is_count(g[1]) || (g[3] != 0 && g[3] != 1)) return false;
  support->groups = SupportedTogether{count(g[0]), count(g[1]), cubic_metres(g[2]), g[3] == 1};
  return true;
}
bool take(const std::vector<double>& n, std::vector<PartTally>& at_parts) {
  if (n.empty()) return true;
  if (n.size() != 2 * part_count) return false;
  for (std::size_t i = 0; i < n.size(); i += 2) {
    if (!is_count(n[i])) return false;
    at_parts.push_back({static_cast<std::uint64_t>(n[i]), cubic_metres(n[i + 1])});
  }
  return true;
}
bool take(const std::vector<double>& n, std::optional<Grouped>& groups) {
  if (n.empty()) return true;
  if (n.size() != 5 || !is_count(n[0]) || !is_count(n[1]) || (n[4] != 0 && n[4] != 1)) return false;
  groups = Grouped{static_cast<std::uint64_t>(n[0]), static_cast<std::uint64_t>(n[1]), cubic_metres(n[2]),
                   cubic_metres(n[3]), n[4] == 1};
  return true;
}
bool take(const std::vector<double>& n, std::optional<Clamped>& clamped) {
  if (n.empty()) return true;
  if (n.size() != 3 || !is_count(n[0]) || !is_count(n[1])) return false;
  clamped = Clamped{static_cast<std::uint64_t>(n[0]), static_cast<std::uint64_t>(n[1]), cubic_metres(n[2])};
  return true;
}
bool take(const std::vector<double>& n, std::optional<Staying>& border) {
  if (n.empty()) return true;
  if (n.size() != 2 || !is_count(n[0])) return false;
  border = Staying{static_cast<std::uint64_t>(n[0]), cubic_metres(n[1])};
  return true;
}
bool take(const std::vector<double>& n, std::vector<OrderTally>& orders) {
  if (n.size() % 2 != 0) return false;
  for (std::size_t i = 0; i < n.size(); i += 2) {
    if (!is_count(n[i])) return false;
    orders.push_back({static_cast<std::uint64_t>(n[i]), n[i + 1]});
  }
  return true;
}

bool take(const std::vector<double>& n, std::vector<CaseTally>& cases) {
  std::span<const double> rest{n};
  const auto part = [&](auto& into) {
    if (rest.empty() || !is_count(rest.front()) || rest.front() >= static_cast<double>(rest.size())) return false;
    const auto length = static_cast<std::size_t>(rest.front());
    const std::vector<double> own(rest.begin() + 1, rest.begin() + 1 + static_cast<std::ptrdiff_t>(length));
    rest = rest.subspan(1 + length);
    return take(own, into);
  };
  while (!rest.empty()) {
    if (rest.size() < 4 || !is_count(rest[0])) return false;
    CaseTally& c = cases.emplace_back();
    c.count = static_cast<std::uint64_t>(rest[0]);
    c.volume = cubic_metres(rest[1]);
    c.largest = cubic_metres(rest[2]);
    c.net = newtons(rest[3]);
    rest = rest.subspan(4);
    if (!part(c.support) || !part(c.groups) || !part(c.border) || !part(c.tapered) || !part(c.at_parts)) return false;
  }
  return true;
}

bool take(const std::vector<double>& n, const std::vector<float>& bins, std::optional<WholeBlocks>& whole) {
  if (n.empty()) return bins.empty();
  if (n.size() != 6 || !is_count(n[0]) || bins.size() % 3 != 0) return false;
  WholeBlocks& w = whole.emplace();
  w.count = static_cast<std::uint64_t>(n[0]);
  w.volume = cubic_metres(n[1]);
  std::copy(n.begin() + 2, n.end(), w.shapes.begin());
  for (std::size_t i = 0; i < bins.size(); i += 3) {
    const float bin = bins[i];
    if (!is_count(bin) || bin >= SizeHistogram::bins || !(bins[i + 1] > 0) || !(bins[i + 2] >= 0)) return false;
    w.bins.push_back({static_cast<std::uint32_t>(bin), bins[i + 1], bins[i + 2]});
  }
  return std::ranges::is_sorted(w.bins, std::ranges::less_equal{}, &SizeBin::bin);
}
bool take(const std::vector<double>& n, std::vector<SetTally>& sets) {
  if (n.size() % 4 != 0) return false;
  for (std::size_t i = 0; i < n.size(); i += 4) {
    if (!is_count(n[i])) return false;
    sets.push_back({static_cast<std::uint64_t>(n[i]), n[i + 1], n[i + 2], n[i + 3]});
  }
  return true;
}
bool take(const std::vector<double>& n, std::vector<LineTally>& lines) {
  if (n.size() % 3 != 0) return false;
  for (std::size_t i = 0; i < n.size(); i += 3) {
    if (!is_count(n[i])) return false;
    lines.push_back({static_cast<std::uint64_t>(n[i]), metres(n[i + 1]), n[i + 2]});
  }
  return true;
}
bool take(const std::vector<double>& n, std::optional<FlowTally>& flow) {
  if (n.empty()) return true;
  const auto is_flag = [](double x) { return x == 0 || x == 1; };
  if (n.size() < 5 || !is_count(n[0]) || !is_flag(n[4])) return false;
  FlowTally& f = flow.emplace();
  f.clusters = static_cast<std::uint64_t>(n[0]);
  f.largest_share = n[1];
  f.opening_share = n[2];
  f.backbone_share = n[3];
  std::span<const double> rest = std::span{n}.subspan(5);
  if (n[4] == 1) {
    if (rest.size() < 5 || !is_flag(rest[4])) return false;
    f.water = WaterTally{FlowRate::from_si(rest[0]), FlowRate::from_si(rest[1]), FlowRate::from_si(rest[2]), rest[3],
                         rest[4] == 1};
    rest = rest.subspan(5);
  }
  for (const double pair : rest) {
    if (!is_count(pair)) return false;
    f.connected.push_back(static_cast<std::uint64_t>(pair));
  }
  return true;
}

}  // namespace cleave::stochastic
