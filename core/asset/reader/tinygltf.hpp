#pragma once
// The interface to tinygltf, which reads glTF here and never writes it. It reads a number of
// another kind as 0 and one beyond an int by its low bits, takes ten times the memory of its input,
// and cannot be cancelled. So it gets a document's lists slice by slice, with only the members that
// reading needs, and each value is checked before.

#include <cstddef>
#include <functional>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/asset/gltf/gltf.hpp"

namespace unwrapd::asset::reader {

/// The text of an object for tinygltf. The caller has checked the values.
class Members {
 public:
  void add(std::string_view name, std::size_t value);
  void add(std::string_view name, std::string_view word);  ///< with nothing to escape
  void add(std::string_view name, const Members& object);
  void add(std::string_view name, const std::vector<Members>& objects);
  void add_true(std::string_view name);
  void add_named(const std::string& name, std::size_t value);  ///< by any name that JSON allows

  [[nodiscard]] std::string text() const { return '{' + members_ + '}'; }

 private:
  void begin(std::string_view name);

  std::string members_;
};

/// Collects the elements of a list, and passes them on in slices.
class Slices {
 public:
  using Check = std::function<Members()>;
  using Take = std::function<void(const std::string& slice)>;

  /// take: receives slices; one of the functions below reads them. stop must outlive this.
  Slices(Take take, const std::stop_token& stop) : take_(std::move(take)), stop_(stop) {}

  /// check: checks an element and returns the text for tinygltf. If it throws, the elements before
  /// it are processed first, so that the first of two faults is reported.
  void add(const Check& check);

  /// Must be called after the last element.
  void end();

 private:
  Take take_;
  const std::stop_token& stop_;
  std::string slice_;
};

/// What tinygltf reads of bufferViews: all but the stride.
std::vector<View> views_of(const std::string& slice);

/// What tinygltf reads of accessors.
std::vector<Accessor> accessors_of(const std::string& slice);

/// What tinygltf reads of primitives: mode, material, attributes by name, targets.
std::vector<Primitive> primitives_of(const std::string& slice);

}  // namespace unwrapd::asset::reader
