#pragma once
// The root of a document. Only a few of its members are read or changed. The others are set aside,
// so that neither their number nor their size multiplies any work, and put back in their places
// when the document is written.

#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "core/asset/gltf/json.hpp"

namespace unwrapd::asset {

class Aside {
 public:
  /// Takes the members that are not read out of the root. root: as its author wrote it.
  void take_unread(Json& root);

  /// Takes the members that are read but never changed out of the root. Call after take_unread().
  void take_unwritten(Json& root);

  /// The text of the whole document: the root's members and those set aside in their author's
  /// order, then new members. Throws Error{cancelled}.
  [[nodiscard]] std::string text_with(const Json& root, const std::stop_token& stop) const;

 private:
  /// Empty value: the root has the member.
  std::vector<std::pair<std::string, std::optional<Json>>> members_;
};

}  // namespace unwrapd::asset
