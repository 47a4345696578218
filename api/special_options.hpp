#pragma once
// Options that are more, or less, than a plain field.

#include <array>
#include <string_view>

#include "api/options.hpp"

namespace unwrapd::api {

inline constexpr std::array<std::string_view, 2> kTexcoordChoices = {"auto", "free"};
inline constexpr std::array<std::string_view, 2> kPageSizeChoices = {"auto", "power_of_two"};

Json get_lambda(const JobOptions& options);
/// null is what resolved options have for other methods than hybrid.
void set_lambda(JobOptions& options, const Json& value);

Json get_texcoord(const JobOptions& options);
void set_texcoord(JobOptions& options, const Json& value);

Json get_resolution(const JobOptions& options);
void set_resolution(JobOptions& options, const Json& value);

/// The distance has an option of its own, see settle_welding().
Json get_weld(const JobOptions& options);
void set_weld(JobOptions& options, const Json& value);

Json get_constraints(const JobOptions& options);
void set_constraints(JobOptions& options, const Json& value);

Json get_seam_edges(const JobOptions& options);
void set_seam_edges(JobOptions& options, const Json& value);

Json get_keep_edges(const JobOptions& options);
void set_keep_edges(JobOptions& options, const Json& value);

Json get_locked_islands(const JobOptions& options);
void set_locked_islands(JobOptions& options, const Json& value);

}  // namespace unwrapd::api
