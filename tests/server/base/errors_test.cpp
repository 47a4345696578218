// What the log says of errors.
#include "server/base/errors.hpp"

#include <gmock/gmock.h>

#include <new>
#include <string>
#include <system_error>
#include <utility>
#include <variant>

#include "api/json.hpp"
#include "server/http/http.hpp"

namespace unwrapd::server {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

TEST(ReasonOfAnError, NamesTheLimitOfTheProcessThatIsTooSmall) {
  const std::system_error no_thread(
      std::make_error_code(std::errc::resource_unavailable_try_again));
  EXPECT_THAT(reason_of(no_thread), AllOf(HasSubstr("ulimit -v"), HasSubstr("ulimit -u")));
  EXPECT_THAT(reason_of(std::bad_alloc()), HasSubstr("ulimit -v"));
}

TEST(ReasonOfAnError, IsItsOwnTextElse) {
  EXPECT_EQ(reason_of(InsideError(ErrorCode::internal, "told", "why")), "why");
  EXPECT_EQ(reason_of(Error(ErrorCode::internal, "told")), "told");
}

TEST(AStoreThatIsAway, IsUnavailableForClientsAndHasAReasonForTheLog) {
  const StoreAway away(StorePart::database, "refused by db.example", true);
  EXPECT_THAT(reason_of(away), HasSubstr("refused by db.example"));
  const http::Response response = http::error_response(away);
  EXPECT_EQ(response.status, 503);
  const std::string body = std::get<std::string>(response.body);
  EXPECT_EQ(api::Json::parse(body).at("status"), 503);
  EXPECT_THAT(body, AllOf(HasSubstr("storage_failed"), Not(HasSubstr("db.example"))));
  EXPECT_THAT(response.headers, Contains(std::pair<std::string, std::string>("Retry-After", "2")));
  EXPECT_EQ(http::error_response(Error(ErrorCode::storage_failed, "told")).status, 500);
}

}  // namespace
}  // namespace unwrapd::server
