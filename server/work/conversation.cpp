#include "server/work/conversation.hpp"

#include <optional>
#include <stdexcept>

#include "api/json.hpp"
#include "server/blobs/blob_store.hpp"
#include "server/work/job_process.hpp"

namespace unwrapd::server::work {
namespace {

constexpr std::size_t kMaxTotals = 16384;

[[noreturn]] void misbehaved() { throw WorkerCrashed("its answer is invalid"); }

/// Parses a message of a worker. A message that cannot be parsed is no error of the job.
template <class Read>
auto believed(Read read) {
  try {
    return read();
  } catch (const Error&) {
    misbehaved();
  }
}

/// Throws what the worker caught: an exception that nobody foresaw as such, as it would be thrown
/// in this process.
[[noreturn]] void throw_told(const Frame& frame) {
  const ToldFailure failure = believed([&] { return failure_told(frame); });
  if (failure.reason.empty()) throw failure.error;
  throw std::runtime_error(failure.reason);
}

/// Whether the totals can become a header field of an answer.
bool is_totals(std::string_view bytes) {
  return bytes.size() <= kMaxTotals && api::Json::accept(bytes) &&
         bytes.find_first_of("\r\n") == std::string_view::npos;
}

/// Keeps the event of a frame, for an output that may fail for reasons of its own.
class EventCopy final : public JobOutput {
 public:
  void stage(const StageEvent& event) override { stage_ = event; }
  void iteration(const IterationEvent& event, double elapsed_ms) override {
    iteration_ = event;
    elapsed_ms_ = elapsed_ms;
  }
  void note(const Note& note) override { note_ = note; }
  void result(std::string_view /*format*/, std::string_view /*bytes*/) override {}
  void file(std::string_view /*name*/, std::string_view /*bytes*/) override {}

  void hand_to(JobOutput& output) const {
    if (stage_) output.stage(*stage_);
    if (iteration_) output.iteration(*iteration_, elapsed_ms_);
    if (note_) output.note(*note_);
  }

 private:
  std::optional<StageEvent> stage_;
  std::optional<IterationEvent> iteration_;
  double elapsed_ms_ = 0;
  std::optional<Note> note_;
};

}  // namespace

void Conversation::send(FrameKind kind, std::string_view name, std::string_view bytes) {
  send_frame([&](std::string_view piece) { worker_.send(piece); }, kind, name, bytes);
}

void Conversation::await_ready() {
  if (next().kind != FrameKind::ready) misbehaved();
}

std::string Conversation::listen() {
  while (true) {
    const Frame frame = next();
    if (frame.kind == FrameKind::done && is_result_format(frame.name)) return frame.name;
    hand_over(frame);
  }
}

std::string Conversation::listen_for_file() {
  Frame frame = next();
  if (frame.kind != FrameKind::rendered) misbehaved();
  return std::move(frame.bytes);
}

/// The next frame. Throws the error that the worker ends with.
Frame Conversation::next() {
  Frame frame;
  const auto receive = [&](char* data, std::size_t size) { return worker_.receive(data, size); };
  if (!believed([&] { return receive_frame(receive, left_, frame); })) worker_.reap();
  left_ -= static_cast<std::int64_t>(frame.bytes.size());
  if (frame.kind == FrameKind::failed) throw_told(frame);
  return frame;
}

void Conversation::hand_over(const Frame& frame) {
  if (is_event(frame.kind)) return hand_over_event(frame);
  if (is_for_desk(frame.kind)) return ask_desk(frame);
  if (frame.kind == FrameKind::result && files_.take_result(frame.name))
    return output_.result(frame.name, frame.bytes);
  const bool is_file = frame.kind == FrameKind::file && files_.take(frame.name);
  if (!is_file || (frame.name == blobs::kTotalsFile && !is_totals(frame.bytes))) misbehaved();
  output_.file(frame.name, frame.bytes);
}

void Conversation::ask_desk(const Frame& frame) {
  std::optional<std::string> answer;
  try {
    answer = desk_.answer(frame);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::internal) misbehaved();
    throw;
  }
  if (answer) send(FrameKind::bundle, {}, *answer);
}

void Conversation::hand_over_event(const Frame& frame) {
  EventCopy event;
  believed([&] { unpack_event(frame, event); });
  event.hand_to(output_);
}

}  // namespace unwrapd::server::work
