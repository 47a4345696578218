#include "api/error_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "contract_text.hpp"

namespace unwrapd::api {
namespace {

using testing::UnorderedElementsAreArray;

TEST(ErrorTable, ListsExactlyTheCodesOfTheContract) {
  std::vector<std::string> names;
  for (const ErrorRow& row : error_table()) names.emplace_back(row.name);
  EXPECT_THAT(list({"components", "schemas", "ErrorCode"}, "enum"),
              UnorderedElementsAreArray(names));
}

TEST(ErrorTable, NamesAreDistinctAndLeadBackToTheirCode) {
  std::set<std::string_view> names;
  for (const ErrorRow& row : error_table()) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_EQ(code_named(row.name), row.code);
    EXPECT_EQ(error_row(row.code).name, row.name);
  }
  EXPECT_EQ(names.size(), static_cast<std::size_t>(kErrorCodeCount));
  EXPECT_FALSE(code_named("no_such_code"));
  EXPECT_FALSE(code_named(""));
}

TEST(ErrorTable, EveryStatusIsAnErrorAndEveryTitleIsSaid) {
  for (const ErrorRow& row : error_table()) {
    EXPECT_GE(row.status, 400) << row.name;
    EXPECT_LT(row.status, 600) << row.name;
    EXPECT_FALSE(row.title.empty()) << row.name;
    EXPECT_NE(row.title.back(), '.') << row.name;
  }
}

TEST(ErrorTable, TheUsersMistakesAreNeverTheServersFault) {
  for (const ErrorRow& row : error_table()) {
    const bool is_about_bytes_or_mesh =
        row.code >= ErrorCode::unknown_format && row.code <= ErrorCode::not_orientable;
    if (!is_about_bytes_or_mesh) continue;
    EXPECT_LT(row.status, 500) << row.name;
    EXPECT_EQ(row.status == 400, row.name.starts_with("malformed_")) << row.name;
    EXPECT_EQ(row.status == 413, row.name.starts_with("too_m")) << row.name;
  }
}

TEST(Problem, SaysWhatWhereAndWhichJob) {
  const Json json = problem(Error(ErrorCode::invalid_option, "lambda is bad.", "/lambda"), "j_1");
  EXPECT_EQ(json.at("type"), "urn:unwrapd:problem:invalid_option");
  EXPECT_EQ(json.at("status"), 422);
  EXPECT_EQ(json.at("detail"), "lambda is bad.");
  EXPECT_EQ(json.at("code"), "invalid_option");
  EXPECT_EQ(json.at("pointer"), "/lambda");
  EXPECT_EQ(json.at("job"), "j_1");
}

TEST(Problem, LeavesOutWhatIsNotKnown) {
  const Json json = problem(Error(ErrorCode::not_found, "Nothing here."));
  EXPECT_FALSE(json.contains("pointer"));
  EXPECT_FALSE(json.contains("job"));
}

TEST(Problem, BecomesTheErrorAgainThatItWas) {
  for (const ErrorRow& row : error_table()) {
    const Error error = error_from_problem(problem(Error(row.code, "It is so.", "/a/b"), "j_1"));
    EXPECT_EQ(error.code(), row.code);
    EXPECT_STREQ(error.what(), "It is so.");
    EXPECT_EQ(error.where(), "/a/b");
  }
}

TEST(Problem, OfAnotherServerIsInternalWithItsOwnText) {
  EXPECT_EQ(error_from_problem(Json("text")).code(), ErrorCode::internal);
  EXPECT_EQ(error_from_problem(Json{{"code", 7}}).code(), ErrorCode::internal);
  EXPECT_STREQ(error_from_problem(Json{{"code", "teapot"}, {"title", "Short"}}).what(), "Short");
}

}  // namespace
}  // namespace unwrapd::api
