// Lists of lambdas, in JSON and in a query.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "api/options.hpp"
#include "core/base/error.hpp"
#include "error_of.hpp"

namespace unwrapd::api {
namespace {

const Limits kLimits;

JobOptions from_query(const std::string& lambda) {
  return parse_options(Query{{"lambda", lambda}}, kLimits);
}

JobOptions from_json(const std::string& lambda) {
  return parse_options_text(R"({"lambda":)" + lambda + "}", kLimits);
}

template <class Parse>
void expect_refused(const Parse& parse, const std::string& lambda) {
  const Error error = error_of([&] { parse(lambda); });
  EXPECT_EQ(error.code(), ErrorCode::invalid_option) << lambda;
  EXPECT_EQ(error.where(), "/lambda") << lambda;
}

TEST(LambdaList, KeepsItsOrder) {
  const std::vector<double> three = {1, 0.01, 0.1};
  EXPECT_EQ(from_query("1,0.01,1e-1").unwrap.lambda_curve, three);
  EXPECT_EQ(from_json("[1,0.01,0.1]").unwrap.lambda_curve, three);
}

TEST(LambdaList, OfOneIsACurveAndANumberIsNone) {
  EXPECT_EQ(from_json("[5]").unwrap.lambda_curve, std::vector<double>{5});
  EXPECT_TRUE(from_json("5").unwrap.lambda_curve.empty());
  EXPECT_TRUE(from_query("5").unwrap.lambda_curve.empty());
  EXPECT_EQ(from_query("5").unwrap.lambda, 5);
}

TEST(LambdaList, IsRefusedWithRepetitionsBadNumbersOrTooMany) {
  std::string long_list = "0";
  for (std::size_t k = 1; k <= kMaxNumbers; ++k) long_list += "," + std::to_string(k);
  for (const char* list : {"1,1", "1,2,1.0", "1,-1", "0,-0", long_list.c_str()}) {
    expect_refused(from_query, list);
    expect_refused(from_json, "[" + std::string(list) + "]");
  }
  EXPECT_NO_THROW(from_query(long_list.substr(2)));
}

TEST(LambdaList, IsRefusedWithGapsInAQueryAndEmptyInJson) {
  for (const char* list : {",", "1,", ",1", "1,,2", "1, 2", "[1,2]", "1,x"})
    expect_refused(from_query, list);
  for (const char* list : {"[]", "[[1]]", "[null]", R"(["1"])"}) expect_refused(from_json, list);
}

}  // namespace
}  // namespace unwrapd::api
