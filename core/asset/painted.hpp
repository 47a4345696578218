#pragma once
// Painted preferences: values of vertices, read from the attribute that an option names.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/asset/document.hpp"

namespace unwrapd::asset {

/// An attribute, or one channel of it: "COLOR_0", "COLOR_0.r".
struct AttributeName {
  std::string_view option;  ///< that names it
  std::string whole;        ///< as it was given
  std::string base;         ///< without the channel; whole without one
  std::optional<std::size_t> channel = {};
};

/// The channel is one of r, g, b and a, behind the last dot.
AttributeName attribute_name(std::string_view option, const std::string& given);

inline constexpr std::string_view kColourAttribute = "COLOR_0";

/// One value a vertex, NaN where it has no colour. what: of which file. Throws
/// Error{invalid_option} if there is no such attribute.
std::vector<double> colour_values(std::span<const Colour> colours, const AttributeName& name,
                                  const std::string& what);
std::vector<double> ply_values(const Input& input, const AttributeName& name);

/// Throws Error{invalid_option} for an attribute that is missing; has: those that there are.
[[noreturn]] void refuse_missing(const AttributeName& name, const std::string& what,
                                 const std::vector<std::string>& has);

/// Throws Error{invalid_option} for an attribute that has no single value.
[[noreturn]] void refuse_type(const AttributeName& name, const std::string& why);

/// Fills Surface::seam_avoid and texel_density of the surfaces as the document's options say, with
/// values in [0, 1]. Throws Error{invalid_option, cancelled}.
void read_painted(const Input& input, Document& document);

}  // namespace unwrapd::asset
