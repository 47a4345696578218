#pragma once
// The flags of unwrap for the options of the API.

#include <string>
#include <string_view>

#include "client/job_client.hpp"

namespace CLI {
class App;
}

namespace unwrapd::client {

/// "--stop-iterations" for "stop.iterations".
std::string flag_name(std::string_view option);

/// Adds one flag for every row of the API's table; their values go to options.
void add_option_flags(CLI::App& app, OptionTexts& options);

}  // namespace unwrapd::client
