#pragma once
// The door to tinygltf, which reads glTF here and never writes it. It takes a number of another
// kind for 0, one beyond an int for what its low bits say, holds ten times what it reads and cannot
// be told to stop. So it gets a document's lists slice by slice, and in a slice nothing but what
// reading needs, each value looked at before.

#include <cstddef>
#include <functional>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/asset/gltf.hpp"

namespace unwrapd::asset {

/// The text of an object for tinygltf. The caller has looked at what is added.
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

/// Collects the elements of a list, and hands them over whenever they are enough for a slice.
class Slices {
 public:
  using Check = std::function<Members()>;
  using Take = std::function<void(const std::string& slice)>;

  /// take: gets slices, one of the functions below reads them. stop must outlive this.
  Slices(Take take, const std::stop_token& stop) : take_(std::move(take)), stop_(stop) {}

  /// check: looks at an element and gives what tinygltf shall read of it. The fault that it finds
  /// is thrown once all before it have been taken, so that of two faults the first is told.
  void add(const Check& check);

  /// After the last element.
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

}  // namespace unwrapd::asset
