#pragma once
// Lists of which copies are the same list, and views of lists, that know the digest of what they
// hold. A list that takes another's place brings its own digest, or none.

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/digest.hpp"

namespace unwrapd {

/// Made once and read by many: copies take no memory. Thread-safe, as nobody changes it. Moving is
/// copying.
template <typename T>
class SharedList {
 public:
  SharedList() = default;
  SharedList(std::vector<T> items)  // NOLINT(google-explicit-constructor): it is that list
      : owned_(std::make_shared<const std::vector<T>>(std::move(items))), items_(*owned_) {}
  SharedList(const SharedList&) = default;
  SharedList& operator=(const SharedList&) = default;
  ~SharedList() = default;

  [[nodiscard]] std::size_t size() const { return items_.size(); }
  [[nodiscard]] bool empty() const { return items_.empty(); }
  [[nodiscard]] const T& operator[](std::size_t i) const { return items_[i]; }
  [[nodiscard]] const T* data() const { return items_.data(); }
  [[nodiscard]] const T* begin() const { return items_.data(); }
  [[nodiscard]] const T* end() const { return items_.data() + items_.size(); }

  /// Of the items, or of all that they follow from; nothing where nobody has told it.
  [[nodiscard]] const std::optional<Digest>& digest() const { return digest_; }

  /// The same list, which has this digest.
  [[nodiscard]] SharedList known_as(const Digest& digest) const {
    SharedList known = *this;
    known.digest_ = digest;
    return known;
  }

 private:
  std::shared_ptr<const std::vector<T>> owned_;
  std::span<const T> items_;
  std::optional<Digest> digest_;
};

/// A view of a list that does not change while it is looked at.
template <typename T>
class ListView : public std::span<const T> {
 public:
  ListView() = default;
  ListView(std::span<const T> items)  // NOLINT(google-explicit-constructor): it shows that list
      : std::span<const T>(items) {}
  ListView(const std::vector<T>& items)  // NOLINT(google-explicit-constructor)
      : std::span<const T>(items) {}

  /// As of a SharedList.
  [[nodiscard]] const std::optional<Digest>& digest() const { return digest_; }
  [[nodiscard]] ListView known_as(const Digest& digest) const {
    ListView known = *this;
    known.digest_ = digest;
    return known;
  }

 private:
  std::optional<Digest> digest_;
};

}  // namespace unwrapd
