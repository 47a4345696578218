#include "api/contract/page.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "api/contract/html.hpp"

namespace unwrapd::contract {
namespace {

constexpr std::array<std::string_view, 5> kMethods = {"get", "put", "post", "delete", "patch"};
constexpr std::string_view kSchemas = "#/components/schemas/";
constexpr std::string_view kProblems = "problem_";

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
  return result;
}

/// Text of a member, "" without it.
std::string text_of(const Json& object, const char* name) { return object.value(name, ""); }

/// A value as a reader of the page would write it.
std::string literal(const Json& value) {
  return code(value.is_string() ? value.get<std::string>() : value.dump());
}

class Page {
 public:
  Page(const Json& contract, const Examples& examples) : contract_(contract), examples_(examples) {}

  std::string make() {
    const Json& info = contract_.at("info");
    const std::string title = escaped(text_of(info, "title") + " " + text_of(info, "version"));
    std::string body = element("h1", title) + block_html(text_of(info, "description")) +
                       "<p>The same for machines: <a href=\"openapi.yaml\">openapi.yaml</a>, "
                       "<a href=\"openapi.json\">openapi.json</a>.</p>\n";
    body += contents();
    for (const Json& tag : contract_.at("tags")) body += section(tag);
    body += schemas() + errors();
    return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
           "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n" +
           element("title", title) + "\n<link rel=\"stylesheet\" href=\"docs.css\">\n</head>\n" +
           element("body", "\n" + body) + "\n</html>\n";
  }

 private:
  /// What a reference stands for; anything else stands for itself.
  const Json& resolved(const Json& value) const {
    if (!value.contains("$ref")) return value;
    const std::string pointer = value.at("$ref").get<std::string>().substr(1);
    const Json::json_pointer at(pointer);
    if (!contract_.contains(at)) throw std::runtime_error("there is no " + pointer);
    return resolved(contract_.at(at));
  }

  /// Calls back for every operation of this tag: method, path, operation, parameters of the path.
  template <class Action>
  void for_operations(const std::string& tag, const Action& action) const {
    for (const auto& [path, item] : contract_.at("paths").items()) {
      for (const std::string_view method : kMethods) {
        const std::string name(method);
        if (!item.contains(name) || item.at(name).at("tags").front() != tag) continue;
        action(upper(method), path, item.at(name), item.value("parameters", Json::array()));
      }
    }
  }

  static std::string call_name(const std::string& method, const std::string& path) {
    return "<b class=\"" + method + "\">" + method + "</b> " + code(path);
  }

  std::string contents() const {
    std::string items;
    for (const Json& tag : contract_.at("tags"))
      for_operations(tag.at("name"), [&](const auto& method, const auto& path,
                                         const Json& operation, const Json&) {
        const std::string call =
            link_to(text_of(operation, "operationId"), call_name(method, path));
        items += element("li", call + " " + inline_html(text_of(operation, "summary"))) + "\n";
      });
    items +=
        element("li", link_to("schemas", "Schemas")) + element("li", link_to("errors", "Errors"));
    return element("nav", element("ul", items)) + "\n";
  }

  std::string section(const Json& tag) {
    std::string html = element("h2", inline_html(text_of(tag, "description")));
    for_operations(tag.at("name"), [&](const auto& method, const auto& path, const Json& operation,
                                       const Json& of_path) {
      html += "<article id=\"" + escaped(text_of(operation, "operationId")) + "\">\n";
      html += element("h3", call_name(method, path)) + "\n";
      html += element("p", inline_html(text_of(operation, "summary") + ".")) + "\n";
      html += block_html(text_of(operation, "description"));
      html += parameters(of_path, operation.value("parameters", Json::array()));
      if (operation.contains("requestBody")) html += request_body(operation.at("requestBody"));
      html += responses(operation.at("responses")) + "</article>\n";
    });
    return element("section", html) + "\n";
  }

  std::string parameters(const Json& of_path, const Json& own) const {
    std::string rows;
    for (const Json* list : {&of_path, &own})
      for (const Json& reference : *list) {
        const Json& parameter = resolved(reference);
        rows +=
            element("tr", element("td", code(text_of(parameter, "name"))) +
                              element("td", escaped(text_of(parameter, "in"))) +
                              element("td", type_of(parameter.value("schema", Json::object()))) +
                              element("td", about(parameter)));
      }
    if (rows.empty()) return {};
    return table({"parameter", "in", "value", ""}, rows);
  }

  /// Its own description, else that of its schema.
  std::string about(const Json& parameter) const {
    std::string text = text_of(parameter, "description");
    if (text.empty())
      text = text_of(resolved(parameter.value("schema", Json::object())), "description");
    return block_html(text);
  }

  static std::string table(const std::vector<std::string_view>& heads, const std::string& rows) {
    std::string head;
    for (const std::string_view text : heads) head += element("th", text);
    return element("table", element("thead", element("tr", head)) + element("tbody", rows)) + "\n";
  }

  std::string request_body(const Json& reference) {
    const Json& body = resolved(reference);
    return element("h4", "Body") + block_html(text_of(body, "description")) +
           contents_of(body.at("content"));
  }

  std::string contents_of(const Json& content) {
    std::string items;
    std::string shown;
    for (const auto& [type, media] : content.items()) {
      const bool has_schema = media.contains("schema");
      items += element("li", code(type) + (has_schema ? ": " + type_of(media.at("schema")) : ""));
      const Json examples = media.value("examples", Json::object());
      for (const auto& [name, example] : examples.items())
        shown += details(name, text_of(example, "externalValue"));
    }
    return element("ul", items) + "\n" + shown;
  }

