// Where options come from, who wins, and what is said of a wrong one.
#include "server/config/config.hpp"

#include <gmock/gmock.h>
#include <stdlib.h>

#include <fstream>
#include <sstream>
#include <vector>

#include "server/config/config_row.hpp"
#include "tests/server/temp_dir.hpp"

namespace unwrapd::server::config {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

CommandLine parse(std::vector<const char*> flags) {
  flags.insert(flags.begin(), "unwrapd");
  return parse_command_line(static_cast<int>(flags.size()), flags.data());
}

/// What is said of a mistake.
std::string mistake(const std::vector<const char*>& flags) {
  testing::internal::CaptureStderr();
  const CommandLine line = parse(flags);
  EXPECT_EQ(line.task, Task::leave);
  EXPECT_EQ(line.exit_code, 2);
  return testing::internal::GetCapturedStderr();
}

/// What is printed by a question.
std::string answer(const std::vector<const char*>& flags) {
  testing::internal::CaptureStdout();
  const CommandLine line = parse(flags);
  EXPECT_EQ(line.task, Task::leave);
  EXPECT_EQ(line.exit_code, 0);
  return testing::internal::GetCapturedStdout();
}

/// An environment variable that is unset again.
class Environment {
 public:
  Environment(const char* name, const char* value) : name_(name) { ::setenv(name, value, 1); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;
  ~Environment() { ::unsetenv(name_); }

 private:
  const char* name_;
};

class ConfigFile : public testing::Test {
 protected:
  const char* write(const std::string& text) {
    std::ofstream(path_) << text;
    return path_.c_str();
  }

