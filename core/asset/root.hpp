#pragma once
// The root of a document. Only a few of its members are ever looked at or changed; the others are
// set aside, so that neither their number nor their size multiplies any work, and put back where
// they stood when the document is written.

#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "core/asset/json.hpp"

namespace unwrapd::asset {

class Aside {
 public:
  /// Leaves to the root what reading looks at. root: as its author wrote it.
  void take_unread(Json& root);

  /// Takes what reading looks at and writing never changes. After take_unread().
  void take_unwritten(Json& root);

  /// The text of the whole document: the root's members and those set aside in their author's
  /// order, then the root's new ones. Throws Error{cancelled}.
  [[nodiscard]] std::string text_with(const Json& root, const std::stop_token& stop) const;

 private:
  /// Without a value: the root has it.
  std::vector<std::pair<std::string, std::optional<Json>>> members_;
};

}  // namespace unwrapd::asset
