// The pictures of jobs: what they are, what may be asked of them, when there are none.
#include <gmock/gmock.h>

#include <fstream>
#include <set>

#include "tests/server/decode_png.hpp"
#include "tests/server/running_server.hpp"

namespace unwrapd::server::results {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class Pictures : public RunningServer {
 protected:
  std::string succeeded() {
    const std::string id = submit();
    await_state(id, "succeeded");
    return id;
  }
  /// How many files of the job have this in their names.
  long files(const std::string& id, const std::string& part) {
    long count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(config_.data / "blobs" / id))
      count += entry.path().filename().string().find(part) != std::string::npos ? 1 : 0;
    return count;
  }
};

TEST_F(Pictures, AreWhatTheirNamesSay) {
  start();
  const std::string id = succeeded();
  const api::Json links = job(id).at("links");
  for (const auto& [link, width, height] :
       {std::tuple{"layout_png", 1024, 1104}, std::tuple{"preview", 1024, 1024}}) {
    const auto answer = client().Get(links.at(link).get<std::string>());
    EXPECT_EQ(answer->status, 200) << answer->body;
    EXPECT_EQ(answer->get_header_value("Content-Type"), "image/png");
    const figure::Image image = decode_png(answer->body);
    EXPECT_EQ(image.width, width);
    EXPECT_EQ(image.height, height);
  }
  const auto svg = get(id, "layout.svg");
  EXPECT_EQ(svg->get_header_value("Content-Type"), "image/svg+xml");
  EXPECT_THAT(svg->body, HasSubstr("coloured by stretch"));
}

TEST_F(Pictures, HaveTheSizeAndTheColouringAskedFor) {
  start();
  const std::string id = succeeded();
  EXPECT_EQ(decode_png(get(id, "preview.png?size=100")->body).width, 100);
  EXPECT_EQ(decode_png(get(id, "layout.png?size=64&colour=area")->body).height, 69);
  std::set<std::string> svgs, pngs;
  for (const std::string colour : {"stretch", "angle", "area", "flips"}) {
    const auto svg = get(id, "layout.svg?colour=" + colour);
    EXPECT_THAT(svg->body, HasSubstr("coloured by " + colour));
    svgs.insert(svg->body);
    pngs.insert(get(id, "layout.png?size=256&colour=" + colour)->body);
  }
  EXPECT_EQ(svgs.size(), 4U);
  EXPECT_EQ(pngs.size(), 4U);
}

/// Two faces of a square, wound against each other.
TEST_F(Pictures, ShowFlipsThatTheReportCounts) {
  start();
  const std::string square =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
      "f 1/1 2/2 3/3\nf 1/1 4/4 3/3\n";
  for (const auto& [query, flipped] : {std::pair{"", 0}, std::pair{"?measure_only=true", 1}}) {
    const auto answer = client().Post("/v1/jobs" + std::string(query), {{"Prefer", "wait=60"}},
                                      square, "model/obj");
    const std::string id = api::Json::parse(answer->body).at("id");
    await_state(id, "succeeded");
    const api::Json report = api::Json::parse(get(id, "report")->body);
    EXPECT_EQ(report.at("distortion").at("flipped"), flipped);
    const std::string layout = get(id, "layout.svg?legend=0")->body;
    EXPECT_EQ(layout.find("#ff2a4d") != std::string::npos, flipped > 0) << query;
  }
}

TEST_F(Pictures, AreDrawnOnceAndKeptAtTheUsualSizesOnly) {
  start();
  const std::string id = succeeded();
  EXPECT_EQ(files(id, ".png"), 0);
  EXPECT_EQ(files(id, ".svg"), 0);
  const std::string drawn = get(id, "preview.png?size=128")->body;
  EXPECT_EQ(files(id, "preview.128.png"), 1);
  EXPECT_EQ(get(id, "preview.png?size=128")->body, drawn);
  EXPECT_THAT(get(id, "preview.png?size=129")->body, StartsWith(kSignature));
  EXPECT_EQ(files(id, "preview.129.png"), 0);
}

TEST_F(Pictures, AreDrawnAgainWhenTheyAreDamaged) {
  start();
  const std::string id = succeeded();
  for (const std::string picture : {"layout.svg", "preview.png"}) {
    const std::string whole = get(id, picture)->body;
    for (const auto& entry : std::filesystem::directory_iterator(config_.data / "blobs" / id)) {
      const std::string name = entry.path().filename();
      if (name.ends_with(".png") || name.ends_with(".svg"))
        std::fstream(entry.path()).seekp(100).put('\0');
    }
    EXPECT_EQ(get(id, picture)->body, whole) << picture;
  }
}

TEST_F(Pictures, ComeWithATagAndInParts) {
  start();
  const std::string id = succeeded();
  for (const std::string what : {"layout.svg", "layout.png?size=130", "preview.png?size=64"}) {
    const auto whole = get(id, what);
    const std::string etag = whole->get_header_value("ETag");
    EXPECT_EQ(etag.size(), 66U);
    EXPECT_EQ(get(id, what, {{"If-None-Match", etag}})->status, 304);
    const auto part = get(id, what, {{"Range", "bytes=2-9"}});
    EXPECT_EQ(part->status, 206);
    EXPECT_EQ(part->body, whole->body.substr(2, 8));
  }
}

