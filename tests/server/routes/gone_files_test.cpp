// A request that has found its job and then not its files tells what has become of the job.
#include <gtest/gtest.h>

#include "server/routes/job_routes.hpp"
#include "server/store/job_store.hpp"
#include "tests/server/temp_dir.hpp"
#include "tests/server/test_database.hpp"

namespace unwrapd::server::routes {
namespace {

class GoneFiles : public testing::Test {
 protected:
  store::JobRecord succeeded() {
    store::JobRecord job;
    job.id = "j_1";
    job.options = api::Json::object();
    jobs_.insert(job);
    jobs_.finish(*jobs_.take(""), {.state = api::JobState::succeeded,
                                   .result_format = "glb",
                                   .problem = {},
                                   .finished_ms = 2000});
    return *jobs_.find(job.id);
  }

  /// What a client is told when reading the files fails with `fault` after `then`.
  template <typename Then>
  ErrorCode told(ErrorCode fault, const Then& then) {
    try {
      answer_with_files(jobs_, succeeded(), [&](const store::JobRecord&) -> http::Response {
        then();
        throw Error(fault, "The file cannot be opened.");
      });
    } catch (const Error& error) {
      return error.code();
    }
    ADD_FAILURE() << "answered";
    return ErrorCode::internal;
  }

  TempDir dir_;
  store::JobStore jobs_{database_in(dir_.path())};
};

TEST_F(GoneFiles, AreToldAsExpiredWhenTheResultHasExpiredMeanwhile) {
  EXPECT_EQ(told(ErrorCode::storage_failed, [&] { jobs_.set_expired("j_1"); }),
            ErrorCode::result_expired);
}

TEST_F(GoneFiles, AreToldAsNotFoundWhenTheJobWasRemovedMeanwhile) {
  EXPECT_EQ(told(ErrorCode::storage_failed, [&] { jobs_.remove("j_1"); }), ErrorCode::not_found);
}

TEST_F(GoneFiles, AreAFaultWhenTheJobIsAsItWas) {
  EXPECT_EQ(told(ErrorCode::storage_corrupt, [] {}), ErrorCode::storage_corrupt);
}

TEST_F(GoneFiles, DoNotHideAnotherFault) {
  EXPECT_EQ(told(ErrorCode::malformed_request, [&] { jobs_.set_expired("j_1"); }),
            ErrorCode::malformed_request);
}

}  // namespace
}  // namespace unwrapd::server::routes
