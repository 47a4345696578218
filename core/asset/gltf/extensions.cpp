#include "core/asset/gltf/extensions.hpp"

#include <algorithm>

namespace unwrapd::asset {
namespace {

bool lists_extension(const Json& document, std::string_view list, std::string_view name) {
  const auto names = Node(document).find(list);
  for (std::size_t i = 0; names && i < names->array_size(); ++i)
    if (names->at(i).text() == name) return true;
  return false;
}

}  // namespace

bool uses_extension(const Json& document, std::string_view name) {
  return lists_extension(document, "extensionsUsed", name);
}

bool requires_extension(const Json& document, std::string_view name) {
  return lists_extension(document, "extensionsRequired", name);
}

void forget_extension(Json& document, std::string_view name) {
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    const auto found = document.find(list);
    if (found == document.end()) continue;
    auto& names = found->get_ref<Json::array_t&>();
    names.erase(std::remove(names.begin(), names.end(), Json(name)), names.end());
    if (names.empty()) document.erase(list);
  }
}

void remove_extension(Json& object, std::string_view name) {
  const auto extensions = object.find("extensions");
  if (extensions == object.end()) return;
  extensions->erase(std::string(name));
  if (extensions->empty()) object.erase("extensions");
}

}  // namespace unwrapd::asset
