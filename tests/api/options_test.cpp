#include "api/options.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <random>
#include <string>

#include "core/base/error.hpp"
#include "error_of.hpp"
#include "random_constraints.hpp"

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

/// The option's own pointer, or one into its value.
void expect_refused(const Error& error, const std::string& name, const std::string& value) {
  EXPECT_EQ(error.code(), ErrorCode::invalid_option) << name << "=" << value;
  const std::string own = option_pointer(name);
  EXPECT_EQ(error.where().substr(0, own.size()), own) << name << "=" << value;
}

/// {"stop":{"iterations":VALUE}} for stop.iterations.
std::string object_text(const std::string& name, const std::string& value) {
  const std::size_t dot = name.find('.');
  if (dot == std::string::npos) return "{\"" + name + "\":" + value + "}";
  return "{\"" + name.substr(0, dot) + "\":" + object_text(name.substr(dot + 1), value) + "}";
}

Json random_number(const OptionRow& row, std::mt19937& rng) {
  const double maximum = row.name == "padding" ? 4 : option_maximum(row, kLimits).value_or(1e6);
  const double value = row.minimum + random_share(rng) * (maximum - row.minimum);
  if (row.type == OptionType::integer) return static_cast<std::int64_t>(value);
  return value;
}

/// A random value that the row allows.
Json random_value(const OptionRow& row, std::mt19937& rng) {
  if (row.name == "constraints") return random_constraints(rng);
  if (row.type == OptionType::objects || row.type == OptionType::names) return Json::array();
  if (row.type == OptionType::flag) return rng() % 2 == 0;
  if (row.type == OptionType::text) return "COLOR_" + std::to_string(rng() % 3);
  const bool has_words = row.type == OptionType::integer && !row.choices.empty();
  if (row.type == OptionType::choice || (has_words && rng() % 2 == 0)) {
    const double index = random_share(rng) * static_cast<double>(row.choices.size());
    return row.choices[static_cast<std::size_t>(index)];
  }
  if (row.type != OptionType::numbers || random_share(rng) < 0.5) return random_number(row, rng);
  Json list = Json::array();
  for (std::size_t left = 1 + rng() % kMaxNumbers; left > 0; --left)
    list.push_back(random_number(row, rng));
  return list;
}

/// The value as a query says it: a list of numbers without its brackets.
std::string query_text(const OptionRow& row, const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  const std::string text = value.dump();
  const bool is_list = row.type == OptionType::numbers && value.is_array();
  return is_list ? text.substr(1, text.size() - 2) : text;
}

TEST(Options, DefaultWhenNothingIsSaid) {
  const Json from_query = to_json(parse_options(Query{}, kLimits));
  EXPECT_EQ(from_query, to_json(preset_options(Preset::texture)));
  EXPECT_EQ(to_json(parse_options_text("{}", kLimits)), from_query);
}

/// Values of all options, by name, that go together.
Json random_values(std::mt19937& rng) {
  Json values = Json::object();
  for (const OptionRow& row : option_table()) {
    Json value = random_value(row, rng);
    const bool one = row.type == OptionType::numbers && value.is_array() && value.size() == 1;
    values[std::string(row.name)] = one ? value[0] : value;  // a query cannot tell a list of one
  }
  if (values["group"] != "scene") values["max_pages"] = 1;
  if (values["boundary"] != "free") values["straighten"] = "off";
  values["repack_only"] = values["measure_only"] = false;  // go with few others
  values["textures"] = "keep";                             // likewise
  if (values["weld"] == "exact") values["weld_distance"] = nullptr;
  if (values["boundary"] != "free") values["max_distortion"] = values["max_charts"] = nullptr;
  if (values["constraints"].empty()) return values;
  values["method"] = "hybrid";
  values["boundary"] = "free";
  values["max_distortion"] = values["max_charts"] = values["texels_per_unit"] = nullptr;
  values["max_pages"] = 1;
  values["stack_identical"] = false;
  values.update({{"rotation", "any"}, {"group", "scene"}, {"straighten", "off"}});
  return values;
}

TEST(Options, EveryAllowedValueSurvivesJsonAndQuery) {
  std::mt19937 rng(11);
  for (int k = 0; k < 500; ++k) {
    Json object = Json::object();
    Query query;
    const Json values = random_values(rng);
    for (const auto& [name, value] : values.items()) {
      if (value.is_null()) {
        object[name] = nullptr;  // which a patch would take away
      } else {
        object.merge_patch(Json::parse(object_text(name, value.dump())));
      }
      query.emplace(name, value.is_null() ? "none" : query_text(*find_option(name), value));
    }
    const JobOptions options = parse_options(object, kLimits);
    EXPECT_EQ(to_json(parse_options(query, kLimits)), to_json(options));
    if (options.unwrap.method != Method::hybrid) object["lambda"] = nullptr;
    EXPECT_EQ(to_json(options), object);
  }
}

