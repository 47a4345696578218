#include "server/http/http.hpp"

#include <algorithm>
#include <iterator>

#include "api/error_table.hpp"
#include "core/base/lower_case.hpp"
#include "server/base/errors.hpp"
#include "server/base/utf8.hpp"

namespace unwrapd::server::http {
namespace {

constexpr int kInternal = 500;
constexpr int kUnavailable = 503;

constexpr std::size_t kMaxProblemText = 500;  // bytes of a detail, or of a pointer

/// A name from a request may be as long as the request.
std::string bounded(const std::string& text) {
  if (text.size() <= kMaxProblemText) return text;
  return std::string(within_bytes(text, kMaxProblemText)) + "...";
}

/// What fails now and passes is no fault of the server.
int status_of(ErrorCode code, bool passes) {
  const int status = api::error_row(code).status;
  return passes && status == kInternal ? kUnavailable : status;
}

}  // namespace

std::string_view trim(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

bool same_word(std::string_view left, std::string_view right) {
  return std::ranges::equal(left, right, {}, lower_letter, lower_letter);
}

bool IgnoreCase::operator()(std::string_view left, std::string_view right) const {
  return std::ranges::lexicographical_compare(left, right, {}, lower_letter, lower_letter);
}

std::string Request::header(std::string_view name) const {
  const auto [first, end] = headers.equal_range(name);
  if (first == end) return {};
  std::string all = first->second;
  for (auto before = first, at = std::next(first); at != end; before = at++)
    if (at->second != before->second) all.append(", ").append(at->second);
  return all;
}

Response json_response(int status, std::string_view json) {
  Response response;
  response.status = status;
  response.content_type = "application/json";
  response.body = std::string(json);
  return response;
}

Response uncached_json_response(int status, std::string_view json) {
  Response response = json_response(status, json);
  response.headers.emplace_back("Cache-Control", "no-store");
  return response;
}

Response error_response(const Error& error, std::string_view job) {
  api::Json problem = api::problem(error, job);
  for (const char* member : {"detail", "pointer"})
    if (problem.contains(member)) problem[member] = bounded(problem[member]);
  const auto* later = dynamic_cast<const RetryLater*>(&error);
  const int status = status_of(error.code(), later != nullptr);
  problem["status"] = status;
  Response response = json_response(status, api::to_text(problem));
  response.content_type = "application/problem+json";
  response.problem = api::error_row(error.code()).name;
  if (error.code() == ErrorCode::unauthorized)
    response.headers.emplace_back("WWW-Authenticate", "Bearer");
  if (later != nullptr)
    response.headers.emplace_back("Retry-After", std::to_string(later->seconds()));
  return response;
}

}  // namespace unwrapd::server::http
