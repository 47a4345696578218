// What the server reads that a worker process has written: frames, from one that a stranger's mesh
// may have taken over, and the maps of jobs that were stored. A frame that is none is an answer
// here.
#include <algorithm>
#include <array>

#include "core/base/byte_pack.hpp"
#include "core/base/error.hpp"
#include "server/work/job_frames.hpp"
#include "server/work/uv_file.hpp"
#include "tests/fuzz/targets.hpp"

namespace unwrapd::fuzz {
namespace {

constexpr std::int64_t kMaxFrameBytes = std::int64_t{1} << 16;

class EventSink final : public server::work::JobOutput {
 public:
  void stage(const StageEvent& event) override {
    promise(event.stage <= Stage::write, "a stage is one of ours");
  }
  void iteration(const IterationEvent& /*event*/, double /*elapsed_ms*/) override {}
  void note(const Note& /*note*/) override {}
  void result(std::string_view /*format*/, std::string_view /*bytes*/) override {}
  void file(std::string_view /*name*/, std::string_view /*bytes*/) override {}
};

void read_frame(const server::work::Frame& frame) {
  EventSink sink;
  promise(frame.name.size() <= server::work::kMaxFrameName, "a name is as long as names may be");
  promise(static_cast<std::int64_t>(frame.bytes.size()) <= kMaxFrameBytes, "a frame is bounded");
  server::work::unpack_event(frame, sink);
}

void frames(std::string_view bytes) {
  const auto receive = [&](char* data, std::size_t size) {
    if (bytes.size() < size) return false;
    std::copy_n(bytes.data(), size, data);
    bytes.remove_prefix(size);
    return true;
  };
  try {
    for (server::work::Frame frame; server::work::receive_frame(receive, kMaxFrameBytes, frame);)
      read_frame(frame);
  } catch (const Error& error) {
    promise(error.code() == ErrorCode::internal, "a worker that sends no frames is at fault");
  }
}

std::vector<std::string> frames_seeds() {
  std::string all;
  const auto send = [&](std::string_view piece) { all += piece; };
  server::work::send_frame(send, server::work::FrameKind::ready, {}, {});
  server::work::send_frame(send, server::work::FrameKind::stage, {},
                           server::work::pack(StageEvent{.stage = Stage::solve}));
  server::work::send_frame(send, server::work::FrameKind::iteration, {},
                           server::work::pack(IterationEvent{}, 1.5));
  server::work::send_frame(send, server::work::FrameKind::note, "overlaps", "2 pairs");
  server::work::send_frame(send, server::work::FrameKind::result, "glb", "glTF");
  server::work::send_frame(send, server::work::FrameKind::done, "glb", {});
  return {all};
}

void uvs(std::string_view bytes) {
  promise(server::work::encode_uvs(server::work::decode_uvs(bytes)) == bytes,
          "a map is written as it was");
}

std::vector<std::string> uvs_seeds() {
  UnwrappedSurface surface;
  surface.faces = {Triangle{0, 1, 2}};
  surface.source = {0, 1, 2};
  surface.uv.resize(3);
  return {server::work::encode_uvs({surface}), server::work::encode_uvs({surface, {}}),
          server::work::encode_uvs({})};
}

constexpr std::array kTargets = {Target{"frames", frames, frames_seeds},
                                 Target{"uvs", uvs, uvs_seeds}};

}  // namespace

std::span<const Target> worker_targets() { return kTargets; }

}  // namespace unwrapd::fuzz
