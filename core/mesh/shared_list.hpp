#pragma once
// Lists whose copies share memory, and views of lists, with the digest of their contents. A list
// that is assigned over another brings its own digest, or none.

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/digest.hpp"

namespace unwrapd {

/// An immutable list; copies share memory. Thread-safe. Moving is copying.
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

  /// The digest of the items, or of all that they are computed from; empty if it was not set.
  [[nodiscard]] const std::optional<Digest>& digest() const { return digest_; }

  /// The same list with this digest.
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

/// A view of a list, which must not change while the view is in use.
template <typename T>
class ListView : public std::span<const T> {
 public:
  ListView() = default;
  ListView(std::span<const T> items)  // NOLINT(google-explicit-constructor): it shows that list
      : std::span<const T>(items) {}
  ListView(const std::vector<T>& items)  // NOLINT(google-explicit-constructor)
      : std::span<const T>(items) {}

  /// As SharedList::digest().
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
