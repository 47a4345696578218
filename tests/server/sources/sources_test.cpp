// Sources by TLS, and what the metrics tell of them; tests/access tries all else on the whole
// server.
#include "server/sources/sources.hpp"

#include <gmock/gmock.h>

#include <cstdlib>
#include <optional>
#include <string>
#include <thread>

#include "tests/api/error_of.hpp"
#include "tests/server/http_server_fixture.hpp"

namespace unwrapd::server::sources {
namespace {

using testing::HasSubstr;

class SourcesByTls : public testing::Test {
 protected:
  SourcesByTls() {
    write_certificate(certificate_, key_);
    files_.emplace(certificate_.c_str(), key_.c_str());
    files_->Get("/x.glb", [](const httplib::Request&, httplib::Response& answer) {
      answer.set_content("bytes of a mesh", "model/gltf-binary");
    });
    port_ = files_->bind_to_any_port("127.0.0.1");
    serving_ = std::jthread([this] { files_->listen_after_bind(); });
    while (!files_->is_running()) std::this_thread::yield();
  }
  ~SourcesByTls() override {
    ::unsetenv("SSL_CERT_FILE");
    files_->stop();
  }

  std::string read(const std::string& path) {
    std::string all;
    const std::string address = "https://localhost:" + std::to_string(port_) + path;
    sources_.open(address, {.owner = "", .draining = {}})->read([&](std::string_view bytes) {
      all += bytes;
    });
    return all;
  }

  TempDir dir_;
  const std::string certificate_ = dir_.path() / "cert.pem", key_ = dir_.path() / "key.pem";
  const Log log_{LogLevel::off};
  Metrics metrics_;
  Sources sources_{{.allowed_hosts = {"localhost"}, .allow_private = true}, 100, log_, metrics_};
  std::optional<httplib::SSLServer> files_;
  int port_ = 0;
  std::jthread serving_;
};

TEST_F(SourcesByTls, NeedACertificateThatTheSystemTrusts) {
  const Error error = error_of([&] { read("/x.glb"); });
  EXPECT_EQ(error.code(), ErrorCode::source_failed);
  EXPECT_THAT(error.what(), HasSubstr("certificate"));
  ::setenv("SSL_CERT_FILE", certificate_.c_str(), 1);
  EXPECT_EQ(read("/x.glb"), "bytes of a mesh");
}

TEST_F(SourcesByTls, AreCountedByTheirOutcomes) {
  ::setenv("SSL_CERT_FILE", certificate_.c_str(), 1);
  read("/x.glb");
  EXPECT_EQ(error_of([&] { read("/none.glb"); }).code(), ErrorCode::source_failed);
  const std::string text = metrics_.text();
  EXPECT_THAT(text, HasSubstr("unwrapd_sources_total{outcome=\"read\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("unwrapd_sources_total{outcome=\"source_failed\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("unwrapd_source_bytes_total 15\n"));
}

TEST_F(SourcesByTls, EndWithWhatTheirReaderThrows) {
  ::setenv("SSL_CERT_FILE", certificate_.c_str(), 1);
  const auto body = sources_.open("https://localhost:" + std::to_string(port_) + "/x.glb",
                                  {.owner = "", .draining = {}});
  EXPECT_EQ(
      error_of([&] {
        body->read([](std::string_view) { throw Error(ErrorCode::quota_exceeded, "no room"); });
      }).code(),
      ErrorCode::quota_exceeded);
}

}  // namespace
}  // namespace unwrapd::server::sources
