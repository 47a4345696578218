#pragma once
// The files of jobs: DIR/blobs/<job>/{document,buffer_N,options.json,digests,result.*,report.json*,
// uv.bin*}; and of stored meshes: DIR/blobs/<mesh>/{document,digests,analysis.json}. An upload is
// written to DIR/incoming/<job>/ and renamed as a whole. Each later file is written under another
// name, synced and renamed before the job counts as done. What a crash leaves behind is removed at
// the next start; a folder that no row names is set aside (lost_folders.hpp). `digests` has the
// SHA-256 of each file (digests.hpp), against which reads are checked. DIR/digests-noted says that
// all folders have one, which 0.1.0 did not write.
//
// Several nodes may share a directory. Then an attempt writes its results to
// DIR/incoming/<job>.<attempt>/, and they move to the job's folder once its row says that this
// attempt has succeeded (publish()): a node that was taken for dead writes nowhere that counts.
// What may be another node's present work is left alone by sweeps, and shared files count for each
// of their holders.
//
// Or the folders are in a bucket (bucket_folders.hpp), and blobs/ has this node's copies of them.
// An upload and the results of an attempt are in the bucket before their rows are written. What is
// made after seal() stays on this node, and is made again elsewhere.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/files.hpp"
#include "server/blobs/blob_files.hpp"
#include "server/blobs/cached_folders.hpp"
#include "server/blobs/checked_files.hpp"
#include "server/blobs/digests.hpp"
#include "server/blobs/disk_budget.hpp"
#include "server/blobs/lost_folders.hpp"
#include "server/blobs/shared_files.hpp"

namespace unwrapd::server::blobs {

/// Callbacks of try_keep().
struct Keeping {
  /// Reserves bytes in the quota of the job's owner while the returned pointer lives; nullptr if
  /// the quota does not allow them, or if the job of this number is gone.
  std::function<std::shared_ptr<void>(const std::string& job, std::int64_t seq, std::int64_t bytes)>
      reservation = {};
  /// The bytes of all the job's files now.
  std::function<void(std::string_view job, std::int64_t bytes)> kept = {};
};

/// The outcome of a sweep.
struct Swept {
  int removed = 0;
  int returned = 0;               ///< from lost
  std::vector<std::string> lost;  ///< set aside
  std::vector<std::pair<std::string, std::int64_t>> sharing =
      {};                           ///< jobs, and what counts for them
  std::vector<std::string> failed;  ///< left where they are, for they cannot be read or moved
};

/// Of a file in a bucket.
struct ResultLink {
  std::string url;
  std::string sha256;
};

/// Whether other nodes use the same directory.
enum class Sharing { none, by_nodes };

class BlobStore {
 public:
  /// Creates the directories below data where they are missing.
  explicit BlobStore(const std::filesystem::path& data, const DiskLimits& limits = {},
                     Sharing sharing = Sharing::none);
  /// The folders are in a bucket; this node has copies of them below a directory of its own, which
  /// is emptied, and at most so many bytes.
  BlobStore(const std::filesystem::path& copies, const DiskLimits& limits,
            std::unique_ptr<BucketFolders> bucket, std::int64_t most_copied_bytes);

  /// A new empty folder for an upload.
  std::filesystem::path begin_upload(std::string_view upload);
  /// The upload, its files synced and their digests noted, becomes the job's folder. known: digests
  /// of files as they came, which are noted as they are.
  void keep_upload(std::string_view upload, std::string_view job, const Digests& known = {});
  void drop_upload(std::string_view upload) noexcept;

  /// Where a file is, if it is there.
  [[nodiscard]] std::filesystem::path path(std::string_view job, std::string_view file) const;
  /// A file of an attempt of a job at work, which seal() syncs. Throws Error{storage_full} when
  /// there is no room, or storage_failed.
  void write_unsealed(std::string_view job, int attempt, std::string_view file,
                      std::string_view bytes);
  void remove(std::string_view job) noexcept;
  /// The document of a stored mesh becomes that of an upload, too; its bytes are shared, and count
  /// for the mesh. False when it is not there. Throws Error{storage_failed} where the file system
  /// has no hard links, or no more of this file.
  bool share_document(std::string_view mesh, std::string_view upload);
  /// Whether a job shares the document of a mesh.
  [[nodiscard]] bool is_shared(std::string_view mesh) const;
  /// Whether a file is noted: it is there, or was.
  [[nodiscard]] bool has(std::string_view job, std::string_view file) const;
  /// Bytes of all files, without `digests`; those that count for another (shared_files.hpp) are
  /// left out.
  [[nodiscard]] std::int64_t bytes(std::string_view job);

