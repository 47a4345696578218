// What the server says when it cannot start: which file or option, why, and what to do.
#include <gmock/gmock.h>
#include <openssl/evp.h>
#include <openssl/pem.h>

#include <fstream>

#include "http_server_fixture.hpp"
#include "running_server.hpp"
#include "server/base/files.hpp"
#include "tests/api/error_of.hpp"

namespace unwrapd::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class Start : public RunningServer {
 protected:
  std::string refusal() {
    return error_of([this] { start(); }).what();
  }
};

TEST_F(Start, ADataDirectoryThatCannotBeUsedIsNamedWithTheReason) {
  make_directories(dir_.path() / "lock");
  EXPECT_THAT(refusal(), AllOf(HasSubstr((dir_.path() / "lock").string()),
                               HasSubstr("Is a directory"), Not(HasSubstr("other unwrapd"))));
  write_file(dir_.path() / "file", "");
  config_.data = dir_.path() / "file" / "data";
  EXPECT_THAT(refusal(), AllOf(HasSubstr(config_.data.string()), HasSubstr("Not a directory")));
}

TEST_F(Start, ADatabaseThatIsBrokenIsNamedAndNotToBeTriedAgainLater) {
  for (const char* name : {"jobs.sqlite", "keys.sqlite"}) {
    TempDir dir;
    config_.data = dir.path();
    write_file(dir.path() / name, std::string(10'000, 'x'));
    EXPECT_THAT(refusal(), AllOf(HasSubstr(name), HasSubstr("not a database"), HasSubstr("copy"),
                                 Not(HasSubstr("later"))));
  }
}

TEST_F(Start, AnAddressInUseIsThatOfItsOption) {
  start();
  const int taken = service_->port();
  const TempDir dir;
  config::Config other = config_;
  other.data = dir.path();
  other.admin = http::Address{"127.0.0.1", taken};
  const auto start_other = [&] { const Service service(other, log_); };
  EXPECT_THAT(error_of(start_other).what(), HasSubstr("another --admin-listen."));
  other.listen = {"127.0.0.1", taken};
  EXPECT_THAT(error_of(start_other).what(), HasSubstr("another --listen."));
}

TEST_F(Start, ACertificateThatCannotBeReadIsNamedWithTheReason) {
  config_.edge.tls_cert = dir_.path() / "cert.pem";
  config_.edge.tls_key = dir_.path() / "key.pem";
  EXPECT_THAT(refusal(), AllOf(HasSubstr("cert.pem"), HasSubstr("No such file")));
  write_certificate(config_.edge.tls_cert, config_.edge.tls_key);
  std::filesystem::remove(config_.edge.tls_key);
  EXPECT_THAT(refusal(), AllOf(HasSubstr("key.pem"), HasSubstr("No such file")));
}

TEST_F(Start, NobodyIsAskedForThePassPhraseOfAKey) {
  config_.edge.tls_cert = dir_.path() / "cert.pem";
  config_.edge.tls_key = dir_.path() / "key.pem";
  write_certificate(config_.edge.tls_cert, config_.edge.tls_key);
  const auto close = [](std::FILE* file) { std::fclose(file); };
  const std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)> key(EVP_EC_gen("P-256"), EVP_PKEY_free);
  {
    const std::unique_ptr<std::FILE, decltype(close)> to(
        std::fopen(config_.edge.tls_key.c_str(), "w"), close);
    std::string phrase = "phrase";
    PEM_write_PrivateKey(to.get(), key.get(), EVP_aes_256_cbc(), nullptr, 0, nullptr,
                         phrase.data());
  }
  EXPECT_THAT(refusal(), AllOf(HasSubstr("key.pem"), HasSubstr("encrypted")));
}

}  // namespace
}  // namespace unwrapd::server
