// Debian's libcpp-httplib is not built for ThreadSanitizer. It keeps strings and sets in statics
// inside its functions, and the sanitizer, which does not see it read their guards, takes a first
// use on one thread and a second on another for a race. So every test process first makes one
// exchange of each kind in memory, on its main thread, which comes before all others.
#include <gtest/gtest.h>
#include <httplib.h>

#include <string>

namespace unwrapd::server {
namespace {

class LibraryStatics final : public testing::Environment, private httplib::Server {
 public:
  void SetUp() override {
    svr_sock_ = 0;  // or it takes itself for shut down and writes no chunks
    Get("/text", [](const httplib::Request&, httplib::Response& response) {
      response.set_content("text", "text/plain");
    });
    Get("/chunks", [](const httplib::Request&, httplib::Response& response) {
      response.set_chunked_content_provider("text/plain", [](std::size_t, auto& sink) {
        sink.write("chunk", 5);
        sink.done();
        return true;
      });
    });
    Post("/text", [](const httplib::Request&, httplib::Response&, const auto& read) {
      read([](const char*, std::size_t) { return true; });
    });
    for (const char* request :
         {"GET /text HTTP/1.1\r\nHost: x\r\n\r\n", "GET /chunks?a=b HTTP/1.1\r\nHost: x\r\n\r\n",
          "GET /text HTTP/1.1\r\nHost: x\r\nRange: bytes=0-1\r\n\r\n",
          "POST /text HTTP/1.1\r\nHost: x\r\nContent-Length: 1\r\n\r\nx",
          "POST /text HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: "
          "chunked\r\n\r\n1\r\nx\r\n0\r\n\r\n"})
      exchange(request);
    svr_sock_ = INVALID_SOCKET;
  }

 private:
  void exchange(const std::string& request) {
    httplib::detail::BufferStream stream;
    stream.write(request.data(), request.size());
    bool closed = false;
    process_request(stream, true, closed, [](httplib::Request&) {});
    EXPECT_NE(stream.get_buffer().find("HTTP/1.1 20"), std::string::npos) << request;
    const bool chunks = request.starts_with("GET /chunks");
    EXPECT_TRUE(!chunks || stream.get_buffer().ends_with("0\r\n\r\n")) << stream.get_buffer();
  }
};

const testing::Environment* const kStatics =
    testing::AddGlobalTestEnvironment(new LibraryStatics);  // which gtest owns

}  // namespace
}  // namespace unwrapd::server
