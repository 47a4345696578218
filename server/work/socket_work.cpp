#include "server/work/socket_work.hpp"

#include <algorithm>
#include <utility>

#include "core/base/byte_pack.hpp"
#include "core/base/error.hpp"
#include "server/base/identity.hpp"

namespace unwrapd::server::work {
namespace {

using std::chrono::milliseconds;

constexpr std::int64_t kMostAnswer = std::int64_t{1} << 40;  // the server is trusted
constexpr int kMostBundles = 256;
constexpr std::size_t kMostStages = 64;
constexpr double kPatience = 2;  // times what this process would take
constexpr milliseconds kLeastPatience{2'000};
constexpr milliseconds kMostPatience{600'000};

std::string name_of(const SharedStage& stage) {
  return to_hex({reinterpret_cast<const char*>(stage.key.data()), stage.key.size()});
}

[[noreturn]] void invalid() {
  throw Error(ErrorCode::internal, "The worker process asked for no bundle that there is.");
}

std::string packed_answer(std::int32_t bundle, const std::optional<std::string>& bytes) {
  BytePacker pack;
  pack.add(bundle).add(std::uint8_t{bytes.has_value()});
  return pack.take() + bytes.value_or("");
}

int bundle_in(ByteUnpacker& from) {
  const auto bundle = from.next<std::int32_t>();
  if (bundle < 0 || bundle >= kMostBundles) invalid();
  return bundle;
}

}  // namespace

std::string SocketWork::answer() {
  Frame frame;
  receive_frame(receive_, kMostAnswer, frame);
  return std::move(frame.bytes);
}

std::optional<SharedWork::Claim> SocketWork::claim(const SharedStage& stage) {
  if (stage_ != stage.key) {
    stage_ = stage.key;
    longest_ms_ = 0;
    is_impatient_ = false;
  }
  send_frame(send_, FrameKind::claim, name_of(stage),
             BytePacker().add(std::int32_t{stage.bundle_count()}).take());
  const std::string bytes = answer();
  ByteUnpacker from(bytes);
  const auto bundle = from.next<std::int32_t>();
  if (bundle < 0 || bundle >= stage.bundle_count()) return std::nullopt;
  Claim claim{.bundle = bundle};
  if (from.next<std::uint8_t>() != 0) claim.made = bytes.substr(bytes.size() - from.size());
  began_ = Clock::now();
  return claim;
}

void SocketWork::publish(const SharedStage& stage, int bundle, std::string_view bytes) {
  const double work = stage.work[static_cast<std::size_t>(bundle)];
  const double took_ms = std::chrono::duration<double, std::milli>(Clock::now() - began_).count();
  longest_ms_ = std::max(longest_ms_, took_ms / work);
  send_frame(send_, FrameKind::publish, name_of(stage),
             BytePacker().add(std::int32_t{bundle}).take() + std::string(bytes));
}

/// Where one bundle was lost, the others that are missing are made at once.
milliseconds SocketWork::patience(double work) const {
  if (is_impatient_) return milliseconds(0);
  const double own_ms = std::min(kPatience * longest_ms_ * work, 1e6);
  return std::clamp(milliseconds(static_cast<std::int64_t>(own_ms)), kLeastPatience, kMostPatience);
}

std::optional<std::string> SocketWork::obtain(const SharedStage& stage, int bundle) {
  const milliseconds left = patience(stage.work[static_cast<std::size_t>(bundle)]);
  BytePacker question;
  question.add(std::int32_t{bundle}).add(std::int64_t{left.count()});
  send_frame(send_, FrameKind::obtain, name_of(stage), question.take());
  const std::string bytes = answer();
  ByteUnpacker from(bytes);
  from.next<std::int32_t>();
  if (from.next<std::uint8_t>() != 0) return bytes.substr(bytes.size() - from.size());
  is_impatient_ = true;
  return std::nullopt;
}

void SocketWork::finish() {
  if (is_helper_) throw Error(ErrorCode::cancelled, "There is nothing left to help with.");
}

std::optional<std::string> DeskConversation::answer(const Frame& frame) {
  const std::string& stage = frame.name;
  if (desk_ == nullptr || !is_sha256(stage) || claimed_.size() > kMostStages) invalid();
  ByteUnpacker from(frame.bytes);
  if (frame.kind == FrameKind::claim) {
    const auto bundles = from.next<std::int32_t>();
    if (bundles < 1 || bundles > kMostBundles) invalid();
    const auto claim = desk_->claim(stage, bundles);
    if (!claim) return packed_answer(-1, std::nullopt);
    claimed_[stage].insert(claim->bundle);  // what was made of it may turn out unsound
    return packed_answer(claim->bundle, claim->made);
  }
  const int bundle = bundle_in(from);
  if (frame.kind == FrameKind::obtain) {
    const milliseconds patience(from.next<std::int64_t>());
    return packed_answer(
        bundle, desk_->obtain(stage, bundle, std::clamp(patience, milliseconds(0), kMostPatience)));
  }
  if (claimed_[stage].erase(bundle) == 0) invalid();
  desk_->publish(stage, bundle,
                 std::string_view(frame.bytes).substr(frame.bytes.size() - from.size()));
  return std::nullopt;
}

}  // namespace unwrapd::server::work
