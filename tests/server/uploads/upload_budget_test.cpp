// What an upload may take, and what is never given up for one that is then refused.
#include "server/uploads/upload_budget.hpp"

#include <gtest/gtest.h>

#include "server/store/mesh_store.hpp"
#include "server/uploads/spooled_text.hpp"
#include "tests/api/error_of.hpp"
#include "tests/server/temp_dir.hpp"
#include "tests/server/test_database.hpp"

namespace unwrapd::server::uploads {
namespace {

/// Room for 1000 bytes, 750 of them for uploads, in which a finished job has 400.
class RoomOfAnUpload : public testing::Test {
 protected:
  RoomOfAnUpload() {
    disk_.set("finished", 400);
    const auto evict = [this] {
      if (evicted_) return false;
      evicted_ = true;
      disk_.give_back("finished");
      return true;
    };
    disk_.on_shortage({.evict = evict, .bytes = [this] { return evicted_ ? 0 : 400; }});
  }

  static http::Caller caller(std::int64_t most) {
    return {.owner = "his", .sees_all = false, .quota = {.max_bytes = most}};
  }
  UploadBudget upload(std::int64_t declared, std::int64_t most = 0, std::int64_t known = 0) {
    const std::string name = "u" + std::to_string(++uploads_);
    return {rooms_, caller(most), name, {.known_bytes = known, .declared_bytes = declared}};
  }
  void add(const std::string& id, std::int64_t bytes) {
    store::JobRecord job;
    job.id = id;
    job.owner = "his";
    job.input.sha256 = id;
    job.stored_bytes = bytes;
    job.options = job.notes = api::Json::array();
    store_.insert(job);
  }

  static ErrorCode refusal(const std::function<void()>& act) { return error_of(act).code(); }

