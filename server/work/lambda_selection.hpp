#pragma once
// Which of a job's maps a request is about. A job with a list of lambdas has one map for each, in
// the list's order; every other job has one.

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

#include "server/store/job_record.hpp"

namespace unwrapd::server::work {

/// The file of a map: "uv.bin" is that of the first, "uv.bin.2" that of the third.
std::string map_file(std::string_view file, std::size_t map);

/// How many maps a job has.
std::size_t map_count(const store::JobRecord& job);

/// The map that the parameter lambda of a query names, as the number that the job was given;
/// without it the first. Throws Error{invalid_option} when the job has no map of this lambda.
std::size_t chosen_map(const store::JobRecord& job,
                       const std::multimap<std::string, std::string>& query);

/// The same for a query that can have no other parameter: throws for any.
std::size_t only_chosen_map(const store::JobRecord& job,
                            const std::multimap<std::string, std::string>& query);

}  // namespace unwrapd::server::work