TEST(Options, ResolvedOnesCanBeSentAgainAndStayAsTheyAre) {
  for (const char* text :
       {"{}", R"({"repack_only":true})", R"({"method":"asap","pins":"spectral"})",
        R"({"method":"hybrid","lambda":1e-300})",
        R"({"method":"hybrid","lambda":[3,1,2],"stop":{"iterations":10}})",
        R"({"constraints":[{"at":[1,2,3],"uv":[0,1]}],"method":"asap"})"}) {
    const Json resolved = to_json(parse_options_text(text, kLimits));
    const JobOptions again = parse_options(resolved, kLimits);
    EXPECT_EQ(to_json(again), resolved);
    EXPECT_TRUE(again.notes.empty());
  }
}

TEST(Options, ADensityWithoutASizeAsksForTheSize) {
  const auto fit = [](const char* json) {
    return parse_options_text(json, kLimits).unwrap.page_fit;
  };
  EXPECT_EQ(fit(R"({"texels_per_unit":64})"), PageFit::multiple_of_four);
  EXPECT_EQ(fit(R"({"texels_per_unit":64,"resolution":"power_of_two"})"), PageFit::power_of_two);
  for (const char* given :
       {R"({})", R"({"texels_per_unit":64,"resolution":512})",
        R"({"texels_per_unit":64,"width":512})", R"({"texels_per_unit":64,"textures":"transfer"})"})
    EXPECT_EQ(fit(given), PageFit::given) << given;
  EXPECT_EQ(refusal(std::string(R"({"texels_per_unit":64,"resolution":"auto",)") +
                    R"("textures":"transfer"})")
                .where(),
            "/textures");
}

TEST(Options, RepackingMakesNothingBijective) {
  expect_refused(refusal(R"({"repack_only":true,"guarantee":"bijective"})"), "guarantee", "");
}

TEST(Options, RefuseAWrongTypeOfEveryOption) {
  for (const OptionRow& row : option_table()) {
    if (row.type == OptionType::text) continue;  // any text is a name
    const std::string name(row.name);
    for (const char* value : {"[[]]", "{}", "true", "\"\"", "\"x\"", "\"1\"", "-1e9"}) {
      if (row.type == OptionType::flag && std::string(value) == "true") continue;
      expect_refused(refusal(object_text(name, value)), name, value);
    }
    const char* other = row.type == OptionType::choice ? "1" : "\"best\"";
    expect_refused(refusal(object_text(name, other)), name, other);
    if (row.type == OptionType::names) continue;  // a query's text is a name, whatever it is
    for (const char* value : {"", " ", "x", "-1e9", "nan", "NaN", "1x", " 1", "1 ", "+1", "true"}) {
      if (row.type == OptionType::flag && std::string(value) == "true") continue;
      expect_refused(refusal(Query{{name, value}}), name, value);
    }
  }
}

TEST(Options, RefuseNullButWhereResolvedOptionsHaveIt) {
  for (const OptionRow& row : option_table()) {
    const std::string text = object_text(std::string(row.name), "null");
    if (row.nullable) {
      const Json options = to_json(parse_options_text(text, kLimits));
      EXPECT_TRUE(options.at(Json::json_pointer(option_pointer(row.name))).is_null()) << row.name;
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
      const std::string text = std::to_string(value);
      expect_refused(refusal(Query{{name, text}}), name, text);
      expect_refused(refusal(object_text(name, text)), name, text);
    }
  }
}

TEST(Options, RefuseNumbersOutsideOfWhatCanBeCounted) {
  for (const char* name : {"stop.iterations", "stop.max_iterations"}) {
    for (const char* value : {"0", "1000000000", "99999999999999999999", "1.5", "1e2", "0x10"}) {
      expect_refused(refusal(Query{{name, value}}), name, value);
    }
    expect_refused(refusal(object_text(name, "1.5")), name, "1.5");
    expect_refused(refusal(object_text(name, "1e300")), name, "1e300");
  }
  for (const char* value : {"inf", "infinity", "-0.1", "1e999", "nan", "--1", "0.1;1"}) {
    expect_refused(refusal(Query{{"lambda", value}}), "lambda", value);
  }
  for (const char* value : {"0", "-1e-6", "0.11", "1e-13"}) {
    expect_refused(refusal(Query{{"stop.tolerance", value}}), "stop.tolerance", value);
  }
  const std::string whole = R"({"stop":{"iterations":20.0}})";
  EXPECT_EQ(parse_options_text(whole, kLimits).unwrap.stop.iterations, 20);
}

