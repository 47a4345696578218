#include "server/bucket/bucket_link.hpp"

#include <ctime>
#include <utility>

namespace unwrapd::server::bucket {

std::string link_to(const BucketAddress& address, const std::string& key, const LinkTerms& terms) {
  UnsignedRequest request{.method = terms.method,
                          .host = address.link_host,
                          .path = "/" + address.bucket + "/" + address.prefix + key,
                          .query = {{"response-cache-control", terms.cache_control},
                                    {"response-content-type", terms.content_type}},
                          .headers = {},
                          .body_sha256 = {}};
  const std::string url = address.link_scheme + "://" + request.host + encoded_path(request.path);
  return url + "?" +
         signed_query(std::move(request), address.credentials, address.region,
                      signing_time(std::time(nullptr)), kLinkSeconds);
}

}  // namespace unwrapd::server::bucket
