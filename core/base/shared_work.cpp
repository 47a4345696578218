#include "core/base/shared_work.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>

#include "core/base/error.hpp"

namespace unwrapd {
namespace {

constexpr double kMostBundles = 256;

std::string with_digest(const SharedCache& digests, std::string bytes) {
  const Digest digest = digest_of(digests, bytes);
  bytes.append(reinterpret_cast<const char*>(digest.data()), digest.size());
  return bytes;
}

/// Nothing where they are not those that were sent.
std::optional<std::string_view> without_digest(const SharedCache& digests, std::string_view bytes) {
  Digest digest;
  if (bytes.size() < digest.size()) return std::nullopt;
  const std::string_view own = bytes.substr(0, bytes.size() - digest.size());
  std::memcpy(digest.data(), bytes.data() + own.size(), digest.size());
  if (digest_of(digests, own) != digest) return std::nullopt;
  return own;
}

/// Whether the bytes are sound, and were taken.
bool take(const SharedCache& digests, const BundleSteps& steps, int bundle,
          const std::optional<std::string>& bytes) {
  const auto own = bytes ? without_digest(digests, *bytes) : std::nullopt;
  if (!own) return false;
  try {
    steps.unpack(bundle, *own);
    return true;
  } catch (const Error& error) {
    if (error.code() != ErrorCode::internal) throw;
    return false;
  }
}

}  // namespace

Digest digest_of(const SharedCache& digests, std::string_view bytes) {
  return digests.digest(std::as_bytes(std::span(bytes)));
}

std::optional<SharedStage> bundled(const SharedWork* helpers, std::span<const double> work,
                                   double bundles) {
  const double all = std::accumulate(work.begin(), work.end(), 0.0);
  if (helpers == nullptr || work.size() < 2 || all < helpers->least_faces()) return std::nullopt;
  const double least = std::max(helpers->least_faces() / bundles, all / kMostBundles);
  SharedStage stage;
  double own = 0;
  for (std::size_t k = 0; k < work.size(); ++k) {
    if (own == 0) stage.begin.push_back(k);
    own += work[k];
    if (own < least && k + 1 < work.size()) continue;
    stage.work.push_back(own);
    own = 0;
  }
  stage.begin.push_back(work.size());
  return stage;
}

void make_together(SharedWork& work, const SharedCache& digests, const SharedStage& stage,
                   const BundleSteps& steps) {
  std::vector<char> is_done(stage.work.size(), 0);
  while (const std::optional<SharedWork::Claim> claim = work.claim(stage)) {
    const int bundle = claim->bundle;
    if (!take(digests, steps, bundle, claim->made)) {
      steps.make(bundle);
      work.publish(stage, bundle, with_digest(digests, steps.pack(bundle)));
    }
    is_done.at(static_cast<std::size_t>(bundle)) = 1;
  }
  for (int bundle = 0; bundle < stage.bundle_count(); ++bundle) {
    if (is_done[static_cast<std::size_t>(bundle)] != 0) continue;
    if (!take(digests, steps, bundle, work.obtain(stage, bundle))) steps.make(bundle);
  }
}

}  // namespace unwrapd
