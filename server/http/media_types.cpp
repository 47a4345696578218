#include "server/http/media_types.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/lower_case.hpp"
#include "server/http/http.hpp"

namespace unwrapd::server::http {
namespace {

struct Representation {
  std::string_view format;
  std::string_view type;
};

constexpr std::array kRepresentations = {
    Representation{"glb", "model/gltf-binary"}, Representation{"gltf", "model/gltf+json"},
    Representation{"obj", "model/obj"}, Representation{"json", "application/json"}};

/// The types of an asset that is sent; those that no result has are named as files of the format
/// are.
constexpr std::array<std::string_view, 8> kAssetTypes = {
    "model/gltf-binary", "model/gltf+json", "model/obj",       "model/stl",
    "model/ply",         "model/off",       "application/zip", "application/octet-stream"};

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> items;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(separator), text.size());
    items.push_back(trim(text.substr(0, end)));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return items;
}

std::string_view unquoted(std::string_view text) {
  const bool quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
  return quoted ? text.substr(1, text.size() - 2) : text;
}

template <class Number>
std::optional<Number> number(std::string_view text) {
  Number value{};
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  if (parsed.ec == std::errc::result_out_of_range) return std::numeric_limits<Number>::max();
  if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size()) return std::nullopt;
  return value;
}

/// An entry of an Accept header.
struct MediaRange {
  std::string type;
  double quality = 1;
};

MediaRange media_range(std::string_view entry) {
  const std::vector<std::string_view> parts = split(entry, ';');
  MediaRange range{.type = parts.empty() ? std::string() : lower_case(parts.front()), .quality = 1};
  for (const std::string_view part : parts) {
    if (part.starts_with("q=")) range.quality = number<double>(part.substr(2)).value_or(0);
  }
  return range;
}

/// How exactly a range names a type: 0 not at all, then */*, model/*, model/obj.
int closeness(std::string_view range, std::string_view type) {
  if (range == type) return 3;
  if (range == "*/*") return 1;
  const std::string_view group = type.substr(0, type.find('/') + 1);
  return range.ends_with("/*") && range.substr(0, range.size() - 1) == group ? 2 : 0;
}

std::vector<MediaRange> media_ranges(std::string_view accept) {
  std::vector<MediaRange> ranges;
  for (const std::string_view entry : split(accept, ',')) ranges.push_back(media_range(entry));
  return ranges;
}

/// The weight of a type, and how exactly it was named.
struct Liking {
  double quality = 0;
  int closeness = 0;
  auto operator<=>(const Liking&) const = default;
};

/// The weight that the closest range gives a type.
Liking liking(const std::vector<MediaRange>& ranges, std::string_view type) {
  Liking found;
  for (const MediaRange& range : ranges) {
    const int close = closeness(range.type, type);
    if (close > found.closeness) found = {.quality = range.quality, .closeness = close};
  }
  return found;
}

double quality(const std::vector<MediaRange>& ranges, std::string_view type) {
  return liking(ranges, type).quality;
}

}  // namespace

BodyKind body_kind(std::string_view content_type) {
  const std::string type = lower_case(trim(content_type.substr(0, content_type.find(';'))));
  if (type == "multipart/form-data") return BodyKind::multipart;
  if (type == media_type("json")) return BodyKind::reference;
  if (type.empty() || std::ranges::find(kAssetTypes, type) != kAssetTypes.end())
    return BodyKind::asset;
  std::string known;
  for (const std::string_view asset_type : kAssetTypes) known += std::string(asset_type) + ", ";
  throw Error(
      ErrorCode::unsupported_media_type,
      "The Content-Type must be " + known +
          "multipart/form-data or, for a stored mesh, application/json; send one of these.");
}

std::string multipart_boundary(std::string_view content_type) {
  const std::vector<std::string_view> fields = split(content_type, ';');
  if (fields.empty() || lower_case(fields.front()) != "multipart/form-data") return {};
  for (const std::string_view field : fields) {
    const std::size_t equals = field.find('=');
    if (equals == std::string_view::npos || lower_case(trim(field.substr(0, equals))) != "boundary")
      continue;
    return std::string(unquoted(trim(field.substr(equals + 1))));
  }
  return {};
}

std::string_view media_type(std::string_view format) {
  const auto found = std::ranges::find(kRepresentations, format, &Representation::format);
  return found == kRepresentations.end() ? "application/octet-stream" : found->type;
}

std::string choose_format(std::string_view accept, std::string_view usual) {
  const std::vector<MediaRange> ranges = media_ranges(accept);
  if (ranges.empty()) return std::string(usual);
  std::string_view best = usual;
  double best_quality = quality(ranges, media_type(usual));
  for (const Representation& candidate : kRepresentations) {
    const double candidate_quality = quality(ranges, candidate.type);
    if (candidate_quality > best_quality) best = candidate.format;
    best_quality = std::max(best_quality, candidate_quality);
  }
  if (best_quality > 0) return std::string(best);
  throw Error(ErrorCode::not_acceptable,
              "The result is available as model/gltf-binary, model/gltf+json, model/obj or "
              "application/json; name one of these in Accept. Formats such as STL hold no texture "
              "coordinates.");
}

bool accepts_coding(std::string_view accept_encoding, std::string_view coding) {
  double named = -1, any = -1, identity = 0;  // qualities; -1: not named
  for (const MediaRange& one : media_ranges(accept_encoding)) {
    if (one.type == coding || one.type == "x-" + std::string(coding)) named = one.quality;
    if (one.type == "*") any = one.quality;
    if (one.type == "identity") identity = one.quality;
  }
  const double quality = named < 0 ? any : named;
  return quality > 0 && quality >= identity;
}

bool accepts_gzip(std::string_view accept_encoding) {
  return accepts_coding(accept_encoding, "gzip");
}

bool prefers_events(std::string_view accept) {
  const std::vector<MediaRange> ranges = media_ranges(accept);
  const Liking events = liking(ranges, "text/event-stream");
  return events.quality > 0 && events > liking(ranges, "application/json");
}

std::optional<int> preferred_wait(std::string_view prefer) {
  for (const std::string_view preference : split(prefer, ',')) {
    const std::string_view named = preference.substr(0, preference.find(';'));  // its parameters
    const std::size_t equals = std::min(named.find('='), named.size());
    if (lower_case(trim(named.substr(0, equals))) != "wait" || equals == named.size()) continue;
    const std::optional<int> seconds = number<int>(unquoted(trim(named.substr(equals + 1))));
    if (seconds && *seconds >= 0) return seconds;
  }
  return std::nullopt;
}

std::optional<ByteRange> single_range(std::string_view range, std::int64_t size) {
  constexpr std::string_view unit = "bytes=";
  if (!range.starts_with(unit)) return std::nullopt;
  range.remove_prefix(unit.size());
  const std::size_t dash = range.find('-');
  if (dash == std::string_view::npos) return std::nullopt;
  const auto first = number<std::int64_t>(range.substr(0, dash));
  const auto last = number<std::int64_t>(range.substr(dash + 1));
  if (range.front() == '-') {  // the last bytes of the file
    if (!last || *last <= 0) return std::nullopt;
    const std::int64_t length = std::min(*last, size);
    return ByteRange{size - length, length};
  }
  const bool open_end = dash + 1 == range.size();
  if (!first || (!last && !open_end) || *first >= size) return std::nullopt;
  const std::int64_t end = open_end ? size - 1 : std::min(*last, size - 1);
  if (end < *first) return std::nullopt;
  return ByteRange{*first, end - *first + 1};
}

}  // namespace unwrapd::server::http