  /// The example of an error is in the table of errors.
  std::string details(const std::string& name, const std::string& file) {
    if (file.find(kProblems) != std::string::npos) return {};
    return element("details", element("summary", "Example: " + escaped(name)) +
                                  element("pre", escaped(examples_(file)))) +
           "\n";
  }

  std::string responses(const Json& all) {
    std::string html = element("h4", "Answers");
    for (const auto& [status, reference] : all.items()) {
      const Json& response = resolved(reference);
      html += "<div class=\"answer\">" + element("b", escaped(status)) +
              block_html(text_of(response, "description"));
      html += headers(response.value("headers", Json::object()));
      const bool is_problem = status.front() >= '4';
      if (!is_problem) html += contents_of(response.value("content", Json::object()));
      html += "</div>\n";
    }
    return html;
  }

  static std::string headers(const Json& all) {
    std::string names;
    for (const auto& [name, header] : all.items())
      if (name != "traceparent") names += (names.empty() ? "" : ", ") + code(name);
    return names.empty() ? "" : element("p", "Header fields: " + names);
  }

  /// A schema in a few words; one that has a name is a link to it.
  std::string type_of(const Json& schema) const {
    if (schema.contains("$ref")) return type_of_reference(schema) + with_default(schema);
    if (schema.contains("const")) return literal(schema.at("const"));
    if (schema.contains("enum")) return listed(schema.at("enum")) + with_default(schema);
    for (const char* choice : {"oneOf", "anyOf", "allOf"})
      if (schema.contains(choice)) return choices(schema.at(choice));
    if (schema.contains("contentSchema"))
      return (text_of(schema, "contentMediaType") == "application/json" ? "JSON text: "
                                                                        : "events: ") +
             type_of(schema.at("contentSchema"));
    std::string text = plain_type(schema) + range(schema);
    if (schema.contains("items")) text += " of " + type_of(schema.at("items"));
    if (schema.contains("pattern")) text += ", " + code(text_of(schema, "pattern"));
    return text + with_default(schema);
  }

  /// A part of a schema has no place of its own on the page.
  std::string type_of_reference(const Json& schema) const {
    const std::string name = schema.at("$ref").get<std::string>().substr(kSchemas.size());
    const Json& meant = resolved(schema);
    if (name.find('/') != std::string::npos) return type_of(meant);
    return link_to("schema-" + name, escaped(name));
  }

  std::string choices(const Json& all) const {
    std::string text;
    for (const Json& one : all) text += (text.empty() ? "" : " or ") + type_of(one);
    return text;
  }

  static std::string listed(const Json& values) {
    std::string text;
    for (const Json& value : values) text += (text.empty() ? "" : ", ") + literal(value);
    return text;
  }

  static std::string plain_type(const Json& schema) {
    if (!schema.contains("type")) return "any";
    const Json& type = schema.at("type");
    if (type.is_string()) return escaped(type.get<std::string>());
    std::string text;
    for (const Json& one : type)
      text += (text.empty() ? "" : " or ") + escaped(one.get<std::string>());
    return text;
  }

  static std::string range(const Json& schema) {
    std::string text;
    if (schema.contains("minimum")) text += ", from " + literal(schema.at("minimum"));
    if (schema.contains("maximum")) text += ", to " + literal(schema.at("maximum"));
    return text;
  }

  static std::string with_default(const Json& schema) {
    return schema.contains("default") ? "; default " + literal(schema.at("default")) : "";
  }

  std::string schemas() const {
    std::string html = "<h2 id=\"schemas\">Schemas</h2>\n";
    for (const auto& [name, schema] : contract_.at("components").at("schemas").items()) {
      html += "<article id=\"schema-" + escaped(name) + "\">\n" + element("h3", escaped(name));
      html += block_html(text_of(schema, "description"));
      html += schema.contains("properties") ? properties(schema) : element("p", type_of(schema));
      html += "</article>\n";
    }
    return element("section", html) + "\n";
  }

  std::string properties(const Json& schema) const {
    const Json required = schema.value("required", Json::array());
    std::string rows;
    for (const auto& [name, property] : schema.at("properties").items()) {
      const bool always = std::find(required.begin(), required.end(), name) != required.end();
      rows +=
          element("tr", element("td", code(name)) + element("td", always ? "" : "may be missing") +
                            element("td", type_of(property)) +
                            element("td", block_html(text_of(property, "description"))));
    }
    return table({"member", "", "value", ""}, rows);
  }

  std::string errors() {
    std::string rows;
    for (const Json& name : contract_.at("components").at("schemas").at("ErrorCode").at("enum")) {
      const std::string code_name = name;
      const Json problem =
          Json::parse(examples_("examples/" + std::string(kProblems) + code_name + ".json"));
      rows += element("tr", element("td", code(code_name)) +
                                element("td", problem.at("status").dump()) +
                                element("td", escaped(text_of(problem, "title"))) +
                                element("td", escaped(text_of(problem, "detail"))));
    }
    return element("section", "<h2 id=\"errors\">Errors</h2>\n" +
                                  table({"code", "status", "title", "for example"}, rows)) +
           "\n";
  }

  const Json& contract_;
  const Examples& examples_;
};

}  // namespace

std::string page_of(const Json& contract, const Examples& examples) {
  return Page(contract, examples).make();
}

}  // namespace unwrapd::contract