  TempDir dir_;
  store::JobStore store_{database_in(dir_.path())};
  blobs::DiskBudget disk_{dir_.path(), {.max_bytes = 1000, .min_free_bytes = 0}};
  store::QuotaReservations reservations_{store_};
  const UploadRooms rooms_{reservations_, disk_};
  bool evicted_ = false;
  int uploads_ = 0;
};

TEST_F(RoomOfAnUpload, IsMadeForOneThatFits) {
  UploadBudget room = upload(750);
  room.check_declared();
  room.take(350);
  EXPECT_FALSE(evicted_);
  room.take(400);
  EXPECT_TRUE(evicted_);
  EXPECT_EQ(disk_.used_bytes(), 750);
}

TEST_F(RoomOfAnUpload, IsRefusedBeforeItsBytesWhenTheyCanNeverFit) {
  UploadBudget room = upload(751);
  EXPECT_EQ(refusal([&] { room.check_declared(); }), ErrorCode::storage_full);
}

TEST_F(RoomOfAnUpload, IsRefusedBeforeItsBytesByTheQuota) {
  UploadBudget room = upload(11, 10);
  EXPECT_EQ(refusal([&] { room.check_declared(); }), ErrorCode::quota_exceeded);
}

TEST_F(RoomOfAnUpload, IsNotMadeForAFormThatIsTooLarge) {
  UploadBudget too_large = upload(751);
  too_large.take(350);
  EXPECT_EQ(refusal([&] { too_large.take(1); }), ErrorCode::storage_full);
  disk_.give_back("u1");
  UploadBudget beyond_quota = upload(701, 700);
  beyond_quota.take(350);
  EXPECT_EQ(refusal([&] { beyond_quota.take(1); }), ErrorCode::quota_exceeded);
  EXPECT_FALSE(evicted_);
}

TEST_F(RoomOfAnUpload, IsNotMadeForThePieceThatIsTooLarge) {
  UploadBudget beyond_quota = upload(0, 500);
  EXPECT_EQ(refusal([&] { beyond_quota.take(501); }), ErrorCode::quota_exceeded);
  UploadBudget too_large = upload(0);
  EXPECT_EQ(refusal([&] { too_large.take(751); }), ErrorCode::storage_full);
  EXPECT_FALSE(evicted_);
}

TEST_F(RoomOfAnUpload, IsNotMadeWhereThatWouldNotDo) {
  disk_.set("at work", 300);
  UploadBudget room = upload(451);
  room.take(50);
  EXPECT_EQ(refusal([&] { room.take(1); }), ErrorCode::storage_full);
  EXPECT_FALSE(evicted_);
  disk_.give_back("u1");
  UploadBudget smaller = upload(450);
  smaller.take(450);
  EXPECT_TRUE(evicted_);
}

TEST_F(RoomOfAnUpload, IsWhatTheQuotaLeaves) {
  add("j_1", 70);
  UploadBudget fits = upload(30, 100);
  fits.check_declared();
  fits.take(30);
  EXPECT_EQ(refusal([&] { fits.take(1); }), ErrorCode::quota_exceeded);
}

TEST_F(RoomOfAnUpload, CountsWhatItsOwnerSendsBeside) {
  for (const bool declared : {true, false}) {
    UploadBudget second = upload(0, 100);
    {
      UploadBudget first = upload(declared ? 60 : 0, 100);
      declared ? first.check_declared() : first.take(60);
      EXPECT_EQ(refusal([&] { second.take(41); }), ErrorCode::quota_exceeded);
    }
    second.take(59);  // the first has come to nothing
  }
}

TEST_F(RoomOfAnUpload, LearnsWhatWasStoredMeanwhileBeforeAnythingIsGivenUp) {
  UploadBudget room = upload(0, 500);
  room.take(200);  // twice as much is claimed
  add("j_1", 151);
  room.take(150);
  EXPECT_EQ(refusal([&] { room.take(1); }), ErrorCode::quota_exceeded);
  EXPECT_FALSE(evicted_);
}

TEST_F(RoomOfAnUpload, IsMadeForAllThatTheQuotaLeaves) {
  UploadBudget room = upload(0, 500);
  room.take(200);
  add("j_1", 149);
  room.take(150);
  room.take(1);
  EXPECT_TRUE(evicted_);
}

TEST_F(RoomOfAnUpload, IsEnoughToSendTheSameAgain) {
  add("j_1", 130);  // what was made of it counts, too, and may go beyond the quota
  UploadBudget again = upload(70, 100, 70);
  again.check_declared();
  UploadBudget twice = upload(70, 100, 70);
  twice.check_declared();
  twice.take(70);
  EXPECT_EQ(refusal([&] { again.take(71); }), ErrorCode::quota_exceeded);
  disk_.set("at work", 250);
  EXPECT_EQ(refusal([&] { UploadBudget(upload(70, 100, 70)).take(70); }), ErrorCode::storage_full);
  EXPECT_FALSE(evicted_) << "only the first may take from others";
  again.take(70);
  EXPECT_TRUE(evicted_);
}

TEST_F(RoomOfAnUpload, CanBeMadeOfWhatNoLiveJobNeeds) {
  store::MeshStore meshes(database_in(dir_.path()));
  meshes.put({.id = "m_1", .owner = "his", .sha256 = "j_1", .media_type = "", .stored_bytes = 5});
  meshes.put({.id = "m_2", .owner = "his", .sha256 = "ab", .media_type = "", .stored_bytes = 2});
  add("j_1", 70);
  EXPECT_EQ(store_.evictable_bytes(), 2) << "j_1 waits, and is about m_1";
  store_.finish(*store_.take("his"), {.result_format = "", .problem = {}, .stored_bytes = 80});
  EXPECT_EQ(store_.evictable_bytes(), 87);
  store_.set_expired("j_1");
  EXPECT_EQ(store_.evictable_bytes(), 7);
}

TEST_F(RoomOfAnUpload, IsSharedWithResultsThatAreMade) {
  add("j_1", 40);
  store::QuotaReservation results(reservations_, "his");
  results.add(50, 100);
  UploadBudget beside = upload(11, 100);
  EXPECT_EQ(refusal([&] { beside.check_declared(); }), ErrorCode::quota_exceeded);
  EXPECT_EQ(refusal([&] { results.add(11, 100); }), ErrorCode::quota_exceeded);
  results.add(10, 100);
  results.give_up();  // made again
  beside.check_declared();
  EXPECT_NO_THROW(results.add(1000, 0)) << "without a quota";
}

TEST_F(RoomOfAnUpload, CountsALongTextWhileItIsThere) {
  UploadBudget room = upload(0, 500);
  {
    SpooledText text(dir_.path() / "text", room.counter());
    text.append(std::string(400, 'x'));
    EXPECT_EQ(disk_.used_bytes(), 400) << "short ones are in memory";
  }
  const std::string piece(70'000, 'x');
  disk_.give_back("finished");
  {
    UploadBudget large = upload(0, 100'000);
    SpooledText text(dir_.path() / "text", large.counter());
    EXPECT_EQ(refusal([&] { text.append(piece); }), ErrorCode::storage_full);
  }
  EXPECT_EQ(disk_.used_bytes(), 0);
  blobs::DiskBudget wide(dir_.path(), {.max_bytes = 200'000, .min_free_bytes = 0});
  const UploadRooms rooms{reservations_, wide};
  UploadBudget his(rooms, caller(150'000), "u", {});
  {
    SpooledText text(dir_.path() / "text", his.counter());
    text.append(piece);
    EXPECT_EQ(wide.used_bytes(), 70'000);
    text.append(piece);
    EXPECT_EQ(refusal([&] { text.append(piece); }), ErrorCode::quota_exceeded);
  }
  EXPECT_EQ(wide.used_bytes(), 0);
  his.take(140'000);  // what the text told of, put away
}

}  // namespace
}  // namespace unwrapd::server::uploads
