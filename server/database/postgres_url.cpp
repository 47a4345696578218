#include "server/database/postgres_url.hpp"

#include <string_view>

#include "server/base/errors.hpp"
#include "server/database/libpq_library.hpp"

namespace unwrapd::server::database {
namespace {

/// Whether what stands before the host has no / and @, at which libpq would end it.
bool has_clear_user(std::string_view url) {
  const std::size_t scheme = url.find("://");
  if (scheme == std::string_view::npos) return true;
  url.remove_prefix(scheme + 3);
  url = url.substr(0, url.find('?'));
  const std::size_t last = url.rfind('@');
  return last == std::string_view::npos || url.find_first_of("/@") == last;
}

bool is_readable(const std::string& url) {
  const LibpqLibrary& pq = LibpqLibrary::loaded();
  char* message = nullptr;
  PQconninfoOption* options = pq.parse(url.c_str(), &message);
  if (message != nullptr) pq.free_text(message);
  if (options == nullptr) return false;
  pq.free_parsed(options);
  return true;
}

}  // namespace

void check_url(const std::string& url) {
  if (has_clear_user(url) && is_readable(url)) return;
  throw InsideError(ErrorCode::storage_failed, "The server's store failed.",
                    "The value of --database is no URL that libpq can read; write %, / and @ of a "
                    "password as %25, %2F and %40.");
}

std::string without_pieces_of_url(std::string message) {
  if (message.starts_with("connection to server")) return message;
  std::size_t open = message.find('"');
  while (open != std::string::npos) {
    const std::size_t close = message.find('"', open + 1);
    message.replace(open, close == std::string::npos ? close : close + 1 - open, "...");
    open = message.find('"', open);
  }
  return message;
}

}  // namespace unwrapd::server::database
