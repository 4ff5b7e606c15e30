#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <string>

#include "cleave/report/contact.hpp"

namespace cleave::report {
namespace {

using bem::Vec2;

scene::ContactResult falling(std::size_t bodies, std::size_t frames) {
  scene::ContactResult result;
  result.title = "Bricks & co";
  result.scene_file = "bricks.toml";
  result.points = {{.name = "top </script><b>", .at = {1, 2}, .body = 0}};
  for (std::size_t b = 0; b < bodies; ++b) {
    const Vec2 at{2 * static_cast<double>(b), 0.5};
    scene::ContactBodyResult body;
    body.name = "brick " + std::to_string(b + 1);
    body.freedoms = 3;
    body.start = body.centroid = at;
    body.outline = {at + Vec2{-1, -0.5}, at + Vec2{1, -0.5}, at + Vec2{1, 0.5}, at + Vec2{-1, 0.5}};
    body.size = scene::size_of(body.outline);
    result.bodies.push_back(std::move(body));
  }
  for (std::size_t f = 0; f < frames; ++f) {
    const double t = 0.01 * static_cast<double>(f), y = -4.905 * t * t;
    scene::ContactFrame frame;
    frame.time = t;
    frame.corners.resize(bodies);
    for (const scene::ContactBodyResult& body : result.bodies) frame.places.push_back({body.start + Vec2{0, y}, 0});
    frame.points = {{0, y}};
    result.frames.push_back(std::move(frame));
    scene::ContactHistory row;
    row.time = t;
    row.step = f > 0 ? 0.01 : 0;
    row.points = {{0, y}};
    result.history.push_back(std::move(row));
  }
  result.steps = frames - 1;
  return result;
}

nlohmann::json data_of(const std::string& page) {
  const std::string begin = "<script type=\"application/json\" id=\"data\">";
  const std::size_t from = page.find(begin) + begin.size();
  return nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
}

/// The frames as if they were the steps of the run.
void note_frames(scene::ContactResult& result) {
  for (std::size_t b = 0; b < result.bodies.size(); ++b) {
    scene::ContactBodyResult& body = result.bodies[b];
    body.moved_at.reset();
    for (const scene::ContactFrame& frame : result.frames) {
      note_step(body, Time::from_si(frame.time), frame.places[b], !frame.contacts.empty());
      body.centroid = frame.places[b].centroid;
      body.rotation = frame.places[b].rotation;
    }
  }
}

// 1 % of a brick's size is 0.0224 m: it has fallen that far at 0.0675 s, and the step to 0.07 s shows it.
TEST(ContactPage, BeginsWithWhatBecameOfTheBodies) {
  scene::ContactResult result = falling(2, 20);
  result.bodies[0].fixed = true;
  note_frames(result);
  scene::ContactVerdict verdict = verdict_of(result);
  EXPECT_EQ(verdict.moved(), 1U);
  EXPECT_EQ(verdict.motion, scene::BodyMotion::falls);
  EXPECT_EQ(verdict.first, 1U);
  ASSERT_TRUE(verdict.since.has_value());
  EXPECT_DOUBLE_EQ(verdict.since->si(), 0.07);
  std::string page = contact_report_html(result);
  EXPECT_TRUE(page.contains("<strong>falls</strong>"));
  EXPECT_TRUE(page.contains("first “brick 2”, seen at 0.07 s; in all 1 fell"));
  EXPECT_LT(page.find(">verdict<"), page.find(">run<"));

  for (scene::ContactFrame& frame : result.frames) frame.contacts = {{.at = {}, .force = {}, .first = 0, .second = 1}};
  note_frames(result);
  EXPECT_EQ(verdict_of(result).motion, scene::BodyMotion::slides);
  result.frames.back().places[1].rotation = 0.1;  // 5.7 degrees
  note_frames(result);
  EXPECT_EQ(verdict_of(result).motion, scene::BodyMotion::topples);
  // A turn alone is a movement too: by 0.04 radians the corners go 2 % of the brick's size.
  scene::ContactResult turned = falling(1, 3);
  for (scene::ContactFrame& frame : turned.frames) frame.places[0].centroid = turned.bodies[0].start;
  note_frames(turned);
  EXPECT_EQ(verdict_of(turned).moved(), 0U);
  turned.frames.back().places[0].rotation = 0.0402;
  note_frames(turned);
  EXPECT_EQ(verdict_of(turned).since, Time::from_si(turned.frames.back().time));
  result.bodies[1].fixed = true;
  verdict = verdict_of(result);
  EXPECT_EQ(verdict.motion, std::nullopt);
  EXPECT_EQ(verdict.moved(), 0U);
  EXPECT_TRUE(contact_report_html(result).contains("<strong>stands</strong>"));
  // A run that stopped does not say that anything stands.
  result.converged = false;
  page = contact_report_html(result);
  EXPECT_TRUE(page.contains("<strong>not known</strong>"));
  EXPECT_FALSE(page.contains("<strong>stands</strong>"));
  EXPECT_EQ(name_of(verdict_of(result)), "not known");
}

TEST(ContactPage, EndsWithItsInputsAndLimits) {
  scene::ContactResult result = falling(1, 3);
  result.scene_file = "a&b.toml";
  result.scene_sha256 = "0123456789abcdef";
  result.seed = 77;
  result.notes = {"one"};
  const std::string page = contact_report_html(result);
  const std::string inputs = page.substr(page.find("<section id=\"inputs\">"));
  for (const char* part : {"a&amp;b.toml <code>0123456789abcdef</code>", ">Seed<", ">77<", "cleave 0.1.0",
                           "Assumptions and limits", "Bodies are rigid; they do not break."}) {
    EXPECT_TRUE(inputs.contains(part)) << part;
  }
  EXPECT_TRUE(page.contains("<div id=\"notes\">"));
  result.elastic = true;
  EXPECT_TRUE(contact_report_html(result).contains("Bodies deform by their modes"));
}

TEST(ContactPage, ScriptFindsAllThatItAsksFor) {
  scene::ContactResult result = falling(2, 3);
  result.solvers = {{.name = "newton", .groups = 3, .iterations = 5}};
  const std::string page = contact_report_html(result);
  const std::regex wanted{"byId\\(\"([a-z-]+)\"\\)|chart\\(\"([a-z]+)\""};
  std::size_t found = 0;
  for (std::sregex_iterator it{page.begin(), page.end(), wanted}, end; it != end; ++it, ++found) {
    const std::string id = (*it)[1].matched ? (*it)[1].str() : (*it)[2].str();
    EXPECT_NE(page.find("id=\"" + id + "\""), std::string::npos) << id;
  }
  EXPECT_GT(found, 15U);
  EXPECT_FALSE(std::regex_search(page, std::regex{"(src|href)\\s*=\\s*[\"'](?!data:)|https?://"}));  // no network
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
}

TEST(ContactPage, DataAreThoseOfTheRunWhateverTheNames) {
  const auto data = data_of(contact_report_html(falling(2, 3)));
  EXPECT_EQ(data["points"][0]["n"], "top </script><b>");
  ASSERT_EQ(data["frames"].size(), 3U);
  EXPECT_DOUBLE_EQ(data["frames"][2]["t"].get<double>(), 0.02);
  EXPECT_NEAR(data["frames"][2]["p"][4].get<double>(), -4.905 * 0.0004, 1e-9);  // relative to the first body
  EXPECT_DOUBLE_EQ(data["bodies"][1]["c"][0].get<double>(), 2);
  EXPECT_EQ(data["history"].size(), 3U);
}

TEST(ContactPage, WhyItStoppedAndNotesStandBeforeThePicture) {
  scene::ContactResult result = falling(1, 2);
  result.converged = false;
  result.to_rest = true;
  result.stopped_why = "no step < 1e-9 s";
  result.notes = {"no strength is stated"};
  const std::string page = contact_report_html(result);
  const std::size_t picture = page.find("<canvas");
  EXPECT_LT(page.find("Stopped: no step &lt; 1e-9 s"), picture);
  EXPECT_LT(page.find("Note: no strength is stated"), picture);
  EXPECT_NE(page.find("not at rest"), std::string::npos);
  EXPECT_EQ(page.find("converged</strong>"), std::string::npos);
}

TEST(ContactPage, WithoutContactThereIsNothingOnSolvers) {
  const std::string page = contact_report_html(falling(1, 2));
  EXPECT_NE(page.find("Nothing touched."), std::string::npos);
  EXPECT_EQ(page.find("id=\"iterations\""), std::string::npos);
}

// The last frame stays when others are left out.
TEST(ContactPage, ManyBodiesAreThinnedInTime) {
  const std::string page = contact_report_html(falling(1000, 700));
  EXPECT_LT(page.size(), 30'000'000U);
  const auto data = data_of(page);
  EXPECT_LT(data["frames"].size(), 500U);
  EXPECT_GT(data["frames"].size(), 250U);
  EXPECT_DOUBLE_EQ(data["frames"].back()["t"].get<double>(), 6.99);
  EXPECT_NE(page.find("The 60 of 1000 that moved most"), std::string::npos);
}

}  // namespace
}  // namespace cleave::report
