#include "api/contract/yaml_json.hpp"

#include <yaml.h>

#include <memory>
#include <stdexcept>
#include <string_view>

namespace unwrapd::contract {
namespace {

[[noreturn]] void fail(const std::string& what, std::size_t line) {
  throw std::runtime_error("line " + std::to_string(line + 1) + ": " + what);
}

/// A parser and the document that it has read.
class Document {
 public:
  explicit Document(const std::string& text) {
    yaml_parser_initialize(&parser_);
    yaml_parser_set_input_string(&parser_, reinterpret_cast<const unsigned char*>(text.data()),
                                 text.size());
    if (yaml_parser_load(&parser_, &document_) == 1) return;
    const std::string problem = parser_.problem ? parser_.problem : "no YAML";
    const std::size_t line = parser_.problem_mark.line;
    yaml_parser_delete(&parser_);
    fail(problem, line);
  }
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;
  ~Document() {
    yaml_document_delete(&document_);
    yaml_parser_delete(&parser_);
  }

  const yaml_node_t& node(int index) { return *yaml_document_get_node(&document_, index); }
  const yaml_node_t* root() { return yaml_document_get_root_node(&document_); }

 private:
  yaml_parser_t parser_{};
  yaml_document_t document_{};
};

std::string text_of(const yaml_node_t& node) {
  const auto& scalar = node.data.scalar;
  return {reinterpret_cast<const char*>(scalar.value), scalar.length};
}

Json scalar_json(const yaml_node_t& node) {
  const std::string text = text_of(node);
  if (node.data.scalar.style != YAML_PLAIN_SCALAR_STYLE) return text;
  if (text.empty() || text == "null" || text == "~") return nullptr;
  if (text == "true" || text == "false") return text == "true";
  const Json number = Json::parse(text, nullptr, false);
  return number.is_number() ? number : Json(text);
}

Json json_of(Document& document, const yaml_node_t& node);

Json mapping_json(Document& document, const yaml_node_t& node) {
  Json object = Json::object();
  const auto& pairs = node.data.mapping.pairs;
  for (const yaml_node_pair_t* pair = pairs.start; pair != pairs.top; ++pair) {
    const yaml_node_t& key = document.node(pair->key);
    if (key.type != YAML_SCALAR_NODE) fail("a key is no text", key.start_mark.line);
    const std::string name = text_of(key);
    if (object.contains(name)) fail("the key " + name + " is given twice", key.start_mark.line);
    object[name] = json_of(document, document.node(pair->value));
  }
  return object;
}

Json json_of(Document& document, const yaml_node_t& node) {
  if (node.type == YAML_SCALAR_NODE) return scalar_json(node);
  if (node.type == YAML_MAPPING_NODE) return mapping_json(document, node);
  Json array = Json::array();
  const auto& items = node.data.sequence.items;
  for (const yaml_node_item_t* item = items.start; item != items.top; ++item)
    array.push_back(json_of(document, document.node(*item)));
  return array;
}

}  // namespace

Json json_of_yaml(const std::string& text) {
  Document document(text);
  if (!document.root()) fail("there is nothing", 0);
  return json_of(document, *document.root());
}

}  // namespace unwrapd::contract
