#pragma once
// The few values that are read from the XML of an object store. Its answers are flat, and what is
// looked for has no attributes.

#include <string>
#include <string_view>
#include <vector>

namespace unwrapd::server::bucket {

/// What is between each <tag> and the next </tag>, with its entities replaced.
std::vector<std::string> texts_of(std::string_view xml, const std::string& tag);
/// The first of them; empty where there is none.
std::string first_text(std::string_view xml, const std::string& tag);

}  // namespace unwrapd::server::bucket
