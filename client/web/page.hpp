#pragma once
// The page that a server shows to people, as it was at build time: a form, the progress of a job,
// and its result, by nothing but the API.

#include <string_view>

namespace unwrapd::web {

std::string_view index_html();  ///< refers to those beside it
std::string_view form_js();
std::string_view page_css();
std::string_view page_js();

}  // namespace unwrapd::web
