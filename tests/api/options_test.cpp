#include "api/options.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <string>

#include "core/error.hpp"
#include "error_of.hpp"

namespace unwrapd::api {
namespace {

using testing::HasSubstr;

const Limits kLimits;

Error refusal(const Query& query) {
  return error_of([&] { parse_options(query, kLimits); });
}

Error refusal(const std::string& json) {
  return error_of([&] { parse_options_text(json, kLimits); });
}

void expect_refused(const Error& error, const std::string& name, const std::string& value) {
  EXPECT_EQ(error.code(), ErrorCode::invalid_option) << name << "=" << value;
  EXPECT_EQ(error.where(), "/" + name) << name << "=" << value;
}

/// A random value that the row allows.
Json random_value(const OptionRow& row, std::mt19937& rng) {
  const double span = std::uniform_real_distribution<double>(0, 1)(rng);
  if (row.type == OptionType::choice) {
    return row.choices[static_cast<std::size_t>(span * static_cast<double>(row.choices.size()))];
  }
  const double maximum = row.name == "padding" ? 4 : option_maximum(row, kLimits).value_or(1e6);
  const double value = row.minimum + span * (maximum - row.minimum);
  if (row.type == OptionType::integer) return static_cast<std::int64_t>(value);
  return value;
}

TEST(Options, DefaultWhenNothingIsSaid) {
  const Json from_query = to_json(parse_options(Query{}, kLimits));
  EXPECT_EQ(from_query, to_json(JobOptions{}));
  EXPECT_EQ(to_json(parse_options_text("{}", kLimits)), from_query);
}

TEST(Options, EveryAllowedValueSurvivesJsonAndQuery) {
  std::mt19937 rng(11);
  for (int k = 0; k < 500; ++k) {
    Json object = Json::object();
    Query query;
    for (const OptionRow& row : option_table()) {
      const Json value = random_value(row, rng);
      object[std::string(row.name)] = value;
      query.emplace(row.name, value.is_string() ? value.get<std::string>() : value.dump());
    }
    const JobOptions options = parse_options(object, kLimits);
    EXPECT_EQ(to_json(parse_options(query, kLimits)), to_json(options));
    if (options.unwrap.method != Method::hybrid) object["lambda"] = nullptr;
    EXPECT_EQ(to_json(options), object);
  }
}

TEST(Options, ResolvedOnesCanBeSentAgainAndStayAsTheyAre) {
  for (const char* text :
       {"{}", R"({"method":"asap","pins":"spectral"})", R"({"method":"hybrid","lambda":1e-300})"}) {
    const Json resolved = to_json(parse_options_text(text, kLimits));
    const JobOptions again = parse_options(resolved, kLimits);
    EXPECT_EQ(to_json(again), resolved);
    EXPECT_TRUE(again.notes.empty());
  }
}

TEST(Options, RefuseAWrongTypeOfEveryOption) {
  for (const OptionRow& row : option_table()) {
    const std::string name(row.name);
    for (const char* value : {"[]", "{}", "true", "\"\"", "\"x\"", "\"1\"", "-1e9"}) {
      expect_refused(refusal("{\"" + name + "\":" + value + "}"), name, value);
    }
    const char* other = row.type == OptionType::choice ? "1" : "\"auto\"";
    expect_refused(refusal("{\"" + name + "\":" + other + "}"), name, other);
    for (const char* value : {"", " ", "x", "-1e9", "nan", "NaN", "1x", " 1", "1 ", "+1", "true"}) {
      expect_refused(refusal(Query{{name, value}}), name, value);
    }
  }
}

TEST(Options, RefuseNullButForLambda) {
  for (const OptionRow& row : option_table()) {
    const std::string text = "{\"" + std::string(row.name) + "\":null}";
    if (row.name == "lambda") {
      EXPECT_NO_THROW(parse_options_text(text, kLimits));
    } else {
      expect_refused(refusal(text), std::string(row.name), "null");
    }
  }
}

TEST(Options, RefuseEveryBoundPassedByOne) {
  for (const OptionRow& row : option_table()) {
    if (row.type != OptionType::integer) continue;
    const std::string name(row.name);
    const auto low = static_cast<std::int64_t>(row.minimum) - 1;
    const auto high = static_cast<std::int64_t>(*option_maximum(row, kLimits)) + 1;
    for (const std::int64_t value : {low, high}) {
      expect_refused(refusal(Query{{name, std::to_string(value)}}), name, std::to_string(value));
      expect_refused(refusal(Json{{name, value}}.dump()), name, std::to_string(value));
    }
  }
}

TEST(Options, RefuseNumbersOutsideOfWhatCanBeCounted) {
  for (const char* value : {"0", "1000000000", "99999999999999999999", "1.5", "1e2", "0x10"}) {
    expect_refused(refusal(Query{{"iterations", value}}), "iterations", value);
  }
  for (const char* value : {"inf", "infinity", "-0.1", "1e999", "nan", "--1", "0,1"}) {
    expect_refused(refusal(Query{{"lambda", value}}), "lambda", value);
  }
  expect_refused(refusal(R"({"iterations":1.5})"), "iterations", "1.5");
  expect_refused(refusal(R"({"iterations":1e300})"), "iterations", "1e300");
  EXPECT_EQ(parse_options_text(R"({"iterations":20.0})", kLimits).unwrap.stop.iterations, 20);
}

TEST(Options, RefusePaddingOfMoreThanAQuarter) {
  EXPECT_NO_THROW(parse_options(Query{{"resolution", "16"}, {"padding", "4"}}, kLimits));
  expect_refused(refusal(Query{{"resolution", "16"}, {"padding", "5"}}), "padding", "5");
}

TEST(Options, IterationsObeyTheServersOwnLimit) {
  Limits strict;
  strict.max_iterations = 20;
  EXPECT_EQ(parse_options(Query{{"iterations", "20"}}, strict).unwrap.stop.iterations, 20);
  const Error error = error_of([&] { parse_options(Query{{"iterations", "21"}}, strict); });
  EXPECT_STREQ(error.what(), "iterations must be an integer between 1 and 20.");
}

TEST(Options, RefuseADuplicate) {
  expect_refused(refusal(Query{{"method", "arap"}, {"method", "arap"}}), "method", "twice");
  expect_refused(refusal(R"({"method":"arap","method":"arap"})"), "method", "twice");
}

TEST(Options, SayWhatIsAllowed) {
  EXPECT_STREQ(refusal(Query{{"method", "abf"}}).what(),
               "method must be one of asap, arap, hybrid.");
  EXPECT_STREQ(refusal(Query{{"lambda", "-1"}}).what(),
               "lambda must be a finite number of at least 0.");
  EXPECT_STREQ(refusal(Query{{"resolution", "8"}}).what(),
               "resolution must be an integer between 16 and 16384.");
}

TEST(Options, GuessWhatAMisspeltNameMeant) {
  for (const auto& [asked, meant] : Query{{"metod", "method"},
                                          {"lamda", "lambda"},
                                          {"lambda-units", "lambda_units"},
                                          {"iteration", "iterations"},
                                          {"resolutoin", "resolution"}}) {
    const Error error = refusal(Query{{asked, "1"}});
    expect_refused(error, asked, "1");
    EXPECT_THAT(error.what(), HasSubstr("did you mean " + meant + "?"));
  }
}

TEST(Options, ListAllNamesForOneThatIsLikeNone) {
  for (const char* name : {"", "x", "texture_size"}) {
    EXPECT_THAT(refusal(Query{{name, "1"}}).what(), HasSubstr("the options are method, lambda,"));
  }
  EXPECT_EQ(refusal(Query{{"a/b~c", "1"}}).where(), "/a~1b~0c");
  EXPECT_EQ(refusal(Query{{std::string(100'000, 'a'), "1"}}).code(), ErrorCode::invalid_option);
}

TEST(Options, RefuseAnythingButAnObject) {
  for (const char* text : {"[]", "null", "1", "\"arap\"", "true"}) {
    EXPECT_EQ(refusal(std::string(text)).code(), ErrorCode::invalid_option) << text;
  }
  for (const char* text : {"", "{", "method=arap", "{'method':'arap'}"}) {
    EXPECT_EQ(refusal(std::string(text)).code(), ErrorCode::malformed_request) << text;
  }
}

TEST(Options, NoteWhatWasGivenButHasNoEffect) {
  EXPECT_THAT(parse_options(Query{{"lambda", "0.1"}}, kLimits).notes,
              testing::ElementsAre("The option lambda has no effect with the method arap."));
  EXPECT_THAT(parse_options_text(R"({"iterations":99,"method":"asap"})", kLimits).notes,
              testing::ElementsAre("The option iterations has no effect with the method asap."));
  EXPECT_TRUE(parse_options(Query{{"method", "hybrid"}, {"lambda", "2"}}, kLimits).notes.empty());
}

}  // namespace
}  // namespace unwrapd::api
