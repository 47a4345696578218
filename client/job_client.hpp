#pragma once
// The API calls of a client in their order: submit a mesh, follow the job, fetch its results. The
// main interface of the library.

#include <chrono>
#include <functional>
#include <map>
#include <stop_token>
#include <string>

#include "api/job.hpp"
#include "client/failure.hpp"
#include "client/http.hpp"
#include "client/servers.hpp"
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

/// What a caller may want to hear, in the thread that calls; each may be empty.
struct Listener {
  std::function<void()> on_begun;  ///< the job that is followed has been started, or ended
  std::function<void(const std::string&)> on_wait;  ///< why a call has to be made again
};

class JobClient {
 public:
  using EventSink = std::function<void(const SseEvent&)>;

  /// A call waits as long as a busy server asks. One that loses its connection is made again, at
  /// the next address; the first of all calls at each address but once. A stop request ends every
  /// wait with Failure{interrupted}.
  JobClient(Servers servers, std::stop_token stop, Patience patience = {}, Listener listener = {});

  /// Queues the job, once, however often the call is made. options, and the job's name, go into
  /// the query; a multipart upload contains the options already, so pass none with it. Throws
  /// Failure: job_failed with the server's problem, unreachable, interrupted, file.
  api::Job submit(const Upload& upload, const OptionTexts& options);

  /// Passes on every event until the job is final, and returns its final state. After a lost
  /// connection it continues behind the last event. Throws Failure: as submit.
  api::Job follow(const std::string& job_id, const EventSink& on_event);

  /// The body of a GET on the job; `what` is "/result", "/report", "/layout.svg" and so on. Each
  /// byte goes to sink once, however often the call is made.
  std::string fetch(const std::string& job_id, const std::string& what);
  void fetch(const std::string& job_id, const std::string& what, const BytesSink& sink);

  void cancel(const std::string& job_id);

  [[nodiscard]] const Servers& servers() const { return servers_; }

 private:
  using Call = std::function<Reply(const Http&)>;

  struct Losses;
  struct FollowState;

  /// Reads the events of one connection; without a stream, the job's state.
  void read_events(const std::string& job_id, FollowState& following, const EventSink& on_event);
  void read_state(const std::string& job_id, FollowState& following);
  void note_begun(FollowState& following) const;
  /// Makes the call again as the constructor says; the last answer.
  Reply ask(const Call& call);
  /// Makes it once. Throws a Failure{unreachable} that may pass for a proxy that finds no server,
  /// and for a server error that is not unwrapd's, too.
  Reply ask_once(const Call& call);
  /// Counts a lost connection, and goes to the next address. Throws the failure if there were too
  /// many, and Failure{job_failed} if other calls are answered meanwhile.
  void lose(const Failure& failure, Losses& losses);
  void wait(const std::string& why, std::chrono::milliseconds duration);

  Servers servers_;
  Http http_;  ///< of the address in use
  std::stop_token stop_;
  Patience patience_;
  Listener listener_;
};

/// A problem document as text: title, detail, code and pointer.
std::string problem_text(const api::Json& problem);

}  // namespace unwrapd::client
