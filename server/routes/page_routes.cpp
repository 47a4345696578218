// Documents are checked each time; what they load has names that change with their content, and is
// never asked for twice. The files are in the program compressed, as nearly every browser takes
// them.
#include "server/routes/page_routes.hpp"

#include <algorithm>
#include <string>

#include "client/web/page.hpp"
#include "core/base/error.hpp"
#include "server/http/gzip.hpp"
#include "server/http/media_types.hpp"
#include "server/routes/text_handlers.hpp"

namespace unwrapd::server::routes {
namespace {

/// The pages call nothing but their own server, and where results are. blob: and data: are files
/// that people open and what is in them; decoders of Draco and meshopt are WebAssembly, the former
/// in a worker made of a blob.
std::string page_policy(const std::string& downloads) {
  return "default-src 'none'; style-src 'self'; script-src 'self' 'wasm-unsafe-eval'; worker-src "
         "'self' blob:; connect-src 'self' blob: data:" +
         (downloads.empty() ? "" : " " + downloads) +
         "; img-src 'self' data: blob:; base-uri 'none'; form-action 'none'; frame-ancestors "
         "'none'";
}
constexpr std::string_view kForGood = "public, max-age=31536000, immutable";
constexpr std::int64_t kMostBytes = std::int64_t{1} << 26;

std::string unpacked_file(std::string_view gzip) {
  std::string bytes;
  http::GzipDecoder decoder(kMostBytes, [&](std::string_view piece) { bytes += piece; });
  decoder.feed(gzip);
  decoder.finish();
  return bytes;
}

/// The file in the smallest form that the caller takes.
void encode_file(const web::PageFile& file, std::string_view accepted, http::Response& response) {
  const bool brotli = http::accepts_coding(accepted, "br");
  if (!brotli && !http::accepts_coding(accepted, "gzip")) {
    response.body = unpacked_file(file.gzip);
    return;
  }
  response.headers.emplace_back("Content-Encoding", brotli ? "br" : "gzip");
  response.body = std::string(brotli ? file.brotli : file.gzip);
}

http::Response get_page_file(const http::Request& request, const std::string& policy) {
  const std::string_view name = std::string_view(request.path).substr(request.path.rfind('/') + 1);
  const auto file = std::ranges::find(web::page_files(), name, &web::PageFile::name);
  if (file == web::page_files().end())
    throw Error(ErrorCode::not_found,
                "The page of this version has no such file; load the page at / again.");
  http::Response response;
  response.content_type = file->type;
  encode_file(*file, request.header("Accept-Encoding"), response);
  response.headers.emplace_back("Cache-Control", kForGood);
  protect(response, policy);
  return response;
}

}  // namespace

void add_page_routes(std::vector<http::Route>& routes, const std::string& downloads) {
  constexpr std::string_view kHtml = "text/html; charset=utf-8";
  const std::string policy = page_policy(downloads);
  routes.push_back({"GET", "/", page_handler(web::index_html(), kHtml, policy)});
  routes.push_back({"GET", "/docs", page_handler(web::docs_html(), kHtml, policy)});
  routes.push_back({"GET", "/assets/{name}", [policy](const http::Request& request) {
                      return get_page_file(request, policy);
                    }});
}

}  // namespace unwrapd::server::routes
