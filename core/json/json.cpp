// A document is built from the parser's events rather than by nlohmann's own builder: that one lets
// duplicate names win silently, looks each name up in linear time and copies whole subtrees
// whenever an ordered object grows. Here values wait on a stack until their container is complete.
#include "core/json/json.hpp"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <deque>
#include <iterator>
#include <unordered_set>
#include <utility>
#include <vector>

#include "core/base/cancel.hpp"

namespace unwrapd::json {
namespace {

constexpr std::size_t kFewNames = 16;  // up to here comparing all pairs beats hashing

/// Receives the parser's events; document() is the result once parsing has succeeded.
class Builder : public nlohmann::json_sax<Json> {
 public:
  Builder(const Policy& policy, const std::stop_token& stop) : policy_(policy), stop_(stop) {}

  bool null() override { return push(nullptr); }
  bool boolean(bool value) override { return push(value); }
  bool number_integer(number_integer_t value) override { return push(value); }
  bool number_unsigned(number_unsigned_t value) override { return push(value); }
  bool number_float(number_float_t value, const string_t& /*text*/) override { return push(value); }
  bool string(string_t& value) override { return push(std::move(value)); }
  bool binary(binary_t& /*value*/) override { return false; }
  bool start_object(std::size_t /*size*/) override { return open(false); }
  bool start_array(std::size_t /*size*/) override { return open(true); }

  bool key(string_t& name) override {
    count();
    Frame& frame = frames_.back();
    if (names_.size() - frame.first_name >= policy_.max_members)
      refuse(Fault::too_many_members, policy_.max_members);
    names_.push_back(std::move(name));
    if (is_repeated(frame)) refuse(Fault::repeated_name);
    return true;
  }

  bool end_object() override {
    const Frame& frame = frames_.back();
    Json::object_t object;
    object.reserve(values_.size() - frame.first_value);
    using Members = Json::object_t::Container;  // its own emplace() searches all names again
    for (std::size_t i = frame.first_value, k = frame.first_name; i < values_.size(); ++i, ++k)
      static_cast<Members&>(object).emplace_back(std::move(names_[k]), std::move(values_[i]));
    return close(std::move(object));
  }

  bool end_array() override {
    Json::array_t array;
    array.assign(
        std::make_move_iterator(values_.begin() + std::ptrdiff_t(frames_.back().first_value)),
        std::make_move_iterator(values_.end()));
    return close(std::move(array));
  }

  bool parse_error(std::size_t byte, const std::string& /*token*/,
                   const nlohmann::detail::exception& cause) override {
    constexpr int kNumberOutOfRange = 406;  // of the library's list of exceptions
    refuse(cause.id == kNumberOutOfRange ? Fault::number_range : Fault::syntax, byte);
  }

  Json document() {
    assert(values_.size() == 1 && frames_.empty());
    return std::move(values_.front());
  }

 private:
  /// A container that is not complete yet.
  struct Frame {
    bool is_array;
    std::size_t first_value;
    std::size_t first_name;
    std::unordered_set<std::string_view> seen = {};  ///< its names, once they are more than a few
  };

  /// Whether the newest name of the object was there before.
  bool is_repeated(Frame& frame) const {
    const auto begin = names_.begin() + std::ptrdiff_t(frame.first_name);
    const auto newest = names_.end() - 1;
    const auto before = static_cast<std::size_t>(newest - begin);
    if (before < kFewNames) return std::find(begin, newest, *newest) != newest;
    if (before == kFewNames) frame.seen.insert(begin, newest);
    return !frame.seen.insert(*newest).second;
  }

  void count() {
    check_cancelled_every(++count_, stop_);
    if (count_ > policy_.max_values) refuse(Fault::too_many_values, policy_.max_values);
  }

  bool push(Json value) {
    count();
    values_.push_back(std::move(value));
    return true;
  }

  bool open(bool is_array) {
    if (frames_.size() >= policy_.max_depth) refuse(Fault::too_deep, policy_.max_depth);
    frames_.push_back({is_array, values_.size(), names_.size()});
    return true;
  }

  bool close(Json container) {
    values_.resize(frames_.back().first_value);
    names_.resize(frames_.back().first_name);
    frames_.pop_back();
    return push(std::move(container));
  }

  [[noreturn]] void refuse(Fault fault, std::size_t figure = 0) const {
    throw policy_.error({fault, figure, names_.empty() ? std::string() : names_.back(), pointer()});
  }

  [[nodiscard]] std::string pointer() const {
    std::string text;
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      const bool innermost = i + 1 == frames_.size();
      const std::size_t values = innermost ? values_.size() : frames_[i + 1].first_value;
      const std::size_t names = innermost ? names_.size() : frames_[i + 1].first_name;
      if (frames_[i].is_array)
        text += "/" + std::to_string(values - frames_[i].first_value);
      else if (names > frames_[i].first_name)
        text += "/" + pointer_token(names_[names - 1]);
    }
    return text;
  }

  const Policy& policy_;
  const std::stop_token& stop_;
  std::size_t count_ = 0;
  std::deque<Json> values_;        // not a vector: that one takes thrice its size while it grows
  std::deque<std::string> names_;  // keeps its strings in place, to which `seen` refers
  std::vector<Frame> frames_;
};

/// The text's characters; at every so many of them it is asked whether the job was told to stop.
class WatchedText {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  WatchedText(const char* at, const std::stop_token& stop) : at_(at), stop_(&stop) {}

  const char& operator*() const { return *at_; }
  WatchedText& operator++() {
    if (reinterpret_cast<std::uintptr_t>(++at_) % 65'536 == 0) throw_if_cancelled(*stop_);
    return *this;
  }
  bool operator==(const WatchedText& other) const { return at_ == other.at_; }

 private:
  const char* at_;
  const std::stop_token* stop_;
};

}  // namespace

Json read(std::string_view text, const Policy& policy, const std::stop_token& stop) {
  if (text.size() > policy.max_bytes) throw policy.error({Fault::too_long, policy.max_bytes});
  if (policy.max_tree_bytes < Policy::kUnbounded) {
    const std::size_t bytes = tree_bytes(text, stop);
    if (bytes > policy.max_tree_bytes) throw policy.error({Fault::too_dense, bytes});
  }
  Builder builder(policy, stop);
  Json::sax_parse(WatchedText(text.data(), stop), WatchedText(text.data() + text.size(), stop),
                  &builder);
  return builder.document();
}

std::string pointer_token(std::string_view text) {
  std::string token;
  for (const char c : text) token += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return token;
}

}  // namespace unwrapd::json
