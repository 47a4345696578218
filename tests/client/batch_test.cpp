// Several meshes against a server that behaves badly on purpose; tests/e2e has the real one.
#include "client/batch.hpp"

#include <gmock/gmock.h>

#include <sstream>

#include "api/events.hpp"
#include "client/files.hpp"
#include "tests/client/expect_failure.hpp"
#include "tests/client/fake_server.hpp"
#include "tests/client/temporary_folder.hpp"

namespace unwrapd::client {
namespace {

using testing::HasSubstr;

constexpr const char* kShortReport =
    R"({"input":{"faces":1},"charts":[{}],"seam_ratio":1,"fill":0.5,"overlaps":0,"notes":[],)"
    R"("distortion":{"angle":2,"area":2,"flipped":0}})";

/// Takes every mesh but those with the text "strange", whose upload something before it refuses.
class Batches : public testing::Test {
 protected:
  void SetUp() override {
    server_.routes().Post("/v1/jobs",
                          [this](const httplib::Request& request, httplib::Response& reply) {
                            output_ = request.get_param_value("output");
                            if (request.body.find("strange") == std::string::npos)
                              return answer(reply, 202, to_json(job_in(api::JobState::queued)));
                            reply.status = 413;
                            reply.set_content("<html>", "text/html");
                          });
    const auto answer_with = [&](const char* what, std::string text, const char* type) {
      server_.routes().Get(std::string("/v1/jobs/j_1/") + what,
                           [=](const httplib::Request&, httplib::Response& reply) {
                             reply.set_content(text, type);
                           });
    };
    answer_with("events", api::sse_frame(api::final_event(1, job_in(api::JobState::succeeded))),
                "text/event-stream");
    answer_with("result", "vt 0 0\n", "model/obj");
    answer_with("report", kShortReport, "application/json");
    server_.start();
  }

  /// What the command prints.
  std::string run(const char* input = "in") {
    Arguments arguments;
    arguments.inputs = {folder_.file(input)};
    arguments.out = folder_.file("out");
    arguments.jobs = 1;  // one after the other
    std::ostringstream out, err;
    const Servers servers(parse_server_url(server_.address()));
    try {
      run_batch(arguments, servers, {out, err, ProgressStyle::lines}, {});
    } catch (const Failure& failure) {
      code_ = failure.code();
    }
    return out.str();
  }

  std::string output_;  ///< format that the last request asks for
  FakeServer server_;
  const TemporaryFolder folder_;
  ExitCode code_ = ExitCode::ok;
};

TEST_F(Batches, AStrangeAnswerBetweenOthersIsOfOneMesh) {
  folder_.write("in/a.obj", "v");
  folder_.write("in/b.obj", "strange");
  folder_.write("in/c.obj", "v");
  EXPECT_THAT(run(), HasSubstr("2 done, 1 failed"));
  EXPECT_EQ(code_, ExitCode::job_failed);
}

TEST_F(Batches, AnotherServiceIsToldAtTheFirstMesh) {
  folder_.write("in/a.obj", "strange");
  folder_.write("in/b.obj", "v");
  EXPECT_EQ(run(), "");
  EXPECT_EQ(code_, ExitCode::unreachable);
}

TEST_F(Batches, AResultIsAGlbWhereTheInputsNameDoesNotTellItsFormat) {
  folder_.write("in/a.obj", "v");
  run("in/a.obj");
  EXPECT_EQ(output_, "");
  folder_.write("in/a.txt", "v");
  EXPECT_THAT(run("in/a.txt"), HasSubstr("1 done, 0 failed"));
  EXPECT_EQ(output_, "glb");
  EXPECT_EQ(read_file(folder_.file("out/a.glb")), "vt 0 0\n");
}

}  // namespace
}  // namespace unwrapd::client
