#include "server/private_server.hpp"

#include <gtest/gtest.h>
#include <httplib.h>

#include <cstdlib>
#include <filesystem>

#include "core/base/error.hpp"
#include "tests/server/temp_dir.hpp"

namespace unwrapd::server {
namespace {

int status(httplib::Client& client, const std::string& key) {
  client.set_bearer_token_auth(key);
  const httplib::Result answer = client.Get("/v1/jobs");
  return answer ? answer->status : 0;
}

TEST(PrivateServer, AnswersOnlyWhoHasItsKeyAndLeavesNothing) {
  const TempDir temporary;
  ::setenv("TMPDIR", temporary.path().c_str(), 1);
  {
    const PrivateServer first, second;
    EXPECT_NE(first.url(), second.url());
    httplib::Client client(first.url());
    EXPECT_EQ(client.Get("/v1/jobs")->status, 401);
    EXPECT_EQ(status(client, second.key()), 401);
    EXPECT_EQ(status(client, first.key()), 200);
    int folders = 0;
    for (const auto& entry : std::filesystem::directory_iterator(temporary.path())) {
      EXPECT_EQ(entry.status().permissions(), std::filesystem::perms::owner_all) << entry;
      ++folders;
    }
    EXPECT_EQ(folders, 2);
  }
  EXPECT_TRUE(std::filesystem::is_empty(temporary.path()));
  ::unsetenv("TMPDIR");
}

TEST(PrivateServer, SaysWhereItCannotMakeItsFolder) {
  ::setenv("TMPDIR", "/proc/self", 1);
  try {
    const PrivateServer server;
    FAIL() << "it runs at " << server.url();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("TMPDIR"), std::string::npos);
  }
  ::unsetenv("TMPDIR");
}

}  // namespace
}  // namespace unwrapd::server
