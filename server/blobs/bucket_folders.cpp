#include "server/blobs/bucket_folders.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "api/json.hpp"
#include "server/base/errors.hpp"
#include "server/base/identity.hpp"
#include "server/blobs/blob_files.hpp"

namespace unwrapd::server::blobs {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kInputList = "/input", kResultList = "result", kManifest = "manifest";
constexpr std::chrono::seconds kTimeToFinish{5};
constexpr std::chrono::seconds kClockTick{1};  // of the times of objects
constexpr std::size_t kRootBytes = 8;
constexpr int kCopied = 0;  // instead of the number of an attempt: those begin at 1

std::string input_list(std::string_view job) { return std::string(job) + std::string(kInputList); }

std::string result_list(const std::string& root) { return root + std::string(kResultList); }

std::string attempt_prefix(const std::string& root, int attempt) {
  return root + std::to_string(attempt) + "/";
}

std::string to_text(const StoredObjects& objects) {
  api::Json list = api::Json::object();
  for (const auto& [file, object] : objects)
    list[file] = {{"key", object.key}, {"sha256", object.sha256}, {"bytes", object.bytes}};
  return api::to_text(list);
}

StoredObjects objects_of(const std::string& text) {
  StoredObjects objects;
  try {
    const api::Json list = api::Json::parse(text);
    for (const auto& [file, object] : list.items())
      objects[file] = {.key = object.at("key").get<std::string>(),
                       .sha256 = object.at("sha256").get<std::string>(),
                       .bytes = object.at("bytes").get<std::int64_t>()};
  } catch (const api::Json::exception&) {
    throw Error(ErrorCode::storage_corrupt,
                "The list of the stored files is damaged; send the job again.");
  }
  return objects;
}

/// The files of a folder that have digests, under keys that begin with prefix.
StoredObjects objects_in(const fs::path& folder, const std::string& prefix) {
  StoredObjects objects;
  for (const auto& [file, sha256] : read_digests(folder))
    objects[file] = {.key = prefix + file,
                     .sha256 = sha256,
                     .bytes = static_cast<std::int64_t>(fs::file_size(folder / file))};
  return objects;
}

}  // namespace

BucketFolders::BucketFolders(bucket::BucketAddress address, const std::string& node,
                             const SweepAges& ages, const Log& log)
    : bucket_(std::move(address)), ages_(ages), log_(log) {
  bucket_.check("check/" + node);
  working_ = std::jthread([this] { work(); });
}

BucketFolders::~BucketFolders() {
  {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kTimeToFinish, [&] { return tasks_.empty(); });
    is_ending_ = true;
  }
  changed_.notify_all();
}

/// Another node may be sent the job of this name at the same time: its objects have another root.
std::optional<std::string> BucketFolders::put_input(std::string_view job, const fs::path& folder) {
  const std::string root = std::string(job) + "/" + random_hex(kRootBytes) + "/";
  const StoredObjects objects = objects_in(folder, root);
  for (const auto& [file, object] : objects)
    bucket_.put_file(object.key, folder / file, object.sha256);
  if (!bucket_.put_new(input_list(job), to_text(objects))) return std::nullopt;
  return root;
}

void BucketFolders::put_results(const std::string& root, int attempt, const fs::path& folder) {
  const std::string prefix = attempt_prefix(root, attempt);
  const StoredObjects objects = objects_in(folder, prefix);
  for (const auto& [file, object] : objects)
    bucket_.put_file(object.key, folder / file, object.sha256);
  bucket_.put(prefix + std::string(kManifest), to_text(objects));
}

void BucketFolders::publish(const std::string& root, int attempt) {
  if (bucket_.age_s(result_list(root))) return;
  const std::optional<std::string> list =
      bucket_.get(attempt_prefix(root, attempt) + std::string(kManifest));
  if (list) bucket_.put(result_list(root), *list);
}

bool BucketFolders::copy_results(const std::string& root, const std::string& from) {
  StoredObjects objects = listed(result_list(from));
  const std::string prefix = attempt_prefix(root, kCopied);
  for (auto& [file, object] : objects) {
    if (!bucket_.copy(object.key, prefix + file)) return false;
    object.key = prefix + file;
  }
  if (objects.empty()) return false;
  bucket_.put(result_list(root), to_text(objects));
  return true;
}

bool BucketFolders::has_input(std::string_view job) {
  return bucket_.age_s(input_list(job)).has_value();
}

std::int64_t BucketFolders::age_s(std::string_view job) {
  return bucket_.age_s(input_list(job)).value_or(0);
}

StoredObjects BucketFolders::listed(const std::string& list) {
  const std::optional<std::string> text = bucket_.get(list);
  return text ? objects_of(*text) : StoredObjects();
}

