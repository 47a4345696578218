#pragma once
// The one table of errors: code, wire name, HTTP status and title; and the problem document (RFC
// 9457) made from it. openapi.yaml lists the same names, and a test compares them.

#include <optional>
#include <span>
#include <string_view>

#include "api/json.hpp"
#include "core/base/error.hpp"

namespace unwrapd::api {

struct ErrorRow {
  ErrorCode code;
  std::string_view name;   ///< on the wire; never changes
  int status;              ///< HTTP status
  std::string_view title;  ///< the same for every occurrence
};

/// All rows, in the order of ErrorCode.
std::span<const ErrorRow> error_table();

const ErrorRow& error_row(ErrorCode code);

/// The code of a wire name; empty if no code has this name.
std::optional<ErrorCode> code_named(std::string_view name);

/// The problem document of an error: type, title, status, detail, code; pointer if the error has a
/// location; job if job_id is not empty.
Json problem(const Error& error, std::string_view job_id = {});

/// The error that a problem document describes, for the client. Any other document becomes
/// ErrorCode::internal with the text that it has.
Error error_from_problem(const Json& problem);

}  // namespace unwrapd::api
