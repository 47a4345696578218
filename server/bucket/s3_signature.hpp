#pragma once
// Signatures of requests to an object store: AWS Signature Version 4, as Amazon S3, Ceph, MinIO and
// others ask for it (docs.aws.amazon.com, "Authenticating Requests": by the Authorization header,
// or by the query of a link). libcurl's own was rejected: in 7.88 it neither sorts queries nor
// signs the digest of a body.

#include <chrono>
#include <ctime>
#include <map>
#include <string>
#include <vector>

namespace unwrapd::server::bucket {

struct Credentials {
  std::string access_key;
  std::string secret_key;
  std::string session_token = {};  ///< of temporary ones; empty: none
};

/// What is signed of a request.
struct UnsignedRequest {
  std::string method;
  std::string host;                            ///< as the header Host has it
  std::string path;                            ///< "/bucket/key", not yet encoded
  std::map<std::string, std::string> query;    ///< not yet encoded
  std::map<std::string, std::string> headers;  ///< further ones, in small letters
  std::string body_sha256;                     ///< lowercase hex
};

/// "/bucket/a%20key": each byte but letters, digits and -_.~/ as its code.
std::string encoded_path(const std::string& path);
/// "list-type=2&prefix=a%2F", in the order of the names; empty without a query.
std::string encoded_query(const std::map<std::string, std::string>& query);

/// As signatures have it: "20130524T000000Z".
std::string signing_time(std::time_t time);

/// The lines of the header, Host left out. time: of signing_time().
std::vector<std::string> signed_headers(UnsignedRequest request, const Credentials& credentials,
                                        const std::string& region, const std::string& time);

/// The query of a link by which anyone may make this request for so long. It has no further
/// headers, and no body is signed.
std::string signed_query(UnsignedRequest request, const Credentials& credentials,
                         const std::string& region, const std::string& time,
                         std::chrono::seconds valid);

}  // namespace unwrapd::server::bucket