BucketFolder BucketFolders::find(std::string_view job) {
  BucketFolder folder{.root = {}, .files = listed(input_list(job))};
  if (folder.files.empty()) return folder;
  const std::string& key = folder.files.begin()->second.key;
  folder.root = key.substr(0, key.rfind('/') + 1);
  folder.files.merge(listed(result_list(folder.root)));
  return folder;
}

bool BucketFolders::get(const StoredObject& object, const fs::path& file) {
  return bucket_.get_file(object.key, file);
}

std::string BucketFolders::link(const StoredObject& object, const bucket::LinkTerms& terms) const {
  return bucket_.link(object.key, terms);
}

bool BucketFolders::set_aside(std::string_view job) {
  if (!has_input(job)) return false;
  bucket_.remove(input_list(job));
  return true;
}

bool BucketFolders::has_any() {
  for (const std::string_view kind : {"j_", "m_"})
    if (!bucket_.list(std::string(kind), 1).empty()) return true;
  return false;
}

/// Lists first: what is left when this ends half-way is what no list names.
void BucketFolders::remove_all(std::vector<bucket::ObjectInfo> objects) {
  const auto depth = [](const std::string& key) { return std::ranges::count(key, '/'); };
  std::ranges::stable_sort(objects, {}, [&](const auto& object) { return depth(object.key); });
  for (const bucket::ObjectInfo& object : objects) bucket_.remove(object.key);
}

void BucketFolders::remove(const std::string& job, std::string root, Time called) {
  const std::string present = find(job).root;
  if (root.empty()) {
    const auto since_call = std::chrono::steady_clock::now() - called;
    if (std::chrono::seconds(age_s(job)) <= since_call + kClockTick) return;
    root = present;
  }
  if (root.empty()) return;
  if (root == present) bucket_.remove(input_list(job));
  remove_all(bucket_.list(root));
}

void BucketFolders::remove_later(std::string_view job, const std::string& root) {
  put_off([this, job = std::string(job), root, called = std::chrono::steady_clock::now()] {
    remove(job, root, called);
  });
}

void BucketFolders::publish_later(const std::string& root, int attempt) {
  put_off([this, root, attempt] { publish(root, attempt); });
}

void BucketFolders::put_off(std::function<void()> task) {
  {
    const std::lock_guard lock(mutex_);
    tasks_.push_back(std::move(task));
  }
  changed_.notify_all();
}

void BucketFolders::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return is_ending_ || !tasks_.empty(); });
    if (is_ending_) return;
    const std::function<void()> task = tasks_.front();
    lock.unlock();
    try {
      task();
    } catch (const std::exception& error) {
      log_.warning("files in the bucket are left for a sweep", {{"reason", reason_of(error)}});
    }
    lock.lock();
    tasks_.pop_front();
    changed_.notify_all();
  }
}

int BucketFolders::sweep(const Fates& fates,
                         const std::function<void(const std::string& job)>& settle) {
  std::map<std::string, std::vector<bucket::ObjectInfo>> folders;
  for (bucket::ObjectInfo& object : bucket_.list("")) {
    const std::size_t slash = object.key.find('/');
    if (slash != std::string::npos)
      folders[object.key.substr(0, slash)].push_back(std::move(object));
  }
  const std::int64_t now_s = bucket_.now_s();
  int removed = 0;
  for (auto& [job, objects] : folders) {
    const FolderFate fate = fates(job);
    const auto newest = std::ranges::max_element(objects, {}, &bucket::ObjectInfo::written_s);
    const std::chrono::seconds age(std::max<std::int64_t>(0, now_s - newest->written_s));
    if (age < (fate == FolderFate::unknown ? ages_.unknown : ages_.at_work)) continue;
    if (fate == FolderFate::kept) {
      remove_unnamed(job, std::move(objects), settle);
    } else {
      remove_all(std::move(objects));
      ++removed;
    }
  }
  return removed;
}

/// Of a job in which nothing was written lately. Where there are one upload and one attempt, all is
/// named, and no list is read.
void BucketFolders::remove_unnamed(const std::string& job, std::vector<bucket::ObjectInfo> objects,
                                   const std::function<void(const std::string& job)>& settle) {
  const auto part_of = [](const std::string& key) { return key.substr(0, key.rfind('/') + 1); };
  std::set<std::string> parts;
  for (const bucket::ObjectInfo& object : objects) parts.insert(part_of(object.key));
  constexpr std::size_t kUsual = 3;  // <job>/, its root, an attempt
  if (parts.size() <= kUsual) return;
  settle(job);
  const BucketFolder folder = find(job);
  std::set<std::string> named = {job + "/", folder.root};
  for (const auto& [file, object] : folder.files) named.insert(part_of(object.key));
  std::erase_if(objects, [&](const auto& object) { return named.contains(part_of(object.key)); });
  remove_all(std::move(objects));
}

}  // namespace unwrapd::server::blobs
