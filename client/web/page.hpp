#pragma once
// The pages that a server shows to people, as they were at build time: documents, and the files
// that they load, under names that change with their content.

#include <span>
#include <string_view>

namespace unwrapd::web {

/// A file of the pages, compressed in two ways.
struct PageFile {
  std::string_view name;  ///< without a folder
  std::string_view type;
  std::string_view gzip;
  std::string_view brotli;
};

std::string_view index_html();  ///< loads assets/NAME of the files
std::string_view docs_html();   ///< the API; loads such files, and openapi.json
std::span<const PageFile> page_files();

}  // namespace unwrapd::web
