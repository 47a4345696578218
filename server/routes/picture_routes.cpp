#include "server/routes/picture_routes.hpp"

#include <charconv>

#include "server/routes/job_routes.hpp"
#include "server/routes/result_routes.hpp"
#include "server/work/lambda_selection.hpp"

namespace unwrapd::server::routes {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& what) {
  throw Error(ErrorCode::invalid_option, what, "/" + name);
}

figure::Colouring parse_colour(const std::string& text) {
  const std::optional<figure::Colouring> colouring = figure::colouring_named(text);
  if (!colouring) refuse("colour", "The colour is unknown; use stretch, angle, area or flips.");
  return *colouring;
}

int parse_size(const std::string& text) {
  int size = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, size);
  if (error != std::errc() || stop != end || size < figure::kMinImageSize ||
      size > figure::kMaxImageSize)
    refuse("size", "The size must be a whole number of pixels from 64 to 4096.");
  return size;
}

http::Response get_picture(results::PictureStore& pictures, const store::JobRecord& job,
                           work::PictureKind kind, const http::Request& request) {
  std::multimap<std::string, std::string> query = request.query;
  const std::size_t map = work::chosen_map(job, query);
  query.erase("lambda");
  const work::Picture picture = picture_of(kind, query);
  require_result(job);
  const std::string_view type =
      kind == work::PictureKind::layout_svg ? "image/svg+xml" : "image/png";
  return stored_response(pictures.open(job, map, picture, request.has_left), type, request);
}

}  // namespace

work::Picture picture_of(work::PictureKind kind,
                         const std::multimap<std::string, std::string>& query) {
  work::Picture picture{.kind = kind};
  for (const auto& [name, text] : query) {
    if (query.count(name) > 1) refuse(name, "The parameter is given twice; give it once.");
    if (name == "colour" && kind != work::PictureKind::preview_png) {
      picture.colouring = parse_colour(text);
    } else if (name == "size" && kind != work::PictureKind::layout_svg) {
      picture.size = parse_size(text);
    } else {
      refuse(name, "This picture has no parameter of this name; see /openapi.yaml.");
    }
  }
  return picture;
}

void add_picture_routes(std::vector<http::Route>& routes, store::JobStore& jobs,
                        results::PictureStore& pictures) {
  const auto add = [&](std::string_view path, work::PictureKind kind) {
    routes.push_back({"GET", path, [&jobs, &pictures, kind](const http::Request& request) {
                        return answer_with_files(jobs, find_job(jobs, request),
                                                 [&](const store::JobRecord& job) {
                                                   return get_picture(pictures, job, kind, request);
                                                 });
                      }});
  };
  add("/v1/jobs/{id}/layout.svg", work::PictureKind::layout_svg);
  add("/v1/jobs/{id}/layout.png", work::PictureKind::layout_png);
  add("/v1/jobs/{id}/preview.png", work::PictureKind::preview_png);
}

}  // namespace unwrapd::server::routes