TEST_F(Pictures, AreTheSameAfterARestart) {
  start();
  const std::string id = succeeded();
  const std::string before = get(id, "preview.png?size=90")->body;
  restart();
  EXPECT_EQ(get(id, "preview.png?size=90")->body, before);
}

TEST_F(Pictures, RefuseWhatTheyDoNotHave) {
  start();
  const std::string id = succeeded();
  for (const auto& [what, pointer] :
       std::vector<std::pair<std::string, std::string>>{{"layout.svg?colour=red", "/colour"},
                                                        {"layout.svg?size=100", "/size"},
                                                        {"layout.png?colour=", "/colour"},
                                                        {"layout.png?size=63", "/size"},
                                                        {"layout.png?size=4097", "/size"},
                                                        {"layout.png?size=1e3", "/size"},
                                                        {"layout.png?size=99999999999", "/size"},
                                                        {"layout.png?size=100&size=101", "/size"},
                                                        {"preview.png?colour=area", "/colour"},
                                                        {"preview.png?color=area", "/color"}}) {
    const auto answer = get(id, what);
    expect_problem(answer, 422, "invalid_option");
    EXPECT_EQ(api::Json::parse(answer->body).at("pointer"), pointer) << what;
  }
}

TEST_F(Pictures, MayHave4096PixelsASide) {
  start();
  EXPECT_EQ(get(succeeded(), "layout.png?size=4096")->status, 200);
}

TEST_F(Pictures, AreNotThereBeforeTheEndNorForAStranger) {
  start();
  const std::string running = submit_endless();
  for (const std::string what : {"layout.svg", "layout.png", "preview.png"}) {
    expect_problem(get(running, what), 409, "job_unfinished");
    expect_problem(get("j_00000000000000000000000000000000", what), 404, "not_found");
  }
}

TEST_F(Pictures, ShareTheFateOfTheirJob) {
  config_.keep_seconds = 1;
  start();
  const auto answer =
      client().Post("/v1/jobs", {{"Prefer", "wait=60"}}, "v 0 0 0\nf 1 2 3\n", "model/obj");
  const api::Json failed = api::Json::parse(answer->body);
  EXPECT_EQ(failed.at("state"), "failed");
  const std::string code = failed.at("problem").at("code");
  expect_problem(get(failed.at("id"), "preview.png"), failed.at("problem").at("status"), code);
  const std::string id = succeeded();
  await([&] { return get(id, "preview.png?size=64")->status != 200; });
  expect_problem(get(id, "layout.png"), 410, "result_expired");
}

/// Each parameter changes the picture, and none is answered with the file of another.
TEST_F(Pictures, OfEveryLookAreTheirOwn) {
  start();
  const std::string id = submit("?height=512");
  await_state(id, "succeeded");
  std::set<std::string> seen;
  const std::vector<std::string> layouts = {"",
                                            "legend=0",
                                            "background=none",
                                            "legend=0&background=none",
                                            "wireframe=1",
                                            "wireframe=1&background=none",
                                            "numbers=1",
                                            "wireframe=1&background=none&page=1&numbers=1",
                                            "wireframe=1&numbers=1",
                                            "page=1&legend=1&background=none"};
  for (const char* file : {"layout.png?size=256&", "layout.svg?"})
    for (const std::string& look : layouts) seen.insert(get(id, file + look)->body);
  for (const char* view : {"auto", "front", "top", "31,20", "31,21", "turntable"})
    seen.insert(get(id, "preview.png?size=256&view=" + std::string(view))->body);
  EXPECT_EQ(seen.size(), 2 * layouts.size() + 6);
  for (const char* file : {"layout.png?size=256&", "layout.svg?"})
    for (const std::string& look : layouts)
      EXPECT_TRUE(seen.contains(get(id, file + look)->body)) << look << " comes again";
  EXPECT_EQ(files(id, ".layout."), 2 + 1 + 1) << "usual ones, and templates of a page";
}

TEST_F(Pictures, ATemplateHasTheTexelsOfItsPage) {
  start();
  const std::string id = submit("?width=300&height=200");
  await_state(id, "succeeded");
  const auto answer = get(id, "layout.png?size=page&wireframe=1&background=none");
  const figure::Image image = decode_png(answer->body);
  EXPECT_EQ(image.width, 300);
  EXPECT_EQ(image.height, 200);
  expect_problem(get(id, "layout.png?page=2"), 422, "invalid_option");
  const std::string large = submit("?resolution=8192");
  await_state(large, "succeeded");
  expect_problem(get(large, "layout.png?size=page"), 422, "invalid_option");
  const figure::Image sheet = decode_png(get(id, "preview.png?view=turntable&size=512")->body);
  EXPECT_EQ(sheet.width, 512);
  EXPECT_EQ(sheet.height, 256);
}

}  // namespace
}  // namespace unwrapd::server::results
