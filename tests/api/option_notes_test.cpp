// Options without effect are noted.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "api/options.hpp"

namespace unwrapd::api {
namespace {

const Limits kUsualLimits;

TEST(OptionNotes, NameWhatWasGivenButHasNoEffect) {
  EXPECT_THAT(parse_options(Query{{"lambda", "0.1"}}, kUsualLimits).notes,
              testing::ElementsAre("The option lambda has no effect with the method arap."));
  EXPECT_THAT(
      parse_options_text(R"({"stop":{"iterations":99},"method":"asap"})", kUsualLimits).notes,
      testing::ElementsAre("The option stop.iterations has no effect with the method asap."));
  const Query both = {{"stop.iterations", "5"}, {"stop.tolerance", "1e-3"}};
  EXPECT_THAT(
      parse_options(both, kUsualLimits).notes,
      testing::ElementsAre("The option stop.tolerance has no effect with stop.iterations."));
  EXPECT_EQ(parse_options_text(R"({"draco_bits": 12})", kUsualLimits).notes.size(), 1U);
  EXPECT_TRUE(
      parse_options(Query{{"method", "hybrid"}, {"lambda", "2"}}, kUsualLimits).notes.empty());
  EXPECT_TRUE(
      parse_options(to_json(parse_options_text("{}", kUsualLimits)), kUsualLimits).notes.empty());
}

TEST(OptionNotes, NameWhatOtherOptionsTakeTheEffectFrom) {
  const std::string pin = R"([{"vertex":0,"uv":[0,0]}])";
  const auto unused = [](const Query& query) {
    std::vector<std::string> names;
    for (const std::string& note : parse_options(query, kUsualLimits).notes)
      names.push_back(note.substr(0, note.find(" has no effect ")));
    return names;
  };
  const auto the = [](const std::string& name) {
    return std::vector<std::string>{"The option " + name};
  };
  EXPECT_EQ(unused({{"weld", "exact"}, {"weld_distance", "0.1"}}), the("weld_distance"));
  EXPECT_EQ(unused({{"width", "512"}, {"height", "256"}, {"resolution", "2048"}}),
            the("resolution"));
  EXPECT_EQ(unused({{"guarantee", "none"}, {"repair", "virtual_boundary"}}), the("repair"));
  EXPECT_EQ(unused({{"boundary", "circle"}, {"max_charts", "3"}}), the("max_charts"));
  EXPECT_EQ(unused({{"constraints", pin}, {"max_charts", "3"}}), the("max_charts"));
  EXPECT_EQ(unused({{"constraints", pin}, {"texel_density", "_D"}}), the("texel_density"));
  EXPECT_EQ(unused({{"repack_only", "true"}, {"seam_avoid", "_A"}}), the("seam_avoid"));
  EXPECT_EQ(unused({{"repack_only", "true"}, {"keep_edges", R"([{"vertices":[0,1]}])"}}),
            the("keep_edges"));
  EXPECT_EQ(unused({{"measure_only", "true"}, {"texel_density", "_D"}}), the("texel_density"));
  EXPECT_EQ(unused({{"constraints", pin}, {"effort", "best"}}), the("effort"));
  for (const Query& with_effect : std::vector<Query>{{{"weld_distance", "0.1"}},
                                                     {{"width", "512"}, {"resolution", "2048"}},
                                                     {{"repair", "virtual_boundary"}},
                                                     {{"guarantee", "none"}},
                                                     {{"boundary", "circle"}, {"effort", "best"}},
                                                     {{"constraints", pin}, {"padding", "10"}},
                                                     {{"preset", "paper"}, {"max_charts", "3"}}})
    EXPECT_TRUE(unused(with_effect).empty()) << with_effect.begin()->first;
  for (const char* asked : {R"({"preset":"paper","boundary":"circle"})", R"({"weld":"exact"})",
                            R"({"guarantee":"none"})"})
    EXPECT_TRUE(
        parse_options(to_json(parse_options_text(asked, kUsualLimits)), kUsualLimits).notes.empty())
        << asked;
}

}  // namespace
}  // namespace unwrapd::api
