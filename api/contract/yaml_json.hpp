#pragma once
// YAML as JSON, as far as a contract needs it: one document, plain scalars by the core schema of
// YAML 1.2 (null, true, false, decimal numbers, else strings), aliases resolved, no tags.

#include <nlohmann/json.hpp>

#include <string>

namespace unwrapd::contract {

using Json = nlohmann::ordered_json;

/// Throws std::runtime_error, with the line, for what is no YAML, a key given twice, or a key that
/// is no text.
Json json_of_yaml(const std::string& text);

}  // namespace unwrapd::contract
