#pragma once
// Objects in a bucket of an object store that speaks the API of Amazon S3. Requests that fail in a
// way that may pass are tried again a few times, with growing pauses; then they throw StoreAway.

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/bucket/bucket_link.hpp"
#include "server/bucket/s3_exchange.hpp"

namespace unwrapd::server::bucket {

struct ObjectInfo {
  std::string key;
  std::int64_t bytes = 0;
  std::int64_t written_s = 0;  ///< since 1970, by the store's clock
};

/// Thread-safe.
class Bucket {
 public:
  /// Throws Error{internal} where libcurl cannot be used.
  explicit Bucket(BucketAddress address);
  Bucket(const Bucket&) = delete;
  Bucket& operator=(const Bucket&) = delete;
  ~Bucket();

  /// Tries at the start, under a key of this name, what is needed: to write, to keep an object from
  /// being written twice, to read, to list and to remove. Throws InsideError{storage_failed} that
  /// says which of them fails, and why.
  void check(const std::string& name);

  void put(const std::string& key, std::string_view bytes);
  /// False where there is one.
  [[nodiscard]] bool put_new(const std::string& key, std::string_view bytes);
  /// sha256: of the file. Above 16 MB it goes in parts.
  void put_file(const std::string& key, const std::filesystem::path& file,
                const std::string& sha256);
  /// Nothing where there is none.
  std::optional<std::string> get(const std::string& key);
  /// Writes an object into a file that must not exist. Where the connection breaks, the rest is
  /// fetched. False, and no file, where there is none.
  bool get_file(const std::string& key, const std::filesystem::path& file);
  /// Seconds since an object was written, by the store's clock; nothing where there is none.
  std::optional<std::int64_t> age_s(const std::string& key);
  /// False where there is none to copy.
  bool copy(const std::string& from, const std::string& to);
  /// Does nothing where there is none.
  void remove(const std::string& key);
  /// All whose keys begin so; most: at most so many, about.
  std::vector<ObjectInfo> list(const std::string& prefix, std::size_t most = SIZE_MAX);
  /// Asks nobody: there may be no such object.
  [[nodiscard]] std::string link(const std::string& key, const LinkTerms& terms) const;
  /// Now, by the store's clock, in seconds since 1970.
  std::int64_t now_s();

 private:
  Answer ask(const Call& call, const std::vector<long>& also = {});
  Answer ask_once(const Call& call);
  void put_in_parts(const std::string& key, const std::filesystem::path& file);

  const BucketAddress address_;
  const outbound::CurlLibrary& curl_;
  std::mutex mutex_;
  std::vector<CURL*> idle_;  // with their connections
};

}  // namespace unwrapd::server::bucket
