#include "core/asset/gltf/root.hpp"

#include <algorithm>
#include <array>
#include <ostream>
#include <streambuf>
#include <string_view>
#include <unordered_set>

#include "core/base/cancel.hpp"

namespace unwrapd::asset {
namespace {

constexpr std::array<std::string_view, 16> kRead = {
    "asset",     "extensionsUsed", "extensionsRequired", "buffers", "bufferViews",
    "accessors", "meshes",         "materials",          "images",  "textures",
    "samplers",  "skins",          "animations",         "nodes",   "scene",
    "scenes"};
constexpr std::array<std::string_view, 3> kUnwritten = {"nodes", "scene",
                                                        "scenes"};  // subset of these

/// Writes a text in pieces, and checks the stop at each.
class WatchedSink final : public std::streambuf {
 public:
  WatchedSink(std::string& text, const std::stop_token& stop) : text_(text), stop_(stop) {
    setp(piece_.data(), piece_.data() + piece_.size());
  }

  void flush() {
    text_.append(pbase(), pptr());
    setp(piece_.data(), piece_.data() + piece_.size());
    throw_if_cancelled(stop_);
  }

 protected:
  int_type overflow(int_type c) override {
    flush();
    return sputc(traits_type::to_char_type(c));
  }

 private:
  std::string& text_;
  const std::stop_token& stop_;
  std::array<char, 65'536> piece_;
};

class RootWriter {
 public:
  RootWriter(std::string& text, const std::stop_token& stop) : sink_(text, stop), out_(&sink_) {
    out_.exceptions(std::ios::badbit);  // the sink throws on a stop
    out_ << '{';
  }

  void write(const std::string& name, const Json& value) {
    if (!is_first_) out_ << ',';
    is_first_ = false;
    out_ << Json(name) << ':' << value;
  }

  void finish() {
    out_ << '}';
    sink_.flush();
  }

 private:
  WatchedSink sink_;
  std::ostream out_;
  bool is_first_ = true;
};

}  // namespace

void Aside::take_unread(Json& root) {
  if (!root.is_object()) return;
  auto& members = root.get_ref<Json::object_t&>();
  Json::object_t read;
  for (auto& [name, value] : members) {
    members_.emplace_back(name, std::nullopt);
    if (std::find(kRead.begin(), kRead.end(), name) != kRead.end())
      read.emplace(name, std::move(value));
    else
      members_.back().second = std::move(value);
  }
  members = std::move(read);
}

void Aside::take_unwritten(Json& root) {
  for (auto& [name, value] : members_) {
    const bool is_meant = std::find(kUnwritten.begin(), kUnwritten.end(), name) != kUnwritten.end();
    if (value || !is_meant) continue;
    value = std::move(root[name]);
    root.erase(name);
  }
}

std::string Aside::text_with(const Json& root, const std::stop_token& stop) const {
  std::string text;
  RootWriter writer(text, stop);
  std::unordered_set<std::string_view> written;
  for (const auto& [name, value] : members_) {
    const auto found = value ? root.end() : root.find(name);
    if (!value && found == root.end()) continue;  // removed by writing
    writer.write(name, value ? *value : *found);
    if (!value) written.insert(name);
  }
  for (const auto& [name, value] : root.get_ref<const Json::object_t&>())
    if (!written.contains(name)) writer.write(name, value);
  writer.finish();
  return text;
}

}  // namespace unwrapd::asset
