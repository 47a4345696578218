#include "client/figures.hpp"

#include <gtest/gtest.h>

#include "tests/client/expect_failure.hpp"

namespace unwrapd::client {
namespace {

constexpr const char* kReport =
    R"({"input":{"faces":12},"charts":[{},{}],"seam_ratio":1.5,"fill":0.5,"overlaps":null,"notes":[)"
    R"({"code":"overlaps","text":"two"}],"distortion":{"angle":2.1,"area":2.2,"flipped":3}})";

TEST(Figures, AreThoseOfTheReport) {
  const Figures figures = read_figures(kReport);
  EXPECT_EQ(figures.faces, 12);
  EXPECT_EQ(figures.charts, 2U);
  EXPECT_EQ(figures.angle, 2.1);
  EXPECT_EQ(figures.area, 2.2);
  EXPECT_EQ(figures.flipped, 3);
  EXPECT_FALSE(figures.overlaps.has_value());
  EXPECT_EQ(figures.seam_ratio, 1.5);
  EXPECT_EQ(figures.fill, 0.5);
  EXPECT_EQ(figures.notes, std::vector<std::string>{"note (overlaps): two"});
}

TEST(Figures, OfAnotherVersionOrNoReportAreRefused) {
  for (const char* text : {"", "{}", "[]", R"({"charts":[]})"})
    expect_failure(ExitCode::unreachable, [&] { read_figures(text); });
}

}  // namespace
}  // namespace unwrapd::client
