#include "client/arguments.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <span>
#include <string_view>

#include "api/error_table.hpp"
#include "api/options.hpp"
#include "client/files.hpp"

namespace unwrapd::client {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxTimeoutSeconds = 1e6;
constexpr const char* kUsualServer = "http://127.0.0.1:8080";

constexpr const char* kAbout =
    "unwrap computes UV coordinates for a triangle mesh: it sends FILE (glTF, GLB, OBJ, STL, "
    "PLY or OFF) to an unwrapd server, or does its work where there is none, shows the progress, "
    "and writes the same asset with texture coordinates.";

constexpr const char* kFooter = R"(Examples:
  unwrap chair.glb                                 writes chair.uv.glb
  unwrap chair.gltf -o chair.glb --method asap     sends the buffers beside chair.gltf with it
  unwrap bust.obj -o bust.uv.obj --method hybrid --lambda 0.1 --layout bust.svg
  unwrap bust.glb --method hybrid --lambda 1,0.1   writes bust.uv.1.glb and bust.uv.0.1.glb
  unwrap chair.glb --json --quiet | jq .distortion
  unwrap chair.glb --local --preset lightmap       works without a server
  curl -s $URL | unwrap - --output glb > chair.uv.glb
  unwrap --sample shell.glb                        writes a mesh to try these commands with

For servers that require an API key, set the environment variable UNWRAP_API_KEY.

Exit codes:
    0  done
    1  the server refused the job, or the job failed; the problem is printed on stderr
    2  the command line is wrong
    3  the server cannot be reached, does not answer in time, or is not unwrapd
    4  a file cannot be read or written
  130  interrupted (Ctrl-C): the job is cancelled)";

std::string flag_name(std::string_view option) {
  std::string flag(option);
  std::ranges::replace(flag, '_', '-');
  std::ranges::replace(flag, '.', '-');
  return "--" + flag;
}

std::string value_text(const api::Json& value) {
  if (value.is_null()) return "unset";
  if (value.is_array()) return "empty";
  return value.is_string() ? value.get<std::string>() : value.dump();
}

constexpr double kMostDigits = 1e9;  // larger numbers have an exponent

/// "asap|arap|hybrid", "INT >= 1", "NUMBER[,NUMBER...] >= 0", "INT in [16, 16384]".
std::string range_text(const api::OptionRow& row) {
  if (row.type == api::OptionType::objects) return "FILE.json";
  if (row.type == api::OptionType::names) return "NAME[,NAME...]";
  if (row.type == api::OptionType::choice) {
    std::string text;
    for (const std::string_view choice : row.choices)
      text += (text.empty() ? "" : "|") + std::string(choice);
    return text;
  }
  std::string kind = row.type == api::OptionType::integer ? "INT" : "NUMBER";
  if (row.type == api::OptionType::numbers) kind += "[,NUMBER...]";
  const auto figure = [](double value) {
    const bool is_whole = std::trunc(value) == value && std::abs(value) < kMostDigits;
    return is_whole ? std::to_string(std::lround(value)) : api::Json(value).dump();
  };
  std::string text = kind + " >= " + figure(row.minimum);
  if (row.maximum) text = kind + " in [" + figure(row.minimum) + ", " + figure(*row.maximum) + "]";
  for (const std::string_view word : row.choices) text += "|" + std::string(word);
  return can_unset(row) ? text + "|none" : text;
}

/// Adds one flag for every row of the API's table; their values go to options.
void add_option_flags(CLI::App& app, OptionTexts& options) {
  for (const api::OptionRow& row : api::option_table()) {
    const std::string name(row.name);
    const std::string text = std::string(row.description) +
                             " Default: " + value_text(api::option_default(row, {})) + ".";
    const bool is_file = row.type == api::OptionType::objects;
    if (row.type == api::OptionType::flag) {
      app.add_flag_callback(
             flag_name(row.name), [&options, name] { options[name] = "true"; }, text)
          ->group("Options of the job");
      continue;
    }
    app.add_option_function<std::string>(
           flag_name(row.name),
           [&options, name, is_file](const std::string& value) {
             options[name] = is_file ? read_file(value) : value;
           },
           text)
        ->type_name(range_text(row))
        ->group("Options of the job");
  }
}

/// The raw values of the command line's flags.
struct RawArguments {
  Arguments arguments;
  std::string server;
  bool local = false;
  double timeout_seconds = 0;
};

void add_picture_flags(CLI::App& app, Arguments& arguments) {
  app.add_option("--layout", arguments.layout,
                 "Write a picture of the UV layout to PATH: a PNG if it ends in .png, else an SVG")
      ->type_name("PATH");
  app.add_option("--layout-colour", arguments.layout_colour,
                 "Quantity that the layout's colours show: worst stretch of lengths, distortion of "
                 "angles, ratio of areas, or flipped triangles. Default: stretch")
      ->check(CLI::IsMember({"stretch", "angle", "area", "flips"}).description(""))
      ->type_name("stretch|angle|area|flips");
  app.add_option("--preview", arguments.preview,
                 "Write a picture of the mesh, textured with a checkerboard, to PATH (PNG)")
      ->type_name("PATH");
}

