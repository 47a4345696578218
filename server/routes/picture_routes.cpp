#include "server/routes/picture_routes.hpp"

#include <charconv>
#include <cmath>
#include <optional>

#include "core/base/parse_number.hpp"
#include "server/base/errors.hpp"
#include "server/http/query.hpp"
#include "server/routes/job_routes.hpp"
#include "server/routes/result_routes.hpp"
#include "server/work/lambda_selection.hpp"

namespace unwrapd::server::routes {
namespace {

constexpr int kMostPages = 100;

figure::Colouring parse_colour(const std::string& text) {
  const std::optional<figure::Colouring> colouring = figure::colouring_named(text);
  if (!colouring)
    refuse_option("colour", "The colour is unknown; use stretch, angle, area or flips.");
  return *colouring;
}

int parse_size(const std::string& text) {
  const std::optional<int> size = parse_number<int>(text);
  if (!size || *size < figure::kMinImageSize || *size > figure::kMaxImageSize)
    refuse_option(
        "size",
        "The size must be a whole number of pixels from 64 to 4096, or for layout.png page.");
  return *size;
}

bool parse_switch(const std::string& name, const std::string& text) {
  if (text != "0" && text != "1") refuse_option(name, "The parameter must be 0 or 1.");
  return text == "1";
}

bool parse_background(const std::string& text) {
  if (text != "page" && text != "none")
    refuse_option("background", "The background is unknown; use page or none.");
  return text == "page";
}

int parse_page(const std::string& text) {
  const std::optional<int> page = parse_number<int>(text);
  if (!page || *page < 1 || *page > kMostPages)
    refuse_option("page", "The page must be a whole number from 1 to 100.");
  return *page;
}

/// An angle in degrees, at the start of a text, which it is taken from.
std::optional<double> take_degrees(std::string_view& text, double most) {
  double degrees = 0;
  const auto [stop, error] =
      std::from_chars(text.data(), text.data() + text.size(), degrees, std::chars_format::fixed);
  if (error != std::errc() || !(std::abs(degrees) <= most)) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(stop - text.data()));
  return degrees;
}

/// "30,-20.5", rounded to hundredths.
std::optional<figure::Aspect> parse_angles(std::string_view text) {
  const auto rounded = [](double degrees) { return std::round(100 * degrees) / 100 + 0.0; };
  const std::optional<double> azimuth = take_degrees(text, 360);
  if (!azimuth || !text.starts_with(',')) return std::nullopt;
  text.remove_prefix(1);
  const std::optional<double> elevation = take_degrees(text, 90);
  if (!elevation || !text.empty()) return std::nullopt;
  return figure::Aspect{.azimuth = rounded(*azimuth), .elevation = rounded(*elevation)};
}

void set_view(work::Picture& picture, const std::string& text) {
  if (text == "auto") return;
  picture.turns = text == "turntable";
  if (picture.turns) return;
  picture.aspect = figure::aspect_named(text);
  if (!picture.aspect) picture.aspect = parse_angles(text);
  if (!picture.aspect)
    refuse_option(
        "view",
        "The view must be auto, front, back, left, right, top, bottom, turntable, or two angles "
        "in degrees such as 30,20, from -360 to 360 and from -90 to 90.");
}

/// Sets a parameter of layouts; false when it is none.
bool set_layout(work::Picture& picture, const std::string& name, const std::string& text) {
  if (name == "colour") {
    picture.colouring = parse_colour(text);
  } else if (name == "legend") {
    picture.legend = parse_switch(name, text);
  } else if (name == "background") {
    picture.background = parse_background(text);
  } else if (name == "wireframe") {
    picture.wireframe = parse_switch(name, text);
  } else if (name == "numbers") {
    picture.numbers = parse_switch(name, text);
  } else if (name == "page") {
    picture.page = parse_page(text);
  } else {
    return false;
  }
  return true;
}

void set_size(work::Picture& picture, const std::string& text) {
  picture.has_page_size = text == "page" && picture.kind == work::PictureKind::layout_png;
  if (!picture.has_page_size) picture.size = parse_size(text);
}

/// What some parameters say of others.
void settle_layout(work::Picture& picture, const std::multimap<std::string, std::string>& query) {
  if (picture.has_page_size && picture.page == 0) picture.page = 1;
  if (!query.contains("legend")) picture.legend = !picture.wireframe && picture.page == 0;
  if (!picture.wireframe) return;
  for (const char* name : {"colour", "legend"})
    if (query.contains(name) && (picture.legend || std::string_view(name) == "colour"))
      refuse_option(name,
                    "A wireframe shows no colours, and has no legend of them; leave this out.");
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
  const bool is_layout = kind != work::PictureKind::preview_png;
  for (const auto& [name, text] : query) {
    http::check_once(query, name);
    if (is_layout && set_layout(picture, name, text)) continue;
    if (name == "view" && !is_layout) {
      set_view(picture, text);
    } else if (name == "size" && kind != work::PictureKind::layout_svg) {
      set_size(picture, text);
    } else {
      refuse_option(name, "This picture has no parameter of this name; see /openapi.yaml.");
    }
  }
  if (is_layout) settle_layout(picture, query);
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