TEST(Options, RefuseAGroupThatIsNoObjectAndADotInJson) {
  for (const char* value : {"1", "[]", "null", "\"iterations\""}) {
    const Error error = refusal(object_text("stop", value));
    expect_refused(error, "stop", value);
    EXPECT_THAT(error.what(), HasSubstr("must be an object"));
  }
  const Error error = refusal(R"({"stop.iterations":10})");
  expect_refused(error, "stop.iterations", "10");
  EXPECT_THAT(error.what(), HasSubstr("{\"stop\": {"));
  expect_refused(refusal(Query{{"stop", "10"}}), "stop", "10");
}

TEST(Options, RefusePaddingOfMoreThanAQuarter) {
  EXPECT_NO_THROW(parse_options(Query{{"resolution", "16"}, {"padding", "4"}}, kLimits));
  expect_refused(refusal(Query{{"resolution", "16"}, {"padding", "5"}}), "padding", "5");
}

TEST(Options, IterationsObeyTheServersOwnLimit) {
  Limits strict;
  strict.max_iterations = 20;
  for (const char* option : {"stop.iterations", "stop.max_iterations"}) {
    const std::string name = option;
    EXPECT_NO_THROW(parse_options(Query{{name, "20"}}, strict));
    const Error error = error_of([&] { parse_options(Query{{name, "21"}}, strict); });
    const std::string none = can_unset(*find_option(name)) ? ", or none (null in JSON)." : ".";
    EXPECT_EQ(error.what(), name + " must be an integer between 1 and 20" + none);
  }
  EXPECT_EQ(parse_options(Query{}, strict).unwrap.stop.max_iterations, 20);
}

TEST(Options, RefuseADuplicate) {
  expect_refused(refusal(Query{{"method", "arap"}, {"method", "arap"}}), "method", "twice");
  const Query both = {{"stop.iterations", "1"}, {"stop.iterations", "1"}};
  expect_refused(refusal(both), "stop.iterations", "twice");
  expect_refused(refusal(R"({"method":"arap","method":"arap"})"), "method", "twice");
}

TEST(Options, SayWhatIsAllowed) {
  EXPECT_STREQ(refusal(Query{{"method", "lscm"}}).what(),
               "method must be one of asap, arap, hybrid, abf, linabf, cp, bff, ic, slim.");
  EXPECT_STREQ(
      refusal(Query{{"lambda", "-1"}}).what(),
      "lambda must be a finite number of at least 0, or a list of at most 32 different ones.");
  EXPECT_STREQ(refusal(Query{{"resolution", "8"}}).what(),
               "resolution must be an integer between 16 and 16384, or one of auto, power_of_two.");
}

TEST(Options, GuessWhatAMisspeltNameMeant) {
  for (const auto& [asked, meant] : Query{{"metod", "method"},
                                          {"lamda", "lambda"},
                                          {"lambda-units", "lambda_units"},
                                          {"iterations", "stop.iterations"},
                                          {"stop.iteration", "stop.iterations"},
                                          {"tolerence", "stop.tolerance"},
                                          {"garantee", "guarantee"},
                                          {"resolutoin", "resolution"}}) {
    const Error error = refusal(Query{{asked, "1"}});
    expect_refused(error, asked, "1");
    EXPECT_THAT(error.what(), HasSubstr("did you mean " + meant + "?"));
  }
}

TEST(Options, ListAllNamesForOneThatIsLikeNone) {
  for (const char* name : {"", "x", "texture_size"})
    EXPECT_THAT(refusal(Query{{name, "1"}}).what(),
                HasSubstr("the options are preset, method, lambda,"));
  EXPECT_THAT(refusal(Query{{"webhook", "1"}}).what(), HasSubstr("header Unwrapd-Webhook."));
  EXPECT_EQ(refusal(Query{{"a/b~c", "1"}}).where(), "/a~1b~0c");
  EXPECT_EQ(refusal(Query{{std::string(100'000, 'a'), "1"}}).code(), ErrorCode::invalid_option);
}

TEST(Options, RefuseAnythingButAnObject) {
  for (const char* text : {"[]", "null", "1", "\"arap\"", "true"})
    EXPECT_EQ(refusal(std::string(text)).code(), ErrorCode::invalid_option) << text;
  for (const char* text : {"", "{", "method=arap", "{'method':'arap'}"})
    EXPECT_EQ(refusal(std::string(text)).code(), ErrorCode::malformed_request) << text;
}

}  // namespace
}  // namespace unwrapd::api
