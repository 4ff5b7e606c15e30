#include "cleave/exchange/json.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

namespace cleave::report {
namespace {

TEST(Json, KeepsTheOrderOfKeysAndWritesNoNan) {
  JsonWriter json;
  json.begin_object();
  json.member("z", 0.1);
  json.member("a", std::numeric_limits<double>::quiet_NaN());
  json.member("m", std::numeric_limits<double>::infinity());
  json.member("text", "<é\">");
  json.member("flag", true);
  json.member("count", 7U);
  json.key("list");
  json.begin_array();
  json.value(1.0);
  json.begin_object();
  json.end_object();
  json.end_array();
  json.end_object();
  const std::string text = std::move(json).finish();
  EXPECT_EQ(text,
            "{\n  \"z\": 0.1,\n  \"a\": null,\n  \"m\": null,\n  \"text\": \"\\u003cé\\\">\",\n  \"flag\": true,\n  "
            "\"count\": 7,\n"
            "  \"list\": [\n    1,\n    {}\n  ]\n}\n");
  const auto back = nlohmann::json::parse(text);
  EXPECT_EQ(back["text"], "<é\">");
}

}  // namespace
}  // namespace cleave::report
