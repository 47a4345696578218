// Folders in a bucket of a real object store (tests/bucket/with_bucket.mjs): which lists count, and
// what is removed.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "server/base/files.hpp"
#include "server/base/identity.hpp"
#include "server/blobs/blob_store.hpp"
#include "tests/server/temp_dir.hpp"

namespace unwrapd::server::blobs {
namespace {

using namespace std::chrono_literals;

class Bucketed : public testing::Test {
 protected:
  std::unique_ptr<BucketFolders> folders(const SweepAges& ages = {.at_work = 0s, .unknown = 0s}) {
    bucket::BucketConfig config;
    config.url = "s3://jobs/" + prefix_;
    config.endpoint = std::getenv("TEST_BUCKET");
    return std::make_unique<BucketFolders>(bucket::address_of(config), "n_1", ages, log_);
  }
  BlobStore node(const std::string& name) {
    return {dir_.path() / name, {}, folders(), std::int64_t{1} << 30};
  }
  static void upload(BlobStore& node, const std::string& job, const std::string& text) {
    write_file(node.begin_upload("in") / kDocumentFile, text);
    node.keep_upload("in", job);
  }
  static void work(BlobStore& node, const std::string& job, int attempt, const std::string& text) {
    node.write_unsealed(job, attempt, kReportFile, text);
    node.write_unsealed(job, attempt, "result.glb", "glb of " + text);
    node.seal(job, attempt);
  }
  std::size_t objects() {
    bucket::BucketConfig config;
    config.url = "s3://jobs/" + prefix_;
    config.endpoint = std::getenv("TEST_BUCKET");
    return bucket::Bucket(bucket::address_of(config)).list("j_").size();
  }
  void expect_objects(std::size_t count) {
    for (int k = 0; k < 200 && objects() != count; ++k) std::this_thread::sleep_for(20ms);
    EXPECT_EQ(objects(), count);
  }

