// The routes of a running server are the operations of openapi.yaml, no more and no fewer.
#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>
#include <set>
#include <string>

#include "api/openapi.hpp"
#include "tests/server/running_server.hpp"

namespace unwrapd::server::routes {
namespace {

/// "GET /v1/jobs" of each operation. The other keys of a path describe all operations of it.
std::set<std::string> documented_routes() {
  const api::Json contract = api::Json::parse(api::openapi_json());
  std::set<std::string> routes;
  for (const auto& [path, item] : contract.at("paths").items())
    for (const auto& [key, operation] : item.items()) {
      if (!operation.is_object() || !operation.contains("responses")) continue;
      std::string method = key;
      std::ranges::transform(method, method.begin(),
                             [](unsigned char c) { return std::toupper(c); });
      routes.insert(method + " " + path);
    }
  return routes;
}

TEST_F(RunningServer, HasTheRoutesOfTheContractAndNoOthers) {
  start();
  std::set<std::string> served;
  for (const http::Route& route : service_->routes()) {
    const std::string name = std::string(route.method) + " " + std::string(route.path);
    EXPECT_TRUE(served.insert(name).second) << name << " is served twice";
  }
  EXPECT_THAT(served, testing::ContainerEq(documented_routes()));
}

}  // namespace
}  // namespace unwrapd::server::routes
