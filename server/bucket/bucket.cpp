#include "server/bucket/bucket.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <memory>
#include <new>
#include <random>
#include <thread>
#include <utility>

#include "server/base/errors.hpp"
#include "server/base/files.hpp"
#include "server/base/identity.hpp"
#include "server/bucket/xml_texts.hpp"

namespace unwrapd::server::bucket {
namespace {

constexpr int kMostTries = 4;
constexpr std::chrono::milliseconds kFirstPause{100};
constexpr std::size_t kMostIdle = 16;
constexpr std::size_t kMostToldOfAnswer = 200;
constexpr std::int64_t kPartBytes = std::int64_t{16} * 1024 * 1024;
constexpr std::size_t kMostListedAtOnce = 1000;  // what S3 answers with at most
constexpr long kNotFound = 404, kExists = 412, kTooPatient = 408, kRaced = 409, kTooMany = 429,
               kFirstServerError = 500, kNotImplemented = 501;

bool may_pass(long status) {
  return status == kTooPatient || status == kRaced || status == kTooMany ||
         (status >= kFirstServerError && status != kNotImplemented);
}

std::string told_of(const Call& call, const Answer& answer) {
  std::string code = first_text(answer.body, "Code");
  if (code.empty()) code = answer.body.substr(0, kMostToldOfAnswer);
  return "it answers " + call.method + " with " + std::to_string(answer.status) +
         (code.empty() ? "" : ", " + code);
}

void pause_after(int tries) {
  thread_local std::mt19937 lot{std::random_device{}()};
  const std::int64_t longest = kFirstPause.count() << static_cast<unsigned>(tries);
  std::uniform_int_distribution<std::int64_t> pause(longest / 2, longest);
  std::this_thread::sleep_for(std::chrono::milliseconds(pause(lot)));
}

/// Seconds since 1970 of a time in this format of strptime(); 0 for another.
std::int64_t seconds_of(const std::string& text, const char* format) {
  std::tm parts{};
  return ::strptime(text.c_str(), format, &parts) == nullptr ? 0 : ::timegm(&parts);
}

std::int64_t seconds_of_header(const Answer& answer, const std::string& name) {
  const auto found = answer.headers.find(name);
  if (found == answer.headers.end()) return 0;
  return seconds_of(found->second, "%a, %d %b %Y %H:%M:%S");
}

/// A part of a file, as a body.
Body part_of(const File& file, std::int64_t from, std::int64_t bytes, std::string sha256) {
  return {.bytes = bytes,
          .sha256 = std::move(sha256),
          .read = [&file, from, bytes](std::int64_t offset, std::size_t most) {
            const auto left = static_cast<std::size_t>(bytes - offset);
            return file.read(from + offset, std::min(most, left));
          }};
}

}  // namespace

Bucket::Bucket(BucketAddress address)
    : address_(std::move(address)), curl_(outbound::CurlLibrary::loaded()) {}

Bucket::~Bucket() {
  for (CURL* const easy : idle_) curl_.easy_cleanup(easy);
}

Answer Bucket::ask_once(const Call& call) {
  CURL* easy = nullptr;
  {
    const std::lock_guard lock(mutex_);
    if (!idle_.empty()) {
      easy = idle_.back();
      idle_.pop_back();
    }
  }
  if (easy == nullptr) easy = curl_.easy_init();
  if (easy == nullptr) throw std::bad_alloc();
  const std::shared_ptr<void> given_back(easy, [this](void* used) {
    curl_.easy_reset(used);
    const std::lock_guard lock(mutex_);
    if (idle_.size() < kMostIdle)
      idle_.push_back(used);
    else
      curl_.easy_cleanup(used);
  });
  S3Exchange exchange(call);
  const std::string failure = exchange.run(easy, address_);
  if (!failure.empty()) throw StoreAway(StorePart::files, failure);
  return std::move(exchange.answer());
}

Answer Bucket::ask(const Call& call, const std::vector<long>& also) {
  for (int tries = 1;; ++tries) {
    bool is_last = tries == kMostTries;
    try {
      Answer answer = ask_once(call);
      if (answer.is_success() || std::ranges::find(also, answer.status) != also.end())
        return answer;
      is_last |= !may_pass(answer.status);
      throw StoreAway(StorePart::files, told_of(call, answer));
    } catch (const StoreAway&) {
      if (is_last) throw;
    }
    pause_after(tries);
  }
}

void Bucket::check(const std::string& name) {
  const char* what = "be written to";
  try {
    remove(name);
    put(name, name);
    what = "keep an object from being written twice (If-None-Match)";
    if (put_new(name, "another")) throw StoreAway(StorePart::files, "it was written");
    what = "be read";
    if (get(name) != name) throw StoreAway(StorePart::files, "it has other bytes");
    what = "be listed";
    if (list(name).size() != 1) throw StoreAway(StorePart::files, "the list has no object");
    what = "be cleared";
    remove(name);
  } catch (const StoreAway& away) {
    throw InsideError(
        ErrorCode::storage_failed, "The bucket cannot be used.",
        "The bucket of --blobs cannot " + std::string(what) + ": " + away.detail() + ".");
  }
}

void Bucket::put(const std::string& key, std::string_view bytes) {
  const Body body = body_of(bytes);
  ask({.method = "PUT", .key = key, .body = &body});
}

/// Where the answer to a first try was lost, the second finds the object of the first.
bool Bucket::put_new(const std::string& key, std::string_view bytes) {
  const Body body = body_of(bytes);
  const Call call{.method = "PUT", .key = key, .headers = {{"if-none-match", "*"}}, .body = &body};
  if (ask(call, {kExists}).status != kExists) return true;
  return get(key) == bytes;
}

void Bucket::put_file(const std::string& key, const std::filesystem::path& file,
                      const std::string& sha256) {
  const File opened = File::open(file);
  const std::int64_t bytes = opened.size();
  if (bytes > kPartBytes) return put_in_parts(key, file);
  const Body body = part_of(opened, 0, bytes, sha256);
  ask({.method = "PUT", .key = key, .body = &body});
}

void Bucket::put_in_parts(const std::string& key, const std::filesystem::path& file) {
  const File opened = File::open(file);
  const std::string id =
      first_text(ask({.method = "POST", .key = key, .query = {{"uploads", ""}}}).body, "UploadId");
  try {
    std::string list = "<CompleteMultipartUpload>";
    const std::int64_t bytes = opened.size();
    for (std::int64_t from = 0, number = 1; from < bytes; from += kPartBytes, ++number) {
      const std::int64_t length = std::min(kPartBytes, bytes - from);
      const std::string piece = opened.read(from, static_cast<std::size_t>(length));
      const Body body = body_of(piece);
      const std::string k = std::to_string(number);
      Answer answer = ask({.method = "PUT",
                           .key = key,
                           .query = {{"partNumber", k}, {"uploadId", id}},
                           .body = &body});
      list += "<Part><PartNumber>" + k + "</PartNumber><ETag>" + answer.headers["etag"] +
              "</ETag></Part>";
    }
    list += "</CompleteMultipartUpload>";
    const Body body = body_of(list);
    const Answer answer =
        ask({.method = "POST", .key = key, .query = {{"uploadId", id}}, .body = &body});
    const std::string code = first_text(answer.body, "Code");  // of a failure with status 200
    if (!code.empty()) throw StoreAway(StorePart::files, "a file in parts: " + code);
  } catch (...) {
    try {
      ask({.method = "DELETE", .key = key, .query = {{"uploadId", id}}}, {kNotFound});
    } catch (const StoreAway&) {  // a rule of the bucket's life cycle removes what is left
    }
    throw;
  }
}

std::optional<std::string> Bucket::get(const std::string& key) {
  Answer answer = ask({.method = "GET", .key = key}, {kNotFound});
  if (answer.status == kNotFound) return std::nullopt;
  return std::move(answer.body);
}

bool Bucket::get_file(const std::string& key, const std::filesystem::path& file) {
  File written = File::create(file);
  std::int64_t bytes = 0;
  try {
    for (int tries = 1;; ++tries) {
      Call call{.method = "GET", .key = key, .take = [&](std::string_view piece) {
                  written.append(piece);
                  bytes += static_cast<std::int64_t>(piece.size());
                }};
      if (bytes > 0) call.headers["range"] = "bytes=" + std::to_string(bytes) + "-";
      try {
        const Answer answer = ask_once(call);
        if (answer.is_success()) return true;
        if (answer.status == kNotFound) break;
        throw StoreAway(StorePart::files, told_of(call, answer));
      } catch (const StoreAway&) {
        if (tries == kMostTries) throw;
      }
      pause_after(tries);
    }
  } catch (...) {
    remove_tree(file);
    throw;
  }
  remove_tree(file);
  return false;
}

std::optional<std::int64_t> Bucket::age_s(const std::string& key) {
  const Answer answer = ask({.method = "HEAD", .key = key}, {kNotFound});
  if (answer.status == kNotFound) return std::nullopt;
  return seconds_of_header(answer, "date") - seconds_of_header(answer, "last-modified");
}

bool Bucket::copy(const std::string& from, const std::string& to) {
  const Body nothing = body_of("");
  const std::string source = "/" + address_.bucket + "/" + address_.prefix + from;
  const Answer answer = ask({.method = "PUT",
                             .key = to,
                             .headers = {{"x-amz-copy-source", encoded_path(source)}},
                             .body = &nothing},
                            {kNotFound});
  const std::string code = first_text(answer.body, "Code");  // of a failure with status 200
  if (answer.is_success() && !code.empty()) throw StoreAway(StorePart::files, "a copy: " + code);
  return answer.is_success();
}

void Bucket::remove(const std::string& key) { ask({.method = "DELETE", .key = key}, {kNotFound}); }

std::vector<ObjectInfo> Bucket::list(const std::string& prefix, std::size_t most) {
  std::vector<ObjectInfo> objects;
  std::string token;
  do {
    Call call{.method = "GET",
              .query = {{"list-type", "2"},
                        {"max-keys", std::to_string(std::min(most, kMostListedAtOnce))},
                        {"prefix", address_.prefix + prefix}}};
    if (!token.empty()) call.query["continuation-token"] = token;
    const std::string xml = ask(call).body;
    for (const std::string& content : texts_of(xml, "Contents"))
      objects.push_back(
          {.key = first_text(content, "Key").substr(address_.prefix.size()),
           .bytes = std::strtoll(first_text(content, "Size").c_str(), nullptr, 10),
           .written_s = seconds_of(first_text(content, "LastModified"), "%Y-%m-%dT%H:%M:%S")});
    token = first_text(xml, "NextContinuationToken");
  } while (!token.empty() && objects.size() < most);
  return objects;
}

std::string Bucket::link(const std::string& key, const LinkTerms& terms) const {
  return link_to(address_, key, terms);
}

std::int64_t Bucket::now_s() {
  return seconds_of_header(ask({.method = "GET", .query = {{"list-type", "2"}, {"max-keys", "1"}}}),
                           "date");
}

}  // namespace unwrapd::server::bucket