  TempDir dir_;
  const Log log_{LogLevel::warning, LogFormat::text};
  const std::string prefix_ = random_hex(8);
};

constexpr std::size_t kOfInput = 2, kOfAttempt = 3, kOfResult = 1;

TEST_F(Bucketed, ResultsAreThoseOfTheAttemptThatSucceeded) {
  BlobStore one = node("one"), two = node("two");
  upload(one, "j_1", "v 0 0 0\n");
  EXPECT_EQ(two.read("j_1", kDocumentFile), "v 0 0 0\n");
  work(one, "j_1", 1, "first");
  EXPECT_FALSE(two.has("j_1", kReportFile));
  work(two, "j_1", 2, "second");
  one.note_row("j_1", 5, 2);  // the node that made it says nothing
  EXPECT_EQ(one.read("j_1", "result.glb"), "glb of second");
  EXPECT_EQ(one.read("j_1", kReportFile), "second");
}

TEST_F(Bucketed, OneOfTwoUploadsUnderANameWins) {
  BlobStore one = node("one"), two = node("two");
  upload(one, "j_1", "one");
  EXPECT_TRUE(two.holds("j_1"));
  EXPECT_THROW(upload(two, "j_1", "two"), Error);
  EXPECT_EQ(two.read("j_1", kDocumentFile), "one");
}

TEST_F(Bucketed, ASweepTakesWhatNoListNamesAndPublishesFirst) {
  BlobStore one = node("one");
  upload(one, "j_1", "v");
  work(one, "j_1", 1, "of a node that died");
  work(one, "j_1", 2, "of one that died before it published");
  BlobStore two = node("two");
  const auto fates = [&](const std::string& job) {
    if (job != "j_1") return FolderFate::unknown;
    two.note_row(job, 5, 2);  // as JobStore::on_found() does
    return FolderFate::kept;
  };
  static_cast<void>(two.sweep(fates, 0));
  EXPECT_EQ(objects(), kOfInput + kOfAttempt + kOfResult);
  EXPECT_EQ(two.read("j_1", kReportFile), "of one that died before it published");
  static_cast<void>(two.sweep([](const std::string&) { return FolderFate::gone; }, 0));
  EXPECT_EQ(objects(), 0U);
}

TEST_F(Bucketed, ASweepLeavesAloneWhatIsYoungOrUnknown) {
  BlobStore one = node("one");
  upload(one, "j_1", "v");
  for (const int attempt : {1, 2}) work(one, "j_1", attempt, "report");
  const auto all = [](FolderFate fate) { return [=](const std::string&) { return fate; }; };
  const auto nothing = [](const std::string&) {};
  EXPECT_EQ(folders({})->sweep(all(FolderFate::gone), nothing), 0);
  EXPECT_EQ(folders({})->sweep(all(FolderFate::kept), nothing), 0);
  EXPECT_EQ(folders({.at_work = 0s, .unknown = 1h})->sweep(all(FolderFate::unknown), nothing), 0);
  EXPECT_EQ(objects(), kOfInput + 2 * kOfAttempt);
}

TEST_F(Bucketed, ARemovalTakesNothingOfTheNextJobOfItsName) {
  BlobStore one = node("one"), two = node("two");
  upload(one, "j_1", "first");
  work(one, "j_1", 1, "first");
  const auto late = folders();
  ASSERT_TRUE(late->set_aside("j_1"));
  upload(two, "j_1", "second");
  late->remove_later("j_1", "");  // of a node that never knew the first
  one.remove("j_1");
  expect_objects(kOfInput);
  EXPECT_EQ(two.read("j_1", kDocumentFile), "second");
  EXPECT_EQ(node("three").read("j_1", kDocumentFile), "second");
  two.remove("j_1");
  expect_objects(0);
}

TEST_F(Bucketed, AnotherJobGetsTheSameResults) {
  BlobStore one = node("one");
  upload(one, "j_1", "v");
  upload(one, "j_2", "v");
  work(one, "j_1", 1, "report");
  folders()->publish(folders()->find("j_1").root, 1);
  BlobStore two = node("two");
  EXPECT_FALSE(two.adopt("j_1", "j_2")) << "it has none";
  ASSERT_TRUE(one.adopt("j_2", "j_1"));
  one.remove("j_1");
  EXPECT_EQ(two.read("j_2", "result.glb"), "glb of report");
}

TEST_F(Bucketed, LinksAreToResultsOfTheRowThatIsMeant) {
  BlobStore one = node("one"), two = node("two");
  upload(one, "j_1", "v");
  work(one, "j_1", 1, "report");
  const auto link = [&](std::int64_t seq, const char* file) {
    return two.link("j_1", seq, file, "GET", "model/gltf-binary");
  };
  two.note_row("j_1", 5, 0);
  EXPECT_FALSE(link(5, "result.glb")) << "it has not succeeded";
  two.note_row("j_1", 5, 1);
  const std::optional<ResultLink> linked = link(5, "result.glb");
  ASSERT_TRUE(linked);
  EXPECT_EQ(linked->sha256, sha256("glb of report"));
  EXPECT_NE(linked->url.find("/1/result.glb?"), std::string::npos) << linked->url;
  EXPECT_FALSE(link(5, "result.obj")) << "the bucket has none";
  EXPECT_FALSE(link(5, kDocumentFile.data())) << "it is no result";
  EXPECT_FALSE(link(4, "result.glb")) << "of the job that had the name before";
  one.remove("j_1");
  expect_objects(0);
  upload(one, "j_1", "w");
  two.note_row("j_1", 6, 0);
  EXPECT_FALSE(link(6, "result.glb")) << "the next has none yet";
  EXPECT_FALSE(BlobStore(dir_.path() / "alone").link("j_1", 5, "result.glb", "GET", "model/obj"));
}

TEST_F(Bucketed, CopiesGoWhereTheyAreTooManyAndComeBack) {
  BlobStore small(dir_.path() / "small", {}, folders(), 100);
  for (const std::string job : {"j_1", "j_2", "j_3"}) upload(small, job, std::string(60, 'v'));
  EXPECT_EQ(small.read("j_1", kDocumentFile).size(), 60U) << "used last";
  small.note_row("j_1", 1, 0);
  small.trim_copies();
  const auto copies = dir_.path() / "small" / "blobs";
  EXPECT_TRUE(std::filesystem::exists(copies / "j_1"));
  EXPECT_FALSE(std::filesystem::exists(copies / "j_2"));
  EXPECT_EQ(small.read("j_2", kDocumentFile).size(), 60U);
}

}  // namespace
}  // namespace unwrapd::server::blobs
