#include "server/jobs/request_fingerprint.hpp"

#include "api/options.hpp"
#include "server/base/identity.hpp"
#include "server/store/stored_input.hpp"

namespace unwrapd::server::jobs {

std::string request_fingerprint(const api::Json& options, const store::JobRecord& job) {
  Sha256 hash;
  const auto add = [&](const std::string& text) { hash.add(text + '\0'); };
  add(job.synchronous ? "small" : "any size");
  add(options.dump());
  add(job.input.sha256);
  for (const store::StoredBuffer& buffer : job.input.buffers) {
    add(buffer.uri);
    add(buffer.sha256);
  }
  return hash.finish();
}

bool is_same_request(const store::JobRecord& stored, const store::JobRecord& sent) {
  if (sent.request_key == sent.id && stored.id != sent.id) return false;
  if (!stored.asked.empty()) return stored.asked == sent.asked;
  const api::Json resolved = api::to_json(api::parse_stored_options(stored.options));
  return stored.input.sha256 == sent.input.sha256 &&
         store::without_long_members(resolved) == store::without_long_members(sent.options);
}

}  // namespace unwrapd::server::jobs
