#pragma once
// Just enough YAML to read names, ranges and lists out of openapi.yaml as it is embedded: block
// mappings by their indentation, [a, b] and "- a" lists. It leans on the layout of that one file.

#include <string>
#include <vector>

namespace unwrapd::api {

/// The lines below a key, found by the path of keys that leads there; empty when there is none.
std::vector<std::string> section(const std::vector<std::string>& path);

/// The keys directly below a path, in order.
std::vector<std::string> keys(const std::vector<std::string>& path);

/// The text after "key:" directly below a path; empty when there is none.
std::string scalar(const std::vector<std::string>& path, const std::string& key);

/// Without the quotes around it.
std::string unquoted(const std::string& text);

/// The items of a list written as "[a, b]" or as lines "- a", directly below a path.
std::vector<std::string> list(const std::vector<std::string>& path, const std::string& key);

}  // namespace unwrapd::api
