#include "server/submissions.hpp"

#include "server/clock.hpp"
#include "server/identity.hpp"
#include "server/mesh_reference.hpp"
#include "server/request_headers.hpp"
#include "server/trace.hpp"

namespace unwrapd::server {
namespace {

constexpr std::size_t kSmallText = std::size_t{64} * 1024;

/// The options of a body that may bring some: those, or the query when there are none.
api::JobOptions options_of(const Upload& upload, const Request& request,
                           const api::Limits& limits) {
  if (!upload.options) return api::parse_options(request.query, limits);
  if (request.query.empty()) return api::parse_options_text(*upload.options, limits);
  throw Error(ErrorCode::invalid_option,
              "Options are given in the query and in the body; give them once.",
              "/" + request.query.begin()->first);
}

/// The same for the same question to the same version: what is asked, and of what.
std::string content_key(const JobRecord& job) {
  Sha256 hash;
  const auto add = [&](const std::string& text) { hash.add(text + '\0'); };
  add(UNWRAPD_VERSION);
  add(job.synchronous ? "small" : "any size");
  add(job.options.dump());
  add(job.input.sha256);
  for (const StoredBuffer& buffer : job.input.buffers) {
    add(buffer.uri);
    add(buffer.sha256);
  }
  return hash.finish();
}

/// By which the sender can send it again; empty when it has none.
std::string request_name(const Request& request) {
  return request.id.empty() ? idempotency_key(request) : request.id;
}

/// What tells a request from others before its body is read: the same when it is sent again.
std::string sender_of(const Request& request) {
  Sha256 hash;
  const auto add = [&](const std::string& text) { hash.add(text + '\0'); };
  add(request.caller.owner);
  add(request.client);
  add(request.path);
  for (const auto& [name, value] : request.query) {
    add(name);
    add(value);
  }
  add(std::to_string(request.declared_bytes));
  add(request.header("Idempotency-Key"));
  return hash.finish();
}

}  // namespace

JobRecord Submissions::accept(const Request& request, bool synchronous) {
  const std::string sender = sender_of(request);
  queue_.check_room(sender);
  const std::string upload = random_job_id();
  try {
    Submission submission = receive(request, upload);
    submission.job.synchronous = synchronous;
    submission.job.content_key = content_key(submission.job);
    return queue_.submit(std::move(submission));
  } catch (...) {
    queue_.give_back(sender);
    blobs_.drop_upload(upload);
    throw;
  }
}

/// What the request brings; the same may come again when its sender has no bytes left. A form is
/// more than its files: what it declares tells nothing then.
UploadRoom Submissions::room_for(const Request& request, BodyKind kind, const std::string& upload) {
  const std::string name = request_name(request);
  std::optional<JobRecord> known;
  if (!name.empty()) known = store_.find_request(request.caller.owner, name);
  const bool tells = kind == BodyKind::asset || !known;
  return {blobs_.room(), upload,
          allowance_of(store_, request.caller, known ? known->input.bytes : 0),
          tells ? request.declared_bytes : 0};
}

std::unique_lock<std::mutex> Submissions::turn_to_read(std::size_t bytes) {
  return bytes > kSmallText ? std::unique_lock(reading_) : std::unique_lock<std::mutex>();
}

Upload Submissions::bring(const Request& request, BodyKind kind, const std::string& upload) {
  UploadRoom room = room_for(request, kind, upload);
  if (kind == BodyKind::asset) room.check_declared();
  const UploadFolder folder{.path = blobs_.begin_upload(upload),
                            .take = [&](std::int64_t bytes) { room.take(bytes); }};
  if (kind == BodyKind::asset) return receive_asset(*request.body, folder);
  if (kind == BodyKind::multipart) return receive_parts(*request.body, folder);
  const std::string text = receive_reference_text(*request.body);
  const auto turn = turn_to_read(text.size());
  MeshReference named = parse_mesh_reference(text);
  return {.input = meshes_.share(request.caller.owner, named.sha256, upload),
          .options = std::move(named.options)};
}

Submission Submissions::receive(const Request& request, const std::string& upload) {
  const BodyKind kind = body_kind(request.header("Content-Type"));
  api::JobOptions options = api::parse_options(request.query, limits_);  // before the body is read
  Submission submission{.job = {},
                        .sender = sender_of(request),
                        .upload = upload,
                        .quota = request.caller.quota,
                        .anew = wants_new_answer(request)};
  JobRecord& job = submission.job;
  job.id = request.id.empty() ? upload : request.id;
  job.request_key = request_name(request);
  job.owner = request.caller.owner;
  job.urgency = urgency(request);
  job.trace = current_trace();
  job.webhook = request.header("Unwrapd-Webhook");
  if (!job.webhook.empty()) static_cast<void>(parse_webhook(job.webhook, webhooks_));
  Upload came = bring(request, kind, upload);
  if (kind != BodyKind::asset) {
    const auto turn = turn_to_read(came.options ? came.options->size() : 0);
    options = options_of(came, request, limits_);
  }
  job.created_ms = now_ms();
  job.options = api::to_json(options);
  job.notes = std::move(options.notes);
  job.input = std::move(came.input);
  job.stored_bytes = kind == BodyKind::reference ? 0 : job.input.bytes;
  return submission;
}

}  // namespace unwrapd::server
