#pragma once
// A job as the store keeps it: one row. The bytes of its mesh and of its answer are files.

#include <cstdint>
#include <string>
#include <vector>

#include "api/job.hpp"
#include "server/blobs/digests.hpp"

namespace unwrapd::server::store {

inline constexpr int kUsualUrgency = 3;  // RFC 9218
inline constexpr int kMaxUrgency = 7;

/// A part of an upload: the URI that the document uses for it, and its file in the job's folder.
struct StoredBuffer {
  std::string uri;
  std::string file;
  std::string sha256 = {};  ///< of an upload that has just come; later in the file `digests`
};

/// What was sent.
struct JobInput {
  std::string sha256;                 ///< of the document, lowercase hex
  std::int64_t bytes = 0;             ///< of the document and its buffers
  std::vector<StoredBuffer> buffers;  ///< beside the document
};

/// Of an upload that has just come: all its files but long options.
blobs::Digests digests_of(const JobInput& input);

// NOLINTNEXTLINE(bugprone-exception-escape): moving a JSON value moves a pointer, and cannot throw
struct JobRecord {
  std::int64_t seq = 0;  ///< the order of arrival
  std::string id;
  api::JobState state = api::JobState::queued;
  std::int64_t created_ms = 0;
  std::int64_t finished_ms = 0;  ///< 0 while it is not final
  int attempt = 0;               ///< how often a worker has begun it
  int crashes = 0;               ///< how often the server died, or could not stop it, while it ran
  int process_ends = 0;          ///< how often it has ended a process of its own
  bool cancel_requested = false;
  bool synchronous = false;        ///< came by POST /v1/unwrap, with its lower limit of faces
  bool expired = false;            ///< its files are gone
  api::Json options;               ///< resolved
  std::vector<std::string> notes;  ///< of the options, for the report
  JobInput input;
  std::string result_format;      ///< glb, gltf or obj, once it has succeeded
  api::Json problem;              ///< null unless failed or cancelled
  std::int64_t last_event = 0;    ///< sequence number of the final event
  std::string owner;              ///< id of the API key that sent it; empty without keys
  int urgency = kUsualUrgency;    ///< 0 (first) to 7, among the jobs of its owner
  std::string request_key;        ///< the sender's own name of the request, empty without one
  std::string asked;              ///< the same for the same request; empty when 0.1.0 stored it
  std::string content_key;        ///< the same for the same answer: mesh, options, notes, version
  std::int64_t stored_bytes = 0;  ///< of its files, as far as quotas count them
  std::string webhook;            ///< called at its end, empty for none
  std::string name;               ///< for people, empty without one
  std::string trace;              ///< id of the trace that it came in and all is done in
  std::string node;               ///< that has begun it last; empty on a node that shares nothing
  std::int64_t beat = 0;          ///< rises while that node works on this attempt
  std::int64_t started_ms = 0;    ///< when this attempt began, by the clock of its node
  std::int64_t ran_ms = 0;        ///< of all attempts that have come to an end
  std::string unreadable;  ///< why its row cannot be read, and it counts as failed; else empty
};

/// The job as its owner sees it, without live progress.
api::Job to_job(const JobRecord& record);

}  // namespace unwrapd::server::store
