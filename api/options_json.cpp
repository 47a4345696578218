// What the table tells others: the resolved options of a job and the body of GET /v1/methods.
#include <algorithm>
#include <array>

#include "api/options.hpp"

namespace unwrapd::api {
namespace {

struct MethodRow {
  Method method;
  std::string_view title;
  std::string_view description;
};

constexpr std::array kMethods = {
    MethodRow{Method::asap, "As similar as possible",
              "Keeps angles (the least squares conformal map); solved directly."},
    MethodRow{Method::arap, "As rigid as possible",
              "Keeps angles and areas together; iterates between local fits and one global solve."},
    MethodRow{Method::hybrid, "Hybrid", "Between asap and arap: lambda weighs area against angle."},
};

std::string_view type_name(OptionType type) {
  switch (type) {
    case OptionType::choice:
      return "string";
    case OptionType::number:
      return "number";
    case OptionType::integer:
      return "integer";
  }
  return {};
}

/// A bound in the option's own type: an integer is written without a fraction.
Json bound(const OptionRow& row, double value) {
  if (row.type == OptionType::integer) return static_cast<std::int64_t>(value);
  return value;
}

Json option_json(const OptionRow& row, const Limits& limits) {
  Json json = {{"name", row.name}, {"type", type_name(row.type)}};
  if (row.type == OptionType::choice) {
    json["enum"] = row.choices;
  } else {
    json["minimum"] = bound(row, row.minimum);
    if (const auto maximum = option_maximum(row, limits)) json["maximum"] = bound(row, *maximum);
  }
  json["default"] = option_default(row);
  json["description"] = row.description;
  json["methods"] = Json::array();
  for (const Method method : row.methods) json["methods"].push_back(method_name(method));
  return json;
}

Json method_json(const MethodRow& row) {
  Json json = {{"name", method_name(row.method)},
               {"title", row.title},
               {"description", row.description},
               {"options", Json::array()}};
  for (const OptionRow& option : option_table()) {
    if (has_effect(option, row.method)) json["options"].push_back(option.name);
  }
  return json;
}

}  // namespace

const OptionRow* find_option(std::string_view name) {
  const auto found = std::ranges::find(option_table(), name, &OptionRow::name);
  return found == option_table().end() ? nullptr : &*found;
}

Json option_default(const OptionRow& row) { return row.get(JobOptions{}); }

std::optional<double> option_maximum(const OptionRow& row, const Limits& limits) {
  if (row.name == "iterations") return limits.max_iterations;
  return row.maximum;
}

bool has_effect(const OptionRow& row, Method method) {
  return std::ranges::find(row.methods, method) != row.methods.end();
}

Json to_json(const JobOptions& options) {
  Json json = Json::object();
  for (const OptionRow& row : option_table()) json[std::string(row.name)] = row.get(options);
  if (options.unwrap.method != Method::hybrid) json["lambda"] = nullptr;
  return json;
}

Json methods_json(const Limits& limits) {
  Json json = {{"methods", Json::array()}, {"options", Json::array()}};
  for (const MethodRow& row : kMethods) json["methods"].push_back(method_json(row));
  for (const OptionRow& row : option_table()) json["options"].push_back(option_json(row, limits));
  return json;
}

}  // namespace unwrapd::api
