#pragma once
// Text as HTML.

#include <string>
#include <string_view>

namespace unwrapd::contract {

/// Every character stands for itself, between tags and in quoted attributes.
std::string escaped(std::string_view text);

/// What the contract uses of Markdown within a line: `code` and *emphasis*.
std::string inline_html(std::string_view text);

/// The same with paragraphs, and lists of lines that begin with "- ".
std::string block_html(std::string_view text);

/// "<name>text</name>", where text is HTML already.
std::string element(std::string_view name, std::string_view html);

/// "<code>text</code>", of text.
std::string code(std::string_view text);

/// A link within the page to what has this id.
std::string link_to(std::string_view id, std::string_view html);

}  // namespace unwrapd::contract
