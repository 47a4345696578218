#pragma once
// One signed request to an object store and its answer, by libcurl.

#include <cstdint>
#include <exception>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "server/bucket/bucket_config.hpp"
#include "server/outbound/curl_library.hpp"

namespace unwrapd::server::bucket {

/// The body of a request, which is read in pieces, and again where a request is repeated.
struct Body {
  std::int64_t bytes = 0;
  std::string sha256;  ///< lowercase hex
  std::function<std::string(std::int64_t offset, std::size_t most)> read;
};
/// bytes must outlive it.
Body body_of(std::string_view bytes);

struct Call {
  std::string method;
  std::string key = {};                             ///< empty: of the bucket itself
  std::map<std::string, std::string> query = {};    ///< not encoded
  std::map<std::string, std::string> headers = {};  ///< names in small letters
  const Body* body = nullptr;
  /// Takes the body of a success in pieces; none: Answer::body has it.
  std::function<void(std::string_view bytes)> take = {};
};

struct Answer {
  long status = 0;
  std::map<std::string, std::string> headers;  ///< names in small letters
  std::string body;

  [[nodiscard]] bool is_success() const { return status >= 200 && status < 300; }
};

/// Used once.
class S3Exchange {
 public:
  explicit S3Exchange(const Call& call) : call_(call) {}
  S3Exchange(const S3Exchange&) = delete;
  S3Exchange& operator=(const S3Exchange&) = delete;

  /// Uses the connection of easy, which keeps it open. What libcurl says of a failure; empty where
  /// there was an answer. Throws what the body and `take` throw.
  std::string run(CURL* easy, const BucketAddress& address);
  Answer& answer() { return answer_; }

 private:
  void set_options(CURL* easy, const BucketAddress& address);
  static std::size_t read_body(char* buffer, std::size_t one, std::size_t count, void* self);
  static int seek_body(void* self, curl_off_t offset, int origin);
  static std::size_t line_came(const char* bytes, std::size_t one, std::size_t count, void* self);
  static std::size_t body_came(const char* bytes, std::size_t one, std::size_t count, void* self);
  void take_line(std::string_view line);
  bool take_body(std::string_view bytes);
  template <class Step>
  bool goes_on(const Step& step);

  const Call& call_;
  Answer answer_;
  std::int64_t sent_ = 0;
  std::exception_ptr thrown_;
};

}  // namespace unwrapd::server::bucket
