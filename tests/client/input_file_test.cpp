// What is read from a pipe is sent like a file.
#include "client/input_file.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <thread>

#include "client/files.hpp"
#include "tests/client/expect_failure.hpp"
#include "tests/client/temporary_folder.hpp"

namespace unwrapd::client {
namespace {

/// A pipe in place of standard input, as long as it exists.
class PipedInput {
 public:
  explicit PipedInput(const std::string& bytes) : before_(dup(STDIN_FILENO)) {
    std::array<int, 2> ends{};
    EXPECT_EQ(pipe(ends.data()), 0);
    dup2(ends[0], STDIN_FILENO);
    close(ends[0]);
    writer_ = std::jthread([bytes, end = ends[1]] {
      EXPECT_EQ(write(end, bytes.data(), bytes.size()), std::ssize(bytes));
      close(end);
    });
  }
  PipedInput(const PipedInput&) = delete;
  PipedInput& operator=(const PipedInput&) = delete;
  ~PipedInput() {
    dup2(before_, STDIN_FILENO);
    close(before_);
  }

 private:
  int before_;
  std::jthread writer_;
};

TEST(InputFile, IsTheFileItselfWhereItHasASize) {
  const TemporaryFolder folder;
  const auto path = folder.write("a.obj", "v 0 0 0\n");
  EXPECT_EQ(InputFile(path, {}).path(), path);
  expect_failure(ExitCode::file, [&] { InputFile(folder.file("none.obj"), {}); });
  expect_failure(ExitCode::file, [&] { InputFile(folder.file(""), {}); });
}

TEST(InputFile, OfStandardInputHasAllOfItsBytesAndIsRemoved) {
  const std::string bytes(300'000, 'x');
  for (const char* name : {"-", "/dev/stdin"}) {
    const PipedInput piped(bytes);
    std::filesystem::path path;
    {
      const InputFile input(name, {});
      path = input.path();
      EXPECT_EQ(read_file(path), bytes) << name;
    }
    EXPECT_FALSE(std::filesystem::exists(path));
  }
}

TEST(InputFile, OfAPipeWithANameWaitsForItsWriter) {
  const TemporaryFolder folder;
  const auto pipe = folder.file("a.obj");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const std::jthread writer([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
    std::ofstream(pipe) << "bytes";
  });
  EXPECT_EQ(read_file(InputFile(pipe, {}).path()), "bytes");
}

TEST(InputFile, ThatIsEmptyIsRefused) {
  const PipedInput piped("");
  const std::string message = expect_failure(ExitCode::file, [] { InputFile("-", {}); });
  EXPECT_NE(message.find("Standard input is empty"), std::string::npos);
}

TEST(InputFile, ThatNobodyWritesEndsWithTheStop) {
  const TemporaryFolder folder;
  const auto pipe = folder.file("a.obj");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::stop_source stop;
  const std::jthread stopper([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    stop.request_stop();
  });
  expect_failure(ExitCode::interrupted, [&] { InputFile(pipe, stop.get_token()); });
}

}  // namespace
}  // namespace unwrapd::client
