#include "server/http/gzip.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <new>
#include <utility>

#include "server/http/media_types.hpp"

namespace unwrapd::server::http {
namespace {

constexpr int kGzipOnly = 16 + MAX_WBITS;  // zlib's way to ask for gzip, not its own format
constexpr int kLevel = 1;                  // ADR 0050
constexpr int kMemoryLevel = 8;
constexpr std::size_t kPiece = std::size_t{64} * 1024;
constexpr std::int64_t kFileRead = std::int64_t{256} * 1024;
constexpr std::size_t kWorthIt = 1024;  // bytes of an answer; a smaller one fits a packet anyway

Bytef* input_of(std::string_view bytes) {
  return reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));  // zlib only reads it
}

bool compresses(std::string_view type) {
  constexpr std::array<std::string_view, 7> prefixes = {
      "application/json", "application/yaml", "application/wasm", "image/svg+xml",
      "model/",           "text/html",        "text/css"};
  return type.starts_with("text/javascript") ||
         std::ranges::any_of(prefixes, [&](auto prefix) { return type.starts_with(prefix); });
}

/// Of a body that is sent whole; 0 for a stream.
std::size_t whole_size(const Response& response) {
  if (const auto* text = std::get_if<std::string>(&response.body)) return text->size();
  const auto* file = std::get_if<FileBody>(&response.body);
  return file == nullptr ? 0 : static_cast<std::size_t>(file->length);
}

void vary_by_encoding(Response& response) {
  for (auto& [name, value] : response.headers)
    if (name == "Vary") return void(value += ", Accept-Encoding");
  response.headers.emplace_back("Vary", "Accept-Encoding");
}

bool is_encoded(const Response& response) {
  return std::ranges::any_of(response.headers,
                             [](const auto& field) { return field.first == "Content-Encoding"; });
}

}  // namespace

struct GzipDecoder::Stream : z_stream {};
struct GzipEncoder::Stream : z_stream {};

GzipDecoder::GzipDecoder(std::int64_t max_bytes, BodyReader::Sink sink)
    : stream_(new Stream{},
              [](Stream* stream) {
                inflateEnd(stream);
                delete stream;
              }),
      max_bytes_(max_bytes),
      sink_(std::move(sink)) {
  if (inflateInit2(stream_.get(), kGzipOnly) != Z_OK) throw std::bad_alloc();
}

void GzipDecoder::begin_member_if_needed() {
  if (in_member_) return;
  inflateReset(stream_.get());
  in_member_ = true;
  ended_ = false;
}

void GzipDecoder::hand_out(std::string_view bytes) {
  decoded_ += static_cast<std::int64_t>(bytes.size());
  if (decoded_ > max_bytes_)
    throw Error(ErrorCode::body_too_large, "The body unpacks to more than " +
                                               std::to_string(max_bytes_) +
                                               " bytes; send a smaller mesh.");
  if (decoded_ > kFreeUnpackedBytes && decoded_ / kMaxGzipRatio > received_)
    throw Error(ErrorCode::body_too_large, "The body unpacks to more than " +
                                               std::to_string(kMaxGzipRatio) +
                                               " times its size; send it uncompressed.");
  if (!bytes.empty()) sink_(bytes);
}

void GzipDecoder::feed(std::string_view bytes) {
  received_ += static_cast<std::int64_t>(bytes.size());
  std::array<char, kPiece> piece;
  stream_->next_in = input_of(bytes);
  stream_->avail_in = static_cast<uInt>(bytes.size());
  bool is_full = false;  // then more may come without further input
  while (stream_->avail_in > 0 || is_full) {
    begin_member_if_needed();
    stream_->next_out = reinterpret_cast<Bytef*>(piece.data());
    stream_->avail_out = kPiece;
    const int result = inflate(stream_.get(), Z_NO_FLUSH);
    if (result != Z_OK && result != Z_STREAM_END && result != Z_BUF_ERROR)
      throw Error(ErrorCode::malformed_request,
                  "The body is not gzip, as its Content-Encoding says; check the client.");
    hand_out({piece.data(), kPiece - stream_->avail_out});
    is_full = stream_->avail_out == 0 && result == Z_OK;
    if (result != Z_STREAM_END) continue;
    in_member_ = false;
    ended_ = true;
  }
}

void GzipDecoder::finish() const {
  if (!ended_ || in_member_)
    throw Error(ErrorCode::malformed_request,
                "The gzip of the body is cut off; send it completely.");
}

GzipEncoder::GzipEncoder()
    : stream_(new Stream{}, [](Stream* stream) {
        deflateEnd(stream);
        delete stream;
      }) {
  if (deflateInit2(stream_.get(), kLevel, Z_DEFLATED, kGzipOnly, kMemoryLevel,
                   Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
}

std::string GzipEncoder::add(std::string_view bytes, bool last) {
  std::string ready;
  std::array<char, kPiece> piece;
  stream_->next_in = input_of(bytes);
  stream_->avail_in = static_cast<uInt>(bytes.size());
  do {
    stream_->next_out = reinterpret_cast<Bytef*>(piece.data());
    stream_->avail_out = kPiece;
    deflate(stream_.get(), last ? Z_FINISH : Z_NO_FLUSH);
    ready.append(piece.data(), kPiece - stream_->avail_out);
  } while (stream_->avail_out == 0);
  return ready;
}

std::function<std::optional<StreamPiece>()> gzip_pieces(const FileBody& file) {
  return [file, encoder = std::make_shared<GzipEncoder>(),
          read = std::int64_t{0}]() mutable -> std::optional<StreamPiece> {
    const std::int64_t size = std::min(file.length - read, kFileRead);
    const std::string bytes = file.file->read(file.offset + read, static_cast<std::size_t>(size));
    read += std::ssize(bytes);
    const bool end = read == file.length;
    if (bytes.empty() && !end) return std::nullopt;
    return StreamPiece{encoder->add(bytes, end), end};
  };
}

std::string gzip_etag(std::string_view etag) {
  return std::string(etag.substr(0, etag.size() - 1)) + "-gzip\"";
}

void encode_answer(const Request& request, Response& response) {
  if (!compresses(response.content_type)) return;
  vary_by_encoding(response);
  if (is_encoded(response)) return;
  if (response.status != 200 || whole_size(response) < kWorthIt) return;
  if (!accepts_gzip(request.header("Accept-Encoding"))) return;
  for (auto& [name, value] : response.headers)
    if (name == "ETag") value = gzip_etag(value);
  response.headers.emplace_back("Content-Encoding", "gzip");
  if (auto* text = std::get_if<std::string>(&response.body))
    *text = GzipEncoder().add(*text, true);
  else
    std::get<FileBody>(response.body).gzip = true;
}

}  // namespace unwrapd::server::http
