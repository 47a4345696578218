#pragma once
// Where the objects of a farm are, and by which key they are reached.

#include <filesystem>
#include <string>

#include "server/bucket/s3_signature.hpp"

namespace unwrapd::server::bucket {

/// As it is configured.
struct BucketConfig {
  std::string url;       ///< "s3://bucket/prefix"; empty: files are in a directory
  std::string endpoint;  ///< "https://host:port"; empty: Amazon's of the region
  std::string region = "us-east-1";
  std::filesystem::path credentials;   ///< of read_credentials(); empty: of the environment
  bool redirects = false;              ///< clients get results from it
  std::string redirect_endpoint = {};  ///< under which they reach it; empty: the endpoint
};

/// The same, taken apart.
struct BucketAddress {
  std::string scheme = "https";
  std::string host;  ///< with the port, unless it is that of the scheme
  std::string link_scheme = "https";
  std::string link_host;  ///< under which clients reach it, the same
  std::string bucket;
  std::string prefix;  ///< of all keys: empty, or ends with '/'
  std::string region;
  Credentials credentials;
};

/// Whether text is "s3://bucket" or "s3://bucket/prefix", of letters that need no code in a URL.
bool is_bucket_url(const std::string& text);
/// Whether text is "https://host" or "http://host:port", without a path.
bool is_endpoint(const std::string& text);

/// "https://host" of the links that clients get; empty where they get none.
std::string link_origin(const BucketConfig& config);

/// Of config.url, which must be one. Reads the credentials. Throws Error{invalid_option} when there
/// are none.
BucketAddress address_of(const BucketConfig& config);

}  // namespace unwrapd::server::bucket
