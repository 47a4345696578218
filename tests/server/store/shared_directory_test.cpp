// A directory of files that several nodes share: what a node does that was taken for dead counts
// for nothing, and no node removes what another works on.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <string>
#include <thread>

#include "core/base/error.hpp"
#include "server/base/files.hpp"
#include "server/base/identity.hpp"
#include "server/blobs/blob_store.hpp"
#include "tests/api/error_of.hpp"
#include "tests/server/temp_dir.hpp"

namespace unwrapd::server::store {
namespace {

namespace fs = std::filesystem;

class SharedDirectory : public testing::Test {
 protected:
  void upload(const std::string& job) {
    write_file(one_.begin_upload(job) / blobs::kDocumentFile, "v 0 0 0\n");
    one_.keep_upload(job, job);
  }
  static void work(blobs::BlobStore& node, const std::string& job, int attempt,
                   const std::string& text) {
    node.write_unsealed(job, attempt, blobs::kReportFile, text);
    node.write_unsealed(job, attempt, "result.glb", "glb of " + text);
    node.seal(job, attempt);
  }
  /// As if it had been written so long ago.
  static void age(const fs::path& path, std::chrono::hours by) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(path))
      fs::last_write_time(entry.path(), fs::file_time_type::clock::now() - by);
    fs::last_write_time(path, fs::file_time_type::clock::now() - by);
  }
  [[nodiscard]] std::size_t unfinished() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(dir_.path() / "incoming"), fs::directory_iterator()));
  }

  TempDir dir_;
  blobs::BlobStore one_{dir_.path(), {}, blobs::Sharing::by_nodes};
  blobs::BlobStore two_{dir_.path(), {}, blobs::Sharing::by_nodes};
};

TEST_F(SharedDirectory, ResultsAreThoseOfTheAttemptThatIsPublished) {
  upload("j_1");
  work(one_, "j_1", 1, "first");
  EXPECT_FALSE(two_.has("j_1", blobs::kReportFile));
  work(two_, "j_1", 2, "second");
  two_.publish("j_1", 2);
  EXPECT_EQ(one_.read("j_1", blobs::kReportFile), "second");
  one_.drop_attempt("j_1", 1);
  EXPECT_EQ(one_.read("j_1", "result.glb"), "glb of second");
  EXPECT_EQ(one_.read("j_1", blobs::kDocumentFile), "v 0 0 0\n") << "inputs keep their digests";
  EXPECT_EQ(unfinished(), 0U);
}

TEST_F(SharedDirectory, ALateNodeChangesNothing) {
  upload("j_1");
  one_.write_unsealed("j_1", 1, blobs::kReportFile, "begun");
  work(two_, "j_1", 2, "second");
  two_.publish("j_1", 2);
  work(one_, "j_1", 1, "late");
  EXPECT_EQ(two_.read("j_1", blobs::kReportFile), "second");
}

TEST_F(SharedDirectory, PublishingGoesOnWhereAnotherNodeDied) {
  upload("j_1");
  work(one_, "j_1", 1, "report");
  const fs::path from = dir_.path() / "incoming" / "j_1.1";
  fs::rename(from / "result.glb", dir_.path() / "blobs" / "j_1" / "result.glb");
  two_.publish("j_1", 1);
  EXPECT_EQ(two_.read("j_1", "result.glb"), "glb of report");
  EXPECT_EQ(two_.read("j_1", blobs::kReportFile), "report");
  EXPECT_NO_THROW(one_.publish("j_1", 1)) << "done already";
  EXPECT_EQ(unfinished(), 0U);
}

TEST_F(SharedDirectory, ManyNodesPublishAndNoteAtATime) {
  upload("j_1");
  work(one_, "j_1", 1, "report");
  std::vector<std::jthread> threads;
  for (int k = 0; k < 8; ++k)
    threads.emplace_back([this, k] {
      blobs::BlobStore node(dir_.path(), {}, blobs::Sharing::by_nodes);
      node.publish("j_1", 1);
      for (int file = 0; file < 5; ++file) {
        const std::string name = "picture." + std::to_string(k) + "." + std::to_string(file);
        EXPECT_TRUE(node.try_keep("j_1", name, name));
      }
    });
  threads.clear();
  for (int k = 0; k < 8; ++k)
    for (int file = 0; file < 5; ++file) {
      const std::string name = "picture." + std::to_string(k) + "." + std::to_string(file);
      EXPECT_EQ(one_.read("j_1", name), name) << "no digest is lost";
    }
  EXPECT_EQ(one_.read("j_1", blobs::kReportFile), "report");
}

TEST_F(SharedDirectory, ManyNodesBeginAtATime) {
  std::vector<std::jthread> threads;
  for (int k = 0; k < 16; ++k)
    threads.emplace_back([this] {
      for (int round = 0; round < 20; ++round) {
        fs::remove(dir_.path() / "digests-noted");
        EXPECT_NO_THROW(blobs::BlobStore(dir_.path(), {}, blobs::Sharing::by_nodes));
      }
    });
}

TEST_F(SharedDirectory, ASweepPublishesWhatADeadNodeHasEnded) {
  upload("j_1");
  work(one_, "j_1", 1, "report");  // its row says that it has succeeded, and nobody asked since
  age(dir_.path(), std::chrono::hours(2));
  static_cast<void>(two_.sweep(
      [this](const std::string& job) {
        two_.publish(job, 1);  // as JobStore::on_found() does
        return blobs::FolderFate::kept;
      },
      1));
  EXPECT_EQ(two_.read("j_1", blobs::kReportFile), "report");
  EXPECT_EQ(unfinished(), 0U);
}

TEST_F(SharedDirectory, ASweepLeavesAloneWhatANodeMayWorkOn) {
  upload("j_new");
  upload("j_old");
  one_.begin_upload("j_coming");
  work(one_, "j_working", 1, "report");
  age(dir_.path() / "blobs" / "j_old", std::chrono::hours(2));
  const auto nobody_knows = [](const std::string&) { return blobs::FolderFate::unknown; };
  EXPECT_EQ(two_.sweep(nobody_knows, 1).lost, std::vector<std::string>{"j_old"});
  EXPECT_TRUE(two_.holds("j_new"));
  EXPECT_EQ(unfinished(), 2U);
  age(dir_.path() / "incoming", std::chrono::hours(2));
  static_cast<void>(two_.sweep(nobody_knows, 1));
  EXPECT_EQ(unfinished(), 0U) << "of a node that is gone";
}

TEST_F(SharedDirectory, ADocumentCountsForEachJobThatSharesIt) {
  const std::string mesh = random_mesh_id();
  upload(mesh);
  EXPECT_FALSE(two_.is_shared(mesh));
  one_.begin_upload("j_1");
  ASSERT_TRUE(one_.share_document(mesh, "j_1"));
  one_.keep_upload("j_1", "j_1");
  EXPECT_TRUE(two_.is_shared(mesh)) << "told by another node's job";
  EXPECT_EQ(two_.bytes("j_1"), 8);
  EXPECT_EQ(two_.bytes(mesh), 8);
}

}  // namespace
}  // namespace unwrapd::server::store
