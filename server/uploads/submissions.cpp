#include "server/uploads/submissions.hpp"

#include <algorithm>

#include "server/base/clock.hpp"
#include "server/base/errors.hpp"
#include "server/base/identity.hpp"
#include "server/base/trace.hpp"
#include "server/jobs/request_fingerprint.hpp"
#include "server/store/stored_input.hpp"
#include "server/uploads/job_name.hpp"
#include "server/uploads/mesh_reference.hpp"

namespace unwrapd::server::uploads {
namespace {

/// The options in the body or in the query.
api::Json options_of(const std::optional<std::string>& text, const api::Query& query) {
  if (!text) return api::options_object(query);
  if (query.empty()) return api::parse_json(*text, {.max_bytes = api::kMaxOptionsBytes});
  throw Error(ErrorCode::invalid_option,
              "Options are in the query and in the body; give them in one place.",
              api::option_pointer(query.begin()->first));
}

/// Names a job whose query may have named it.
void name_in_body(store::JobRecord& job, std::string name) {
  if (name.empty()) return;
  if (!job.name.empty())
    throw Error(ErrorCode::invalid_option,
                "The name is in the query and in the body; give it in one place.", "/name");
  job.name = std::move(name);
}

/// Throws what parse_options() does, with the place in the document that was sent.
api::JobOptions read_options(const api::Json& asked, const api::Limits& limits,
                             std::string_view place) {
  try {
    return api::parse_options(asked, limits);
  } catch (const Error& error) {
    throw Error(error.code(), error.what(), std::string(place) + error.where());
  }
}

constexpr std::size_t kLongestKey = 255;

bool is_visible(char letter) { return letter > ' ' && letter < '\x7f'; }

/// The value of Idempotency-Key, empty without it. The quotes of a structured field are removed.
std::string idempotency_key(const http::Request& request) {
  if (!request.headers.contains("Idempotency-Key")) return {};
  std::string key = request.header("Idempotency-Key");
  if (key.size() >= 2 && key.front() == '"' && key.back() == '"')
    key = key.substr(1, key.size() - 2);
  if (!key.empty() && key.size() <= kLongestKey && std::ranges::all_of(key, is_visible)) return key;
  throw Error(ErrorCode::malformed_request,
              "Idempotency-Key must have 1 to 255 visible ASCII characters; use a UUID.");
}

/// The u of Priority (RFC 9218): 0 is the most urgent, 7 the least. 3 without the field, and, as
/// the standard asks, if the field cannot be read.
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

/// Whether Cache-Control asks for a new run rather than a stored answer.
bool wants_new_answer(const http::Request& request) {
  return request.header("Cache-Control").find("no-cache") != std::string::npos;
}

/// The name by which a request can be sent again; empty if it has none. No Idempotency-Key has a
/// blank in it, as the name of a ticket's job.
std::string request_name(const http::Request& request) {
  if (request.ticket) return "ticket " + request.ticket->id;
  return request.id.empty() ? idempotency_key(request) : request.id;
}

/// Identifies a request before its body is read: the same value if it is sent again.
std::string sender_of(const http::Request& request) {
  Sha256 hash;
  const auto add = [&](const std::string& text) { hash.add(text + '\0'); };
  add(request.caller.owner);
  add(request.client);
  add(request.path);
  for (const auto& [name, value] : request.query) {
    add(name);
    add(value);
  }
  add(request.header("Content-Length"));
  add(request.header("Idempotency-Key"));
  return hash.finish();
}

/// The size of the upload. A request that is sent again may bring its known bytes even when the
/// quota is used up, and its options in a longer form. A form has more than files, so that its
/// declared size is not used.
UploadSize size_of(const http::Request& request, const std::optional<store::JobRecord>& known) {
  const std::int64_t most = request.ticket ? request.ticket->max_bytes : 0;
  if (!known)
    return {.known_bytes = 0, .declared_bytes = request.declared_bytes, .most_bytes = most};
  if (http::body_kind(request.header("Content-Type")) == http::BodyKind::asset)
    return {.known_bytes = known->input.bytes,
            .declared_bytes = request.declared_bytes,
            .most_bytes = most};
  constexpr auto kOptionBytes = static_cast<std::int64_t>(api::kMaxOptionsBytes);
  return {
      .known_bytes = known->input.bytes + kOptionBytes, .declared_bytes = 0, .most_bytes = most};
}

Error stored_mesh_by_ticket() {
  return Error(ErrorCode::forbidden,
               "An upload ticket opens no stored mesh; send the bytes of the mesh.");
}

/// A ticket is for an upload and nothing else that its key may do. Throws Error{forbidden}.
void check_within_ticket(const http::Request& request) {
  if (!request.ticket) return;
  if (request.headers.contains("Unwrapd-Webhook"))
    throw Error(ErrorCode::forbidden, "An upload ticket allows no webhook; leave it out.");
  if (!request.sha256.empty()) throw stored_mesh_by_ticket();
}

std::optional<store::SpentTicket> ticket_of(const http::Request& request) {
  if (!request.ticket) return std::nullopt;
  return store::SpentTicket{.id = request.ticket->id,
                            .until_ms = request.ticket->expires * kMsPerSecond};
}

}  // namespace

/// The options in a body, and, if they are long, the turn to process them.
struct Submissions::Sent {
  std::unique_lock<std::mutex> turn;
  std::optional<std::string> options;  // JSON text
  std::string place = {};              // of the options in the body's document, a JSON pointer
  std::string source = {};             // the address of the mesh, where it is still to be read
};

std::string Submissions::accept(const http::Request& request, bool synchronous) {
  check_within_ticket(request);
  const std::string sender = sender_of(request);
  const bool is_spent = request.ticket && store_.is_spent(request.ticket->id);  // read first
  const std::optional<store::JobRecord> known = known_job(request);
  if (!known && is_spent) throw ticket_spent();
  if (!known) queue_.check_room({.who = sender, .owner = request.caller.owner});
  const std::string upload = random_job_id();
  try {
    UploadBudget room(rooms_, request.caller, upload, size_of(request, known));
    jobs::Submission submission{.job = begin_job(request, upload, synchronous),
                                .sender = sender,
                                .upload = upload,
                                .quota = request.caller.quota,
                                .bypass_cache = wants_new_answer(request),
                                .ticket = ticket_of(request)};
    receive(request, submission.job, room, upload);
    return queue_.submit(std::move(submission)).id;
  } catch (...) {
    queue_.give_back(sender);
    blobs_.drop_upload(upload);
    throw;
  }
}

/// The job that an earlier copy of this request has made: it needs no slot.
std::optional<store::JobRecord> Submissions::known_job(const http::Request& request) {
  const std::string name = request_name(request);
  return name.empty() ? std::nullopt : store_.find_request(request.caller.owner, name);
}

/// Begins a job from the head of the request.
store::JobRecord Submissions::begin_job(const http::Request& request, const std::string& upload,
                                        bool synchronous) const {
  store::JobRecord job;
  job.id = request.id.empty() ? upload : request.id;
  job.request_key = request_name(request);
  job.owner = request.caller.owner;
  job.urgency = request.ticket ? store::kUsualUrgency : urgency(request);
  job.trace = current_trace();
  job.synchronous = synchronous;
  job.webhook = request.header("Unwrapd-Webhook");
  if (request.headers.contains("Unwrapd-Webhook"))
    static_cast<void>(webhooks::parse_webhook(job.webhook, webhooks_));
  return job;
}

/// JSON in memory takes many times the size of its text: long texts are processed one at a time.
Submissions::Sent Submissions::read_whole(SpooledText& text) {
  Sent sent;
  if (text.is_long()) sent.turn = std::unique_lock(reading_);
  sent.options = text.read();
  return sent;
}

Submissions::Sent Submissions::bring(const http::Request& request,
                                     const store::UploadFolder& folder, store::JobRecord& job) {
  if (!request.sha256.empty()) return bring_options(request, folder, job);
  const http::BodyKind kind = http::body_kind(request.header("Content-Type"));
  if (kind == http::BodyKind::reference) return bring_reference(request, folder, job);
  Upload came = kind == http::BodyKind::asset ? receive_asset(*request.body, folder)
                                              : receive_parts(*request.body, folder);
  job.input = std::move(came.input);
  job.stored_bytes = job.input.bytes;
  name_in_body(job, take_job_name(came.fields));
  if (came.options) return read_whole(*came.options);
  Sent sent;
  if (!came.fields.empty()) sent.options = api::options_object(came.fields).dump();
  return sent;
}

Submissions::Sent Submissions::bring_reference(const http::Request& request,
                                               const store::UploadFolder& folder,
                                               store::JobRecord& job) {
  SpooledText text(folder.path / "reference.sent", folder.room);
  receive_reference_text(*request.body, text);
  Sent sent = read_whole(text);
  MeshReference named = parse_mesh_reference(*sent.options);
  if (named.source.empty()) {
    if (request.ticket) throw stored_mesh_by_ticket();
    job.input = meshes_.share(request.caller.owner, named.sha256, folder.path.filename(), "/mesh");
  }
  sent.source = std::move(named.source);
  name_in_body(job, std::move(named.name));
  sent.options = std::move(named.options);
  sent.place = "/options";
  return sent;
}

/// Others may process their options meanwhile.
void Submissions::bring_source(const http::Request& request, const store::UploadFolder& folder,
                               Sent& sent, store::JobRecord& job) {
  const bool has_turn = sent.turn.owns_lock();
  if (has_turn) sent.turn.unlock();
  const auto body = sources_.open(sent.source, {.owner = request.caller.owner,
                                                .has_left = request.has_left,
                                                .draining = [this] { return queue_.draining(); }});
  job.input = receive_asset(*body, folder).input;
  job.stored_bytes = job.input.bytes;
  if (has_turn) sent.turn.lock();
}

Submissions::Sent Submissions::bring_options(const http::Request& request,
                                             const store::UploadFolder& folder,
                                             store::JobRecord& job) {
  if (http::body_kind(request.header("Content-Type")) != http::BodyKind::reference)
    throw Error(ErrorCode::unsupported_media_type,
                "The options of a job on a stored mesh are JSON; send application/json.");
  SpooledText text(folder.path / "options.sent", folder.room);
  receive_reference_text(*request.body, text);
  Sent sent = read_whole(text);
  job.input = meshes_.share(request.caller.owner, request.sha256, folder.path.filename());
  return sent;
}

void Submissions::receive(const http::Request& request, store::JobRecord& job, UploadBudget& room,
                          const std::string& upload) {
  const http::BodyKind kind = http::body_kind(request.header("Content-Type"));
  api::Query query = request.query;
  job.name = take_job_name(query);
  api::JobOptions options = api::parse_options(query, limits_);  // before the body is read
  if (kind == http::BodyKind::asset) room.check_declared();
  const store::UploadFolder folder{.path = blobs_.begin_upload(upload), .room = room.counter()};
  Sent sent = bring(request, folder, job);
  api::Json asked = options_of(sent.options, query);
  if (sent.options) options = read_options(asked, limits_, sent.place);
  if (!sent.source.empty()) {
    asked = nullptr;  // may be large, and the source takes its time
    bring_source(request, folder, sent, job);
    asked = options_of(sent.options, query);
  }
  job.created_ms = now_ms();
  job.options = api::to_json(options);
  job.notes = std::move(options.notes);
  job.asked = jobs::request_fingerprint(asked, job);
  job.content_key = UNWRAPD_VERSION " " + jobs::content_fingerprint(job);
  store::shorten_options(job, folder);
}

}  // namespace unwrapd::server::uploads