void add_flags(CLI::App& app, RawArguments& raw) {
  Arguments& arguments = raw.arguments;
  app.add_option("FILE", arguments.file,
                 "The mesh: .glb, .gltf, .obj, .stl, .ply or .off, or a .zip with one of them; "
                 "- reads standard input")
      ->type_name("");
  app.add_option(
         "-o,--out", arguments.out,
         "File to write the result to. Its extension selects the format unless --output "
         "does; GLB, glTF and OBJ are written. Default: the name of FILE with \".uv\" before the "
         "extension, which becomes .glb for .stl, .ply, .off and .zip; - (standard output) if FILE "
         "is "
         "- or a pipe. A list of lambdas writes one file for each, with the lambda before the "
         "extension")
      ->type_name("OUT");
  app.add_option("--report", arguments.report, "Write the report (JSON) to PATH")
      ->type_name("PATH");
  add_picture_flags(app, arguments);
  app.add_flag("--json", arguments.json, "Print only the report (JSON) on stdout");
  app.add_flag("-q,--quiet", arguments.quiet, "Print no progress and no summary");
  app.add_option("--server", raw.server,
                 std::string("Address of the server. Default: ") + kUsualServer +
                     "; if none answers there, the job runs in this process")
      ->type_name("URL")
      ->envname("UNWRAPD_SERVER");
  app.add_flag("--local", raw.local,
               "Run the job in this process, without a server, whatever --server says");
  app.add_option("--timeout", raw.timeout_seconds,
                 "Cancel the job and give up after this many seconds; 0: never")
      ->type_name("SECONDS")
      ->capture_default_str();
  app.add_option("--sample", arguments.sample,
                 "Write a sample mesh (GLB, 20,164 faces) to OUT.glb and exit")
      ->type_name("OUT.glb");
  app.set_version_flag("--version", "unwrap " UNWRAPD_VERSION);
}

constexpr std::array<std::string_view, 3> kWritten = {"glb", "gltf", "obj"};
constexpr std::array<std::string_view, 3> kOnlyRead = {"stl", "ply", "off"};
constexpr std::array<std::string_view, 10> kForeign = {"zip",  "fbx",  "dae", "usd", "usda",
                                                       "usdc", "usdz", "3mf", "3ds", "blend"};

bool is_among(std::span<const std::string_view> names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

/// The extension in small letters, without its dot.
std::string extension_of(const fs::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  return extension.empty() ? extension : extension.substr(1);
}

/// The format of a file name: "glb", "gltf", "obj", or "auto" for any other. Throws Failure for the
/// name of a format that is not written.
std::string format_of(const fs::path& path) {
  const std::string extension = extension_of(path);
  if (is_among(kWritten, extension)) return extension;
  if (is_among(kOnlyRead, extension) || is_among(kForeign, extension))
    throw Failure(ExitCode::usage,
                  "--out: ." + extension + " is not written" +
                      (extension == "stl" ? ", because STL has no place for UVs" : "") +
                      "; name a .glb, .gltf or .obj.");
  return "auto";
}

/// An archive's asset may have any format, so that the format of its result is to be named.
bool is_zip(const fs::path& path) { return extension_of(path) == "zip"; }

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

/// Checks what the parser cannot, and derives the remaining values.
Arguments complete(RawArguments raw) {
  Arguments& arguments = raw.arguments;
  if (!arguments.sample.empty()) return std::move(arguments);
  if (!(raw.timeout_seconds >= 0 && raw.timeout_seconds <= kMaxTimeoutSeconds))
    throw Failure(ExitCode::usage, "--timeout: it must be a number of seconds, at most a million.");
  if (arguments.file.empty()) throw Failure(ExitCode::usage, "FILE is missing; name a mesh.");
  if (!raw.server.empty()) arguments.place = Place::server;
  if (raw.local) arguments.place = Place::here;
  arguments.server = parse_server_url(raw.server.empty() ? kUsualServer : raw.server);
  // Only from the environment, since all users of the machine can see a command line.
  if (const char* key = std::getenv("UNWRAP_API_KEY")) arguments.server.key = key;
  arguments.timeout = std::chrono::milliseconds(std::lround(1000 * raw.timeout_seconds));
  check_options(arguments.options);
  arguments.lambdas = lambdas_of(arguments.options);
  const auto output = arguments.options.find("output");
  const bool output_given = output != arguments.options.end();
  const bool is_named = !arguments.out.empty() && !is_standard(arguments.out);
  const std::string format = is_named                 ? format_of(arguments.out)
                             : is_zip(arguments.file) ? "glb"
                                                      : "auto";
  if (arguments.out.empty())
    arguments.out = default_out(arguments.file, output_given ? output->second : "auto");
  if (!output_given && format != "auto") arguments.options["output"] = format;
  return std::move(arguments);
}

}  // namespace

fs::path default_out(const fs::path& file, const std::string& output) {
  if (is_stream(file)) return "-";
  fs::path out = file;
  const bool keep = output.empty() || output == "auto";
  std::string extension = keep ? file.extension().string() : "." + output;
  if (keep && (is_among(kOnlyRead, extension_of(file)) || is_zip(file))) extension = ".glb";
  out.replace_filename(file.stem().string() + ".uv" + extension);
  return out;
}

std::variant<Arguments, Message> parse_arguments(int argc, const char* const* argv) {
  CLI::App app(kAbout, "unwrap");
  app.footer(kFooter);
  RawArguments raw;
  add_flags(app, raw);
  add_option_flags(app, raw.arguments.options);
  try {
    app.parse(argc, argv);
    return complete(std::move(raw));
  } catch (const CLI::CallForHelp&) {
    return Message{ExitCode::ok, app.help()};
  } catch (const CLI::CallForVersion& version) {
    return Message{ExitCode::ok, std::string(version.what()) + "\n"};
  } catch (const CLI::ParseError& error) {
    return Message{ExitCode::usage,
                   std::string("unwrap: ") + error.what() + "\nSee unwrap --help.\n"};
  } catch (const Failure& failure) {
    return Message{failure.code(),
                   std::string("unwrap: ") + failure.what() + "\nSee unwrap --help.\n"};
  }
}

}  // namespace unwrapd::client
