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

struct Arguments {
  std::filesystem::path file;  ///< to unwrap; empty with sample
  std::filesystem::path out;   ///< where the result goes, never empty unless sample is given
  std::filesystem::path report;
  std::filesystem::path layout;   ///< a PNG where its extension says so, else an SVG
  std::string layout_colour;      ///< what the layout's colours say; empty: the server's default
  std::filesystem::path preview;  ///< the textured mesh, PNG
  std::filesystem::path sample;   ///< write the sample mesh here and do nothing else
  ServerUrl server;
  OptionTexts options;               ///< as given, with output filled in; checked
  std::vector<std::string> lambdas;  ///< of a list with the method hybrid, as given; else empty
  std::chrono::milliseconds timeout{0};
  bool json = false;
  bool quiet = false;
};

/// What there is to print instead of work: --help and --version with ExitCode::ok, mistakes with
/// ExitCode::usage.
struct Message {
  ExitCode code = ExitCode::ok;
  std::string text;
};

std::variant<Arguments, Message> parse_arguments(int argc, const char* const* argv);

/// "folder/mesh.glb" becomes "folder/mesh.uv.glb"; output ("obj") changes the extension, "auto" or
/// nothing keeps it.
std::filesystem::path default_out(const std::filesystem::path& file, const std::string& output);

}  // namespace unwrapd::client
