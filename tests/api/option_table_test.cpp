// The table against the contract, the limits and the answer of GET /v1/methods.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "api/options.hpp"
#include "contract_text.hpp"

namespace unwrapd::api {
namespace {

using testing::ElementsAreArray;

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const OptionRow& row : option_table()) all.emplace_back(row.name);
  return all;
}

/// "stop" of "stop.iterations"; of a name without a group, itself.
std::string first_part(std::string_view name) {
  return std::string(name.substr(0, name.find('.')));
}

/// The members of the options' object, in the order of the table.
std::vector<std::string> members() {
  std::vector<std::string> all;
  for (const std::string& name : names())
    if (all.empty() || all.back() != first_part(name)) all.push_back(first_part(name));
  return all;
}

std::vector<std::string> schema_of(const OptionRow& row) {
  if (row.name == "lambda") return {"components", "schemas", "Lambda"};  // elsewhere it may be null
  if (row.name == "method") return {"components", "schemas", "Method"};
  if (row.name == "preset") return {"components", "schemas", "Preset"};
  if (row.name == "guarantee") return {"components", "schemas", "Guarantee"};
  const std::size_t dot = row.name.find('.');
  if (dot != std::string_view::npos)
    return {"components", "schemas", "Stop", "properties", std::string(row.name.substr(dot + 1))};
  return {"components", "schemas", "Options", "properties", std::string(row.name)};
}

std::string type_of(const OptionRow& row) {
  if (row.type == OptionType::integer && !row.choices.empty()) return "[integer, string]";
  if (row.type == OptionType::integer) return row.nullable ? "[integer, 'null']" : "integer";
  if (row.type == OptionType::objects || row.type == OptionType::names) return "array";
  if (row.type == OptionType::flag) return "boolean";
  if (row.type == OptionType::text) return "[string, 'null']";
  if (row.type == OptionType::number && row.nullable) return "[number, 'null']";
  return row.type == OptionType::choice ? "string" : "number";
}

std::string joined(std::span<const std::string_view> words, const char* between) {
  std::string text;
  for (const std::string_view word : words)
    text += (text.empty() ? "" : between) + std::string(word);
  return text;
}

