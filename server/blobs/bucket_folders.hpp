#pragma once
// The folders of jobs and meshes in a bucket, for nodes that share no directory:
//
//   <job>/input                     the list of the files that were brought: written once
//   <job>/<hex>/<file>              these files
//   <job>/<hex>/<attempt>/<file>    results of an attempt
//   <job>/<hex>/<attempt>/manifest  the list of these, once all of them are there
//   <job>/<hex>/result              the list of the results of the attempt that succeeded
//
// No object changes once it is written, so that a copy in a directory stays right; a name that is
// used again gets another <hex>. An attempt of a node that was taken for dead writes where nobody
// looks. What no list names is swept later.

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "server/base/log.hpp"
#include "server/blobs/digests.hpp"
#include "server/bucket/bucket.hpp"

namespace unwrapd::server::blobs {

/// A file of a folder in the bucket.
struct StoredObject {
  std::string key;
  std::string sha256;
  std::int64_t bytes = 0;
};
/// By their names.
using StoredObjects = std::map<std::string, StoredObject, std::less<>>;

/// A folder in the bucket.
struct BucketFolder {
  std::string root;  ///< "<job>/<hex>/"; empty where there is no folder
  StoredObjects files;
};

/// What the rows say of a folder.
enum class FolderFate {
  kept,
  gone,     ///< of a job whose files are no longer kept
  unknown,  ///< no row names it
};
/// Asking for that of a job that has succeeded publishes its results, where its node died before it
/// did so.
using Fates = std::function<FolderFate(const std::string& name)>;

/// How old objects must be to be swept.
struct SweepAges {
  std::chrono::seconds at_work{3600};           ///< younger ones may be another node's work
  std::chrono::seconds unknown{7 * 24 * 3600};  ///< of jobs that no row names
};

/// Thread-safe. What it asks of the bucket throws StoreAway.
class BucketFolders {
 public:
  /// Tries whether the bucket can be used (Bucket::check()), under the name of this node.
  BucketFolders(bucket::BucketAddress address, const std::string& node, const SweepAges& ages,
                const Log& log);
  BucketFolders(const BucketFolders&) = delete;
  BucketFolders& operator=(const BucketFolders&) = delete;
  /// Finishes what was put off, for a few seconds.
  ~BucketFolders();

  /// Copies the files of an upload, whose digests are noted in its folder. Returns the root;
  /// nothing where the job has files already.
  [[nodiscard]] std::optional<std::string> put_input(std::string_view job,
                                                     const std::filesystem::path& folder);
  /// Copies the results of an attempt, of which nobody knows before publish().
  void put_results(const std::string& root, int attempt, const std::filesystem::path& folder);
  /// Makes the results of an attempt those of the folder. Does nothing where that is done.
  void publish(const std::string& root, int attempt);
  /// Gives a folder the results of another. False where that has none.
  [[nodiscard]] bool copy_results(const std::string& root, const std::string& from);

  [[nodiscard]] bool has_input(std::string_view job);
  /// Seconds since a job's files were brought; 0 where there are none.
  [[nodiscard]] std::int64_t age_s(std::string_view job);
  [[nodiscard]] BucketFolder find(std::string_view job);
  /// Writes a file into one that must not exist. False where it is gone.
  [[nodiscard]] bool get(const StoredObject& object, const std::filesystem::path& file);
  /// By which a client gets it.
  [[nodiscard]] std::string link(const StoredObject& object, const bucket::LinkTerms& terms) const;
  /// Makes room for another job of this name: what is there is named by no list, and swept later.
  /// False where there is nothing.
  [[nodiscard]] bool set_aside(std::string_view job);
  /// Whether there is any folder.
  [[nodiscard]] bool has_any();

  // Done by a thread of its own; what fails is left to a sweep, or to whoever finds the job.
  /// root: empty where this node does not know it. Then a folder that may be younger than this call
  /// is left to a sweep, too, as it may be that of another job.
  void remove_later(std::string_view job, const std::string& root);
  void publish_later(const std::string& root, int attempt);

  /// Removes folders of jobs that are gone, and in others what no list names. Returns the number of
  /// folders removed. settle: asked to publish what a job has before something of it is removed.
  int sweep(const Fates& fates, const std::function<void(const std::string& job)>& settle);

 private:
  using Time = std::chrono::steady_clock::time_point;
  void remove(const std::string& job, std::string root, Time called);
  void remove_all(std::vector<bucket::ObjectInfo> objects);
  void put_off(std::function<void()> task);
  void work();
  [[nodiscard]] StoredObjects listed(const std::string& list);
  void remove_unnamed(const std::string& job, std::vector<bucket::ObjectInfo> objects,
                      const std::function<void(const std::string& job)>& settle);

  bucket::Bucket bucket_;
  const SweepAges ages_;
  const Log& log_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> tasks_;
  bool is_ending_ = false;
  std::jthread working_;  // last: it uses the others
};

}  // namespace unwrapd::server::blobs
