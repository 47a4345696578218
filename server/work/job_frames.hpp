#pragma once
// What a server and its worker process say to each other over one socket: frames of a kind, a name
// and bytes. The server trusts nothing in a frame that it receives, the worker everything.

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "core/types/progress.hpp"
#include "server/store/job_record.hpp"
#include "server/work/run_job.hpp"

namespace unwrapd::server::work {

enum class FrameKind : std::uint8_t {
  task,       ///< to the worker: what to do; bytes of pack_task()
  document,   ///< to the worker: the asset
  buffer,     ///< to the worker: a buffer, by its URI
  uvs,        ///< to the worker: of a map to be rendered
  report,     ///< to the worker: of that map
  begin,      ///< to the worker: that was all
  bundle,     ///< to the worker: the answer to what it asked the desk
  ready,      ///< from here on from the worker: it has locked itself in
  stage,      ///< bytes of pack()
  iteration,  ///< bytes of pack()
  note,       ///< the name is its code, the bytes are its text
  result,     ///< the answer's asset, by its format
  file,       ///< a further file, by its name
  claim,      ///< asks for a bundle to make; the name is its stage, as of the next two
  publish,    ///< a bundle for the others
  obtain,     ///< asks for a bundle of another
  done,       ///< the end; the name is the result's format
  rendered,   ///< the end; bytes of the file that was asked for
  failed,     ///< the end; the name is the error's code
};

struct Frame {
  FrameKind kind = FrameKind::failed;
  std::string name;
  std::string bytes;
};

/// A buffer's URI is the longest: it comes in the head of a form's part, which is shorter.
inline constexpr std::size_t kMaxFrameName = std::size_t{64} << 10;

/// Sends all bytes or throws Error{internal}, as when the other end is gone.
using SendAll = std::function<void(std::string_view)>;
/// Fills the memory or throws Error{internal}. False when what is sent ends before that.
using ReceiveAll = std::function<bool(char* data, std::size_t size)>;

void send_frame(const SendAll& send, FrameKind kind, std::string_view name, std::string_view bytes);

/// The next frame, of at most max_bytes. False at the end, be it between two frames or in one: the
/// sender is gone. Throws Error{internal} for what is none.
bool receive_frame(const ReceiveAll& receive, std::int64_t max_bytes, Frame& frame);

std::string pack(const StageEvent& event);
std::string pack(const IterationEvent& event, double elapsed_ms);
/// Hands an event to an output: what pack() made, or a note, of a long text the beginning. Throws
/// Error{internal} for anything else.
void unpack_event(const Frame& frame, JobOutput& output);

inline bool is_event(FrameKind kind) {
  return kind == FrameKind::stage || kind == FrameKind::iteration || kind == FrameKind::note;
}

}  // namespace unwrapd::server::work
