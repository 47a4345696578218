// Backups of a server at work, and what is restored of them; tests/fault runs the commands.
#include "server/backup/backup.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "server/access/key_store.hpp"
#include "server/base/identity.hpp"
#include "server/database/sqlite_database.hpp"
#include "server/store/data_directory.hpp"
#include "tests/api/error_of.hpp"
#include "tests/server/running_server.hpp"

namespace unwrapd::server::backup {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class Backup : public RunningServer {
 protected:
  Backup() {
    config_.workers = 1;
    config_.drain_seconds = 0;
    config_.data = dir_.path() / "data";
  }

  [[nodiscard]] fs::path backup() const { return dir_.path() / "backup"; }
  [[nodiscard]] fs::path restored() const { return dir_.path() / "restored"; }

  void stop() {
    service_->drain();
    service_.reset();
  }
  std::string succeeded(const std::string& query = "") {
    const std::string id = submit(query);
    await_state(id, "succeeded");
    return id;
  }
  std::string of_mesh(const std::string& mesh) {
    const auto answer = client().Post("/v1/jobs", {{"Prefer", "wait=60"}},
                                      api::Json{{"mesh", sha256(mesh)}}.dump(), "application/json");
    return api::Json::parse(answer->body).at("id");
  }
  std::string all_of(const std::string& id) {
    std::string all = job(id).dump();
    for (const char* what : {"result", "report", "layout.svg"}) all += get(id, what)->body;
    return all;
  }
  static std::vector<fs::path> files_below(const fs::path& folder) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
      if (entry.is_regular_file()) files.push_back(entry.path());
    return files;
  }
  static void damage(const fs::path& file) {
    std::string bytes = read_file(file);
    bytes[bytes.size() / 2] ^= 1;
    write_file(file, bytes);
  }
};

TEST_F(Backup, OfAServerAtWorkIsOneThatAnswersTheSame) {
  start();
  access::ApiKey reader;
  reader.scopes.read = true;
  const std::string key = access::KeyStore(config_.data).add(reader);
  const std::string mesh = grid_obj(6);
  client().Put("/v1/meshes/" + sha256(mesh), mesh, "model/obj");
  const std::vector<std::string> done = {succeeded(), of_mesh(mesh), of_mesh(mesh)};
  std::vector<std::string> answers;
  for (const std::string& id : done) answers.push_back(all_of(id));
  const std::string running = submit_endless();
  await_state(running, "running");
  const std::string waiting = submit("?resolution=64");
  const StoreReport made = back_up(config_.data, backup());
  EXPECT_THAT(made.damaged, IsEmpty());
  EXPECT_EQ(made.jobs, 6) << "five jobs and a mesh";
  client().Delete("/v1/jobs/" + done[0]);
  stop();

  EXPECT_THAT(check_store(backup()).damaged, IsEmpty());
  EXPECT_EQ(restore(backup(), restored()).files, made.files);
  config_.data = restored();
  start();
  for (std::size_t k = 0; k < done.size(); ++k) EXPECT_EQ(all_of(done[k]), answers[k]);
  EXPECT_EQ(client().Put("/v1/meshes/" + sha256(mesh), mesh, "model/obj")->status, 200) << "known";
  EXPECT_TRUE(access::KeyStore(restored()).find(key));
  await_state(running, "running");
  client().Delete("/v1/jobs/" + running);
  await_state(waiting, "succeeded");
  EXPECT_EQ(fs::hard_link_count(restored() / "blobs" / done[1] / "document"), 3U);
  EXPECT_EQ(read_file(restored() / "secret"), read_file(dir_.path() / "data" / "secret"));
}

TEST_F(Backup, ThatIsDamagedAnywhereIsRefusedAndNothingIsRestored) {
  start();
  succeeded();
  stop();
  back_up(config_.data, backup());
  const auto expect_refused = [&](const std::string& why) {
    const Error error = error_of([&] { restore(backup(), restored()); });
    EXPECT_EQ(error.code(), ErrorCode::storage_corrupt) << why << error.what();
    EXPECT_FALSE(fs::exists(restored())) << why;
  };
  for (const fs::path& file : files_below(backup())) {
    const std::string whole = read_file(file);
    if (file.filename() != kManifestFile) {
      damage(file);
      expect_refused(file.string() + " with another bit");
    }
    write_file(file, whole.substr(0, whole.size() / 2));
    expect_refused(file.string() + " cut off");
    fs::remove(file);
    expect_refused(file.string() + " removed");
    write_file(file, whole);
  }
  EXPECT_NO_THROW(restore(backup(), restored()));
}

TEST_F(Backup, IsNotMadeOverAnythingNorRestoredIntoADirectoryInUse) {
  start();
  succeeded();
  back_up(config_.data, backup());
  EXPECT_EQ(error_of([&] { back_up(config_.data, backup()); }).code(), ErrorCode::invalid_option);
  EXPECT_EQ(error_of([&] { restore(backup(), config_.data); }).code(), ErrorCode::storage_failed);
  for (const char* inside : {"in", "blobs/in", "lost/in", "../data/in"})
    EXPECT_THAT(error_of([&] { back_up(config_.data, config_.data / inside); }).what(),
                HasSubstr("lies in the data directory"));
  stop();
  EXPECT_THAT(error_of([&] { restore(backup(), config_.data); }).what(), HasSubstr("not empty"));
  EXPECT_THAT(error_of([&] { restore(backup(), dir_.path()); }).what(), HasSubstr("not empty"));
  EXPECT_FALSE(fs::exists(dir_.path() / "lock")) << "left in a folder of others";
  EXPECT_EQ(error_of([&] { back_up(dir_.path(), dir_.path() / "b"); }).code(),
            ErrorCode::not_found);
  EXPECT_EQ(error_of([&] { restore(config_.data, restored()); }).code(),
            ErrorCode::storage_corrupt);
}

TEST_F(Backup, LeavesOutWhatIsDamagedAndSaysSo) {
  start();
  const std::string id = succeeded();
  const std::string gone = succeeded("?resolution=64");
  const std::string result = get(id, "result")->body;
  stop();
  damage(config_.data / "blobs" / id / "result.obj");
  fs::remove_all(config_.data / "blobs" / gone);
  const std::vector<std::string> damaged = back_up(config_.data, backup()).damaged;
  EXPECT_EQ(damaged.size(), 2U);
  EXPECT_THAT(damaged, testing::Contains(HasSubstr(id + "/result.obj is damaged")));
  EXPECT_THAT(damaged, testing::Contains(HasSubstr(gone)));
  restore(backup(), restored());
  config_.data = restored();
  start();
  EXPECT_EQ(get(id, "result")->body, result) << "made again from its map";
  expect_problem(get(gone, "report"), 500, "storage_corrupt");
}

TEST_F(Backup, ACheckNamesWhatIsWrongWhileTheServerWorks) {
  start();
  const std::string id = succeeded();
  const std::string other = succeeded("?resolution=64");
  EXPECT_THAT(check_store(config_.data).damaged, IsEmpty());
  damage(config_.data / "blobs" / id / "uv.bin");
  database::SqliteDatabase(config_.data / store::kStoreFile)
      .run(("UPDATE jobs SET notes = '{' WHERE id = '" + other + "'").c_str());
  fs::create_directories(config_.data / "blobs" / "j_nobodys");
  const StoreReport found = check_store(config_.data);
  EXPECT_THAT(found.damaged, ElementsAre(HasSubstr(other), HasSubstr(id + "/uv.bin")));
  EXPECT_THAT(found.notices, ElementsAre(HasSubstr("1 folders")));
}

}  // namespace
}  // namespace unwrapd::server::backup
