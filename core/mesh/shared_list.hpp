#pragma once
// A list that is made once and read by many: copies are the same list, and take no memory.

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace unwrapd {

/// Thread-safe, as nobody changes it. Moving is copying.
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

 private:
  std::shared_ptr<const std::vector<T>> owned_;
  std::span<const T> items_;
};

}  // namespace unwrapd
