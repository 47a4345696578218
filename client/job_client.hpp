#pragma once
// The calls of the API that a client needs, in the order in which it makes them: submit a mesh,
// follow the job, take what it made. The library's front door.

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

/// How patient a client is. The defaults outlast a restart of the server.
struct Patience {
  std::chrono::milliseconds first_pause{100};  ///< after a lost connection; doubles each time
  std::chrono::milliseconds longest_pause{5000};
  int lost_connections = 12;  ///< in a row, without one event or answer between
  int refusals = 30;          ///< "queue full, come back in n seconds"
};

class JobClient {
 public:
  using EventSink = std::function<void(const SseEvent&)>;

  /// A stop request ends every wait with Failure{interrupted}.
  JobClient(ServerUrl server, std::stop_token stop, Patience patience = {});

  /// Queues the job. options travel in the query; pass none with a multipart upload, which holds
  /// them itself. While the queue is full the call waits as long as the server asks.
  /// Throws Failure: job_failed with the server's problem, unreachable, interrupted, file.
  api::Job submit(const Upload& upload, const OptionTexts& options);

  /// Hands on every event until the job is final, and returns it as it then is. A lost connection
  /// is taken up again behind the last event seen. Throws Failure: as submit.
  api::Job follow(const std::string& job_id, const EventSink& on_event);

  /// The body of a GET on the job: what is "/result", "/report", "/layout.svg" and so on.
  std::string fetch(const std::string& job_id, const std::string& what);
  void fetch(const std::string& job_id, const std::string& what, const BytesSink& sink);

  void cancel(const std::string& job_id);

 private:
  /// What following a job remembers from one connection to the next.
  struct Following {
    std::string last_id;
    std::optional<api::Job> job;  ///< once it is final
    std::chrono::milliseconds wait;
    int lost = 0;  ///< connections in a row without a sign of life
  };

  /// One connection's worth of events; without a stream, the job's state.
  void read_events(const std::string& job_id, Following& following, const EventSink& on_event);
  bool may_reconnect(const Failure& failure, Following& following) const;
  api::Job state_of(const std::string& job_id);
  void pause(std::chrono::milliseconds duration);

  Http http_;
  std::stop_token stop_;
  Patience patience_;
};

/// A problem document as a person reads it: title, detail, code and pointer.
std::string problem_text(const api::Json& problem);

}  // namespace unwrapd::client
