// A document is built from the parser's events rather than by nlohmann's own builder: that one lets
// duplicate names win silently, looks each name up in linear time and copies whole subtrees
// whenever an ordered object grows. Here values wait on a stack until their container is complete.
#include "core/asset/json.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <deque>
#include <iterator>
#include <unordered_set>
#include <utility>
#include <vector>

#include "core/base/cancel.hpp"

namespace unwrapd::asset {
namespace {

constexpr std::size_t kMaxDepth = 128;
constexpr std::size_t kFewNames = 16;  // up to here comparing all pairs beats hashing
constexpr double kMaxNumber = 9007199254740992.0;

using Names = std::deque<std::string>;

bool has_duplicates(Names::const_iterator begin, Names::const_iterator end) {
  const auto count = static_cast<std::size_t>(end - begin);
  if (count <= kFewNames) {
    for (auto name = begin; name != end; ++name)
      if (std::find(begin, name, *name) != name) return true;
    return false;
  }
  const std::unordered_set<std::string_view> seen(begin, end);
  return seen.size() < count;
}

/// Receives the parser's events; document() is the result once parsing has succeeded.
class Builder : public nlohmann::json_sax<Json> {
 public:
  explicit Builder(const std::stop_token& stop) : stop_(stop) {}

  bool null() override { return push(nullptr); }
  bool boolean(bool value) override { return push(value); }
  bool number_integer(number_integer_t value) override { return push(value); }
  bool number_unsigned(number_unsigned_t value) override { return push(value); }
  bool number_float(number_float_t value, const string_t& /*text*/) override { return push(value); }
  bool string(string_t& value) override { return push(std::move(value)); }
  bool binary(binary_t& /*value*/) override { return false; }
  bool start_object(std::size_t /*size*/) override { return open(); }
  bool start_array(std::size_t /*size*/) override { return open(); }

  bool key(string_t& name) override {
    check_cancelled_every(++steps_, stop_);
    names_.push_back(std::move(name));
    return true;
  }

  bool end_object() override {
    const Frame frame = frames_.back();
    Json::object_t object;
    object.reserve(values_.size() - frame.first_value);
    if (has_duplicates(names_.cbegin() + std::ptrdiff_t(frame.first_name), names_.cend()))
      throw Error(ErrorCode::malformed_json,
                  "an object of the document has the same name twice; keep one of them");
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
                   const nlohmann::detail::exception& /*cause*/) override {
    throw Error(ErrorCode::malformed_json,
                "the document is not valid JSON in UTF-8; repair or export it again",
                "byte " + std::to_string(byte));
  }

  Json document() {
    assert(values_.size() == 1 && frames_.empty());
    return std::move(values_.front());
  }

 private:
  struct Frame {
    std::size_t first_value;
    std::size_t first_name;
  };

  bool push(Json value) {
    check_cancelled_every(++steps_, stop_);
    values_.push_back(std::move(value));
    return true;
  }

  bool open() {
    if (frames_.size() == kMaxDepth)
      throw Error(ErrorCode::malformed_json,
                  "the document is nested deeper than 128 levels; flatten it");
    frames_.push_back({values_.size(), names_.size()});
    return true;
  }

  bool close(Json container) {
    values_.resize(frames_.back().first_value);
    names_.resize(frames_.back().first_name);
    frames_.pop_back();
    return push(std::move(container));
  }

  const std::stop_token& stop_;
  std::size_t steps_ = 0;
  std::deque<Json> values_;  // not a vector: that one takes thrice its size while it grows
  Names names_;
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

std::string escaped(std::string_view key) {
  std::string text;
  for (const char c : key) text += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return text;
}

}  // namespace

Json parse_json(std::string_view text, const std::stop_token& stop, std::size_t max_bytes) {
  constexpr std::size_t kFreeBytes = std::size_t{20} << 20;
  constexpr std::size_t kBytesPerByte = 12;
  const std::size_t bytes = tree_bytes(text, stop);
  if (bytes > std::min(max_bytes, kFreeBytes + kBytesPerByte * text.size()))
    throw Error(ErrorCode::too_much_memory,
                "the document's JSON would take " + std::to_string(bytes >> 20) +
                    " MiB of memory, more than is allowed for its size; leave out what is not "
                    "geometry, as extras");
  Builder builder(stop);
  Json::sax_parse(WatchedText(text.data(), stop), WatchedText(text.data() + text.size(), stop),
                  &builder);
  return builder.document();
}

Place Place::at(std::string_view key) const {
  assert(size_ < kMaxSteps && key.data() != nullptr);
  Place place = *this;
  place.steps_[place.size_++] = {key, 0};
  return place;
}

Place Place::at(std::size_t index) const {
  assert(size_ < kMaxSteps);
  Place place = *this;
  place.steps_[place.size_++] = {{}, index};
  return place;
}

std::string Place::pointer() const {
  std::string text;
  for (std::size_t i = 0; i < size_; ++i) {
    const Step& step = steps_[i];
    text += '/';
    text += step.key.data() != nullptr ? escaped(step.key) : std::to_string(step.index);
  }
  return text;
}

void fail(ErrorCode code, const Place& place, const std::string& message) {
  throw Error(code, message, place.pointer());
}

std::optional<Node> Node::find(std::string_view key) const {
  expect_object();
  const auto& members = json_->get_ref<const Json::object_t&>();
  for (const auto& [name, value] : members)
    if (name == key) return Node(value, place_.at(std::string_view(name)));
  return std::nullopt;
}

Node Node::at(std::string_view key) const {
  if (std::optional<Node> node = find(key)) return *node;
  fail(ErrorCode::malformed_gltf, place_,
       "\"" + std::string(key) + "\" is required here; export the asset again");
}

Node Node::at(std::size_t index) const { return Node((*json_)[index], place_.at(index)); }

std::size_t Node::array_size() const {
  if (!json_->is_array())
    fail(ErrorCode::malformed_gltf, place_, "an array is expected here; export the asset again");
  return json_->size();
}

void Node::expect_object() const {
  if (!json_->is_object())
    fail(ErrorCode::malformed_gltf, place_, "an object is expected here; export the asset again");
}

std::size_t Node::number() const {
  const double value = json_->is_number() ? json_->get<double>() : -1;
  if (!(value >= 0 && value <= kMaxNumber && value == std::floor(value)))
    fail(ErrorCode::malformed_gltf, place_,
         "a whole number of at least 0 is expected here; export the asset again");
  return static_cast<std::size_t>(value);
}

std::size_t Node::number(std::string_view key, std::size_t otherwise) const {
  const std::optional<Node> node = find(key);
  return node ? node->number() : otherwise;
}

std::size_t Node::index(std::size_t size, std::string_view list) const {
  const std::size_t value = number();
  if (value >= size)
    fail(ErrorCode::malformed_gltf, place_,
         "index " + std::to_string(value) + " is beyond the " + std::to_string(size) + " " +
             std::string(list) + " of the document; export the asset again");
  return value;
}

const std::string& Node::text() const {
  if (!json_->is_string())
    fail(ErrorCode::malformed_gltf, place_, "a string is expected here; export the asset again");
  return json_->get_ref<const std::string&>();
}

bool Node::flag(std::string_view key) const {
  const std::optional<Node> node = find(key);
  if (node && !node->json().is_boolean())
    fail(ErrorCode::malformed_gltf, node->place(),
         "true or false is expected here; export the asset again");
  return node && node->json().get<bool>();
}

}  // namespace unwrapd::asset
