#pragma once
// Work of one job that several processes do together. All of them run the same job on the same
// input; where it comes to a stage of many independent things, each makes some of them and hands
// them to the others. So all know the same at each stage, whoever made it, and a process that is
// lost costs time only: what it owes is made again.
//
// One process owns the job and answers for its result. It takes bundles from the front of a stage,
// helpers take them from the back.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/digest.hpp"
#include "core/base/shared_cache.hpp"

namespace unwrapd {

/// Things to be made, in bundles of consecutive ones.
struct SharedStage {
  Digest key = {};                 ///< of all that the things are made from
  std::vector<std::size_t> begin;  ///< begin[b]: the first thing of bundle b; ends with the count
  std::vector<double> work;        ///< of each bundle, in some unit

  [[nodiscard]] int bundle_count() const { return static_cast<int>(work.size()); }
};

/// How bundles go from process to process. For one thread.
class SharedWork {
 public:
  struct Claim {
    int bundle = 0;
    std::optional<std::string> made = {};  ///< it was made before, by a process that is gone
  };

  SharedWork() = default;
  SharedWork(const SharedWork&) = delete;
  SharedWork& operator=(const SharedWork&) = delete;
  virtual ~SharedWork() = default;

  /// A bundle that nobody has begun, for this process to make; none: all were begun. Throws
  /// Error{cancelled} where this process is a helper that shall help no longer, as do the others.
  virtual std::optional<Claim> claim(const SharedStage& stage) = 0;
  /// Hands a bundle of this process to the others.
  virtual void publish(const SharedStage& stage, int bundle, std::string_view bytes) = 0;
  /// A bundle of another process, waiting for it as long as it may take; none: make it here.
  virtual std::optional<std::string> obtain(const SharedStage& stage, int bundle) = 0;
  /// What a stage must come to, in faces of meshes, for it to be shared.
  [[nodiscard]] virtual double least_faces() const { return 100'000; }
  /// No further stage follows.
  virtual void finish() = 0;
};

/// What a job does with the bundles of a stage.
struct BundleSteps {
  std::function<void(int bundle)> make;
  std::function<std::string(int bundle)> pack;  ///< what was made
  /// Takes what another has made. It comes from outside: throws Error{internal} where it is
  /// unsound.
  std::function<void(int bundle, std::string_view bytes)> unpack;
};

/// Bundles of consecutive things of about so much work each, at most 256. Nothing where the work is
/// not to be shared: nobody helps (null), or it is too little. work: of each thing, in faces;
/// bundles: about so many of the least work that is shared.
std::optional<SharedStage> bundled(const SharedWork* helpers, std::span<const double> work,
                                   double bundles);

Digest digest_of(const SharedCache& digests, std::string_view bytes);

/// Makes all bundles, with the others. In the process that owns the job, steps see them in
/// ascending order. digests: checks that bundles arrive whole. Throws what steps.make() throws.
void make_together(SharedWork& work, const SharedCache& digests, const SharedStage& stage,
                   const BundleSteps& steps);

}  // namespace unwrapd
