#include "cleave/core/text.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "cleave/core/disjoint_sets.hpp"

namespace cleave {
namespace {

TEST(TextTest, LowerCaseIsOfAsciiOnly) {
  EXPECT_EQ(lower("Dip_DIRECTION 9"), "dip_direction 9");
  EXPECT_EQ(lower("\xC3\x84Z"), "\xC3\x84z");  // a capital A with dots stays
}

TEST(TextTest, TrimmedTakesBlanksOfBothEnds) {
  EXPECT_EQ(trimmed(" \t a b\r"), "a b");
  EXPECT_EQ(trimmed("\v\f "), "");
  EXPECT_EQ(trimmed("\na"), "\na");  // the end of a line is no blank
}

TEST(TextTest, CsvFieldsAreQuotedWhereNeeded) {
  EXPECT_EQ(csv_field("plain"), "plain");
  EXPECT_EQ(csv_field("a,b\"c"), "\"a,b\"\"c\"");
  EXPECT_EQ(csv_field("two\nlines"), "\"two\nlines\"");
  EXPECT_EQ(csv_field("a;b"), "a;b");
  EXPECT_EQ(csv_field("a;b", ";#"), "\"a;b\"");
  EXPECT_EQ(csv_field("", ";#"), "");
  EXPECT_EQ(csv_field("=HYPERLINK(1,2)"), "\"'=HYPERLINK(1,2)\"");
  EXPECT_EQ(csv_field("@x"), "'@x");
  for (const auto* number : {"-5", "+5", "-1e-3", "+.5"}) EXPECT_EQ(csv_field(number), number);
  EXPECT_EQ(csv_field("-5+cmd"), "'-5+cmd");
}

TEST(DisjointSetsTest, TheSmallestMemberStandsForItsSetHoweverJoined) {
  DisjointSets<std::uint32_t> one{6}, other{6};
  one.join(5, 3);
  one.join(3, 1);
  one.join(0, 2);
  other.join_shared(1, 5);
  other.join_shared(2, 0);
  other.join_shared(5, 3);
  for (std::uint32_t k = 0; k < 6; ++k) EXPECT_EQ(one.find(k), other.find_shared(k)) << k;
  EXPECT_EQ(one.find(5), 1U);
  EXPECT_EQ(one.find(4), 4U);
}

TEST(Text, ControlCharactersAreSeen) {
  for (const char* plain : {"", "a b\tc", "\xC3\xBC", "\xC2\xB0", "\xE2\x80\x9C"}) {
    EXPECT_FALSE(has_control_characters(plain)) << plain;
  }
  for (const char* steers : {"\x1b[31m", "a\x7f", "a\n", "\xC2\x9B", "\xC2\x80"}) {
    EXPECT_TRUE(has_control_characters(steers)) << steers;
  }
}

TEST(Text, CommentsOfFilesStayOnTheirLine) {
  EXPECT_EQ(on_one_line("a\tb\r\nc\x7f\x1b[2J \xC2\x9B!"), "a b  c  [2J  !");
  EXPECT_EQ(on_one_line("\xC3\xA4 \xE2\x88\x9E \xF0\x9F\xAA\xA8"), "\xC3\xA4 \xE2\x88\x9E \xF0\x9F\xAA\xA8");
  EXPECT_EQ(on_one_line("\xe4\xC3"), "\xEF\xBF\xBD\xEF\xBF\xBD");
  for (const char* text : {"", "a", "\xC3\xA4", "\xF4\x8F\xBF\xBF"}) EXPECT_TRUE(is_utf8(text)) << text;
  for (const char* bytes : {"\xe4", "\xC0\xAF", "\xED\xA0\x80", "\xF4\x90\x80\x80", "ab\xC3"}) {
    EXPECT_FALSE(is_utf8(bytes));
  }
}

}  // namespace
}  // namespace cleave
