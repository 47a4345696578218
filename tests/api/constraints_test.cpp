#include "api/constraints.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "api/options.hpp"
#include "contract_text.hpp"
#include "error_of.hpp"

namespace unwrapd::api {
namespace {

using testing::HasSubstr;

std::vector<PositionConstraint> constraints(const std::string& text) {
  return parse_options_text(R"({"constraints":)" + text + "}", Limits{}).unwrap.constraints;
}

Error refusal(const std::string& text) {
  return error_of([&] { constraints(text); });
}

TEST(Constraints, HoldExactlyUnlessTheyHaveAWeight) {
  const auto all = constraints(R"([{"vertex":7,"uv":[0.25,-1]},
      {"at":[1,2.5,-3],"uv":[0,1],"weight":4,"mesh":2}, {"vertex":0,"uv":[0,0],"weight":null}])");
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].vertex, 7);
  EXPECT_EQ(all[0].uv, Vec2(0.25, -1));
  EXPECT_TRUE(std::isinf(all[0].weight));
  EXPECT_EQ(all[0].surface, 0);
  EXPECT_FALSE(all[1].vertex);
  EXPECT_EQ(all[1].position, Vec3(1, 2.5, -3));
  EXPECT_EQ(all[1].weight, 4);
  EXPECT_EQ(all[1].surface, 2);
  EXPECT_TRUE(std::isinf(all[2].weight));
}

TEST(Constraints, AreRefusedWithThePlaceOfWhatIsWrong) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {R"({"vertex":1})", "/uv"},
      {R"({"vertex":1,"uv":null})", "/uv"},
      {R"({"vertex":1,"uv":[1]})", "/uv"},
      {R"({"vertex":1,"uv":[1,2,3]})", "/uv"},
      {R"({"vertex":1,"uv":[1,"2"]})", "/uv"},
      {R"({"vertex":1,"uv":"1,2"})", "/uv"},
      {R"({"vertex":-1,"uv":[0,0]})", "/vertex"},
      {R"({"vertex":1.5,"uv":[0,0]})", "/vertex"},
      {R"({"vertex":4294967296,"uv":[0,0]})", "/vertex"},
      {R"({"vertex":"1","uv":[0,0]})", "/vertex"},
      {R"({"at":[1,2],"uv":[0,0]})", "/at"},
      {R"({"at":{"x":1},"uv":[0,0]})", "/at"},
      {R"({"vertex":1,"uv":[0,0],"weight":0})", "/weight"},
      {R"({"vertex":1,"uv":[0,0],"weight":-2})", "/weight"},
      {R"({"vertex":1,"uv":[0,0],"weight":"hard"})", "/weight"},
      {R"({"vertex":1,"uv":[0,0],"weight":9.9e-10})", "/weight"},
      {R"({"vertex":1,"uv":[0,0],"weight":1.1e9})", "/weight"},
      {R"({"vertex":1,"uv":[0,0],"mesh":-1})", "/mesh"},
      {R"({"vertex":1,"uv":[0,0],"wieght":1})", "/wieght"},
      {R"({"vertex":1,"uv":[0,0],"a/b":1})", "/a~1b"},
      {R"({"vertex":1,"at":[0,0,0],"uv":[0,0]})", ""},
      {R"({"uv":[0,0]})", ""},
      {R"([1,2])", ""},
      {R"(null)", ""}};
  for (const auto& [text, where] : cases) {
    const Error error = refusal(R"([{"vertex":0,"uv":[0,0]},)" + text + "]");
    EXPECT_EQ(error.code(), ErrorCode::invalid_option) << text;
    EXPECT_EQ(error.where(), "/constraints/1" + where) << text;
  }
}

TEST(Constraints, AreRefusedWithThePlaceOfAMemberGivenTwiceOrTooLarge) {
  EXPECT_EQ(refusal(R"([{"vertex":0,"uv":[0,0]},{"uv":[0,0],"uv":[1,1]}])").where(),
            "/constraints/1/uv");
  EXPECT_EQ(refusal(R"([{"vertex":0,"uv":[0,1e999]}])").where(), "/constraints/0/uv/1");
}

TEST(Constraints, MustBeAListOfAtMostTheServersLimit) {
  for (const char* text : {"{}", "1", "null", "\"[]\"", "true"})
    EXPECT_EQ(refusal(text).where(), "/constraints") << text;
  Limits limits;
  limits.max_constraints = 2;
  const auto parse = [&](const std::string& list) {
    return parse_options_text(R"({"constraints":[)" + list + "]}", limits);
  };
  const std::string one = R"({"vertex":0,"uv":[0,0]})";
  EXPECT_NO_THROW(parse(one + "," + one));
  const Error error = error_of([&] { parse(one + "," + one + "," + one); });
  EXPECT_EQ(error.where(), "/constraints");
  EXPECT_THAT(error.what(), HasSubstr("at most 2"));
}

TEST(Constraints, AsManyAsAServerTakesFitIntoTheOptions) {
  std::string text = "[";
  for (int k = 0; k < Limits{}.max_constraints; ++k)
    text += std::string(k > 0 ? "," : "") +
            R"({"at":[-12345.678901234567,1.2345678901234567e-5,)"
            R"(0.12345678901234567],"uv":[0.12345678901234567,0.98765432109876543]})";
  EXPECT_EQ(constraints(text + "]").size(), 100'000U);
}

TEST(Constraints, HaveTheMembersOfTheContract) {
  const auto all = constraints(R"([{"vertex":1,"uv":[0,1]},{"at":[1,2,3],"uv":[0,1]}])");
  std::vector<std::string> told = {"vertex"};
  const Json json = to_json(all);
  for (const auto& [name, value] : json.at(1).items()) told.push_back(name);
  EXPECT_THAT(keys({"components", "schemas", "Constraint", "properties"}),
              testing::ElementsAreArray(told));
}

}  // namespace
}  // namespace unwrapd::api
