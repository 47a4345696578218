// Stored meshes and the jobs that share their bytes: what counts where, and what goes when.
#include "server/store/mesh_store.hpp"

#include <gtest/gtest.h>

#include "server/base/files.hpp"
#include "server/blobs/blob_store.hpp"
#include "server/store/job_store.hpp"
#include "server/store/sweeper.hpp"
#include "tests/server/temp_dir.hpp"
#include "tests/server/test_database.hpp"

namespace unwrapd::server::store {
namespace {

MeshRecord some_mesh(const std::string& id, std::int64_t kept_since_ms) {
  return {.id = id,
          .owner = "a",
          .sha256 = id,
          .bytes = 1,
          .media_type = "model/obj",
          .created_ms = 1000,
          .kept_since_ms = kept_since_ms,
          .stored_bytes = 5};
}

class StoreOfMeshes : public testing::Test {
 protected:
  void put(const std::string& id, std::int64_t kept_since_ms) {
    write_file(blobs_.begin_upload(id) / blobs::kDocumentFile, "v");
    blobs_.keep_upload(id, id);
    meshes_.put(some_mesh(id, kept_since_ms));
  }
  void finish_job_of(const std::string& id, const std::string& mesh, std::int64_t finished_ms) {
    JobRecord job;
    job.id = id;
    job.options = api::Json::object();
    jobs_.insert(job);
    blobs_.begin_upload(id);
    EXPECT_TRUE(blobs_.share_document(mesh, id));
    blobs_.keep_upload(id, id);
    jobs_.finish(*jobs_.take(""), {.state = api::JobState::succeeded,
                                   .result_format = "glb",
                                   .problem = {},
                                   .finished_ms = finished_ms});
  }
  bool is_there(const std::string& id) const {
    return std::filesystem::exists(blobs_.path(id, blobs::kDocumentFile));
  }

  static constexpr const char* kOne = "m_11111111111111111111111111111111";
  static constexpr const char* kTwo = "m_22222222222222222222222222222222";
  TempDir dir_;
  const database::DatabaseAddress database_ = database_in(dir_.path());
  JobStore jobs_{database_};
  MeshStore meshes_{database_};
  blobs::BlobStore blobs_{dir_.path()};
};

TEST_F(StoreOfMeshes, TellsAMeshThatIsNotThereFromOneThatCannotBeShared) {
  put(kOne, 2000);
  blobs_.begin_upload("j_1");
  EXPECT_FALSE(blobs_.share_document(kTwo, "j_1"));
  EXPECT_TRUE(blobs_.share_document(kOne, "j_1"));
  try {
    blobs_.share_document(kOne, "j_1");  // the name is taken: a link that fails, of a mesh there is
    FAIL() << "no second document";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::storage_failed);
  }
}

TEST_F(StoreOfMeshes, KeepsEveryFieldForTheOwner) {
  put(kOne, 2000);
  const std::optional<MeshRecord> mesh = meshes_.find("a", kOne);
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->id, kOne);
  EXPECT_EQ(mesh->bytes, 1);
  EXPECT_EQ(mesh->media_type, "model/obj");
  EXPECT_EQ(mesh->created_ms, 1000);
  EXPECT_EQ(mesh->kept_since_ms, 2000);
  EXPECT_FALSE(meshes_.find("b", kOne));
  EXPECT_EQ(jobs_.usage("a").stored_bytes, 5);
  EXPECT_EQ(jobs_.usage("b").stored_bytes, 0);
  meshes_.use(kOne, 3000);
  EXPECT_EQ(meshes_.find("a", kOne)->kept_since_ms, 3000);
  EXPECT_EQ(meshes_.find("a", kOne)->media_type, "model/obj");
}

TEST_F(StoreOfMeshes, SweepsWhatIsUnusedAndUnshared) {
  put(kOne, 1000);
  put(kTwo, 5000);
  finish_job_of("j_1", kOne, 2000);
  EXPECT_EQ(blobs_.bytes(kOne), 1);
  EXPECT_EQ(blobs_.bytes("j_1"), 0) << "the document counts for the mesh";
  sweep(meshes_, blobs_, 12'000, std::chrono::seconds(10));
  EXPECT_TRUE(is_there(kOne) && is_there(kTwo));
  blobs_.remove("j_1");
  sweep(meshes_, blobs_, 12'000, std::chrono::seconds(10));
  EXPECT_FALSE(is_there(kOne) || meshes_.has(kOne));
  EXPECT_TRUE(is_there(kTwo) && meshes_.has(kTwo));
}

TEST_F(StoreOfMeshes, GivesUpWhatWasLeftAloneForTheLongest) {
  put(kOne, 1000);
  put(kTwo, 3000);
  finish_job_of("j_1", kOne, 2000);
  EXPECT_TRUE(evict_oldest(jobs_, meshes_, blobs_));  // the older mesh is shared: the job
  EXPECT_TRUE(jobs_.find("j_1")->expired);
  EXPECT_TRUE(is_there(kOne) && is_there(kTwo));
  EXPECT_TRUE(evict_oldest(jobs_, meshes_, blobs_));
  EXPECT_FALSE(is_there(kOne));
  EXPECT_TRUE(evict_oldest(jobs_, meshes_, blobs_));
  EXPECT_FALSE(is_there(kTwo));
  EXPECT_FALSE(evict_oldest(jobs_, meshes_, blobs_));
}

}  // namespace
}  // namespace unwrapd::server::store
