#pragma once
// The name of a job, for people: one line that its sender chooses. It does not have to be unique,
// and is no part of the question: a request that is sent again under another name gets the job that
// it made before.

#include <cstddef>
#include <string>

#include "api/options.hpp"

namespace unwrapd::server::uploads {

inline constexpr const char* kNameParameter = "name";
inline constexpr std::size_t kMaxNameCharacters = 200;

/// The name itself; empty stands for none. Throws Error{invalid_option} for a longer one, and for
/// text that is no plain line of UTF-8.
std::string checked_job_name(const std::string& name);

/// Takes the name from among options in a query or a form. Throws like checked_job_name(), and for
/// two names.
std::string take_job_name(api::Query& options);

}  // namespace unwrapd::server::uploads
