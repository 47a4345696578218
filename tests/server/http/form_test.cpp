// The reader of multipart/form-data: against a second way to read the same bytes, in pieces of any
// size, and with heads that cost httplib's regular expressions minutes.
#include "server/http/form.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <random>
#include <vector>

#include "core/base/error.hpp"

namespace unwrapd::server::http {
namespace {

struct ReadPart {
  std::string name;
  std::string filename;
  std::string bytes;
  bool operator==(const ReadPart&) const = default;
};

/// The parts of a body that comes in pieces of up to this size; the code of what is thrown.
std::vector<ReadPart> read_form(std::string_view body, std::size_t longest,
                                std::mt19937::result_type seed = 1) {
  std::vector<ReadPart> parts;
  FormParser form(
      "b",
      [&](const Part& part) {
        parts.push_back({part.name, part.filename, {}});
      },
      [&](std::string_view bytes) { parts.back().bytes.append(bytes); });
  std::mt19937 random(seed);
  while (!body.empty()) {
    const std::size_t size = std::min<std::size_t>(1 + random() % longest, body.size());
    form.feed(body.substr(0, size));
    body.remove_prefix(size);
  }
  form.finish();
  return parts;
}

std::optional<ErrorCode> form_refusal(std::string_view body) {
  try {
    read_form(body, 1000);
  } catch (const Error& error) {
    return error.code();
  }
  return std::nullopt;
}

std::string disposed(const std::string& disposition, const std::string& bytes = "x") {
  return "--b\r\nContent-Disposition: " + disposition + "\r\n\r\n" + bytes + "\r\n";
}

/// Bytes that look like delimiters as often as they can.
std::string tricky_bytes(std::mt19937& random) {
  constexpr std::string_view pieces[] = {"\r",   "\n",     "-", "b",       "--b-",
                                         "\r\n", "\r\n--", "x", "\r\n--a", "\r\n\r\n"};
  std::string bytes;
  for (auto left = random() % 40; left > 0; --left) bytes += pieces[random() % std::size(pieces)];
  while (bytes.find("\r\n--b") != std::string::npos) bytes.erase(bytes.find("\r\n--b"), 1);
  return bytes;
}

TEST(Form, GivesThePartsThatWereWrittenHoweverTheBytesAreCut) {
  std::mt19937 random(7);
  for (int k = 0; k < 300; ++k) {
    std::vector<ReadPart> parts;
    std::string body = k % 3 == 0 ? "a preamble\r\n" : "";
    for (auto left = random() % 4; left > 0; --left) {
      const std::string name(1 + random() % 3, 'n');
      const std::string file(random() % 3, 'f');
      parts.push_back({name, file, tricky_bytes(random)});
      body += "--b" + std::string(random() % 2, ' ') +
              "\r\nX: y\r\ncontent-disposition:form-data;" +
              (file.empty() ? "" : "FileName=\"" + file + "\" ; ") + "name=\"" + name +
              "\"\r\n\r\n" + parts.back().bytes + "\r\n";
    }
    body += "--b--\r\nafter it \r\n--b\r\n";
    for (const std::size_t longest : {1U, 3U, 17U, 100'000U})
      ASSERT_EQ(read_form(body, longest, random()), parts) << testing::PrintToString(body);
  }
}

TEST(Form, ReadsDispositionsAsBrowsersAndProgramsWriteThem) {
  const auto read = [](std::string_view text) { return part_of_disposition(text); };
  EXPECT_EQ(read(" form-data; name=\"mesh\"; filename=\"a;b.obj\"").filename, "a;b.obj");
  EXPECT_EQ(read("Form-Data;NAME=mesh;filename=a.obj").filename, "a.obj");
  EXPECT_EQ(read("form-data; name=\"a\\\"b\\\\c\\d\"").name, "a\"b\\c\\d");
  EXPECT_EQ(read("form-data; filename=\"x\"; filename*=UTF-8''y; name=\"n\";").filename, "x");
  for (const char* wrong :
       {"", "form-data", "attachment; name=\"a\"", "form-data; name=\"a", "form-data name=\"a\"",
        "form-data; name=\"a\"; name=\"b\"", "form-data; name", "form-data; =\"a\"",
        "form-data; name=\"a\" filename=\"b\"", "form-data; name=\"a\x01\"",
        "form-data; filename=\"a\""})
    EXPECT_THROW(read(wrong), Error) << wrong;
}

TEST(Form, RefusesWhatIsNoForm) {
  const std::string part = disposed("form-data; name=\"mesh\"");
  for (const std::string& body : std::vector<std::string>{
           "", "--b", "--b\r\n", "--bc\r\n", part, "--b\r\n\r\nx\r\n--b--",
           "--b\r\nX: y\r\n\r\nx\r\n--b--",
           "--b\r\nContent-Disposition: form-data; name=\"a\"\r\n" + part.substr(5) + "--b--",
           "--b" + std::string(10'000, ' ')})
    EXPECT_EQ(form_refusal(body), ErrorCode::malformed_request) << body.substr(0, 80);
  EXPECT_EQ(form_refusal("--b\r\n" + std::string(10'000, 'h')), ErrorCode::headers_too_large);
  EXPECT_EQ(form_refusal(disposed("form-data; name=\"" + std::string(9000, 'a') + "\"") + "--b--"),
            ErrorCode::headers_too_large);
  const auto ignore = [](const auto&) {};
  EXPECT_THROW(FormParser("", ignore, ignore), Error);
  EXPECT_THROW(FormParser(std::string(71, 'b'), ignore, ignore), Error);
}

}  // namespace
}  // namespace unwrapd::server::http
