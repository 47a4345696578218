// Options as JSON and as a query. What is taken is resolved, and what it was resolved to can be
// sent again and means the same.
#include <array>

#include "api/options.hpp"
#include "core/base/error.hpp"
#include "tests/fuzz/targets.hpp"

namespace unwrapd::fuzz {
namespace {

const api::Limits kLimits;

void expect_round_trip(const api::JobOptions& options) {
  const api::Json resolved = api::to_json(options);
  promise(api::to_json(api::parse_options(resolved, kLimits)) == resolved,
          "resolved options mean themselves");
}

void options_text(std::string_view bytes) {
  expect_round_trip(api::parse_options_text(bytes, kLimits));
}

std::vector<std::string> options_seeds() {
  std::string every = "{";
  for (const api::OptionRow& row : api::option_table()) {
    if (row.name.find('.') != std::string_view::npos) continue;
    if (every.size() > 1) every += ',';
    every += '"' + std::string(row.name) + "\":" + api::option_default(row, kLimits).dump();
  }
  return {every + "}", R"({"method":"hybrid","lambda":[0.1,1],"stop":{"iterations":3}})",
          R"({"constraints":[{"vertex":1,"uv":[0,0.5],"weight":2.5,"mesh":0}]})"};
}

void query_text(std::string_view bytes) {
  api::Query query;
  while (!bytes.empty()) {
    const std::string_view pair = bytes.substr(0, bytes.find('&'));
    const std::size_t equals = std::min(pair.find('='), pair.size());
    query.emplace(pair.substr(0, equals), pair.substr(std::min(equals + 1, pair.size())));
    bytes.remove_prefix(std::min(pair.size() + 1, bytes.size()));
  }
  expect_round_trip(api::parse_options(query, kLimits));
}

std::vector<std::string> query_seeds() {
  return {"method=hybrid&lambda=0.1,1e3&stop.tolerance=1e-3", "resolution=64&padding=1&output=glb",
          R"(constraints=[{"at":[0,1,2],"uv":[0.5,-1e3]}]&seams=keep)"};
}

void constraints_text(std::string_view bytes) {
  options_text(R"({"constraints":)" + std::string(bytes) + "}");
}

std::vector<std::string> constraints_seeds() {
  return {R"([{"vertex":1,"uv":[0,0.5],"weight":2.5,"mesh":0},{"vertex":2,"uv":[1,1]}])",
          R"([{"at":[0.5,-1,1e9],"uv":[0,0],"weight":null}])", "[]"};
}

constexpr std::array kTargets = {Target{"options", options_text, options_seeds},
                                 Target{"query", query_text, query_seeds},
                                 Target{"constraints", constraints_text, constraints_seeds}};

}  // namespace

std::span<const Target> api_targets() { return kTargets; }

}  // namespace unwrapd::fuzz
