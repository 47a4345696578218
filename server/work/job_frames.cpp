#include "server/work/job_frames.hpp"

#include <algorithm>
#include <optional>

#include "api/report.hpp"
#include "core/base/byte_pack.hpp"
#include "server/base/utf8.hpp"

namespace unwrapd::server::work {
namespace {

struct FrameHead {
  std::uint8_t kind;
  std::uint64_t name_bytes;
  std::uint64_t bytes;
};
constexpr std::size_t kHeadBytes = 1 + 8 + 8;
constexpr std::size_t kShortBytes = 4096;
constexpr std::size_t kMaxNoteText = 4096;
constexpr std::uint64_t kPieceBytes = std::uint64_t{1} << 20;

[[noreturn]] void no_frame() {
  throw Error(ErrorCode::internal, "The worker process sent an invalid message.");
}

void add_lambda(BytePacker& pack, const std::optional<double>& lambda) {
  pack.add(std::uint8_t{lambda.has_value()}).add(lambda.value_or(0));
}

std::optional<double> next_lambda(ByteUnpacker& from) {
  const bool is_there = from.next<std::uint8_t>() != 0;
  const auto lambda = from.next<double>();
  return is_there ? std::optional(lambda) : std::nullopt;
}

FrameHead head_of(const std::string& bytes) {
  ByteUnpacker from(bytes);
  FrameHead head{};
  head.kind = from.next<std::uint8_t>();
  head.name_bytes = from.next<std::uint64_t>();
  head.bytes = from.next<std::uint64_t>();
  return head;
}

/// Takes memory only as the bytes arrive. False at the end.
bool receive_text(const ReceiveAll& receive, std::uint64_t size, std::string& text) {
  text.clear();
  while (text.size() < size) {
    const std::size_t begin = text.size();
    text.resize(begin + std::min<std::uint64_t>(size - begin, kPieceBytes));
    if (!receive(text.data() + begin, text.size() - begin)) return false;
  }
  return true;
}

/// A progress in [0, 1], whatever a worker sends.
double next_fraction(ByteUnpacker& from) {
  const auto fraction = from.next<double>();
  return fraction >= 0 ? std::min(fraction, 1.0) : 0;  // nor is it NaN
}

void unpack_stage(std::string_view bytes, JobOutput& output) {
  ByteUnpacker from(bytes);
  const auto stage = from.next<std::uint8_t>();
  if (stage > static_cast<std::uint8_t>(Stage::write)) no_frame();
  StageEvent event{.stage = static_cast<Stage>(stage)};
  event.chart = from.next<Index>();
  event.chart_count = from.next<Index>();
  event.fraction = next_fraction(from);
  event.lambda = next_lambda(from);
  output.stage(event);
}

void unpack_iteration(std::string_view bytes, JobOutput& output) {
  ByteUnpacker from(bytes);
  IterationEvent event;
  event.chart = from.next<Index>();
  event.iteration = from.next<int>();
  for (double* figure : {&event.energy, &event.rel_change, &event.angle, &event.area})
    *figure = from.next<double>();
  event.flipped = from.next<Index>();
  event.fraction = next_fraction(from);
  event.lambda = next_lambda(from);
  output.iteration(event, from.next<double>());
}

void unpack_note(const Frame& frame, JobOutput& output) {
  const std::optional<NoteCode> code = api::note_code_named(frame.name);
  if (!code) no_frame();
  output.note({*code, std::string(within_bytes(frame.bytes, kMaxNoteText))});
}

}  // namespace

void send_frame(const SendAll& send, FrameKind kind, std::string_view name,
                std::string_view bytes) {
  BytePacker head;
  head.add(kind).add(std::uint64_t{name.size()}).add(std::uint64_t{bytes.size()});
  std::string first = head.take() + std::string(name);
  const bool is_short = bytes.size() <= kShortBytes;  // an event wakes its reader once
  if (is_short) first += bytes;
  send(first);
  if (!is_short) send(bytes);
}

bool receive_frame(const ReceiveAll& receive, std::int64_t max_bytes, Frame& frame) {
  std::string bytes(kHeadBytes, '\0');
  if (!receive(bytes.data(), bytes.size())) return false;
  const FrameHead head = head_of(bytes);
  const bool known = head.kind <= static_cast<std::uint8_t>(FrameKind::failed);
  if (!known || head.name_bytes > kMaxFrameName ||
      head.bytes > static_cast<std::uint64_t>(max_bytes))
    no_frame();
  frame.kind = static_cast<FrameKind>(head.kind);
  return receive_text(receive, head.name_bytes, frame.name) &&
         receive_text(receive, head.bytes, frame.bytes);
}

std::string pack(const StageEvent& event) {
  const auto& [stage, chart, chart_count, fraction, lambda] = event;
  BytePacker pack;
  pack.add(static_cast<std::uint8_t>(stage)).add(chart).add(chart_count).add(fraction);
  add_lambda(pack, lambda);
  return pack.take();
}

std::string pack(const IterationEvent& event, double elapsed_ms) {
  const auto& [chart, iteration, energy, rel_change, angle, area, flipped, fraction, lambda] =
      event;
  BytePacker pack;
  pack.add(chart).add(iteration).add(energy).add(rel_change).add(angle).add(area).add(flipped);
  pack.add(fraction);
  add_lambda(pack, lambda);
  return pack.add(elapsed_ms).take();
}

void unpack_event(const Frame& frame, JobOutput& output) {
  if (frame.kind == FrameKind::stage) unpack_stage(frame.bytes, output);
  if (frame.kind == FrameKind::iteration) unpack_iteration(frame.bytes, output);
  if (frame.kind == FrameKind::note) unpack_note(frame, output);
}

}  // namespace unwrapd::server::work
