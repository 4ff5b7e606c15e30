#include "cleave/report/summary.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "hand_made.hpp"

namespace cleave::report {
namespace {

using namespace testing;
using Json = nlohmann::ordered_json;

std::vector<std::string> keys(const Json& object) {
  std::vector<std::string> names;
  for (const auto& item : object.items()) names.push_back(item.key());
  return names;
}

scene::RunResult example() {
  scene::RunResult r = scene::empty_result();
  r.title = "Tunnel \"A\"";
  r.seed = 18446744073709551615U;
  r.scene_sha256 = "00ff";
  r.plan.steps = {{.step = scene::Step::cut, .run = true, .why = "asked for"},
                  {.step = scene::Step::stability, .run = false, .why = "nothing is free"}};
  r.cost = {.wall_s = 1.5,
            .cpu_s = 2.5,
            .peak_rss_mb = 100,
            .threads = 2,
            .steps = {{.step = scene::Step::cut, .wall_s = 1, .cpu_s = 2, .peak_rss_mb = 90}}};
  r.figures.input = {{.joints = 3, .lattice_pitch_m = 0x1p-41, .largest_snap_m = 1e-13, .merged_planes = 0}};
  r.figures.blocks =
      scene::BlockFigures{.count = 8, .volume_m3 = 8, .domain_volume_m3 = 8, .hash = "abc", .exact_share = 0.25};
  r.complex.error().passed = true;
  r.complex.error().volume_relative_error = 1e-16;
  r.figures.key_blocks = scene::KeyBlockFigures{
      .count = 2, .volume_m3 = 2, .batches = {{.batch = 1, .count = 2, .volume_m3 = 2, .modes = {1, 0, 0, 1}}}};
  return r;
}

Json schema_in_docs() {
  std::ifstream file{CLEAVE_SOURCE_DIR "/docs/summary.schema.json"};
  return Json::parse(file);
}

// docs/summary.schema.json says which keys every run has, and in which order.
TEST(SummaryJson, KeysAndTheirOrderAreTheContracts) {
  const Json json = Json::parse(summary_json(example())), schema = schema_in_docs();
  const auto required = [](const Json& object) { return object["required"].get<std::vector<std::string>>(); };
  const auto of = [](const Json& object, const char* key) { return object["properties"][key]; };
  std::vector<std::string> head = required(schema);
  for (const char* section : {"input", "blocks", "key_blocks"}) head.emplace_back(section);
  EXPECT_EQ(keys(json), head);
  EXPECT_EQ(keys(json["plan"][0]), required(of(schema, "plan")["items"]));
  EXPECT_EQ(keys(json["cost"]), required(of(schema, "cost")));
  EXPECT_EQ(keys(json["cost"]["stages"][0]), required(of(of(schema, "cost"), "stages")["items"]));
  EXPECT_EQ(keys(json["input"]), required(of(schema, "input")));
  EXPECT_EQ(keys(json["blocks"]), required(of(schema, "blocks")));
  EXPECT_EQ(keys(json["blocks"]["certificate"]), required(of(of(schema, "blocks"), "certificate")));
  Json key_blocks = json["key_blocks"];
  EXPECT_EQ(key_blocks.erase("lowest_factor_of_safety_reason"), 1U);  // the factor is null here
  EXPECT_EQ(keys(key_blocks), required(of(schema, "key_blocks")));
  const Json batch = of(of(schema, "key_blocks"), "batches")["items"];
  EXPECT_EQ(keys(json["key_blocks"]["batches"][0]), required(batch));
  EXPECT_EQ(keys(json["key_blocks"]["batches"][0]["modes"]), required(of(batch, "modes")));
  EXPECT_EQ(json["schema"], 1);
  EXPECT_EQ(json["seed"], 18446744073709551615U);
  EXPECT_EQ(json["input"]["lattice_pitch_m"], 0x1p-41);
}

TEST(SummaryJson, WithoutACertificateNoFigureOfTheBlocksIsGiven) {
  scene::RunResult s = example();
  s.figures.blocks.reset();
  s.figures.key_blocks.reset();
  s.complex.error().passed = false;
  const Json json = Json::parse(summary_json(s));
  EXPECT_TRUE(json["blocks"]["count"].is_null());
  EXPECT_FALSE(json["blocks"]["reason"].get<std::string>().empty());
  EXPECT_EQ(json["blocks"]["certificate"]["passed"], false);
  EXPECT_FALSE(json.contains("key_blocks"));
}

// A walk of the schema's part that we use: required keys are there, no key is unknown to it, types agree.
void expect_valid(const Json& schema, const Json& value, const std::string& where) {
  if (schema.contains("type")) {
    const auto is = [&](const std::string& type) {
      return (type == "object" && value.is_object()) || (type == "array" && value.is_array()) ||
             (type == "string" && value.is_string()) || (type == "boolean" && value.is_boolean()) ||
             (type == "null" && value.is_null()) || (type == "integer" && value.is_number_integer()) ||
             (type == "number" && value.is_number());
    };
    bool any = false;
    for (const Json& type : schema["type"].is_array() ? schema["type"] : Json::array({schema["type"]}))
      any |= is(type.get<std::string>());
    EXPECT_TRUE(any) << where;
  }
  if (schema.contains("required") && value.is_object()) {
    for (const Json& key : schema["required"])
      EXPECT_TRUE(value.contains(key.get<std::string>())) << where << '.' << key;
  }
  if (value.is_object()) {
    for (const auto& item : value.items()) {
      if (schema.contains("additionalProperties")) continue;
      ASSERT_TRUE(schema["properties"].contains(item.key())) << where << '.' << item.key();
      expect_valid(schema["properties"][item.key()], item.value(), where + '.' + item.key());
    }
  }
  if (value.is_array()) {
    for (const Json& item : value) expect_valid(schema["items"], item, where + "[]");
  }
}

/// An example in which every section stands.
scene::RunResult full() {
  scene::RunResult r = example();
  r.figures.input.snapped = {Sample<topology::SnappedJoint>::make()};
  r.figures.load_cases = {{"quake", *r.figures.key_blocks}};
  r.figures.load_cases[0].figures.below_target = 1;
  r.figures.support = scene::SupportFigures{};
  r.figures.support->required_force_n = std::numeric_limits<double>::infinity();
  r.figures.support_cases = {{"quake", {}}};
  r.designs = {{.length = 3}};
  r.tunnel_length = metres(10);
  r.figures.maximum_blocks = scene::MaximumFigures{};
  r.figures.micro_blocks = scene::MicroBlockFigures{};
  r.field_stress = scene::FieldStressResult{};
  r.window = scene::WindowInfo{};
  r.sequence = scene::SequenceResult{.stages = {{}}, .orders = {scene::OrderResult{}}, .stage_of_block = {}};
  return r;
}

TEST(SummaryJson, FitsItsSchema) {
  const Json schema = schema_in_docs();
  expect_valid(schema, Json::parse(summary_json(example())), "summary");
  scene::RunResult failed = example();
  failed.figures.blocks.reset();
  using topology::Misfit;
  topology::Certificate certificate;
  certificate.misfits = 2;
  certificate.first_misfits = {{Misfit::Of::area, topology::BlockId{4U}, topology::FaceId{17U}},
                               {Misfit::Of::volume, topology::BlockId{9U}, {}}};
  certificate.offenders = {topology::BlockId{4U}, topology::BlockId{9U}};
  failed.complex = std::unexpected(certificate);
  const Json refused = Json::parse(summary_json(failed));
  expect_valid(schema, refused, "summary");
  EXPECT_EQ(refused["blocks"]["certificate"]["first_misfits"],
            Json::parse(R"([{"block": 4, "face": 17, "of": "area"}, {"block": 9, "of": "volume"}])"));
  EXPECT_EQ(refused["blocks"]["certificate"]["offenders"], Json::parse("[4, 9]"));
  const Json whole = Json::parse(summary_json(full()));
  expect_valid(schema, whole, "summary");
  for (const char* section : {"support", "field_stress", "maximum_blocks", "micro_blocks", "sequence"}) {
    EXPECT_TRUE(whole.contains(section)) << section;
  }
  EXPECT_TRUE(whole["support"]["required_force_n_per_metre"].is_null());
  scene::BodiesResult bodies;
  bodies.bodies.emplace_back();
  bodies.points.emplace_back();
  expect_valid(schema, Json::parse(summary_json(bodies)), "elastic");
  scene::ContactResult contact;
  contact.bodies.emplace_back();
  contact.points.emplace_back();
  expect_valid(schema, Json::parse(summary_json(contact)), "contact");
}

/// The keys of every object of a schema, and those that each run has, by where they stand.
void keys_of_schema(const Json& schema, const std::string& where, std::vector<std::string>& found) {
  for (const auto& item : schema.items()) {
    if (item.key() == "required") {
      for (const Json& key : item.value()) found.push_back(where + " has " + key.get<std::string>());
    } else if (item.key() == "properties") {
      for (const auto& [name, of] : item.value().items()) {
        found.push_back(where + "." + name);
        keys_of_schema(of, where + "." + name, found);
      }
    } else if (item.value().is_object()) {
      keys_of_schema(item.value(), where + "/" + item.key(), found);
    }
  }
}

// The schema in docs/ is what the figures say of themselves; CLEAVE_GOLDEN=1 in the environment writes it anew, unless
// a key that users have would go or change its place among the others.
TEST(SummaryJson, TheSchemaInDocsIsTheOneOfTheFigures) {
  const char* path = CLEAVE_SOURCE_DIR "/docs/summary.schema.json";
  if (std::getenv("CLEAVE_GOLDEN") != nullptr) {
    std::vector<std::string> before, now;
    keys_of_schema(schema_in_docs(), "", before);
    keys_of_schema(Json::parse(summary_schema()), "", now);
    ASSERT_GT(before.size(), 400U);
    ASSERT_TRUE(keeps(before, now)) << "take a key that shall go, or move, out of " << path << " first";
    std::ofstream{path, std::ios::binary} << summary_schema();
  }
  std::ifstream file{path, std::ios::binary};
  const std::string text{std::istreambuf_iterator<char>{file}, {}};
  EXPECT_EQ(text, summary_schema());
}

TEST(Summary, CountsShapes) {
  const auto count = [](const topology::BlockComplex& c) { return scene::count_blocks(c, ""); };
  const scene::BlockFigures boxes = count(grid(2));
  EXPECT_EQ(boxes.count, 8U);
  EXPECT_EQ(boxes.concave, 0U);
  EXPECT_EQ(boxes.volume_m3, 8.0);
  const scene::BlockFigures through = count(box_with_shafts({{1, 1, 2, 2}}, 0, {16, 24, 10, 12, 1, 1}));
  EXPECT_EQ(through.concave, 1U);
  EXPECT_EQ(through.with_holes, 1U);
  EXPECT_EQ(through.with_cavities, 0U);
  const scene::BlockFigures blind = count(box_with_shafts({{1, 1, 2, 2}}, 1, {16, 24, 11, 12, 1, 0}));
  EXPECT_EQ(blind.with_holes, 1U);
  HandMade made;
  auto faces = box_faces({0, 0, 0}, {3, 3, 3});
  for (const FaceSpec& wall : void_faces({1, 1, 1}, {2, 2, 2}, 1)) faces.push_back(wall);
  made.block(faces, {16, 24, 12, 12, 2, 0});
  made.report().predicate_calls = 8;
  made.report().predicate_exact = 2;
  const scene::BlockFigures hollow = count(std::move(made).complex());
  EXPECT_EQ(hollow.with_holes, 0U);
  EXPECT_EQ(hollow.with_cavities, 1U);
  EXPECT_DOUBLE_EQ(hollow.volume_m3, 26.0);
  EXPECT_EQ(hollow.exact_share, 0.25);
}

TEST(Summary, CountsModesByBatch) {
  stability::Analysis analysis;
  analysis.judgements = {judgement(0, stability::Mode::falling, 1, 0), judgement(2, stability::Mode::wedge, 1, 0.5),
                         judgement(4, stability::Mode::sliding, std::nullopt, 2),
                         judgement(5, stability::Mode::sliding, 2, 0.5)};
  analysis.batches = {
      {.number = 1, .blocks = {topology::BlockId{0U}, topology::BlockId{2U}}, .volume = cubic_metres(2)},
      {.number = 2, .blocks = {topology::BlockId{5U}}, .volume = cubic_metres(1)}};
  const scene::KeyBlockFigures figures = scene::count_key_blocks(analysis);
  EXPECT_EQ(figures.count, 3U);
  EXPECT_EQ(figures.volume_m3, 3.0);
  ASSERT_EQ(figures.batches.size(), 2U);
  EXPECT_EQ(figures.batches[0].modes, (std::array<std::uint64_t, 4>{1, 0, 0, 1}));
  EXPECT_EQ(figures.batches[1].modes, (std::array<std::uint64_t, 4>{0, 0, 1, 0}));
}

}  // namespace
}  // namespace cleave::report
