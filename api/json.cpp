// Strict reading on top of nlohmann's callback parser: the callback sees every member name before
// its value is kept, so duplicates and depth are refused while the text is read. The library's own
// default, the last duplicate wins, would let two readers of one request disagree.
#include "api/json.hpp"

#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "core/error.hpp"

namespace unwrapd::api {
namespace {

/// Where the parser stands: for each open object its member names so far and the current one.
class Path {
 public:
  void open() { levels_.emplace_back(); }
  void close() { levels_.pop_back(); }

  void enter(const std::string& name) {
    Level& level = levels_.back();
    level.current = name;
    if (level.seen.insert(name).second) return;
    throw Error(ErrorCode::invalid_option, "\"" + name + "\" is given twice: give it once.",
                pointer());
  }

  [[nodiscard]] std::string pointer() const {
    std::string text;
    for (const Level& level : levels_) {
      if (!level.current.empty()) text += "/" + pointer_token(level.current);
    }
    return text;
  }

 private:
  struct Level {
    std::set<std::string> seen;
    std::string current;
  };
  std::vector<Level> levels_;
};

void check_depth(int depth, int max_depth) {
  if (depth < max_depth) return;
  throw Error(ErrorCode::malformed_request, "The JSON is nested too deeply: use at most " +
                                                std::to_string(max_depth) + " levels.");
}

Json parse_tracked(std::string_view text, int max_depth, Path& path) {
  using Event = Json::parse_event_t;
  const auto track = [&](int depth, Event event, Json& parsed) {
    if (event == Event::object_start || event == Event::array_start) check_depth(depth, max_depth);
    if (event == Event::object_start) path.open();
    if (event == Event::object_end) path.close();
    if (event == Event::key) path.enter(parsed.get_ref<const std::string&>());
    return true;
  };
  return Json::parse(text, track);
}

}  // namespace

Json parse_json(std::string_view text, const JsonLimits& limits) {
  if (text.size() > limits.max_bytes) {
    throw Error(ErrorCode::malformed_request, "The JSON is too long: send at most " +
                                                  std::to_string(limits.max_bytes) + " bytes.");
  }
  Path path;
  try {
    return parse_tracked(text, limits.max_depth, path);
  } catch (const Json::parse_error& e) {
    throw Error(ErrorCode::malformed_request,
                "The text is not valid JSON: correct it at byte " + std::to_string(e.byte) + ".",
                "byte " + std::to_string(e.byte));
  } catch (const Json::out_of_range&) {
    throw Error(ErrorCode::invalid_option, "A number is out of range: give a finite one.",
                path.pointer());
  }
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
