#include "server/submissions.hpp"

#include "server/clock.hpp"
#include "server/identity.hpp"
#include "server/job_input.hpp"
#include "server/media_types.hpp"

namespace unwrapd::server {
namespace {

/// The options of a form: its part, or the query when there is no such part.
api::JobOptions form_options(const Upload& upload, const Request& request,
                             const api::Limits& limits) {
  if (!upload.options) return api::parse_options(request.query, limits);
  if (request.query.empty()) return api::parse_options_text(*upload.options, limits);
  throw Error(ErrorCode::invalid_option,
              "Options are given in the query and in the part \"options\"; give them once.",
              "/" + request.query.begin()->first);
}

}  // namespace

JobRecord Submissions::accept(const Request& request, bool synchronous) {
  queue_.check_room();
  const std::string id = random_job_id();
  try {
    JobRecord job = receive(request, id);
    job.synchronous = synchronous;
    return queue_.submit(std::move(job));
  } catch (...) {
    blobs_.drop_upload(id);
    throw;
  }
}

JobRecord Submissions::receive(const Request& request, const std::string& id) {
  const BodyKind kind = body_kind(request.header("Content-Type"));
  const bool raw = kind == BodyKind::asset;
  api::JobOptions options = api::parse_options(request.query, limits_);  // before the body is read
  const std::filesystem::path folder = blobs_.begin_upload(id);
  Upload upload = raw ? receive_asset(*request.body, folder) : receive_parts(*request.body, folder);
  if (!raw) options = form_options(upload, request, limits_);
  JobRecord job;
  job.id = id;
  job.created_ms = now_ms();
  job.options = api::to_json(options);
  job.notes = std::move(options.notes);
  job.input = std::move(upload.input);
  return job;
}

}  // namespace unwrapd::server