  /// Syncs all results and notes their digests, replacing those of an attempt before: on return
  /// they survive a loss of power. Returns the bytes of all files of the job.
  std::int64_t seal(std::string_view job, int attempt);
  /// Makes the sealed results of an attempt those of the job, which has succeeded by them. Does
  /// nothing where that is done. Throws Error{storage_failed}.
  void publish(std::string_view job, int attempt);
  /// Removes the results of an attempt that came to nothing.
  void drop_attempt(std::string_view job, int attempt) noexcept;
  /// Keeps a file that was made after seal() and can be made again, and notes its digest. False
  /// when that would take something from others: there is no room for it, its owner may not have
  /// so much, or another job has this id by now. seq: the number of the job's row; 0 for a mesh.
  /// Throws Error{storage_failed}.
  [[nodiscard]] bool try_keep(std::string_view job, const std::string& file, std::string_view bytes,
                              std::int64_t seq = 0);
  /// A file without a name, for what is handed out once. Throws Error: storage_full,
  /// storage_failed.
  [[nodiscard]] std::shared_ptr<const File> lend(std::string_view bytes) const;
  /// Gives a job that is not yet published the results of another; the bytes are shared, not
  /// copied. Every file is read and checked: false, and none is given, when one is not whole.
  bool adopt(std::string_view job, std::string_view from) noexcept;

  /// A file whose bytes are those that were noted, checked once while it stays as it is
  /// (checked_files.hpp). Throws Error{storage_corrupt} when they are not,
  /// or none were.
  [[nodiscard]] std::shared_ptr<const File> open(std::string_view job, std::string_view file) const;
  /// The same, read whole.
  [[nodiscard]] std::string read(std::string_view job, std::string_view file) const;
  /// The noted digest; of a file without one, computed.
  [[nodiscard]] std::string digest(std::string_view job, std::string_view file) const;

  /// For a client that gets a result from the bucket by this method (GET or HEAD), as this type.
  /// Nothing where that is not in a bucket, or the job's row has another number by now.
  [[nodiscard]] std::optional<ResultLink> link(const std::string& job, std::int64_t seq,
                                               std::string_view file, std::string_view method,
                                               std::string_view type) const;

  void on_keeping(Keeping keeping) { keeping_ = std::move(keeping); }

  /// The number of folders of jobs and meshes; of a bucket, whether there are any.
  [[nodiscard]] int folder_count() const;
  /// At the start: removes unfinished uploads and files and the folders of jobs that are gone, and
  /// sets aside in DIR/lost folders that no row names, and all that is no folder. now_ms: of
  /// Moment::kept_ms().
  [[nodiscard]] Swept sweep(const Fates& fates, std::int64_t now_ms);
  /// Whether other nodes use the same directory.
  [[nodiscard]] bool is_shared_by_nodes() const { return sharing_ == Sharing::by_nodes; }
  /// Moves a job's folder to DIR/lost. False when there is none.
  bool set_aside(const std::string& job, std::int64_t now_ms);

  LostFolders& lost() { return lost_; }
  DiskBudget& room() { return room_; }
  [[nodiscard]] bool holds(std::string_view job) const;
  /// The row of this number has the name of this folder, and its attempt of this number has
  /// succeeded (0: none has).
  void note_row(std::string_view job, std::int64_t seq, int succeeded);
  /// Removes copies of what is in a bucket: those that are too many; one more than that.
  void trim_copies();
  bool give_up_copy() noexcept { return copies_ && copies_->give_up_one(); }
  /// Whether nothing was written to a job's folder for so long.
  [[nodiscard]] bool is_idle(std::string_view job, std::chrono::seconds time) const;

  /// Removes what could not be removed before; returns how much that was.
  int remove_left() noexcept { return left_.retry(); }

 private:
  const Sharing sharing_;
  std::filesystem::path incoming_;
  std::filesystem::path blobs_;
  DiskBudget room_;
  LostFolders lost_;
  std::int64_t count(const std::string& name);
  void count_again(const std::vector<std::string>& holders);
  void sweep_one(const std::filesystem::directory_entry& entry, const Fates& fates,
                 std::int64_t now_ms, Swept& swept);
  void settle_attempts(const Fates& fates) const;
  void note(std::string_view job, const std::string& file);
  [[nodiscard]] std::filesystem::path place(std::string_view job, std::string_view file) const;
  void publish_here(std::string_view job, const std::filesystem::path& from);
  void bring(std::string_view job, std::string_view file) const;
  void keep_in_bucket(std::string_view upload, std::string_view job);
  std::int64_t seal_in_bucket(std::string_view job, int attempt,
                              const std::filesystem::path& folder);
  void publish_in_bucket(std::string_view job, int attempt);
  void remove_in_bucket(std::string_view job) noexcept;
  bool keep_copy(std::string_view job, const std::string& file, std::string_view bytes);
  [[nodiscard]] std::filesystem::path attempt_folder(std::string_view job, int attempt) const;
  [[nodiscard]] std::filesystem::path work_folder(std::string_view job, int attempt) const;
  [[nodiscard]] bool may_be_at_work(const std::filesystem::path& path, std::int64_t now_ms) const;
  [[nodiscard]] std::shared_ptr<void> lock_folder(std::string_view job) const;

  Keeping keeping_;
  mutable CheckedFiles checked_;
  LeftFolders left_;
  mutable std::mutex counting_;
  SharedFiles shared_;
  mutable std::mutex noting_;              // one writer of `digests` at a time
  std::unique_ptr<CachedFolders> copies_;  // of a bucket
};

}  // namespace unwrapd::server::blobs
