#include "server/bucket/bucket_config.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <sstream>
#include <string_view>

#include "core/base/error.hpp"
#include "server/base/files.hpp"

namespace unwrapd::server::bucket {
namespace {

constexpr std::string_view kScheme = "s3://";

bool needs_no_code(char letter) {
  const auto byte = static_cast<unsigned char>(letter);
  return byte < 128 && (std::isalnum(byte) != 0 || letter == '-' || letter == '_' || letter == '.');
}

std::string variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

Credentials read_credentials(const std::filesystem::path& path) {
  std::istringstream words(read_file(path));
  Credentials credentials;
  words >> credentials.access_key >> credentials.secret_key >> credentials.session_token;
  if (credentials.secret_key.empty())
    throw Error(ErrorCode::invalid_option,
                "--s3-credentials has no key; write its id and its secret into the file, each on a "
                "line.");
  return credentials;
}

Credentials credentials_of_environment() {
  const Credentials credentials{.access_key = variable("AWS_ACCESS_KEY_ID"),
                                .secret_key = variable("AWS_SECRET_ACCESS_KEY"),
                                .session_token = variable("AWS_SESSION_TOKEN")};
  if (credentials.access_key.empty() || credentials.secret_key.empty())
    throw Error(ErrorCode::invalid_option,
                "--blobs is a bucket and there is no key for it; give --s3-credentials, or set "
                "AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY.");
  return credentials;
}

}  // namespace

bool is_bucket_url(const std::string& text) {
  if (!text.starts_with(kScheme)) return false;
  const std::string_view path = std::string_view(text).substr(kScheme.size());
  const bool has_empty_part =
      path.empty() || path.starts_with('/') || path.find("//") != std::string_view::npos;
  return !has_empty_part && path.find("..") == std::string_view::npos &&
         std::ranges::all_of(path, [](char c) { return c == '/' || needs_no_code(c); });
}

bool is_endpoint(const std::string& text) {
  const std::size_t scheme = text.find("://");
  if (scheme == std::string::npos) return false;
  const std::string name = text.substr(0, scheme);
  const std::string host = text.substr(scheme + 3);
  return (name == "http" || name == "https") && !host.empty() &&
         host.find_first_of("/@?# ") == std::string::npos;
}

BucketAddress address_of(const BucketConfig& config) {
  const std::string path = config.url.substr(kScheme.size());
  const std::size_t slash = path.find('/');
  BucketAddress address;
  address.bucket = path.substr(0, slash);
  if (slash != std::string::npos) address.prefix = path.substr(slash + 1);
  if (!address.prefix.empty() && !address.prefix.ends_with('/')) address.prefix += '/';
  address.region = config.region;
  const std::string endpoint =
      config.endpoint.empty() ? "https://s3." + config.region + ".amazonaws.com" : config.endpoint;
  const std::size_t scheme = endpoint.find("://");
  address.scheme = endpoint.substr(0, scheme);
  address.host = endpoint.substr(scheme + 3);
  address.credentials = config.credentials.empty() ? credentials_of_environment()
                                                   : read_credentials(config.credentials);
  return address;
}

}  // namespace unwrapd::server::bucket
