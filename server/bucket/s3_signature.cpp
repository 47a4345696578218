#include "server/bucket/s3_signature.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <string_view>
#include <utility>

#include "server/base/identity.hpp"

namespace unwrapd::server::bucket {
namespace {

constexpr std::string_view kAlgorithm = "AWS4-HMAC-SHA256";
constexpr std::size_t kDateLength = 8;
constexpr unsigned kLowHalf = 0xF;

std::string encoded(std::string_view text, std::string_view also_kept) {
  constexpr std::string_view kHex = "0123456789ABCDEF";
  std::string all;
  for (const char letter : text) {
    const auto byte = static_cast<unsigned char>(letter);
    const bool is_kept = (byte < 128 && std::isalnum(byte) != 0) ||
                         std::string_view("-_.~").find(letter) != std::string_view::npos ||
                         also_kept.find(letter) != std::string_view::npos;
    if (is_kept)
      all += letter;
    else
      all += {'%', kHex[byte >> 4U], kHex[byte & kLowHalf]};
  }
  return all;
}

std::string names_of(const std::map<std::string, std::string>& headers) {
  std::string names;
  for (const auto& [name, value] : headers) names += (names.empty() ? "" : ";") + name;
  return names;
}

std::string canonical_request(const UnsignedRequest& request) {
  std::string text = request.method + "\n" + encoded_path(request.path) + "\n" +
                     encoded_query(request.query) + "\n";
  for (const auto& [name, value] : request.headers) text += name + ":" + value + "\n";
  return text + "\n" + names_of(request.headers) + "\n" + request.body_sha256;
}

std::string signing_key(const Credentials& credentials, const std::array<std::string, 3>& scope) {
  std::string key = "AWS4" + credentials.secret_key;
  for (const std::string& part : scope) key = hmac_sha256(key, part);
  return hmac_sha256(key, "aws4_request");
}

std::string scope_of(const std::string& region, const std::string& time) {
  return time.substr(0, kDateLength) + "/" + region + "/s3/aws4_request";
}

std::string signature_of(const UnsignedRequest& request, const Credentials& credentials,
                         const std::string& region, const std::string& time) {
  const std::string to_sign = std::string(kAlgorithm) + "\n" + time + "\n" +
                              scope_of(region, time) + "\n" + sha256(canonical_request(request));
  const std::string key = signing_key(credentials, {time.substr(0, kDateLength), region, "s3"});
  return to_hex(hmac_sha256(key, to_sign));
}

}  // namespace

std::string encoded_path(const std::string& path) { return encoded(path, "/"); }

std::string encoded_query(const std::map<std::string, std::string>& query) {
  std::string text;
  for (const auto& [name, value] : query)
    text += (text.empty() ? "" : "&") + encoded(name, "") + "=" + encoded(value, "");
  return text;
}

std::string signing_time(std::time_t time) {
  std::tm parts{};
  ::gmtime_r(&time, &parts);
  std::array<char, sizeof "20130524T000000Z"> text{};
  std::strftime(text.data(), text.size(), "%Y%m%dT%H%M%SZ", &parts);
  return text.data();
}

std::vector<std::string> signed_headers(UnsignedRequest request, const Credentials& credentials,
                                        const std::string& region, const std::string& time) {
  request.headers["x-amz-date"] = time;
  request.headers["x-amz-content-sha256"] = request.body_sha256;
  if (!credentials.session_token.empty())
    request.headers["x-amz-security-token"] = credentials.session_token;
  std::vector<std::string> lines;
  for (const auto& [name, value] : request.headers) lines.push_back(name + ": " + value);
  request.headers["host"] = request.host;

  lines.push_back("Authorization: " + std::string(kAlgorithm) +
                  " Credential=" + credentials.access_key + "/" + scope_of(region, time) +
                  ",SignedHeaders=" + names_of(request.headers) +
                  ",Signature=" + signature_of(request, credentials, region, time));
  return lines;
}

std::string signed_query(UnsignedRequest request, const Credentials& credentials,
                         const std::string& region, const std::string& time,
                         std::chrono::seconds valid) {
  request.headers = {{"host", request.host}};
  request.body_sha256 = "UNSIGNED-PAYLOAD";
  request.query["X-Amz-Algorithm"] = kAlgorithm;
  request.query["X-Amz-Credential"] = credentials.access_key + "/" + scope_of(region, time);
  request.query["X-Amz-Date"] = time;
  request.query["X-Amz-Expires"] = std::to_string(valid.count());
  request.query["X-Amz-SignedHeaders"] = names_of(request.headers);
  if (!credentials.session_token.empty())
    request.query["X-Amz-Security-Token"] = credentials.session_token;
  return encoded_query(request.query) +
         "&X-Amz-Signature=" + signature_of(request, credentials, region, time);
}

}  // namespace unwrapd::server::bucket
