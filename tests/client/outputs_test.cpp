// The files of a job with one map and of a job with several, from a server that tells what it was
// asked for.
#include "client/outputs.hpp"

#include <gmock/gmock.h>

#include "tests/client/expect_failure.hpp"
#include "tests/client/fake_server.hpp"
#include "tests/client/temporary_folder.hpp"

namespace unwrapd::client {
namespace {

using testing::HasSubstr;

/// Answers every GET with its own path and query.
class Echo {
 public:
  Echo() {
    server_.routes().Get(".*", [](const httplib::Request& request, httplib::Response& response) {
      response.set_content(request.target, "text/plain");
    });
    server_.start();
  }
  JobClient client() { return JobClient(parse_server_url(server_.address()), {}); }

 private:
  FakeServer server_;
};

Arguments everything(const TemporaryFolder& folder) {
  Arguments arguments;
  arguments.out = folder.file("bust.uv.glb");
  arguments.report = folder.file("report.json");
  arguments.layout = folder.file("layout.png");
  arguments.layout_colour = "area";
  arguments.preview = folder.file("preview.png");
  return arguments;
}

TEST(Outputs, AMapsFilesCarryItsLambdaBeforeTheExtension) {
  EXPECT_EQ(map_path("a.b/bust.uv.glb", "0.01"), "a.b/bust.uv.0.01.glb");
  EXPECT_EQ(map_path("bust", "1e+5"), "bust.1e+5");
  EXPECT_EQ(map_path("bust.glb", ""), "bust.glb");
}

TEST(Outputs, OfOneMapAreAskedForWithoutALambda) {
  Echo echo;
  JobClient client = echo.client();
  const TemporaryFolder folder;
  Outputs outputs(everything(folder));
  const std::vector<WrittenMap> maps = outputs.fill(client, "j_1");
  ASSERT_EQ(maps.size(), 1U);
  EXPECT_EQ(maps[0].result, folder.file("bust.uv.glb"));
  EXPECT_EQ(maps[0].report, "/v1/jobs/j_1/report");
  EXPECT_EQ(read_file(folder.file("bust.uv.glb")), "/v1/jobs/j_1/result");
  EXPECT_EQ(read_file(folder.file("layout.png")), "/v1/jobs/j_1/layout.png?colour=area");
  EXPECT_EQ(folder.file_count(), 4U);
}

TEST(Outputs, OfACurveAreWrittenForEveryLambda) {
  Echo echo;
  JobClient client = echo.client();
  const TemporaryFolder folder;
  Arguments arguments = everything(folder);
  arguments.lambdas = {"1e+1", "0.01"};
  Outputs outputs(arguments);
  const std::vector<WrittenMap> maps = outputs.fill(client, "j_1");
  ASSERT_EQ(maps.size(), 2U);
  EXPECT_EQ(maps[1].result, folder.file("bust.uv.0.01.glb"));
  EXPECT_EQ(read_file(maps[0].result), "/v1/jobs/j_1/result?lambda=1e%2B1");
  EXPECT_EQ(read_file(maps[1].result), "/v1/jobs/j_1/result?lambda=0.01");
  EXPECT_EQ(read_file(folder.file("layout.0.01.png")),
            "/v1/jobs/j_1/layout.png?colour=area&lambda=0.01");
  EXPECT_EQ(read_file(folder.file("report.json")), maps[0].report);
  EXPECT_EQ(folder.file_count(), 7U);
}

TEST(Outputs, OfATemplateAndAViewAreWhatIsAskedFor) {
  Echo echo;
  JobClient client = echo.client();
  const TemporaryFolder folder;
  Arguments arguments = everything(folder);
  arguments.painting = folder.file("paint.png");
  arguments.preview_view = "30,20&size=9";
  arguments.lambdas = {"1", "0.01"};
  static_cast<void>(Outputs(arguments).fill(client, "j_1"));
  EXPECT_EQ(read_file(folder.file("paint.0.01.png")),
            "/v1/jobs/j_1/layout.png?size=page&wireframe=1&background=none&lambda=0.01");
  EXPECT_EQ(read_file(folder.file("preview.1.png")),
            "/v1/jobs/j_1/preview.png?view=30%2C20%26size%3D9&lambda=1");
}

TEST(Outputs, ThatCannotBeWrittenAreRefusedBeforeAnythingIsFetched) {
  const TemporaryFolder folder;
  Arguments arguments = everything(folder);
  arguments.preview = folder.file("missing") / "preview.png";
  expect_failure(ExitCode::file, [&] { const Outputs outputs(arguments); });
  EXPECT_EQ(folder.file_count(), 0U);
}

/// The message of the refusal; empty if there is none.
std::string refusal(const Arguments& arguments) {
  try {
    check_outputs(arguments);
    return {};
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ExitCode::usage);
    return failure.what();
  }
}

TEST(Outputs, AreDifferentFilesAndNotTheInput) {
  const TemporaryFolder folder;
  Arguments arguments = everything(folder);
  arguments.file = folder.write("bust.glb", "mesh");
  EXPECT_EQ(refusal(arguments), "");
  std::filesystem::create_symlink("bust.glb", folder.file("link.glb"));
  for (const std::string same : {"bust.glb", "./bust.glb", "link.glb"}) {
    arguments.out = folder.file(same);
    EXPECT_THAT(refusal(arguments), HasSubstr("--out names the input")) << same;
  }
  for (const std::string same : {"report.json", "none/../report.json"}) {
    arguments.out = folder.file(same);
    EXPECT_THAT(refusal(arguments), HasSubstr("--out and --report name the same file")) << same;
  }
  arguments.out = folder.file("bust.uv.glb");
  arguments.lambdas = {"1", "0.1"};
  EXPECT_EQ(refusal(arguments), "");
  arguments.report = folder.file("layout.0.1.png");
  EXPECT_THAT(refusal(arguments), HasSubstr("--layout and --report name the same file"));
  arguments.report = arguments.layout = "/dev/null";
  EXPECT_EQ(refusal(arguments), "") << "a device takes all";
  arguments.layout = arguments.preview = "";
  EXPECT_EQ(refusal(arguments), "") << "what is not written has no name";
}

TEST(Outputs, OnStandardOutputAreOne) {
  const TemporaryFolder folder;
  Arguments arguments = everything(folder);
  EXPECT_FALSE(writes_to_standard_output(arguments));
  arguments.preview = "-";
  EXPECT_TRUE(writes_to_standard_output(arguments));
  EXPECT_EQ(refusal(arguments), "");
  arguments.json = true;
  EXPECT_THAT(refusal(arguments), HasSubstr("--json"));
  arguments.json = false;
  arguments.report = "-";
  EXPECT_THAT(refusal(arguments), HasSubstr("Standard output (-) takes one file"));
  arguments.report.clear();
  arguments.lambdas = {"1", "0.1"};
  EXPECT_THAT(refusal(arguments), HasSubstr("2 would be written"));
}

}  // namespace
}  // namespace unwrapd::client
