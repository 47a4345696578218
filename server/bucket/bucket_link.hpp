#pragma once
// Links by which anyone may get an object for a few minutes, without a key.

#include <chrono>
#include <string>

#include "server/bucket/bucket_config.hpp"

namespace unwrapd::server::bucket {

inline constexpr std::chrono::seconds kLinkSeconds{300};

/// What a link allows, and what the answer says of the object.
struct LinkTerms {
  std::string method = "GET";
  std::string content_type;
  std::string cache_control;
};

/// A URL of the object at the endpoint for clients.
std::string link_to(const BucketAddress& address, const std::string& key, const LinkTerms& terms);

}  // namespace unwrapd::server::bucket
