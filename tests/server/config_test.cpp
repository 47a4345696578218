#include "server/config.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <vector>

namespace unwrapd::server {
namespace {

CommandLine parse(std::vector<const char*> flags) {
  flags.insert(flags.begin(), "unwrapd");
  return parse_command_line(static_cast<int>(flags.size()), flags.data());
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

TEST(Config, FlagsSetEveryLimit) {
  const CommandLine line =
      parse({"--listen", "0.0.0.0:99", "--data", "d", "--workers", "3", "--max-queue", "7",
             "--max-body-bytes", "5000", "--keep-seconds", "60", "--log-level", "error"});
  ASSERT_TRUE(line.config);
  EXPECT_EQ(line.config->host, "0.0.0.0");
  EXPECT_EQ(line.config->port, 99);
  EXPECT_EQ(line.config->data, "d");
  EXPECT_EQ(line.config->workers, 3);
  EXPECT_EQ(line.config->limits.max_queue, 7);
  EXPECT_EQ(line.config->limits.max_body_bytes, 5000);
  EXPECT_EQ(line.config->keep_seconds, 60);
  EXPECT_EQ(line.config->log_level, LogLevel::error);
}

TEST(Config, EveryMemberOfLimitsHasAFlag) {
  const api::Json limits = api::to_json(api::Limits{});
  for (const auto& member : limits.items()) {
    std::string flag = "--" + member.key();
    for (char& letter : flag) letter = letter == '_' ? '-' : letter;
    const CommandLine line = parse({flag.c_str(), "1234"});
    ASSERT_TRUE(line.config) << flag;
    EXPECT_EQ(api::to_json(line.config->limits).at(member.key()), 1234) << flag;
  }
}

TEST(Config, TheEnvironmentCountsAndTheFlagWins) {
  const Environment queue("UNWRAPD_MAX_QUEUE", "9");
  const Environment listen("UNWRAPD_LISTEN", "[::1]:0");
  EXPECT_EQ(parse({}).config->limits.max_queue, 9);
  EXPECT_EQ(parse({}).config->host, "::1");
  EXPECT_EQ(parse({"--max-queue", "8"}).config->limits.max_queue, 8);
}

TEST(Config, MistakesEndTheProgramAndQuestionsDoSoWithSuccess) {
  testing::internal::CaptureStderr();
  for (const std::vector<const char*>& wrong :
       std::vector<std::vector<const char*>>{{"--listen", "8080"},
                                             {"--listen", "x:70000"},
                                             {"--listen", "x:-1"},
                                             {"--workers", "0"},
                                             {"--max-queue", "many"},
                                             {"--log-level", "loud"},
                                             {"--no-such-flag"},
                                             {"file.glb"}}) {
    const CommandLine line = parse(wrong);
    EXPECT_FALSE(line.config) << wrong[0];
    EXPECT_NE(line.exit_code, 0) << wrong[0];
  }
  EXPECT_NE(testing::internal::GetCapturedStderr(), "");
  testing::internal::CaptureStdout();
  for (const char* question : {"--help", "--version"}) {
    const CommandLine line = parse({question});
    EXPECT_FALSE(line.config);
    EXPECT_EQ(line.exit_code, 0);
  }
  const std::string told = testing::internal::GetCapturedStdout();
  EXPECT_NE(told.find("--max-job-seconds"), std::string::npos);
  EXPECT_NE(told.find("UNWRAPD_MAX_QUEUE"), std::string::npos);
}

}  // namespace
}  // namespace unwrapd::server
