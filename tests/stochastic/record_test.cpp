#include "cleave/stochastic/record.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "cleave/core/rng.hpp"

namespace cleave::stochastic {
namespace {

namespace fs = std::filesystem;

Record example(std::uint64_t k) {
  Rng rng{{.seed = 3, .realization = k}};
  Record r;
  r.realization = k;
  r.joints = 39;
  r.blocks = 100 + k;
  r.rock_m3 = 1000 * rng.uniform();
  r.batches = 3;
  for (Tally* t : {&r.all, &r.first}) {
    t->count = static_cast<std::uint64_t>(rng.between(1, 20));
    for (std::uint64_t i = 0; i < t->count; ++i) {
      const double v = std::exp(3 * rng.normal());
      t->volume_m3 += v;
      t->largest_m3 = std::max(t->largest_m3, v);
      t->sizes.add(v);
    }
    t->support_n = 1e5 * rng.uniform();
    t->modes = {1, 2, 3, 4};
    t->shapes = {5, 4, 3, 2, 1};
    t->sphericity_sum = 0.1;
  }
  r.free_m2 = 100 * rng.uniform();
  r.free_fixed_m2 = rng.uniform();
  r.middle_m2 = 50 * rng.uniform();
  r.middle_fixed_m2 = rng.uniform();
  r.largest_pressure_pa = 1e4 * rng.uniform();
  if (k % 2 == 1) {
    r.factors.resize(factor_bins);
    r.factors[3] = k;
  }
  r.above = {7, 0, 3};
  r.chainage_m3 = {0, 0.1, 1e-300, 12345.678};
  if (k % 2 == 0) r.support = Supported{9, k, rng.uniform(), 1e6 * rng.uniform(), 3, 1};
  if (k % 6 == 0) r.support->groups = SupportedTogether{k, 2, cubic_metres(rng.uniform()), k % 4 == 0};
  if (k % 3 == 0) r.orders = {{k, rng.uniform()}, {0, 0}, {7, 1e-9}};
  if (k % 3 == 1) r.border = Staying{k, cubic_metres(rng.uniform())};
  if (k % 3 == 2) r.tapered = Staying{k, cubic_metres(rng.uniform())};
  if (k % 4 == 0) r.clamped = Clamped{k, 2, cubic_metres(rng.uniform())};
  if (k % 2 == 1) {
    r.whole = WholeBlocks{k,
                          cubic_metres(1e3 * rng.uniform()),
                          {rng.uniform(), 0, 3, rng.uniform()},
                          {{3, 1.25F, 7e-6F}, {48, 1e3F, 2e3F}}};
    r.lines = {{k, metres(rng.uniform()), 99.5}, {0, {}, 0}};
    r.sets = {{k, rng.uniform(), rng.uniform(), rng.uniform()}, {0, 0, 0, 0}};
  }
  if (k % 5 == 0) r.groups = Grouped{k, 3, cubic_metres(rng.uniform()), cubic_metres(1e3 * rng.uniform()), k % 2 == 0};
  if (r.support) {
    r.support->pressures = {pascals(1e3 * rng.uniform()), {}, pascals(7e-300), pascals(2e6)};
    r.at_parts = {{k, cubic_metres(rng.uniform())}, {}, {1, cubic_metres(0.5)}, {}};
  }
  if (k % 6 == 1) r.supported_stages = SupportedStages{k, k / 2};
  if (k % 4 == 1) {
    r.flow = FlowTally{k, rng.uniform(), rng.uniform(), rng.uniform(), {2, 5, 4949}};
    if (k % 8 == 1)
      r.flow->water = WaterTally{
          FlowRate::from_si(1e-7 * rng.uniform()), {}, FlowRate::from_si(3e-300), rng.uniform(), k % 16 == 1};
  }
  if (k % 7 == 2)
    r.cases = {{k, cubic_metres(2), cubic_metres(0.1), newtons(3e-300), r.support, r.groups, r.border, r.tapered,
                r.at_parts, k},
               {}};
  if (k % 7 == 3)
    r.cases = {
        {1, {}, cubic_metres(rng.uniform()), {}, {}, Grouped{k, 3, {}, {}, true}, Staying{k, {}}, Staying{1, {}}}};
  return r;
}

TEST(RecordTest, LinesReadBackToTheLastBit) {
  for (std::uint64_t k = 0; k < 200; ++k) {
    const Record record = example(k);
    const auto back = record_of(line_of(record));
    ASSERT_TRUE(back.has_value()) << k;
    EXPECT_EQ(*back, record) << k;
  }
  Record empty;
  empty.outcome = Outcome::refused;
  EXPECT_EQ(record_of(line_of(empty)), empty);
}

TEST(RecordTest, ColumnsAreAsManyAsFields) {
  const std::string line = line_of(example(1));
  const std::string_view columns = record_columns();
  EXPECT_EQ(std::ranges::count(line, ','), std::ranges::count(columns, ','));
}

// A line cut anywhere, or with any digit changed, is no record.
TEST(RecordTest, DamageIsSeen) {
  const std::string line = line_of(example(5));
  for (std::size_t cut = 0; cut < line.size(); ++cut) {
    EXPECT_FALSE(record_of(line.substr(0, cut)).has_value()) << cut;
    std::string changed = line;
    changed[cut] = changed[cut] == '7' ? '8' : '7';
    EXPECT_FALSE(record_of(changed).has_value()) << cut;
  }
}

// Bins of whole blocks that do not rise, or lie beyond the last one, are refused though the checksum fits.
TEST(RecordTest, BinsRiseAndExist) {
  Record record = example(1);
  record.whole->bins = {{48, 1, 1}, {48, 1, 1}};
  EXPECT_FALSE(record_of(line_of(record)).has_value());
  record.whole->bins = {{SizeHistogram::bins, 1, 1}};
  EXPECT_FALSE(record_of(line_of(record)).has_value());
  record.whole->bins = {{SizeHistogram::bins - 1, 1, 1}};
  EXPECT_EQ(record_of(line_of(record)), record);
}

TEST(RecordTest, HistogramBinsHoldTheirVolumes) {
  SizeHistogram histogram;
  histogram.add(1.0);  // 10^0: the lower end of bin 48
  EXPECT_EQ(histogram.counts()[48], 1U);
  histogram.add(0);
  histogram.add(1e-30);
  EXPECT_EQ(histogram.counts()[0], 2U);
  histogram.add(1e30);
  EXPECT_EQ(histogram.counts()[SizeHistogram::bins - 1], 1U);
  EXPECT_DOUBLE_EQ(SizeHistogram::edge(48), 1.0);
}

class RecordFileTest : public testing::Test {
 protected:
  void SetUp() override { fs::remove(path_); }
  void TearDown() override { fs::remove(path_); }
  [[nodiscard]] std::string bytes() const {
    std::ifstream in{path_, std::ios::binary};
    return {std::istreambuf_iterator<char>{in}, {}};
  }
  void write(const std::string& text) const { std::ofstream{path_, std::ios::binary} << text; }
  fs::path path_ = fs::temp_directory_path() / ("cleave-records-" + std::to_string(::getpid()));
  RunIdentity identity_{"0.1.0", "abc", 7, {2, 3}};
};

// Whatever moment a run is ended at: what is whole is kept, the rest is made again, and the bytes are the same.
TEST_F(RecordFileTest, AnyCutResumesToTheSameBytes) {
  {
    auto file = RecordFile::open(path_, identity_);
    ASSERT_TRUE(file.has_value());
    for (int i = 0; i < 4; ++i) ASSERT_TRUE(file->append(example(file->next_realization())).has_value());
    EXPECT_EQ(file->next_realization(), 13U);  // 1, 4, 7, 10 of shard 2/3 are done
  }
  const std::string whole = bytes();
  for (std::size_t cut = 0; cut <= whole.size(); cut += 7) {
    write(whole.substr(0, cut));
    {
      auto file = RecordFile::open(path_, identity_);
      ASSERT_TRUE(file.has_value()) << cut;
      while (file->records() < 4) ASSERT_TRUE(file->append(example(file->next_realization())).has_value());
    }
    ASSERT_EQ(bytes(), whole) << cut;
  }
}

TEST_F(RecordFileTest, AnotherRunIsRefusedAndUntouched) {
  {
    ASSERT_TRUE(RecordFile::open(path_, identity_).has_value());
  }
  const std::string before = bytes();
  RunIdentity other = identity_;
  other.seed = 8;
  const auto file = RecordFile::open(path_, other);
  ASSERT_FALSE(file.has_value());
  EXPECT_TRUE(std::holds_alternative<OtherRun>(file.error()));
  EXPECT_EQ(bytes(), before);
}

TEST_F(RecordFileTest, TwoProcessesDoNotWriteOneFile) {
  const auto first = RecordFile::open(path_, identity_);
  ASSERT_TRUE(first.has_value());
  const auto second = RecordFile::open(path_, identity_);
  ASSERT_FALSE(second.has_value());
  EXPECT_TRUE(std::holds_alternative<InUse>(second.error()));
}

TEST_F(RecordFileTest, ReadingNamesTheBrokenLine) {
  {
    auto file = RecordFile::open(path_, identity_);
    ASSERT_TRUE(file->append(example(1)).has_value());
    ASSERT_TRUE(file->append(example(4)).has_value());
  }
  std::uint64_t seen = 0;
  const auto count = [&](const Record&, std::string_view) { return ++seen > 0; };
  const auto read = read_records(path_, count);
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(*read, identity_);
  EXPECT_EQ(seen, 2U);
  write(bytes() + "5,0,1\n");
  const auto broken = read_records(path_, count);
  ASSERT_FALSE(broken.has_value());
  EXPECT_EQ(std::get<Unreadable>(broken.error()).line, 5U);
}

}  // namespace
}  // namespace cleave::stochastic
