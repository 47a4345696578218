#pragma once
// The header fields by which a sender says how a job is to be taken.

#include <string>

#include "server/http/http.hpp"
#include "server/store/job_record.hpp"

namespace unwrapd::server::uploads {

/// The value of Idempotency-Key, empty without it. Throws Error{malformed_request} unless it is 1
/// to 255 visible ASCII characters; the quotes of a structured field are taken off.
std::string idempotency_key(const http::Request& request);

/// The u of Priority (RFC 9218): 0 is the most urgent, 7 the least; 3 without one, or where the
/// field cannot be read, as that standard wants it.
int urgency(const http::Request& request);

/// Whether Cache-Control asks for work rather than a stored answer.
bool wants_new_answer(const http::Request& request);

}  // namespace unwrapd::server::uploads
