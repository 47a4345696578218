#include "server/bucket/xml_texts.hpp"

#include <array>
#include <cstddef>
#include <utility>

namespace unwrapd::server::bucket {
namespace {

std::string without_entities(std::string text) {
  static constexpr std::array<std::pair<std::string_view, char>, 5> kEntities = {
      {{"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}, {"&amp;", '&'}}};
  for (const auto& [entity, letter] : kEntities)
    for (std::size_t at = 0; (at = text.find(entity, at)) != std::string::npos; ++at)
      text.replace(at, entity.size(), 1, letter);
  return text;
}

}  // namespace

std::vector<std::string> texts_of(std::string_view xml, const std::string& tag) {
  const std::string begin = "<" + tag + ">";
  const std::string end = "</" + tag + ">";
  std::vector<std::string> texts;
  for (std::size_t at = 0; (at = xml.find(begin, at)) != std::string_view::npos;) {
    at += begin.size();
    const std::size_t to = xml.find(end, at);
    if (to == std::string_view::npos) break;
    texts.push_back(without_entities(std::string(xml.substr(at, to - at))));
    at = to;
  }
  return texts;
}

std::string first_text(std::string_view xml, const std::string& tag) {
  const std::vector<std::string> all = texts_of(xml, tag);
  return all.empty() ? std::string() : all.front();
}

}  // namespace unwrapd::server::bucket
