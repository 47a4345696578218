#pragma once
// Finds the handler of a request. All handlers run inside answer(), which turns whatever they throw
// into a problem document.

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/log.hpp"
#include "server/http/http.hpp"

namespace unwrapd::server::http {

/// A segment "{id}" of the path matches a job id, "{sha256}" a digest, "{name}" any.
struct Route {
  std::string_view method;
  std::string_view path;
  Handler handler;
};

/// Called before the handler, with the path of its route: sets the caller, or throws Error.
using Admit = std::function<void(Request& request, std::string_view route)>;

class Router {
 public:
  Router(std::vector<Route> routes, const Log& log, Admit admit = {})
      : routes_(std::move(routes)), log_(log), admit_(std::move(admit)) {}

  /// Never throws. HEAD is answered like GET; the caller omits the body.
  [[nodiscard]] Response answer(Request request) const noexcept;
  [[nodiscard]] const std::vector<Route>& routes() const { return routes_; }

 private:
  [[nodiscard]] Response guarded(Request& request, std::string_view& route) const noexcept;
  [[nodiscard]] Response dispatch(Request& request, std::string_view& matched) const;

  std::vector<Route> routes_;
  const Log& log_;
  const Admit admit_;
};

}  // namespace unwrapd::server::http
