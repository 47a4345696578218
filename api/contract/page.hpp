#pragma once
// The contract as one page for people: static HTML without scripts, which needs nothing but a
// stylesheet beside it.

#include <functional>
#include <string>

#include "api/contract/yaml_json.hpp"

namespace unwrapd::contract {

/// The text of an example, by the name of its file.
using Examples = std::function<std::string(const std::string& file)>;

/// Throws std::runtime_error where the contract refers to what it does not have.
std::string page_of(const Json& contract, const Examples& examples);

}  // namespace unwrapd::contract
