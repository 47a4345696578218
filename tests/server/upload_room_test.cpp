// What an upload may take, and what is never given up for one that is then refused.
#include "server/upload_room.hpp"

#include <gtest/gtest.h>

#include "server/mesh_store.hpp"
#include "temp_dir.hpp"
#include "tests/api/error_of.hpp"

namespace unwrapd::server {
namespace {

/// Room for 1000 bytes, 750 of them for uploads, in which a finished job has 400.
class RoomOfAnUpload : public testing::Test {
 protected:
  RoomOfAnUpload() {
    room_.set("finished", 400);
    const auto evict = [this] {
      if (evicted_) return false;
      evicted_ = true;
      room_.give_back("finished");
      return true;
    };
    room_.on_shortage({.evict = evict, .bytes = [this] { return evicted_ ? 0 : 400; }});
  }

  static ErrorCode refusal(const std::function<void()>& act) { return error_of(act).code(); }

  TempDir dir_;
  DiskRoom room_{dir_.path(), {.max_bytes = 1000, .min_free_bytes = 0}};
  bool evicted_ = false;
};

TEST_F(RoomOfAnUpload, IsMadeForOneThatFits) {
  UploadRoom upload(room_, "u", {}, 750);
  upload.check_declared();
  upload.take(350);
  EXPECT_FALSE(evicted_);
  upload.take(400);
  EXPECT_TRUE(evicted_);
  EXPECT_EQ(room_.used_bytes(), 750);
}

TEST_F(RoomOfAnUpload, IsRefusedBeforeItsBytesWhenTheyCanNeverFit) {
  const UploadRoom upload(room_, "u", {}, 751);
  EXPECT_EQ(refusal([&] { upload.check_declared(); }), ErrorCode::storage_full);
}

TEST_F(RoomOfAnUpload, IsRefusedBeforeItsBytesByTheQuota) {
  const UploadRoom upload(room_, "u", {.left = 10, .most = 10}, 11);
  EXPECT_EQ(refusal([&] { upload.check_declared(); }), ErrorCode::quota_exceeded);
}

TEST_F(RoomOfAnUpload, IsNotMadeForAFormThatIsTooLarge) {
  UploadRoom too_large(room_, "u", {}, 751);
  too_large.take(350);
  EXPECT_EQ(refusal([&] { too_large.take(1); }), ErrorCode::storage_full);
  room_.give_back("u");
  UploadRoom beyond_quota(room_, "u", {.left = 700, .most = 700}, 701);
  beyond_quota.take(350);
  EXPECT_EQ(refusal([&] { beyond_quota.take(1); }), ErrorCode::quota_exceeded);
  EXPECT_FALSE(evicted_);
}

TEST_F(RoomOfAnUpload, IsNotMadeForThePieceThatIsTooLarge) {
  UploadRoom beyond_quota(room_, "u", {.left = 500, .most = 500}, 0);
  EXPECT_EQ(refusal([&] { beyond_quota.take(501); }), ErrorCode::quota_exceeded);
  UploadRoom too_large(room_, "u", {}, 0);
  EXPECT_EQ(refusal([&] { too_large.take(751); }), ErrorCode::storage_full);
  EXPECT_FALSE(evicted_);
}

TEST_F(RoomOfAnUpload, IsNotMadeWhereThatWouldNotDo) {
  room_.set("at work", 300);
  UploadRoom upload(room_, "u", {}, 451);
  upload.take(50);
  EXPECT_EQ(refusal([&] { upload.take(1); }), ErrorCode::storage_full);
  EXPECT_FALSE(evicted_);
  room_.give_back("u");
  UploadRoom smaller(room_, "u", {}, 450);
  smaller.take(450);
  EXPECT_TRUE(evicted_);
}

class AllowanceOfAnOwner : public testing::Test {
 protected:
  void add(const std::string& id, std::int64_t bytes) {
    JobRecord job;
    job.id = id;
    job.owner = "his";
    job.input.sha256 = id;
    job.stored_bytes = bytes;
    job.options = job.notes = api::Json::array();
    store_.insert(job);
  }

  TempDir dir_;
  JobStore store_{dir_.path() / "jobs.sqlite"};
  Caller his_{.owner = "his", .sees_all = false, .quota = {.max_bytes = 100}};
};

TEST_F(AllowanceOfAnOwner, IsWhatTheQuotaLeaves) {
  add("j_1", 70);
  EXPECT_EQ(allowance_of(store_, his_, 0).left, 30);
  EXPECT_EQ(allowance_of(store_, his_, 0).most, 100);
  his_.quota = {};
  EXPECT_EQ(allowance_of(store_, his_, 0).left, std::numeric_limits<std::int64_t>::max());
}

TEST_F(AllowanceOfAnOwner, IsEnoughToSendTheSameAgain) {
  add("j_1", 70);
  EXPECT_EQ(allowance_of(store_, his_, 70).left, 70);
}

TEST_F(AllowanceOfAnOwner, CountsAsEvictableWhatNoLiveJobNeeds) {
  MeshStore meshes(dir_.path() / "jobs.sqlite");
  meshes.put({.id = "m_1", .owner = "his", .sha256 = "j_1", .media_type = "", .stored_bytes = 5});
  meshes.put({.id = "m_2", .owner = "his", .sha256 = "ab", .media_type = "", .stored_bytes = 2});
  add("j_1", 70);
  EXPECT_EQ(store_.evictable_bytes(), 2) << "j_1 waits, and is about m_1";
  store_.finish(*store_.take("his", 1), {.result_format = "", .problem = {}, .stored_bytes = 80});
  EXPECT_EQ(store_.evictable_bytes(), 87);
  store_.set_expired("j_1");
  EXPECT_EQ(store_.evictable_bytes(), 7);
}

}  // namespace
}  // namespace unwrapd::server
