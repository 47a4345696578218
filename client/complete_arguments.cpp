#include "client/complete_arguments.hpp"

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string_view>
#include <utility>

#include "api/error_table.hpp"
#include "api/options.hpp"
#include "client/files.hpp"
#include "client/formats.hpp"
#include "client/option_flags.hpp"

namespace unwrapd::client {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxTimeoutSeconds = 1e6;
constexpr std::array<std::string_view, 2> kPictures = {"png", "svg"};
constexpr std::array<std::string_view, 1> kPng = {"png"};
constexpr std::array<std::string_view, 1> kGlb = {"glb"};

/// Checks the options without a server's limits, which the server checks itself.
void check_options(const OptionTexts& options) {
  api::Limits limits;
  limits.max_iterations = limits.max_constraints = std::numeric_limits<int>::max();
  try {
    api::parse_options(std::multimap<std::string, std::string>(options.begin(), options.end()),
                       limits);
  } catch (const Error& error) {
    const api::OptionRow* row = api::option_at(error.where());
    std::string message = row == nullptr ? "" : flag_name(row->name) + ": ";
    message += error.what();
    if (row != nullptr && row->type == api::OptionType::objects)
      message += " (at " + error.where() + ")";
    throw Failure(ExitCode::usage, message);
  }
}

/// The entries of a list of lambdas, in its order, if the method makes a map for each.
std::vector<std::string> lambdas_of(const OptionTexts& options) {
  const auto method = options.find("method");
  const auto lambda = options.find("lambda");
  const bool is_list = lambda != options.end() && lambda->second.find(',') != std::string::npos;
  if (!is_list || method == options.end() || method->second != "hybrid") return {};
  return CLI::detail::split(lambda->second, ',');
}

bool is_batch(const Arguments& arguments) {
  const fs::path& first = arguments.inputs.front();
  std::error_code none;
  const bool has_sign = first.string().find_first_of("*?[") != std::string::npos;
  const bool is_pattern = has_sign && !is_address(first) && !fs::exists(first, none);
  return arguments.inputs.size() > 1 || fs::is_directory(first, none) || is_pattern ||
         arguments.resume || arguments.watch;
}

void check_batch(const Arguments& arguments) {
  const std::array<std::pair<const char*, const fs::path&>, 4> of_one = {
      {{"--report", arguments.report},
       {"--layout", arguments.layout},
       {"--template", arguments.painting},
       {"--preview", arguments.preview}}};
  for (const auto& [flag, path] : of_one)
    if (!path.empty())
      throw Failure(ExitCode::usage,
                    std::string(flag) + " writes one file; leave it out, or name one FILE.");
  std::error_code none;
  const fs::path& out = arguments.out;
  const bool is_file = is_stream(out) || is_mesh_name(out) || fs::exists(out, none);
  if (!out.empty() && is_file && !fs::is_directory(out, none))
    throw Failure(ExitCode::usage,
                  "--out: several meshes, --resume and --watch write into a folder, and " +
                      out.string() + " is none; name one.");
  if (!arguments.lambdas.empty())
    throw Failure(ExitCode::usage,
                  "Of several meshes each has one result; name one --lambda, or one FILE.");
}

/// Whether the first of several words is a command, and no file.
bool is_comparison(const Arguments& arguments) {
  std::error_code none;
  return arguments.inputs.size() > 1 && arguments.inputs.front() == "compare" &&
         !fs::exists("compare", none);
}

/// Of `unwrap compare A B`.
void settle_comparison(Arguments& arguments) {
  arguments.compares = true;
  arguments.inputs.erase(arguments.inputs.begin());
  if (arguments.inputs.size() != 2)
    throw Failure(ExitCode::usage, "compare takes two meshes; name both.");
  if (!arguments.out.empty() && arguments.out.extension() != ".html")
    throw Failure(ExitCode::usage, "--out: compare writes a page; name a file that ends in .html.");
  if (!arguments.report.empty() || !arguments.layout.empty() || !arguments.painting.empty() ||
      !arguments.preview.empty() || arguments.resume || arguments.watch ||
      arguments.options.contains("measure_only"))
    throw Failure(ExitCode::usage,
                  "compare prints a table, or with --json both reports, and writes a page with -o; "
                  "leave out --report, --layout, --template, --preview, --resume, --watch and "
                  "--measure-only.");
  arguments.options["measure_only"] = "true";
}

/// Checks the names of pictures. Colours and views need the picture that they change: compare
/// shows both on its page.
void check_pictures(const Arguments& arguments) {
  check_ending("--layout", arguments.layout, kPictures);
  check_ending("--template", arguments.painting, kPictures);
  check_ending("--preview", arguments.preview, kPng);
  const bool has_page = arguments.compares && !arguments.out.empty();
  if (!arguments.layout_colour.empty() && arguments.layout.empty() && !has_page)
    throw Failure(ExitCode::usage,
                  "--layout-colour changes the picture of --layout; name that picture, too.");
  if (!arguments.preview_view.empty() && arguments.preview.empty() && !has_page)
    throw Failure(ExitCode::usage,
                  "--preview-view changes the picture of --preview; name that picture, too.");
}

/// The format that is asked for, or else that of the name; "auto" leaves it to the input.
std::string format_for(const Arguments& arguments) {
  const auto output = arguments.options.find("output");
  const std::string asked = output == arguments.options.end() ? "auto" : output->second;
  const bool is_named = !arguments.out.empty() && !is_standard(arguments.out);
  const std::string named =
      is_named ? format_of(arguments.out) : usual_output(local_name(arguments.file));
  if (asked == "auto") return named;
  if (is_named && named != "auto" && named != asked)
    throw Failure(ExitCode::usage, "--out: " + arguments.out.string() +
                                       " names another format than --output " + asked +
                                       "; name a ." + asked + ", or leave out --output.");
  return asked;
}

/// Of a command with one mesh.
void settle_output(Arguments& arguments) {
  arguments.file = std::exchange(arguments.inputs, {}).front();
  const std::string format = format_for(arguments);
  if (arguments.out.empty()) arguments.out = default_out(arguments.file, format);
  if (format != "auto") arguments.options["output"] = format;
}

void settle_servers(Arguments& arguments, const RawArguments& raw) {
  if (!raw.server.empty()) arguments.place = Place::server;
  if (raw.local) arguments.place = Place::here;
  arguments.servers = parse_server_urls(raw.server.empty() ? kUsualServer : raw.server);
  // Only from the environment, since all users of the machine can see a command line.
  const char* key = std::getenv("UNWRAP_API_KEY");
  for (ServerUrl& server : arguments.servers) server.key = key == nullptr ? "" : key;
}

}  // namespace

Arguments complete_arguments(RawArguments raw) {
  Arguments& arguments = raw.arguments;
  check_ending("--sample", arguments.sample, kGlb);
  if (!arguments.sample.empty()) return std::move(arguments);
  if (!(raw.timeout_seconds >= 0 && raw.timeout_seconds <= kMaxTimeoutSeconds))
    throw Failure(ExitCode::usage, "--timeout: it must be a number of seconds, at most a million.");
  if (arguments.inputs.empty()) throw Failure(ExitCode::usage, "FILE is missing; name a mesh.");
  settle_servers(arguments, raw);
  arguments.timeout = std::chrono::milliseconds(std::lround(1000 * raw.timeout_seconds));
  if (is_comparison(arguments)) settle_comparison(arguments);
  check_options(arguments.options);
  if (!arguments.compares) arguments.lambdas = lambdas_of(arguments.options);
  const bool is_one = !arguments.compares && !is_batch(arguments);
  if (!arguments.compares && !is_one) check_batch(arguments);
  check_pictures(arguments);
  if (is_one) settle_output(arguments);
  return std::move(arguments);
}

}  // namespace unwrapd::client