  TempDir dir_;
  std::string path_ = dir_.path() / "unwrapd.toml";
};

TEST(Config, FlagsSetEveryLimit) {
  const Config config =
      parse({"--listen", "0.0.0.0:99", "--data", "d", "--workers", "3", "--max-queue", "7",
             "--max-body-bytes", "5000", "--keep-seconds", "60", "--log-level", "error"})
          .config;
  EXPECT_EQ(config.listen, (http::Address{"0.0.0.0", 99}));
  EXPECT_EQ(config.data, "d");
  EXPECT_EQ(config.workers, 3);
  EXPECT_EQ(config.limits.max_queue, 7);
  EXPECT_EQ(config.limits.max_body_bytes, 5000);
  EXPECT_EQ(config.keep_seconds, 60);
  EXPECT_EQ(config.log_level, LogLevel::error);
}

TEST(Config, EveryMemberOfLimitsHasAFlag) {
  const api::Json limits = api::to_json(api::Limits{});
  for (const auto& member : limits.items()) {
    std::string flag = "--" + member.key();
    for (char& letter : flag) letter = letter == '_' ? '-' : letter;
    const CommandLine line = parse({flag.c_str(), "1234"});
    ASSERT_EQ(line.task, Task::serve) << flag;
    EXPECT_EQ(api::to_json(line.config.limits).at(member.key()), 1234) << flag;
  }
}

TEST(Config, ProbesAreOnLoopbackBesideTheServiceWhereNothingElseIsSaid) {
  EXPECT_EQ(parse({}).config.admin, (http::Address{"127.0.0.1", 8081}));
  EXPECT_EQ(parse({"--listen", "0.0.0.0:90"}).config.admin, (http::Address{"127.0.0.1", 91}));
  EXPECT_EQ(parse({"--listen", "[::1]:0"}).config.admin, (http::Address{"127.0.0.1", 0}));
  EXPECT_EQ(parse({"--admin-listen", "[::]:7"}).config.admin, (http::Address{"::", 7}));
  EXPECT_FALSE(parse({"--admin-listen", "off"}).config.admin);
  EXPECT_THAT(mistake({"--listen", "a:7", "--admin-listen", "a:7"}),
              HasSubstr("give each its own"));
}

TEST_F(ConfigFile, TheFlagWinsOverTheVariableAndThatOverTheFile) {
  const char* file = write("max-queue = 5\nmax-faces = 50\nworkers = 2\nlog-level = \"debug\"\n");
  const Environment queue("UNWRAPD_MAX_QUEUE", "9");
  const Environment faces("UNWRAPD_MAX_FACES", "90");
  const Config config = parse({"--config", file, "--max-queue", "8"}).config;
  EXPECT_EQ(config.limits.max_queue, 8);
  EXPECT_EQ(config.limits.max_faces, 90);
  EXPECT_EQ(config.workers, 2);
  EXPECT_EQ(config.log_level, LogLevel::debug);
  EXPECT_EQ(parse({}).config.limits.max_queue, 9);
  const Environment config_file("UNWRAPD_CONFIG", file);
  EXPECT_EQ(parse({}).config.workers, 2);
}

TEST_F(ConfigFile, WhatIsWrongIsNamedWithItsPlaceAndWhatWouldBeRight) {
  const auto wrong = [&](const std::string& text) { return mistake({"--config", write(text)}); };
  EXPECT_THAT(wrong("workers = 257\n"),
              AllOf(HasSubstr("unwrapd.toml: workers takes a whole number from 0 to 256"),
                    HasSubstr("\"257\"")));
  EXPECT_THAT(wrong("workers = 0\n"), HasSubstr("give --database and --blobs"));
  EXPECT_THAT(wrong("blobs = \"dir:/srv/unwrapd\"\n"), HasSubstr("give its URL, too"));
  EXPECT_THAT(wrong("blobs = \"/srv/unwrapd\"\n"), HasSubstr("dir: and the path of a directory"));
  EXPECT_THAT(wrong("\nmax-queue ="), HasSubstr("unwrapd.toml line 2"));
  EXPECT_THAT(wrong("max-que = 1"), HasSubstr("there is no option \"max-que\""));
  EXPECT_THAT(wrong("[workers]\nn = 1"), HasSubstr("workers must be text, a whole number"));
  EXPECT_THAT(wrong("workers = 1.5"), HasSubstr("workers must be text, a whole number"));
  EXPECT_THAT(wrong("data = [1]"), HasSubstr("data must be an array of text"));
  EXPECT_THAT(mistake({"--config", "/no/such/file"}), HasSubstr("/no/such/file"));
  EXPECT_THAT(mistake({"--config", "/tmp"}), HasSubstr("/tmp is a directory"));
  const Environment queue("UNWRAPD_MAX_QUEUE", "many");
  EXPECT_THAT(mistake({}),
              AllOf(HasSubstr("UNWRAPD_MAX_QUEUE: max-queue takes"), HasSubstr("not \"many\"")));
}

TEST(Config, AVariableThatThereIsNotIsAMistakeThatNamesTheNearest) {
  for (const auto& [name, nearest] : {std::pair{"UNWRAPD_MAX_QUEU", "UNWRAPD_MAX_QUEUE"},
                                      {"UNWRAPD_MAX_QEUUE", "UNWRAPD_MAX_QUEUE"},
                                      {"UNWRAPD_CONFIG_FILE", "UNWRAPD_CONFIG"},
                                      {"UNWRAPD_CORS_ORIGIN", "UNWRAPD_CORS_ORIGINS"},
                                      {"UNWRAPD_", "UNWRAPD_DATA"}}) {
    const Environment variable(name, "9");
    EXPECT_THAT(mistake({}), AllOf(HasSubstr(std::string("there is no variable ") + name + ";"),
                                   HasSubstr(std::string("did you mean ") + nearest + "?")));
  }
}

TEST(Config, VariablesOfOthersAreTheirs) {
  const Environment client("UNWRAPD_SERVER", "http://farm:8080");
  const Environment service("UNWRAPD_SERVICE_HOST", "10.0.0.1");
  const Environment port("UNWRAPD_PORT", "tcp://10.0.0.1:8080");
  const Environment linked("UNWRAPD_PORT_8080_TCP_ADDR", "10.0.0.1");
  const Environment ours("UNWRAPD_MAX_QUEUE", "9");
  EXPECT_EQ(parse({}).config.limits.max_queue, 9);
  const Environment mistaken("UNWRAPD_PORT", "8080");  // what somebody may well try
  EXPECT_THAT(mistake({}), HasSubstr("there is no variable UNWRAPD_PORT;"));
}

TEST(Config, MistakesEndTheProgram) {
  for (const std::vector<const char*>& flags :
       std::vector<std::vector<const char*>>{{"--listen", "8080"},
                                             {"--listen", "x:70000"},
                                             {"--listen", "x:-1"},
                                             {"--listen", "[]:1"},
                                             {"--workers", "0"},
                                             {"--workers", "-1"},
                                             {"--workers", "2x"},
                                             {"--workers", ""},
                                             {"--workers"},
                                             {"--max-queue", "many"},
                                             {"--max-queue", "99999999999999999999"},
                                             {"--log-level", "loud"},
                                             {"--cors-origins", "https://Example.com"},
                                             {"--cors-origins", "https://"},
                                             {"--cors-origins", "https://*.example.com"},
                                             {"--webhook-hosts", "*.*"},
                                             {"--webhook-hosts", "Example.com"},
                                             {"--webhook-hosts", "*."},
                                             {"--no-such-flag"},
                                             {"file.glb"}})
    EXPECT_NE(mistake(flags), "") << flags[0];
}

TEST(Config, IsolationIsASwitchThatMayHaveAValue) {
  EXPECT_EQ(parse({}).config.isolate, Isolate::automatic);
  EXPECT_EQ(parse({"--isolate", "--workers", "1"}).config.isolate, Isolate::on);
  for (const auto& [text, meaning] : Names<Isolate>{{"auto", Isolate::automatic},
                                                    {"on", Isolate::on},
                                                    {"true", Isolate::on},
                                                    {"off", Isolate::off},
                                                    {"false", Isolate::off}}) {
    EXPECT_EQ(parse({("--isolate=" + std::string(text)).c_str()}).config.isolate, meaning) << text;
    const std::string apart(text);
    EXPECT_EQ(parse({"--isolate", apart.c_str(), "--workers", "1"}).config.isolate, meaning)
        << text;
    const Environment variable("UNWRAPD_ISOLATE", std::string(text).c_str());
    EXPECT_EQ(parse({}).config.isolate, meaning) << text;
  }
  EXPECT_EQ(parse({"--isolate"}).config.isolate, Isolate::on);
  for (const std::vector<const char*>& flags :
       std::vector<std::vector<const char*>>{{"--isolate=maybe"}, {"--isolate", "maybe"}})
    EXPECT_THAT(mistake(flags), HasSubstr("auto, on, off"));
}

TEST(Config, QuestionsAreAnsweredAndEndTheProgramWithSuccess) {
  EXPECT_THAT(answer({"--help"}),
              AllOf(HasSubstr("--max-job-seconds"), HasSubstr("UNWRAPD_MAX_QUEUE"),
                    HasSubstr("--print-config")));
  EXPECT_THAT(answer({"--version"}), testing::StartsWith("unwrapd "));
}

/// The text without what follows "  # from " in each line.
std::string without_sources(const std::string& text) {
  std::istringstream lines(text);
  std::string kept;
  for (std::string line; std::getline(lines, line);)
    kept += line.substr(0, line.find("  # from ")) + "\n";
  return kept;
}

TEST(Config, TheDatabaseIsAUrlThatNobodyIsTold) {
  constexpr const char* url = "postgres://unwrapd:hush@db/unwrapd";
  EXPECT_EQ(parse({"--database", url}).config.database.url, url);
  EXPECT_TRUE(parse({}).config.database.url.empty());
  EXPECT_THAT(answer({"--database", url, "--print-config"}),
              AllOf(HasSubstr("database = \"********\""), Not(HasSubstr("hush"))));
  EXPECT_THAT(mistake({"--database", "hush.sqlite"}),
              AllOf(HasSubstr("postgres://"), Not(HasSubstr("hush"))));
}

TEST_F(ConfigFile, APrintedConfigReadAsAFileIsTheSameConfig) {
  const std::string odd = R"(a "b"\#c, d)";
  const std::string printed = answer({"--print-config", "--data", odd.c_str(), "--listen",
                                      "[::1]:0", "--admin-listen", "off", "--max-queue", "7"});
  EXPECT_THAT(printed, HasSubstr("max-queue = 7  # from --max-queue"));
  const char* file = write(printed);
  EXPECT_EQ(parse({"--config", file}).config.data, odd);
  EXPECT_EQ(without_sources(answer({"--print-config", "--config", file})),
            without_sources(printed));
}

TEST(Config, EveryOptionTellsItselfWithoutItsSecret) {
  for (const ConfigGroup& group : config_groups())
    for (const ConfigRow& row : group.rows) {
      Config config = parse({}).config;
      row.set(config, row.get(config));  // takes what it tells
      if (!row.heading.is_secret) continue;
      const std::string flag = "--" + std::string(row.heading.name);
      EXPECT_THAT(
          answer({"--print-config", flag.c_str(), "postgres://0123456789abcdef/0123456789"}),
          AllOf(HasSubstr("********"), Not(HasSubstr("0123456789"))));
    }
}

}  // namespace
}  // namespace unwrapd::server::config
