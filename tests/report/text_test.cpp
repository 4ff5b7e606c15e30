#include "text.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <vector>

#include "cleave/core/text.hpp"

namespace cleave::report {
namespace {

TEST(Text, NumbersAreTheShortestRoundTrip) {
  EXPECT_EQ(number(0.1), "0.1");
  EXPECT_EQ(number(0.1 + 0.2), "0.30000000000000004");
  EXPECT_EQ(number(-0.0), "0");
  EXPECT_EQ(number(1e300), "1e+300");
  EXPECT_EQ(number(80.0), "80");
  EXPECT_EQ(number(std::numeric_limits<double>::infinity()), "inf");
}

TEST(Text, DisplayRoundsForPeopleOnly) {
  EXPECT_EQ(display(384000.4), "384\u2009000");
  EXPECT_EQ(display(1234.5), "1234");
  EXPECT_EQ(display(12.34567), "12.35");
  EXPECT_EQ(display(-0.012345), "\u22120.01235");
  EXPECT_EQ(display(1.5e-13, 2), "1.5e\u221213");
  EXPECT_EQ(display(2.0), "2");
  EXPECT_EQ(display(std::numeric_limits<double>::infinity()), "\u221e");
  EXPECT_EQ(display_count(22782), "22\u2009782");
  EXPECT_EQ(display_count(347), "347");
}

TEST(Text, EscapesCannotBreakOutOfTheirContext) {
  EXPECT_EQ(escape_xml("<a href=\"x\">&'\x01"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;\uFFFD");
  std::string json;
  append_json_string(json, "</script>\"\\\n\x02\xFF");
  EXPECT_EQ(json, "\"\\u003c/script>\\\"\\\\\\n\\u0002\uFFFD\"");
  EXPECT_EQ(csv_field("a,b\"c"), "\"a,b\"\"c\"");
  EXPECT_EQ(csv_field("plain"), "plain");
}

// Test vectors of RFC 4648, section 10.
TEST(Text, Base64) {
  const std::array<std::pair<std::string_view, std::string_view>, 7> cases{{{"", ""},
                                                                            {"f", "Zg=="},
                                                                            {"fo", "Zm8="},
                                                                            {"foo", "Zm9v"},
                                                                            {"foob", "Zm9vYg=="},
                                                                            {"fooba", "Zm9vYmE="},
                                                                            {"foobar", "Zm9vYmFy"}}};
  for (const auto& [plain, coded] : cases) {
    std::string out;
    append_base64(out, std::as_bytes(std::span{plain}));
    EXPECT_EQ(out, coded);
  }
}

}  // namespace
}  // namespace cleave::report
