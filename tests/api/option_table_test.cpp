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

std::vector<std::string> schema_of(const OptionRow& row) {
  if (row.name == "lambda") return {"components", "schemas", "Lambda"};  // elsewhere it may be null
  return {"components", "schemas", "Options", "properties", std::string(row.name)};
}

std::string text(const Json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

TEST(OptionTable, IsTheContractsListOfOptions) {
  EXPECT_THAT(keys({"components", "schemas", "Options", "properties"}), ElementsAreArray(names()));
  EXPECT_THAT(list({"components", "schemas", "ResolvedOptions"}, "required"),
              ElementsAreArray(names()));
}

TEST(OptionTable, HasEveryOptionAsAQueryParameterOfBothPosts) {
  for (const char* path : {"/v1/jobs", "/v1/unwrap"}) {
    const std::vector<std::string> references = list({"paths", path, "post"}, "parameters");
    for (const std::string& name : names()) {
      EXPECT_THAT(references, testing::Contains("$ref: '#/components/parameters/" + name + "'"));
      EXPECT_EQ(scalar({"components", "parameters", name}, "name"), name);
      EXPECT_EQ(scalar({"components", "parameters", name}, "in"), "query");
    }
  }
}

TEST(OptionTable, AgreesWithTheContractInTypeRangeAndDefault) {
  for (const OptionRow& row : option_table()) {
    const std::vector<std::string> schema = schema_of(row);
    EXPECT_EQ(scalar(schema, "default"), text(option_default(row))) << row.name;
    if (row.type == OptionType::choice) {
      EXPECT_EQ(scalar(schema, "type"), "string") << row.name;
      EXPECT_THAT(list(schema, "enum"), ElementsAreArray(row.choices)) << row.name;
      continue;
    }
    EXPECT_EQ(scalar(schema, "type"), row.type == OptionType::integer ? "integer" : "number");
    EXPECT_EQ(std::stod(scalar(schema, "minimum")), row.minimum) << row.name;
    const std::optional<double> maximum = option_maximum(row, Limits{});
    EXPECT_EQ(scalar(schema, "maximum").empty(), !maximum) << row.name;
    if (!maximum) continue;
    EXPECT_EQ(std::stod(scalar(schema, "maximum")), *maximum) << row.name;
  }
}

TEST(OptionTable, DefaultsAreAllowedValues) {
  for (const OptionRow& row : option_table()) {
    const Json object = {{std::string(row.name), option_default(row)}};
    EXPECT_NO_THROW(parse_options(object, Limits{})) << row.name;
  }
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
  EXPECT_EQ(options({{"lambda_units", "paper"}}).unwrap.lambda_units, LambdaUnits::paper);
  EXPECT_EQ(options({{"initial", "lscm"}}).unwrap.initial, InitialMap::lscm);
  EXPECT_EQ(options({{"pins", "spectral"}}).unwrap.pins, Pins::spectral);
  EXPECT_EQ(options({{"seams", "none"}}).unwrap.seams, SeamMode::none);
  EXPECT_EQ(options({{"output", "obj"}}).output, OutputFormat::obj);
}

TEST(Methods, ListEveryMethodWithExactlyItsOptions) {
  const Json json = methods_json(Limits{});
  ASSERT_EQ(json.at("methods").size(), 3U);
  EXPECT_EQ(json.at("options").size(), option_table().size());
  for (const Json& method : json.at("methods")) {
    const std::set<std::string> own = method.at("options");
    for (const Json& option : json.at("options")) {
      const std::set<std::string> methods = option.at("methods");
      EXPECT_EQ(own.contains(option.at("name")), methods.contains(method.at("name")));
    }
  }
}

TEST(Methods, TellTheServersOwnMaximumOfIterations) {
  Limits limits;
  limits.max_iterations = 77;
  const Json json = methods_json(limits);
  EXPECT_EQ(json.at("options").at(3).at("name"), "iterations");
  EXPECT_EQ(json.at("options").at(3).at("maximum"), 77);
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
