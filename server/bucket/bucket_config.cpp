#include "server/bucket/bucket_config.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <sstream>
#include <string_view>
#include <tuple>
#include <utility>

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

std::string endpoint_of(const BucketConfig& config) {
  return config.endpoint.empty() ? "https://s3." + config.region + ".amazonaws.com"
                                 : config.endpoint;
}

/// Under which clients reach it.
std::string link_endpoint(const BucketConfig& config) {
  return config.redirect_endpoint.empty() ? endpoint_of(config) : config.redirect_endpoint;
}

/// The scheme and the host of an endpoint; a port that its scheme means anyway is left out, as
/// clients leave it out of what is signed.
std::pair<std::string, std::string> scheme_and_host(const std::string& endpoint) {
  const std::size_t end = endpoint.find("://");
  const std::string scheme = endpoint.substr(0, end);
  std::string host = endpoint.substr(end + 3);
  const std::string usual_port = scheme == "https" ? ":443" : ":80";
  if (host.ends_with(usual_port)) host.resize(host.size() - usual_port.size());
  return {scheme, host};
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
  const auto is_of_host = [](unsigned char c) {
    return std::isalnum(c) != 0 ||
           std::string_view("-._:[]").find(static_cast<char>(c)) != std::string_view::npos;
  };
  return (name == "http" || name == "https") && !host.empty() &&
         std::ranges::all_of(host, is_of_host);
}

std::string link_origin(const BucketConfig& config) {
  if (!config.redirects) return {};
  const auto [scheme, host] = scheme_and_host(link_endpoint(config));
  return scheme + "://" + host;
}

BucketAddress address_of(const BucketConfig& config) {
  const std::string path = config.url.substr(kScheme.size());
  const std::size_t slash = path.find('/');
  BucketAddress address;
  address.bucket = path.substr(0, slash);
  if (slash != std::string::npos) address.prefix = path.substr(slash + 1);
  if (!address.prefix.empty() && !address.prefix.ends_with('/')) address.prefix += '/';
  address.region = config.region;
  std::tie(address.scheme, address.host) = scheme_and_host(endpoint_of(config));
  std::tie(address.link_scheme, address.link_host) = scheme_and_host(link_endpoint(config));
  address.credentials = config.credentials.empty() ? credentials_of_environment()
                                                   : read_credentials(config.credentials);
  return address;
}

}  // namespace unwrapd::server::bucket
