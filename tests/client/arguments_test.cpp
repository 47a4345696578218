#include "client/arguments.hpp"

#include <gmock/gmock.h>

#include <vector>

#include "api/options.hpp"
#include "client/outputs.hpp"
#include "tests/client/temporary_folder.hpp"

namespace unwrapd::client {
namespace {

using testing::HasSubstr, testing::Not;

std::variant<Arguments, Message> parse(std::vector<const char*> words) {
  words.insert(words.begin(), "unwrap");
  return parse_arguments(static_cast<int>(words.size()), words.data());
}

Arguments accepted(const std::vector<const char*>& words) {
  const auto parsed = parse(words);
  if (const auto* message = std::get_if<Message>(&parsed)) {
    ADD_FAILURE() << message->text;
    return {};
  }
  return std::get<Arguments>(parsed);
}

Message refused(const std::vector<const char*>& words) {
  const auto parsed = parse(words);
  if (std::holds_alternative<Arguments>(parsed)) {
    ADD_FAILURE() << "accepted";
    return {};
  }
  return std::get<Message>(parsed);
}

TEST(Arguments, AResultIsWrittenBesideTheFileWhenNoNameIsGiven) {
  EXPECT_EQ(accepted({"a/chair.glb"}).out, "a/chair.uv.glb");
  EXPECT_EQ(accepted({"a/chair.gltf", "--output", "obj"}).out, "a/chair.uv.obj");
  EXPECT_EQ(accepted({"chair.obj", "--output", "auto"}).out, "chair.uv.obj");
  EXPECT_EQ(accepted({"a/chair.stl"}).out, "a/chair.uv.glb");
  EXPECT_EQ(accepted({"chair.PLY", "--output", "auto"}).out, "chair.uv.glb");
  EXPECT_EQ(accepted({"chair.off", "--output", "obj"}).out, "chair.uv.obj");
  EXPECT_EQ(accepted({"https://a.b/c/chair.glb?token=[1]#top"}).out, "chair.uv.glb");
  EXPECT_EQ(accepted({"https://a.b/chair.zip"}).options.at("output"), "glb");
  EXPECT_THAT(refused({"https://a.b/"}).text, HasSubstr("name the result by --out"));
  EXPECT_EQ(accepted({"https://a.b/", "-o", "chair.glb"}).file, "https://a.b/");
  EXPECT_EQ(accepted({"chair.zip"}).out, "chair.uv.glb");
  EXPECT_EQ(accepted({"chair.zip"}).options.at("output"), "glb");
}

TEST(Arguments, AResultIsAGlbWhereTheInputsNameDoesNotTellItsFormat) {
  for (const char* file : {"chair.txt", "chair"}) {
    EXPECT_EQ(accepted({file}).out, "chair.uv.glb");
    EXPECT_EQ(accepted({file}).options.at("output"), "glb");
    EXPECT_EQ(accepted({file, "--output", "obj"}).out, "chair.uv.obj");
    EXPECT_EQ(accepted({file, "-o", "b.obj"}).options.at("output"), "obj");
  }
}

TEST(Arguments, CompareTakesTwoMeshesAndWritesAPage) {
  const Arguments arguments = accepted({"compare", "a.glb", "b.glb", "-o", "both.html"});
  EXPECT_TRUE(arguments.compares);
  EXPECT_THAT(arguments.inputs, testing::ElementsAre("a.glb", "b.glb"));
  EXPECT_EQ(arguments.options.at("measure_only"), "true");
  EXPECT_EQ(accepted({"compare", "a.glb", "b.glb"}).out, "");
  EXPECT_EQ(accepted({"compare"}).file, "compare");  // a mesh of that name
  for (const std::vector<const char*>& wrong : {std::vector{"compare", "a.glb"},
                                                {"compare", "a.glb", "b.glb", "c.glb"},
                                                {"compare", "a.glb", "b.glb", "-o", "b.glb"},
                                                {"compare", "a.glb", "b.glb", "--watch"}})
    EXPECT_EQ(refused(wrong).code, ExitCode::usage);
}

TEST(Arguments, ADashIsStandardInputAndOutput) {
  EXPECT_EQ(accepted({"-"}).file, "-");
  EXPECT_EQ(accepted({"-"}).out, "-");
  EXPECT_EQ(accepted({"/dev/null"}).out, "-");
  EXPECT_EQ(accepted({"-", "-o", "b.glb"}).out, "b.glb");
  EXPECT_EQ(accepted({"a.obj", "-o", "-"}).options.count("output"), 0);
  EXPECT_EQ(accepted({"a.zip", "-o", "-"}).options.at("output"), "glb");
  EXPECT_EQ(accepted({"-", "-o", "-", "--output", "glb"}).options.at("output"), "glb");
  EXPECT_EQ(accepted({"a.obj", "--report", "-"}).report, "-");
}

TEST(Arguments, PicturesHaveNamesAndTheLayoutAColour) {
  const Arguments arguments =
      accepted({"a.glb", "--layout", "l.png", "--layout-colour", "area", "--preview", "p.png"});
  EXPECT_EQ(arguments.layout, "l.png");
  EXPECT_EQ(arguments.layout_colour, "area");
  EXPECT_EQ(arguments.preview, "p.png");
  EXPECT_EQ(accepted({"a.glb"}).layout_colour, "");
  EXPECT_EQ(refused({"a.glb", "--layout-colour", "size"}).code, ExitCode::usage);
}

TEST(Arguments, TemplatesAndViewsAreAskedForByTheirPaths) {
  const Arguments arguments =
      accepted({"a.glb", "--template", "t.PNG", "--preview", "p.png", "--preview-view", "30,20"});
  EXPECT_EQ(template_of(arguments), "/layout.png?size=page&wireframe=1&background=none");
  EXPECT_EQ(preview_of(arguments), "/preview.png?view=30,20");
  EXPECT_EQ(template_of(accepted({"a.glb", "--template", "t.svg"})),
            "/layout.svg?page=1&wireframe=1&background=none");
  EXPECT_EQ(preview_of(accepted({"a.glb"})), "/preview.png");
}

TEST(Arguments, APictureIsNotWrittenUnderTheNameOfAnotherFormat) {
  for (const char* flag : {"--layout", "--template"})
    EXPECT_THAT(refused({"a.glb", flag, "x.jpg"}).text,
                HasSubstr(std::string(flag) + ": .jpg is not written; name a .png or .svg."));
  EXPECT_THAT(refused({"a.glb", "--preview", "x.svg"}).text,
              HasSubstr("--preview: .svg is not written; name a .png."));
  EXPECT_THAT(refused({"--sample", "x.obj"}).text, HasSubstr("name a .glb."));
  EXPECT_THAT(refused({"a.glb", "-o", "x.jpg"}).text, HasSubstr("name a .glb, .gltf or .obj."));
  EXPECT_EQ(layout_of(accepted({"a.glb", "--layout", "-"})), "/layout.svg");
  EXPECT_EQ(layout_of(accepted({"a.glb", "--layout", "x.PNG"})), "/layout.png");
}

TEST(Arguments, AColourOrAViewNeedsThePictureThatItChanges) {
  EXPECT_THAT(refused({"a.glb", "--preview-view", "top"}).text, HasSubstr("picture of --preview;"));
  EXPECT_THAT(refused({"a.glb", "--layout-colour", "area"}).text,
              HasSubstr("picture of --layout;"));
  EXPECT_EQ(refused({"compare", "a.glb", "b.glb", "--preview-view", "top"}).code, ExitCode::usage);
  const Arguments page =
      accepted({"compare", "a.glb", "b.glb", "-o", "both.html", "--preview-view", "top"});
  EXPECT_EQ(preview_of(page), "/preview.png?view=top");
}

TEST(Arguments, AJobHasANameIfOneIsGiven) {
  EXPECT_EQ(accepted({"a.glb", "--name", "Chair 7"}).name, "Chair 7");
  EXPECT_EQ(accepted({"a.glb"}).name, "");
}

TEST(Arguments, TheFormatFollowsTheResultsName) {
  EXPECT_EQ(accepted({"a.obj", "-o", "b.glb"}).options.at("output"), "glb");
  EXPECT_EQ(accepted({"a.obj", "-o", "b.bin"}).options.count("output"), 0);
  EXPECT_EQ(accepted({"a.obj", "-o", "b.bin", "--output", "gltf"}).options.at("output"), "gltf");
  EXPECT_EQ(accepted({"a.obj", "-o", "b.glb", "--output", "auto"}).options.at("output"), "glb");
  EXPECT_THAT(refused({"a.obj", "-o", "b.glb", "--output", "gltf"}).text,
              HasSubstr("b.glb names another format than --output gltf"));
}

TEST(Arguments, AResultIsNotWrittenUnderTheNameOfAnotherFormat) {
  for (const char* out :
       {"b.stl", "b.STL", "b.ply", "b.off", "b.fbx", "b.usdz", "b.3mf", "b.blend"})
    for (const std::vector<const char*>& words :
         {std::vector<const char*>{"a.obj", "-o", out}, {"a.stl", "-o", out, "--output", "obj"}}) {
      const Message message = refused(words);
      EXPECT_EQ(message.code, ExitCode::usage);
      EXPECT_THAT(message.text, HasSubstr("is not written"));
    }
  EXPECT_THAT(refused({"a.stl", "-o", "b.stl"}).text, HasSubstr("no place for UVs"));
  EXPECT_EQ(accepted({"a.stl", "-o", "b.OBJ"}).options.at("output"), "obj");
}

TEST(Arguments, EveryOptionOfTheApiIsAFlag) {
  const std::string help = refused({"--help"}).text;
  for (const api::OptionRow& row : api::option_table()) {
    std::string flag = "--" + std::string(row.name);
    std::ranges::replace(flag, '_', '-');
    std::ranges::replace(flag, '.', '-');
    EXPECT_THAT(help, HasSubstr(flag + " "));
    if (row.type == api::OptionType::objects) continue;
    if (row.type == api::OptionType::flag) {
      EXPECT_EQ(accepted({"a.glb", flag.c_str()}).options.at(std::string(row.name)), "true");
      continue;
    }
    const api::Json value = api::option_default(row, {});
    const std::string text = value.is_null()     ? "16"
                             : value.is_string() ? value.get<std::string>()
                                                 : value.dump();
    EXPECT_EQ(accepted({"a.glb", flag.c_str(), text.c_str()}).options.at(std::string(row.name)),
              text);
  }
}

TEST(Arguments, HelpTellsRangesAsTheyAreTyped) {
  const std::string help = refused({"--help"}).text;
  for (const char* range :
       {"--stop-max-iterations INT >= 1\n", "--stop-tolerance NUMBER in [1e-12, 0.1]",
        "--lambda NUMBER[,NUMBER...] >= 0\n", "INT in [16, 16384]", "--constraints FILE.json",
        "--weld-distance NUMBER in [0, 1e+100]|none", "asap|arap|hybrid|abf",
        "--texcoord INT in [0, 7]|auto|free", "1000000]|none", "--seam-avoid NAME|none"})
    EXPECT_THAT(help, HasSubstr(range));
}

TEST(Arguments, ConstraintsAreReadFromAFileAndCheckedWithTheirPlace) {
  const TemporaryFolder folder;
  const std::string good = R"([{"vertex":1,"uv":[0,1]}])";
  const std::string file = folder.write("pins.json", good);
  EXPECT_EQ(accepted({"a.glb", "--constraints", file.c_str()}).options.at("constraints"), good);
  const std::string bad = folder.write("bad.json", R"([{"vertex":1,"uv":[0]}])");
  const Message message = refused({"a.glb", "--constraints", bad.c_str()});
  EXPECT_EQ(message.code, ExitCode::usage);
  EXPECT_THAT(message.text, HasSubstr("/constraints/0/uv"));
  EXPECT_EQ(refused({"a.glb", "--constraints", "none.json"}).code, ExitCode::file);
}

TEST(Arguments, AListOfLambdasIsOneOnlyWithTheMethodHybrid) {
  const std::vector<std::string> three = {"1", "0.01", "1e-1"};
  EXPECT_EQ(accepted({"a.glb", "--method", "hybrid", "--lambda", "1,0.01,1e-1"}).lambdas, three);
  EXPECT_TRUE(accepted({"a.glb", "--lambda", "1,0.01"}).lambdas.empty());
  EXPECT_TRUE(accepted({"a.glb", "--method", "hybrid", "--lambda", "1"}).lambdas.empty());
  EXPECT_EQ(refused({"a.glb", "--method", "hybrid", "--lambda", "1,1"}).code, ExitCode::usage);
}

TEST(Arguments, AreCheckedBeforeAnythingIsSent) {
  for (const std::vector<const char*>& words :
       {std::vector<const char*>{"a.glb", "--method", "magic"},
        {"a.glb", "--lambda", "-1"},
        {"a.glb", "--lambda", "nan"},
        {"a.glb", "--stop-iterations", "0"},
        {"a.glb", "--stop-iterations", "2.5"},
        {"a.glb", "--resolution", "1e9"},
        {"a.glb", "--timeout", "-1"},
        {"a.glb", "--timeout", "nan"},
        {"a.glb", "--server", "ftp://x"},
        {"--methd", "arap"},
        {"a.glb", "--lambda"},
        {}}) {
    const Message message = refused(words);
    EXPECT_EQ(message.code, ExitCode::usage) << message.text;
    EXPECT_THAT(message.text, HasSubstr("--help"));
  }
  EXPECT_THAT(refused({"a.glb", "--preset", "chart", "--preset", "paper"}).text,
              HasSubstr("--preset is given several times; give it once."));
  EXPECT_THAT(refused({"a.glb", "--lambda-units", "si"}).text, HasSubstr("--lambda-units"));
}

TEST(Arguments, LeaveTheServersOwnLimitsToTheServer) {
  EXPECT_EQ(accepted({"a.glb", "--stop-iterations", "1000000"}).options.at("stop.iterations"),
            "1000000");
}

TEST(Arguments, HelpTellsTheExitCodes) {
  const Message help = refused({"--help"});
  EXPECT_EQ(help.code, ExitCode::ok);
  for (const char* code : {"    0  ", "    1  ", "    2  ", "    3  ", "    4  ", "  130  "})
    EXPECT_THAT(help.text, HasSubstr(code));
}

TEST(Arguments, TheServerComesFromTheEnvironmentUnlessGiven) {
  setenv("UNWRAPD_SERVER", "http://farm:99", 1);
  EXPECT_EQ(accepted({"a.glb"}).servers.front().origin, "http://farm:99");
  EXPECT_EQ(accepted({"a.glb", "--server", "here:1"}).servers.front().origin, "http://here:1");
  EXPECT_EQ(accepted({"a.glb", "--server", "here:1,there:2"}).servers.back().origin,
            "http://there:2");
  EXPECT_EQ(accepted({"a.glb"}).place, Place::server);
  EXPECT_EQ(accepted({"a.glb", "--local"}).place, Place::here);
  unsetenv("UNWRAPD_SERVER");
  EXPECT_EQ(accepted({"a.glb"}).servers.front().origin, "http://127.0.0.1:8080");
  EXPECT_EQ(accepted({"a.glb"}).place, Place::any);
}

TEST(Arguments, SeveralMeshesOrAFolderAreABatch) {
  const TemporaryFolder folder;
  folder.write("a.obj", "x");
  EXPECT_EQ(accepted({"a.glb"}).file, "a.glb");
  EXPECT_TRUE(accepted({"a.glb"}).inputs.empty());
  EXPECT_EQ(accepted({"a.glb", "b.glb", "-o", "out", "-j", "3"}).inputs.size(), 2U);
  EXPECT_EQ(accepted({"a.glb", "b.glb", "-j", "3"}).jobs, 3);
  EXPECT_EQ(accepted({"a.glb", "b.glb"}).jobs, 0);
  const std::string all = folder.file("").string(), one = folder.file("a.obj").string();
  EXPECT_EQ(accepted({all.c_str()}).inputs.size(), 1U);
  EXPECT_EQ(accepted({"*.glb"}).inputs.size(), 1U);
  EXPECT_EQ(accepted({"a.glb", "--resume"}).inputs.size(), 1U);
  for (const char* flag : {"--report", "--layout", "--template", "--preview"})
    EXPECT_THAT(refused({"a.glb", "b.glb", flag, "x.png"}).text, HasSubstr(flag));
  for (const char* out : {one.c_str(), "-", "new.obj"})
    EXPECT_THAT(refused({"a.glb", "b.glb", "-o", out}).text, HasSubstr("--out"));
  EXPECT_EQ(accepted({std::string(5000, 'a').c_str()}).inputs.size(), 0U);
  for (const char* other : {"b.glb", "--resume"})
    EXPECT_THAT(refused({"a.glb", other, "--method", "hybrid", "--lambda", "1,2"}).text,
                HasSubstr("--lambda"));
  refused({"a.glb", "b.glb", "-j", "0"});
}

TEST(Arguments, AMistypedFlagIsAnsweredWithTheOneThatIsMeant) {
  EXPECT_THAT(refused({"a.glb", "--metod", "arap"}).text, HasSubstr("did you mean --method?"));
  EXPECT_THAT(refused({"a.glb", "--max-chart=3"}).text, HasSubstr("did you mean --max-charts?"));
  EXPECT_THAT(refused({"a.glb", "--nothing-like-it"}).text, Not(HasSubstr("did you mean")));
}

TEST(Arguments, ASampleNeedsNoFile) {
  EXPECT_EQ(accepted({"--sample", "shell.glb"}).sample, "shell.glb");
}

}  // namespace
}  // namespace unwrapd::client
