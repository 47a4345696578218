#include "server/routes/job_link.hpp"

#include <algorithm>
#include <array>

#include "server/base/clock.hpp"
#include "server/http/query.hpp"

namespace unwrapd::server::routes {
namespace {

constexpr std::array<std::string_view, 5> kFiles = {"result", "report", "layout.svg", "layout.png",
                                                    "preview.png"};
constexpr std::int64_t kUsualSeconds = 3600;
constexpr std::int64_t kMostSeconds = 7 * 24 * 3600;
constexpr std::int64_t kMsPerSecond = 1000;

}  // namespace

http::Response get_link(const store::JobRecord& job, const access::LinkSigner& links,
                        const http::Request& request) {
  std::string file(kFiles.front());
  std::int64_t seconds = kUsualSeconds;
  for (const auto& [name, text] : request.query) {
    http::check_once(request, name);
    if (name == "file") {
      file = text;
    } else if (name == "seconds") {
      seconds = http::positive_number(name, text, kMostSeconds);
    } else {
      http::refuse_unknown(name);
    }
  }
  if (std::ranges::count(kFiles, file) == 0)
    http::refuse_parameter("file", "A job has no such file; see /openapi.yaml.");
  const std::int64_t expires_ms = now_ms() + seconds * kMsPerSecond;
  const std::string path = api::job_path(job.id) + "/" + file;
  const access::LinkKey key{.id = request.caller.owner, .sha256 = request.caller.key_sha256};
  const api::Json link = {{"url", links.sign(path, expires_ms / kMsPerSecond, key)},
                          {"expires", rfc3339(expires_ms)}};
  http::Response response = http::json_response(200, link.dump());
  response.headers.emplace_back("Cache-Control", "no-store");
  return response;
}

}  // namespace unwrapd::server::routes
