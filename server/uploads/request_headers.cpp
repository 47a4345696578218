#include "server/uploads/request_headers.hpp"

#include <algorithm>

namespace unwrapd::server::uploads {
namespace {

constexpr std::size_t kLongestKey = 255;

bool is_visible(char letter) { return letter > ' ' && letter < '\x7f'; }

}  // namespace

std::string idempotency_key(const http::Request& request) {
  if (!request.headers.contains("Idempotency-Key")) return {};
  std::string key = request.header("Idempotency-Key");
  if (key.size() >= 2 && key.front() == '"' && key.back() == '"')
    key = key.substr(1, key.size() - 2);
  if (!key.empty() && key.size() <= kLongestKey && std::ranges::all_of(key, is_visible)) return key;
  throw Error(ErrorCode::malformed_request,
              "Idempotency-Key must have 1 to 255 visible ASCII characters; use a UUID.");
}

int urgency(const http::Request& request) {
  const std::string field = request.header("Priority");
  const std::size_t at = field.find("u=");
  const bool starts_item =
      at == 0 || (at != std::string::npos && (field[at - 1] == ' ' || field[at - 1] == ','));
  if (!starts_item || at + 2 >= field.size()) return store::kUsualUrgency;
  const int value = field[at + 2] - '0';
  const bool one_digit = at + 3 == field.size() || field[at + 3] == ',' || field[at + 3] == ' ';
  return one_digit && value >= 0 && value <= store::kMaxUrgency ? value : store::kUsualUrgency;
}

bool wants_new_answer(const http::Request& request) {
  return request.header("Cache-Control").find("no-cache") != std::string::npos;
}

}  // namespace unwrapd::server::uploads
