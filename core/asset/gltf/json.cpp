#include "core/asset/gltf/json.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace unwrapd::asset {
namespace {

constexpr double kMaxNumber = 9007199254740992.0;

Error document_error(const json::Refusal& refusal) {
  switch (refusal.fault) {
    case json::Fault::too_dense:
      return Error(ErrorCode::too_much_memory,
                   "the document's JSON would take " + std::to_string(refusal.figure >> 20) +
                       " MiB of memory, more than is allowed for its size; leave out what is not "
                       "geometry, as extras");
    case json::Fault::repeated_name:
      return Error(ErrorCode::malformed_json,
                   "an object of the document has the same name twice; keep one of them");
    case json::Fault::too_deep:
      return Error(ErrorCode::malformed_json, "the document is nested deeper than " +
                                                  std::to_string(refusal.figure) +
                                                  " levels; flatten it");
    default:  // no other limit is set
      return Error(ErrorCode::malformed_json,
                   "the document is not valid JSON in UTF-8; repair or export it again",
                   "byte " + std::to_string(refusal.figure));
  }
}

}  // namespace

Json parse_json(std::string_view text, const std::stop_token& stop, std::size_t max_bytes) {
  constexpr std::size_t kFreeBytes = std::size_t{20} << 20;
  constexpr std::size_t kBytesPerByte = 12;
  return json::read(
      text,
      {.error = document_error,
       .max_tree_bytes = std::min(max_bytes, kFreeBytes + kBytesPerByte * text.size())},
      stop);
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
    text += step.key.data() != nullptr ? json::pointer_token(step.key) : std::to_string(step.index);
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
