#include "server/work/lambda_selection.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "core/base/parse_number.hpp"
#include "server/base/errors.hpp"

namespace unwrapd::server::work {
namespace {

/// The lambdas of the job's maps, in their order; empty when its method has no lambda.
std::vector<double> lambdas_of(const store::JobRecord& job) {
  const api::Json lambda = job.options.value("lambda", api::Json());
  if (lambda.is_array()) return lambda.get<std::vector<double>>();
  if (lambda.is_number()) return {lambda.get<double>()};
  return {};
}

double number_of(const std::string& text) {
  constexpr double kEqualToNone = std::numeric_limits<double>::quiet_NaN();
  return parse_number<double>(text).value_or(kEqualToNone);
}

}  // namespace

std::string map_file(std::string_view file, std::size_t map) {
  return std::string(file) + (map == 0 ? "" : "." + std::to_string(map));
}

std::size_t map_count(const store::JobRecord& job) {
  return std::max<std::size_t>(1, lambdas_of(job).size());
}

std::size_t chosen_map(const store::JobRecord& job,
                       const std::multimap<std::string, std::string>& query) {
  const auto [first, last] = query.equal_range("lambda");
  if (first == last) return 0;
  if (std::next(first) != last) refuse_option("lambda", "lambda is given twice; give it once.");
  const std::vector<double> lambdas = lambdas_of(job);
  if (lambdas.empty())
    refuse_option("lambda", "The method of the job has no lambda; leave lambda out.");
  const auto found = std::ranges::find(lambdas, number_of(first->second));
  if (found == lambdas.end())
    refuse_option("lambda", "The job has no map for this lambda; it has maps for " +
                                job.options.at("lambda").dump() + ".");
  return static_cast<std::size_t>(found - lambdas.begin());
}

std::size_t only_chosen_map(const store::JobRecord& job,
                            const std::multimap<std::string, std::string>& query) {
  for (const auto& [name, text] : query)
    if (name != "lambda") refuse_option(name, "This call has no such parameter, only lambda.");
  return chosen_map(job, query);
}

}  // namespace unwrapd::server::work
