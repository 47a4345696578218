// Presets: what they set, and what a request changes.
#include <gtest/gtest.h>

#include "api/options.hpp"
#include "core/base/error.hpp"
#include "error_of.hpp"

namespace unwrapd::api {
namespace {

const Limits kLimits;

Json resolved(const std::string& text) { return to_json(parse_options_text(text, kLimits)); }

TEST(Presets, TextureIsTheDefault) {
  EXPECT_EQ(resolved("{}"), resolved(R"({"preset":"texture"})"));
  const UnwrapOptions options = parse_options_text("{}", kLimits).unwrap;
  EXPECT_EQ(options.guarantee, Guarantee::bijective);
  EXPECT_TRUE(options.max_distortion.has_value());
}

TEST(Presets, EveryOtherOptionOverridesThem) {
  for (const char* preset : {"texture", "lightmap", "chart", "paper"}) {
    const std::string begin = R"({"preset":")" + std::string(preset) + R"(",)";
    EXPECT_EQ(resolved(begin + R"("guarantee":"none"})").at("guarantee"), "none");
    EXPECT_EQ(resolved(begin + R"("max_distortion":2.5})").at("max_distortion"), 2.5);
    EXPECT_TRUE(resolved(begin + R"("max_distortion":null})").at("max_distortion").is_null());
    EXPECT_TRUE(resolved(begin + R"("max_charts":null})").at("max_charts").is_null());
    EXPECT_EQ(resolved(begin + R"("texcoord":3})").at("texcoord"), 3);
    EXPECT_EQ(resolved(begin + R"("stop":{"iterations":7}})").at("stop").at("iterations"), 7);
  }
}

TEST(Presets, NoneInAQueryUnsetsWhatTheyBound) {
  const Query bounded{{"preset", "texture"}, {"max_distortion", "none"}};
  EXPECT_TRUE(to_json(parse_options(bounded, kLimits)).at("max_distortion").is_null());
  for (const OptionRow& row : option_table()) {
    const Query query{{std::string(row.name), "none"}};
    if (can_unset(row)) {
      EXPECT_TRUE(row.get(parse_options(query, kLimits)).is_null()) << row.name;
    } else if (!row.nullable && row.type != OptionType::integer) {
      continue;  // none may be a choice or a name
    } else {
      const Error error = error_of([&] { parse_options(query, kLimits); });
      EXPECT_EQ(error.where(), option_pointer(row.name)) << row.name;
    }
  }
}

TEST(Presets, TheOrderOfMembersDoesNotMatter) {
  EXPECT_EQ(resolved(R"({"padding":9,"preset":"lightmap"})"),
            resolved(R"({"preset":"lightmap","padding":9})"));
}

TEST(Presets, YieldToRequestsThatKeepChartsWhole) {
  for (const char* request : {R"("boundary":"circle")", R"("repack_only":true)",
                              R"("constraints":[{"at":[1,2,3],"uv":[0,1]}])"}) {
    const Json options = resolved("{" + std::string(request) + "}");
    EXPECT_TRUE(options.at("max_distortion").is_null()) << request;
    EXPECT_EQ(options.at("guarantee"), "flip_free") << request;
  }
  const Json asked = resolved(R"({"boundary":"circle","guarantee":"bijective"})");
  EXPECT_EQ(asked.at("guarantee"), "bijective");
  const Error error = error_of(
      [] { parse_options_text(R"({"boundary":"circle","max_distortion":2.1})", kLimits); });
  EXPECT_EQ(error.where(), "/max_distortion");
}

TEST(Presets, YieldToABoundaryWhereTheMethodHasOne) {
  const auto boundary = [](std::string_view method) {
    return resolved(R"({"boundary":"circle","method":")" + std::string(method) + R"("})");
  };
  for (const std::string_view method : find_option("method")->choices) {
    const Json options = boundary(method);
    const bool yields = method == "asap" || method == "arap" || method == "hybrid";
    EXPECT_EQ(options.at("max_distortion").is_null(), yields) << method;
    EXPECT_EQ(options.at("guarantee"), yields ? "flip_free" : "bijective") << method;
    EXPECT_EQ(parse_options(options, kLimits).notes.empty(), yields) << method;
  }
}

TEST(Presets, PaperIsTenPlainIterationsOfOneChart) {
  const UnwrapOptions options = parse_options_text(R"({"preset":"paper"})", kLimits).unwrap;
  EXPECT_EQ(options.stop.iterations, 10);
  EXPECT_EQ(options.max_charts, 1);
  EXPECT_EQ(options.guarantee, Guarantee::none);
  EXPECT_FALSE(options.max_distortion.has_value());
  Limits small;
  small.max_iterations = 5;
  EXPECT_EQ(parse_options_text(R"({"preset":"paper"})", small).unwrap.stop.iterations, 5);
}

TEST(Presets, StoredOptionsOfEarlierVersionsKeepWhatTheyMeant) {
  const JobOptions options = parse_stored_options(Json::parse(R"({"method":"arap"})"));
  EXPECT_EQ(options.preset, Preset::chart);
  EXPECT_EQ(options.unwrap.guarantee, Guarantee::flip_free);
  EXPECT_FALSE(options.unwrap.max_distortion.has_value());
  EXPECT_EQ(options.asset.texcoord, (std::variant<int, TexcoordChoice>(0)));
}

TEST(Presets, StoredDracoStaysLosslessWhereItWas) {
  const auto bits = [](const char* stored) {
    return parse_stored_options(Json::parse(stored)).asset.draco_bits;
  };
  EXPECT_FALSE(bits(R"({"preset":"texture","compression":"draco"})"));
  EXPECT_FALSE(bits(R"({"compression":"draco"})"));
  const JobOptions now = parse_options_text(R"({"compression":"draco"})", kLimits);
  EXPECT_EQ(now.asset.draco_bits, 14);
  EXPECT_EQ(parse_stored_options(to_json(now)).asset.draco_bits, 14);
  EXPECT_FALSE(
      parse_options_text(R"({"compression":"draco","draco_bits":null})", kLimits).asset.draco_bits);
}

TEST(Presets, AreListedWithTheOptionsInWhichTheyDiffer) {
  const Json presets = methods_json(kLimits).at("presets");
  ASSERT_EQ(presets.size(), 4U);
  for (const Json& preset : presets) {
    Json options = preset.at("options");
    EXPECT_TRUE(options.contains("guarantee"));
    EXPECT_FALSE(options.contains("method"));
    options["preset"] = preset.at("name");
    EXPECT_EQ(to_json(parse_options(options, kLimits)),
              resolved(R"({"preset":")" + preset.at("name").get<std::string>() + R"("})"));
  }
}

}  // namespace
}  // namespace unwrapd::api
