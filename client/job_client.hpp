#pragma once
// The API calls of a client in their order: submit a mesh, follow the job, fetch its results. The
// main interface of the library.

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <stop_token>
#include <string>

#include "api/job.hpp"
#include "client/failure.hpp"
#include "client/http.hpp"
#include "client/sse.hpp"
#include "client/upload.hpp"

namespace unwrapd::client {

/// Options as text, by the API's names (api/options.hpp).
using OptionTexts = std::map<std::string, std::string>;

/// Limits of retries. The defaults outlast a restart of the server.
struct Patience {
  std::chrono::milliseconds first_pause{100};  ///< after a lost connection; doubles each time
  std::chrono::milliseconds longest_pause{5000};
  int lost_connections = 12;  ///< in a row, without an event or answer between them
  int refusals = 30;          ///< "queue full, come back in n seconds"
};

class JobClient {
 public:
  using EventSink = std::function<void(const SseEvent&)>;

  /// A stop request ends every wait with Failure{interrupted}.
  JobClient(ServerUrl server, std::stop_token stop, Patience patience = {});

  /// Queues the job. options, and the job's name, go into the query; a multipart upload contains
  /// the options already, so pass none with it. While the queue is full the call waits as long as
  /// the server asks. Throws Failure: job_failed with the server's problem, unreachable,
  /// interrupted, file.
  api::Job submit(const Upload& upload, const OptionTexts& options);

  /// Passes on every event until the job is final, and returns its final state. After a lost
  /// connection it continues behind the last event. Throws Failure: as submit.
  api::Job follow(const std::string& job_id, const EventSink& on_event);

  /// The body of a GET on the job; `what` is "/result", "/report", "/layout.svg" and so on.
  std::string fetch(const std::string& job_id, const std::string& what);
  void fetch(const std::string& job_id, const std::string& what, const BytesSink& sink);

  void cancel(const std::string& job_id);

 private:
  /// The state of following a job across connections.
  struct FollowState {
    std::string last_id;
    std::optional<api::Job> job;  ///< set once it is final
    std::chrono::milliseconds wait;
    int lost = 0;  ///< lost connections in a row
  };

  /// Reads the events of one connection; without a stream, the job's state.
  void read_events(const std::string& job_id, FollowState& following, const EventSink& on_event);
  bool may_reconnect(const Failure& failure, FollowState& following) const;
  api::Job state_of(const std::string& job_id);
  void pause(std::chrono::milliseconds duration);

  Http http_;
  std::stop_token stop_;
  Patience patience_;
};

/// A problem document as text: title, detail, code and pointer.
std::string problem_text(const api::Json& problem);

}  // namespace unwrapd::client
