// A process that may have few files open: who gets them, and what happens when there are none.

#include <gtest/gtest.h>

#include "server/base/errors.hpp"
#include "server/blobs/blob_store.hpp"
#include "server/config/component_config.hpp"
#include "server/http/listener.hpp"
#include "tests/api/error_of.hpp"
#include "tests/server/few_descriptors.hpp"
#include "tests/server/raw_client.hpp"
#include "tests/server/temp_dir.hpp"

namespace unwrapd::server::config {
namespace {

TEST(Descriptors, AreKeptBackForAnswersJobsAndTheAdminPort) {
  Config config;
  config.admin = http::Address{"127.0.0.1", 8081};
  config.workers = 4;
  EXPECT_EQ(connections_within(1'000'000, config), config.edge.max_connections);
  int before = 0;
  for (std::int64_t files = kFewestDescriptors; files < 8192; files += 61) {
    const int connections = connections_within(files, config);
    EXPECT_GE(connections, before) << "more files, more connections";
    EXPECT_GE(connections, 16);
    EXPECT_LE(connections, std::max<std::int64_t>(files / 4, files - 64 - 3 * 64));
    before = connections;
  }
  EXPECT_EQ(error_of([&] { connections_within(kFewestDescriptors - 1, config); }).code(),
            ErrorCode::internal);
}

TEST(Descriptors, OfWhichNoneIsLeftAreAReasonToComeBack) {
  const TempDir dir;
  write_file(dir.path() / "file", "x");
  const FewDescriptors none;
  try {
    File::open(dir.path() / "file");
    ADD_FAILURE() << "opened";
  } catch (const RetryLater& error) {
    EXPECT_EQ(error.code(), ErrorCode::rate_limited);
    EXPECT_GE(error.seconds(), 1);
  }
}

TEST(Descriptors, AreNotNeededToRemoveAFile) {
  const TempDir dir;
  write_file(dir.path() / "file", "x");
  const FewDescriptors none;
  remove_tree(dir.path() / "file");
  EXPECT_FALSE(std::filesystem::exists(dir.path() / "file"));
}

TEST(Descriptors, WithoutWhichNothingCanBeRemovedLeaveNoFolderBehind) {
  const TempDir dir;
  blobs::BlobStore blobs(dir.path());
  const std::filesystem::path upload = blobs.begin_upload("u");
  write_file(upload / "document", "x");
  {
    const FewDescriptors none;
    blobs.drop_upload("u");
    EXPECT_TRUE(std::filesystem::exists(upload));
    EXPECT_EQ(blobs.remove_left(), 1);
    EXPECT_TRUE(std::filesystem::exists(upload));
  }
  EXPECT_EQ(blobs.remove_left(), 1);
  EXPECT_FALSE(std::filesystem::exists(upload));
  EXPECT_EQ(blobs.remove_left(), 0);
}

TEST(Descriptors, OfWhichNoneIsLeftShutOutClientsWithoutDelay) {
  const http::Listener listener("127.0.0.1", 0);
  const auto first = std::make_unique<RawClient>(listener.port());
  const auto second = std::make_unique<RawClient>(listener.port());
  {
    const FewDescriptors none;  // but for the one that the listener gives back
    EXPECT_FALSE(listener.accept());
  }
  EXPECT_EQ(first->read_to_end(), "") << "it is told at once";
  const std::optional<http::Accepted> served = listener.accept();
  ASSERT_TRUE(served) << "the second was not touched";
  ::close(served->socket);
}

}  // namespace
}  // namespace unwrapd::server::config
