// Options that name a painted attribute.
#include <gtest/gtest.h>

#include <string>

#include "api/options.hpp"
#include "core/base/error.hpp"
#include "error_of.hpp"

namespace unwrapd::api {
namespace {

const Limits kPaintedLimits;

void expect_refused(const Error& error, const std::string& name) {
  EXPECT_EQ(error.code(), ErrorCode::invalid_option);
  EXPECT_EQ(error.where(), "/" + name);
}

TEST(PaintedOptions, AreNamesOfAttributesOrUnset) {
  const std::string longest(kMaxTextBytes, 'a');
  for (const std::string name : {"seam_avoid", "texel_density"}) {
    for (const std::string& value :
         {std::string("[\"_A\"]"), std::string("{}"), std::string("7"), std::string("true"),
          std::string("\"\""), "\"" + longest + "a\""})
      expect_refused(error_of([&] {
                       std::string json = "{\"" + name + "\":" + value + "}";
                       parse_options_text(json, kPaintedLimits);
                     }),
                     name);
    expect_refused(error_of([&] { parse_options(Query{{name, ""}}, kPaintedLimits); }), name);
    EXPECT_EQ(parse_options(Query{{name, "none"}}, kPaintedLimits).asset.seam_avoid, std::nullopt);
  }
  EXPECT_EQ(parse_options(Query{{"seam_avoid", longest}}, kPaintedLimits).asset.seam_avoid,
            longest);
  const JobOptions options =
      parse_options(Query{{"seam_avoid", "7"}, {"texel_density", "COLOR_0.g"}}, kPaintedLimits);
  EXPECT_EQ(options.asset.seam_avoid, "7");  // names that look like numbers are names
  EXPECT_EQ(options.asset.texel_density, "COLOR_0.g");
}

}  // namespace
}  // namespace unwrapd::api
