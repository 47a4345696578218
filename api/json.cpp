// Strict reading in two passes: the first looks at every member name, the depth and the range of
// numbers, the second, by the library alone, makes the value. The library's default, the last
// duplicate wins, would let two readers of one request disagree; its parser with a callback does
// both in one pass, but in time quadratic in the length of an array.
#include "api/json.hpp"

#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "core/base/error.hpp"

namespace unwrapd::api {
namespace {

/// Where the parser stands: for each open object its member names so far and the current one, for
/// each open array the index of the current entry.
class Path {
 public:
  void open(bool is_array) { levels_.push_back({.is_array = is_array}); }
  void close() { levels_.pop_back(); }
  [[nodiscard]] int depth() const { return static_cast<int>(levels_.size()); }

  /// The object's next member, of at most so many.
  void enter(const std::string& name, std::size_t max_members) {
    Level& level = levels_.back();
    if (level.seen.size() >= max_members)
      throw Error(ErrorCode::malformed_request,
                  "An object of the JSON has too many members: send at most " +
                      std::to_string(max_members) + ".",
                  pointer());
    level.current = name;
    if (level.seen.insert(name).second) return;
    throw Error(ErrorCode::invalid_option, "\"" + name + "\" is given twice; give it once.",
                pointer());
  }

  /// A value is complete; in an array the next one follows.
  void leave() {
    if (!levels_.empty() && levels_.back().is_array) ++levels_.back().index;
  }

  [[nodiscard]] std::string pointer() const {
    std::string text;
    for (const Level& level : levels_) {
      if (level.is_array) text += "/" + std::to_string(level.index);
      if (!level.current.empty()) text += "/" + pointer_token(level.current);
    }
    return text;
  }

 private:
  struct Level {
    bool is_array = false;
    std::size_t index = 0;
    std::set<std::string> seen = {};
    std::string current = {};
  };
  std::vector<Level> levels_;
};

/// The first pass. Throws what parse_json() throws.
class Checker : public nlohmann::json_sax<Json> {
 public:
  explicit Checker(const JsonLimits& limits) : limits_(limits) {}

  bool null() override { return leave(); }
  bool boolean(bool) override { return leave(); }
  bool number_integer(number_integer_t) override { return leave(); }
  bool number_unsigned(number_unsigned_t) override { return leave(); }
  bool number_float(number_float_t, const string_t&) override { return leave(); }
  bool string(string_t&) override { return leave(); }
  bool binary(binary_t&) override { return leave(); }
  bool start_object(std::size_t) override { return open(false); }
  bool start_array(std::size_t) override { return open(true); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    count();
    path_.enter(name, limits_.max_members);
    return true;
  }
  bool parse_error(std::size_t byte, const std::string&, const Json::exception& error) override {
    if (error.id == kNumberOutOfRange)
      throw Error(ErrorCode::invalid_option, "A number is out of range: give a finite one.",
                  path_.pointer());
    throw Error(ErrorCode::malformed_request,
                "The text is not valid JSON: correct it at byte " + std::to_string(byte) + ".",
                "byte " + std::to_string(byte));
  }

 private:
  static constexpr int kNumberOutOfRange = 406;  // of the library's list of exceptions

  void count() {
    if (++count_ > limits_.max_values)
      throw Error(ErrorCode::malformed_request, "The JSON has too many values: send at most " +
                                                    std::to_string(limits_.max_values) + ".");
  }
  bool leave() {
    count();
    path_.leave();
    return true;
  }
  bool open(bool is_array) {
    if (path_.depth() >= limits_.max_depth)
      throw Error(ErrorCode::malformed_request, "The JSON is nested too deeply: use at most " +
                                                    std::to_string(limits_.max_depth) + " levels.");
    path_.open(is_array);
    return true;
  }
  bool close() {
    path_.close();
    return leave();
  }

  const JsonLimits& limits_;
  std::size_t count_ = 0;
  Path path_;
};

}  // namespace

Json parse_json(std::string_view text, const JsonLimits& limits) {
  if (text.size() > limits.max_bytes) {
    throw Error(ErrorCode::malformed_request, "The JSON is too long: send at most " +
                                                  std::to_string(limits.max_bytes) + " bytes.");
  }
  Checker checker(limits);
  Json::sax_parse(text, &checker);
  return Json::parse(text);
}

double finite(double value) {
  if (std::isfinite(value)) return value;
  const double largest = std::numeric_limits<double>::max();
  return value < 0 ? -largest : largest;
}

std::string pointer_token(std::string_view text) {
  std::string token;
  for (const char c : text) {
    if (c == '~') {
      token += "~0";
    } else if (c == '/') {
      token += "~1";
    } else {
      token += c;
    }
  }
  return token;
}

}  // namespace unwrapd::api
