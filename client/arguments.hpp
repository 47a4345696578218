#pragma once
// The command line of unwrap. Its flags for options come from the API's own table.

#include <chrono>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "client/failure.hpp"
#include "client/job_client.hpp"

namespace unwrapd::client {

/// Where the job runs (workplace.hpp).
enum class Place {
  any,     ///< at the usual address, or else in this process
  server,  ///< at the address that is named
  here,    ///< in this process
};

struct Arguments {
  std::filesystem::path file;  ///< input; empty with sample and inputs
  std::filesystem::path out;   ///< output; never empty unless sample or inputs are given
  /// Several files, patterns or folders, and the folder of their results in `out`; empty: one file.
  std::vector<std::filesystem::path> inputs;
  bool compares = false;  ///< the two inputs as they are; out: a page about them, or empty
  int jobs = 0;           ///< of inputs, at once; 0: as many as the workers need
  bool resume = false;    ///< leave out inputs whose results are there
  bool watch = false;     ///< go on with inputs that come or change
  std::filesystem::path report;
  std::filesystem::path layout;    ///< .png or .svg; an SVG without an extension
  std::string layout_colour;       ///< quantity to colour by; empty: the server's default
  std::filesystem::path painting;  ///< a template to paint on, a PNG or an SVG as the layout
  std::filesystem::path preview;   ///< the textured mesh, PNG
  std::string preview_view;        ///< from where it is seen; empty: the server's default
  std::filesystem::path sample;    ///< only write the sample mesh here
  Place place = Place::any;
  std::vector<ServerUrl> servers;    ///< of one service, with the key of the environment
  std::string name;                  ///< of the job; empty for none
  OptionTexts options;               ///< as given, with output set; checked
  std::vector<std::string> lambdas;  ///< of a list with the method hybrid, as given; else empty
  std::chrono::milliseconds timeout{0};
  bool json = false;
  bool quiet = false;
};

/// Text to print instead of running: --help and --version with ExitCode::ok, errors with
/// ExitCode::usage.
struct Message {
  ExitCode code = ExitCode::ok;
  std::string text;
};

std::variant<Arguments, Message> parse_arguments(int argc, const char* const* argv);

}  // namespace unwrapd::client