std::string text(const Json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

/// The members that a job always shows.
std::vector<std::string> short_members() {
  std::vector<std::string> found = members();
  for (const OptionRow& row : option_table())
    if (type_of(row) == "array") std::erase(found, std::string(row.name));
  return found;
}

TEST(OptionTable, IsTheContractsListOfOptions) {
  EXPECT_THAT(keys({"components", "schemas", "Options", "properties"}),
              ElementsAreArray(members()));
  EXPECT_THAT(list({"components", "schemas", "ResolvedOptions"}, "required"),
              ElementsAreArray(short_members()));
  std::vector<std::string> of_stop;
  for (const std::string& name : names())
    if (first_part(name) == "stop") of_stop.push_back(name.substr(5));
  EXPECT_THAT(keys({"components", "schemas", "Stop", "properties"}), ElementsAreArray(of_stop));
}

TEST(OptionTable, HasEveryOptionAsAQueryParameterOfEachPost) {
  for (const char* path : {"/v1/jobs", "/v1/jobs/events", "/v1/unwrap"}) {
    const std::vector<std::string> references = list({"paths", path, "post"}, "parameters");
    for (const std::string& name : names()) {
      EXPECT_THAT(references, testing::Contains("$ref: '#/components/parameters/" + name + "'"));
      EXPECT_EQ(scalar({"components", "parameters", name}, "name"), name);
      EXPECT_EQ(scalar({"components", "parameters", name}, "in"), "query");
    }
  }
}

TEST(OptionTable, AgreesWithTheContractInTypeAndDefault) {
  for (const OptionRow& row : option_table()) {
    const std::vector<std::string> schema = schema_of(row);
    EXPECT_EQ(scalar(schema, "type"), type_of(row)) << row.name;
    const std::string told = unquoted(scalar(schema, "default")),
                      own = text(option_default(row, {}));
    const bool is_number = row.type == OptionType::number || row.type == OptionType::numbers;
    if (is_number && own != "null") {
      EXPECT_EQ(std::stod(told), std::stod(own)) << row.name;
    } else {
      EXPECT_EQ(told, own) << row.name;
    }
    if (row.type == OptionType::integer && !row.choices.empty()) {
      EXPECT_EQ(scalar(schema, "pattern"), "^(" + joined(row.choices, "|") + ")$") << row.name;
    }
    if (row.type != OptionType::choice) continue;
    EXPECT_THAT(list(schema, "enum"), ElementsAreArray(row.choices)) << row.name;
  }
}

TEST(OptionTable, AgreesWithTheContractInRange) {
  for (const OptionRow& row : option_table()) {
    if (scalar(schema_of(row), "minimum").empty()) {
      EXPECT_TRUE(row.type == OptionType::choice || row.type == OptionType::flag ||
                  row.type == OptionType::names || row.type == OptionType::objects ||
                  row.type == OptionType::text)
          << row.name;
      continue;
    }
    const std::vector<std::string> schema = schema_of(row);
    EXPECT_EQ(std::stod(scalar(schema, "minimum")), row.minimum) << row.name;
    const std::optional<double> maximum = option_maximum(row, Limits{});
    EXPECT_EQ(scalar(schema, "maximum").empty(), !maximum) << row.name;
    if (!maximum) continue;
    EXPECT_EQ(std::stod(scalar(schema, "maximum")), *maximum) << row.name;
  }
}

TEST(OptionTable, AgreesWithTheContractInTheLengthOfLists) {
  const std::vector<std::string> options = {"components", "schemas", "Options", "properties"};
  std::vector<std::string> constraints = options;
  constraints.emplace_back("constraints");
  EXPECT_EQ(scalar(constraints, "maxItems"), std::to_string(Limits{}.max_constraints));
  for (const char* list : {"materials", "primitives"}) {
    std::vector<std::string> names = options;
    names.emplace_back(list);
    EXPECT_EQ(scalar(names, "maxItems"), std::to_string(kMaxNames));
  }
  const std::vector<std::string> lambdas = section({"components", "schemas", "Lambdas", "oneOf"});
  EXPECT_THAT(lambdas, testing::Contains("          maxItems: " + std::to_string(kMaxNumbers)));
}

TEST(OptionTable, DefaultsAreAllowedValues) {
  for (const OptionRow& row : option_table()) {
    const Json value = option_default(row, {});
    if (value.is_null()) continue;  // not given, which needs no value
    const std::string given = value.is_string() ? value.get<std::string>() : value.dump();
    const JobOptions options = parse_options(Query{{std::string(row.name), given}}, Limits{});
    EXPECT_EQ(row.get(options), value) << row.name;
  }
}

TEST(OptionTable, KnowsARowByItsPointer) {
  for (const OptionRow& row : option_table()) {
    EXPECT_EQ(option_at(option_pointer(row.name)), &row);
    EXPECT_EQ(option_at(option_pointer(row.name) + "/0/deeper"), &row);
    EXPECT_NE(option_at(option_pointer(row.name) + "x"), &row);
  }
  EXPECT_EQ(option_at("/stop"), nullptr);
  EXPECT_EQ(option_at(""), nullptr);
}

TEST(OptionTable, OnASmallServerTheDefaultIsWhatTheServerAllows) {
  Limits limits;
  limits.max_iterations = 20;
  EXPECT_EQ(option_default(*find_option("stop.max_iterations"), limits), 20);
  EXPECT_EQ(option_default(*find_option("stop.max_iterations"), Limits{}), 500);
}

TEST(OptionTable, EveryChoiceSetsAnOptionOfItsOwn) {
  for (const OptionRow& row : option_table()) {
    std::set<std::string> seen;
    for (const std::string_view choice : row.choices) {
      const JobOptions options =
          parse_options(Query{{std::string(row.name), std::string(choice)}}, {});
      EXPECT_EQ(row.get(options), choice);
      seen.insert(row.get(options));
    }
    EXPECT_EQ(seen.size(), row.choices.size()) << row.name;
  }
}

TEST(OptionTable, ChoicesNameTheEnumeratorsThatTheySay) {
  const auto options = [](const Query& query) { return parse_options(query, Limits{}); };
  EXPECT_EQ(options({{"method", "hybrid"}}).unwrap.method, Method::hybrid);
  EXPECT_EQ(options({{"method", "slim"}}).unwrap.method, Method::slim);
  EXPECT_EQ(options({{"lambda_units", "paper"}}).unwrap.lambda_units, LambdaUnits::paper);
  EXPECT_EQ(options({{"initial", "lscm"}}).unwrap.initial, InitialMap::lscm);
  EXPECT_EQ(options({{"pins", "spectral"}}).unwrap.pins, Pins::spectral);
  EXPECT_EQ(options({{"guarantee", "bijective"}}).unwrap.guarantee, Guarantee::bijective);
  EXPECT_EQ(options({{"repair", "virtual_boundary"}}).unwrap.repair,
            RepairMethod::virtual_boundary);
  EXPECT_EQ(options({{"boundary", "square"}}).unwrap.boundary, BoundaryShape::square);
  EXPECT_EQ(options({{"effort", "best"}}).unwrap.effort, Effort::best);
  EXPECT_EQ(options({{"seams", "none"}}).unwrap.seams, SeamMode::none);
  EXPECT_EQ(options({{"output", "obj"}}).output, OutputFormat::obj);
}

TEST(Methods, ListEveryMethodWithExactlyItsOptions) {
  const Json json = methods_json(Limits{});
  EXPECT_EQ(json.at("options").size(), option_table().size());
  std::vector<std::string> told;
  for (const Json& method : json.at("methods")) {
    told.push_back(method.at("name"));
    const std::set<std::string> own = method.at("options");
    EXPECT_TRUE(own.contains("method")) << told.back();
    for (const Json& option : json.at("options")) {
      const std::set<std::string> methods = option.at("methods");
      EXPECT_EQ(own.contains(option.at("name")), methods.contains(method.at("name")));
    }
  }
  EXPECT_THAT(told, ElementsAreArray(find_option("method")->choices));
}

TEST(Methods, TellTheServersOwnLimits) {
  Limits limits;
  limits.max_iterations = 77;
  limits.max_constraints = 5;
  std::size_t told = 0;
  const Json json = methods_json(limits);
  for (const Json& option : json.at("options")) {
    if (option.at("type") == "integer" && option.at("name").get<std::string>().starts_with("stop"))
      told += option.at("maximum") == 77 ? 1 : 0;
    if (option.at("name") == "constraints") told += option.at("max_items") == 5 ? 1 : 0;
  }
  EXPECT_EQ(told, 3U);
}

TEST(Limits, AreExactlyThoseOfTheContract) {
  std::vector<std::string> told;
  const Json limits = to_json(Limits{});
  for (const auto& [name, value] : limits.items()) told.push_back(name);
  EXPECT_THAT(keys({"components", "schemas", "Limits", "properties"}), ElementsAreArray(told));
  EXPECT_THAT(list({"components", "schemas", "Limits"}, "required"), ElementsAreArray(told));
}

}  // namespace
}  // namespace unwrapd::api
