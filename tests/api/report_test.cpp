#include "api/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "api/result.hpp"
#include "contract_text.hpp"
#include "error_of.hpp"

namespace unwrapd::api {
namespace {

using testing::ElementsAreArray;
using testing::UnorderedElementsAreArray;

std::vector<std::string> member_names(const Json& object) {
  std::vector<std::string> names;
  for (const auto& [name, value] : object.items()) names.push_back(name);
  return names;
}

/// One chart and one repair of every kind, so that every member is there.
Report sample() {
  Report report;
  report.charts.resize(1);
  report.charts[0].energy = {3, 2, 1};
  report.repairs = {Repair{RepairKind::cut_to_disk, 0, 2}};
  report.curve = {CurvePoint{0.1, 0.5, {}, 7}};
  report.notes = {{NoteCode::distorted, "core's own"}};
  return report;
}

void expect_members(const Json& object, const char* schema) {
  EXPECT_THAT(list({"components", "schemas", schema}, "required"),
              ElementsAreArray(member_names(object)));
  EXPECT_THAT(keys({"components", "schemas", schema, "properties"}),
              ElementsAreArray(member_names(object)));
}

TEST(Report, HasExactlyTheMembersOfTheContract) {
  const Json json = to_json(sample(), {});
  EXPECT_THAT(list({"components", "schemas", "Report"}, "required"),
              ElementsAreArray(member_names(json)));
  EXPECT_THAT(keys({"components", "schemas", "Report", "properties"}),
              UnorderedElementsAreArray(
                  member_names(to_json(sample(), {.vertex_maps = std::vector<VertexMap>{}}))));
  expect_members(json.at("input"), "InputReport");
  expect_members(json.at("repairs").at(0), "Repair");
  expect_members(json.at("charts").at(0), "ChartReport");
  expect_members(json.at("charts").at(0).at("mending"), "Mending");
  expect_members(json.at("curve").at(0), "CurvePoint");
  expect_members(json.at("distortion"), "Distortion");
  expect_members(json.at("timings_ms"), "Timings");
  expect_members(totals_json(sample(), {}), "Totals");
  expect_members(json.at("notes").at(0), "Note");
}

TEST(Report, NamesItsKindsAsTheContractDoes) {
  std::vector<std::string> kinds;
  std::vector<std::string> reasons;
  Report report = sample();
  for (int i = 0; i <= static_cast<int>(RepairKind::faces_turned); ++i) {
    report.repairs[0].kind = static_cast<RepairKind>(i);
    kinds.push_back(to_json(report, {}).at("repairs").at(0).at("kind"));
  }
  for (int i = 0; i <= static_cast<int>(FileRepairKind::shared_nodes_kept); ++i) {
    const Json json = to_json(report, {.file_repairs = {{static_cast<FileRepairKind>(i), 3}}});
    expect_members(json.at("repairs").at(0), "Repair");
    EXPECT_EQ(json.at("repairs").at(0).at("count"), 3);
    EXPECT_EQ(json.at("repairs").size(), 2U);
    kinds.push_back(json.at("repairs").at(0).at("kind"));
  }
  for (int i = 0; i <= static_cast<int>(StopReason::neighbour); ++i) {
    report.charts[0].stop_reason = static_cast<StopReason>(i);
    reasons.push_back(to_json(report, {}).at("charts").at(0).at("stop_reason"));
  }
  EXPECT_EQ(list({"components", "schemas", "Repair", "properties", "kind"}, "enum"), kinds);
  EXPECT_EQ(list({"components", "schemas", "ChartReport", "properties", "stop_reason"}, "enum"),
            reasons);
}

TEST(Report, NamesTheCodesOfNotesAsTheContractDoes) {
  const std::vector<std::string> prose = section({"components", "schemas", "NoteCode"});
  std::vector<std::string> told, own;
  for (const std::string& line : prose)
    if (const auto begin = line.find("- `"); begin != std::string::npos)
      told.push_back(line.substr(begin + 3, line.find('`', begin + 3) - begin - 3));
  for (int i = 0; i <= static_cast<int>(NoteCode::nodes_stretch); ++i) {
    Report report;
    report.notes = {{static_cast<NoteCode>(i), "why"}};
    own.push_back(to_json(report, {}).at("notes").at(0).at("code"));
  }
  EXPECT_EQ(told, own);
}

TEST(Report, TellsOverlapsOnlyWhereTheyWereCounted) {
  Report report = sample();
  EXPECT_TRUE(to_json(report, {}).at("charts").at(0).at("overlaps").is_null());
  report.charts[0].overlaps = 0;
  EXPECT_EQ(to_json(report, {}).at("charts").at(0).at("overlaps"), 0);
}

TEST(Report, TellsWhatTheGuaranteeTookOfEveryChart) {
  Report report = sample();
  report.guarantee = Guarantee::bijective;
  report.charts[0].mending = {3, 5, 0.25, true, 2};
  const Json json = to_json(report, {});
  EXPECT_EQ(json.at("guarantee"), "bijective");
  EXPECT_EQ(json.at("charts").at(0).at("mending"), (Json{{"flips", 3},
                                                         {"overlaps", 5},
                                                         {"energy_rise", 0.25},
                                                         {"virtual_boundary", true},
                                                         {"parts", 2}}));
}

TEST(Report, GivesTheCurveInItsOrder) {
  Report report;
  for (const double lambda : {1.0, 0.01, 0.1}) report.curve.push_back({lambda, 2 * lambda, {}, 4});
  const Json curve = to_json(report, {}).at("curve");
  ASSERT_EQ(curve.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(curve.at(k).at("lambda"), report.curve[k].lambda);
    EXPECT_EQ(curve.at(k).at("energy"), report.curve[k].energy);
  }
}

TEST(Report, JoinsTheNotesOfCoreAndOfTheOptions) {
  const Note own{NoteCode::option_unused, "the options'"};
  const ReportContext context{.notes = {own, own}};
  EXPECT_EQ(to_json(sample(), context).at("notes"),
            (Json::array({{{"code", "distorted"}, {"text", "core's own"}},
                          {{"code", "option_unused"}, {"text", "the options'"}},
                          {{"code", "option_unused"}, {"text", "the options'"}}})));
  EXPECT_EQ(totals_json(sample(), context).at("notes"),
            (Json::array({"distorted", "option_unused"})));
  EXPECT_TRUE(to_json(Report{}, {}).at("notes").is_array());
}

TEST(Report, HasItsNotesReadBack) {
  const ReportContext context{.notes = {{NoteCode::option_unused, "the \"notes\": []"}}};
  Json json = to_json(sample(), context);
  json["input"]["notes"] = "of another";
  const std::vector<Note> notes = notes_of_report(json.dump());
  ASSERT_EQ(notes.size(), 2U);
  for (std::size_t k = 0; k < notes.size(); ++k) EXPECT_EQ(to_json(notes[k]), json["notes"][k]);
  EXPECT_TRUE(notes_of_report(to_json(Report{}, {}).dump()).empty());
  for (const char* none : {"", "{", "[]", "{}", R"({"notes":1})", R"({"notes":["text"]})",
                           R"({"notes":[{"code":"unheard_of","text":""}]})"})
    EXPECT_EQ(error_of([&] { notes_of_report(none); }).code(), ErrorCode::storage_corrupt) << none;
}

TEST(Report, WritesNoFigureThatJsonCannotHold) {
  const double infinity = std::numeric_limits<double>::infinity();
  Report report = sample();
  report.charts[0].energy = {infinity, std::nan(""), -infinity};
  report.distortion = {infinity, infinity, std::nan(""), 1};
  report.fill = report.seam_length = report.texel_density = infinity;
  report.charts[0].overlaps = report.overlaps = 0;  // null where they were not counted
  const Json json = to_json(report, {.timings_ms = {{"solve", infinity}}});
  const std::string text = json.dump();
  EXPECT_EQ(text.find("null"), std::string::npos);
  EXPECT_EQ(Json::parse(text), json);
}

TEST(Report, FiguresReadBackAsTheSameDoubles) {
  std::mt19937_64 rng(21);
  Report report = sample();
  report.charts[0].energy.clear();
  while (report.charts[0].energy.size() < 2000) {
    const double value = std::bit_cast<double>(rng());
    if (std::isfinite(value)) report.charts[0].energy.push_back(value);
  }
  const Json json = Json::parse(to_json(report, {}).dump());
  const std::vector<double> energy = json.at("charts").at(0).at("energy");
  EXPECT_EQ(energy, report.charts[0].energy);
}

TEST(Result, GivesTheMeshesInlineToTheLastBit) {
  std::mt19937 rng(22);
  std::normal_distribution<double> any(0, 1e3);
  std::vector<Surface> surfaces(2);
  std::vector<UnwrappedSurface> unwrapped(2);
  surfaces[0].name = "/meshes/0";
  surfaces[1].name = "quoted \" and \n broken";
  for (std::size_t i = 0; i < 2; ++i) {
    for (int k = 0; k < 50; ++k) surfaces[i].mesh.positions.emplace_back(any(rng), any(rng), k);
    unwrapped[i].source = {3, 1, 2, 3};
    unwrapped[i].faces = {{0, 1, 2}, {1, 2, 3}};
    for (int k = 0; k < 4; ++k) unwrapped[i].uv.emplace_back(any(rng), any(rng));
  }
  const Json json = Json::parse(result_json({{"fill", 0.5}}, surfaces, unwrapped));
  EXPECT_EQ(json.at("report"), (Json{{"fill", 0.5}}));
  ASSERT_EQ(json.at("meshes").size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const Json& mesh = json.at("meshes").at(i);
    EXPECT_EQ(mesh.at("name"), surfaces[i].name);
    EXPECT_EQ(mesh.at("faces"), (Json{0, 1, 2, 1, 2, 3}));
    EXPECT_EQ(mesh.at("vertex_map"), (Json{3, 1, 2, 3}));
    for (std::size_t v = 0; v < 4; ++v) {
      const auto source = static_cast<std::size_t>(unwrapped[i].source[v]);
      for (Eigen::Index c = 0; c < 3; ++c) {
        EXPECT_EQ(mesh.at("positions").at(3 * v + static_cast<std::size_t>(c)),
                  surfaces[i].mesh.positions[source](c));
      }
      EXPECT_EQ(mesh.at("uv").at(2 * v), unwrapped[i].uv[v].x());
      EXPECT_EQ(mesh.at("uv").at(2 * v + 1), unwrapped[i].uv[v].y());
    }
  }
}

TEST(Result, OfNothingIsStillADocument) {
  const Json json = Json::parse(result_json(Json::object(), {}, {}));
  EXPECT_EQ(json, (Json{{"report", Json::object()}, {"meshes", Json::array()}}));
  const std::vector<Surface> surfaces(1);
  const std::vector<UnwrappedSurface> unwrapped(1);
  EXPECT_EQ(Json::parse(result_json({}, surfaces, unwrapped)).at("meshes").at(0).at("uv"),
            Json::array());
}

}  // namespace
}  // namespace unwrapd::api
