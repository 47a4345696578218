#include "server/jobs/request_fingerprint.hpp"

#include "api/options.hpp"
#include "server/base/identity.hpp"
#include "server/store/stored_input.hpp"

namespace unwrapd::server::jobs {
namespace {

/// Resolved options of today as a version without presets resolved the same request: its defaults
/// in place of those of the default preset.
api::Json without_default_preset(api::Json options) {
  const api::Json now = api::to_json(api::preset_options(api::Preset::texture));
  const api::Json before = api::to_json(api::parse_stored_options(api::Json::object()));
  for (const auto& [name, value] : now.items())
    if (options.value(name, api::Json()) == value) options[name] = before.at(name);
  return options;
}

}  // namespace

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

std::string content_fingerprint(const store::JobRecord& job) {
  return request_fingerprint({{"options", job.options}, {"notes", job.notes}}, job);
}

bool is_same_request(const store::JobRecord& stored, const store::JobRecord& sent) {
  if (sent.request_key == sent.id && stored.id != sent.id) return false;
  if (!stored.asked.empty()) return stored.asked == sent.asked;
  const api::Json resolved = api::to_json(api::parse_stored_options(stored.options));
  const api::Json asked =
      stored.options.contains("preset") ? sent.options : without_default_preset(sent.options);
  return stored.input.sha256 == sent.input.sha256 &&
         store::without_long_members(resolved) == store::without_long_members(asked);
}

}  // namespace unwrapd::server::jobs
