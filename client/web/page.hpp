#pragma once
// The page that a server shows to people, as it was at build time: a document, and the files that
// it loads, under names that change with their content.

#include <span>
#include <string_view>

namespace unwrapd::web {

/// A file of the page, compressed in two ways.
struct PageFile {
  std::string_view name;  ///< without a folder
  std::string_view type;
  std::string_view gzip;
  std::string_view brotli;
};

std::string_view index_html();  ///< loads assets/NAME of the files
std::span<const PageFile> page_files();

}  // namespace unwrapd::web
