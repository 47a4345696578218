// What the log says of errors.
#include "server/base/errors.hpp"

#include <gmock/gmock.h>

#include <new>
#include <system_error>

namespace unwrapd::server {
namespace {

using testing::HasSubstr;

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

}  // namespace
}  // namespace unwrapd::server
