#include "server/uploads/job_name.hpp"

#include "server/base/errors.hpp"
#include "server/base/utf8.hpp"

namespace unwrapd::server::uploads {

std::string checked_job_name(const std::string& name) {
  if (!is_plain_line(name))
    refuse_option(kNameParameter,
                  "The name of a job is one line of UTF-8 without control characters; correct it.");
  if (count_characters(name) > kMaxNameCharacters)
    refuse_option(kNameParameter, "The name of a job has at most " +
                                      std::to_string(kMaxNameCharacters) +
                                      " characters; shorten it.");
  return name;
}

std::string take_job_name(api::Query& options) {
  const auto found = options.find(kNameParameter);
  if (found == options.end()) return {};
  if (options.count(kNameParameter) > 1)
    refuse_option(kNameParameter, "The name is given twice; give it once.");
  std::string name = checked_job_name(found->second);
  options.erase(found);
  return name;
}

}  // namespace unwrapd::server::uploads
