#include "client/arguments.hpp"

#include <CLI/CLI.hpp>
#include <string_view>
#include <utility>

#include "client/complete_arguments.hpp"
#include "client/in_flight.hpp"
#include "client/nearest.hpp"
#include "client/option_flags.hpp"

namespace unwrapd::client {
namespace {

constexpr const char* kAbout =
    "unwrap computes UV coordinates for a triangle mesh: it sends FILE (glTF, GLB, OBJ, STL, "
    "PLY or OFF) to an unwrapd server, or does its work where there is none, shows the progress, "
    "and writes the same asset with texture coordinates.";

constexpr const char* kFooter = R"(Examples:
  unwrap chair.glb                                 writes chair.uv.glb
  unwrap chair.gltf -o chair.glb --method asap     sends buffers and images beside it, too
  unwrap bust.obj -o bust.uv.obj --method hybrid --lambda 0.1 --layout bust.svg
  unwrap bust.glb --method hybrid --lambda 1,0.1   writes bust.uv.1.glb and bust.uv.0.1.glb
  unwrap chair.glb --json --quiet | jq .distortion
  unwrap chair.glb --local --preset lightmap       works without a server
  unwrap meshes --out done -j 8 --resume           all meshes below the folder meshes
  unwrap compare old.glb new.glb -o both.html      tells the UVs of two files side by side
  curl -s $URL | unwrap - --output glb > chair.uv.glb
  unwrap --sample shell.glb                        writes a mesh to try these commands with

For servers that require an API key, set the environment variable UNWRAP_API_KEY.

Exit codes:
    0  done
    1  the server refused the job, or the job failed; the problem is printed on stderr. Of several
       meshes: one failed, and the others are done
    2  the command line is wrong
    3  the server cannot be reached, does not answer in time, or is not unwrapd
    4  a file cannot be read or written
  130  interrupted (Ctrl-C): the job is cancelled)";

void add_picture_flags(CLI::App& app, Arguments& arguments) {
  app.add_option("--layout", arguments.layout,
                 "Write a picture of the UV layout to PATH: a .png or an .svg")
      ->type_name("PATH");
  app.add_option("--layout-colour", arguments.layout_colour,
                 "Quantity that the layout's colours show: worst stretch of lengths, distortion of "
                 "angles, ratio of areas, or flipped triangles. Default: stretch")
      ->check(CLI::IsMember({"stretch", "angle", "area", "flips"}).description(""))
      ->type_name("stretch|angle|area|flips");
  app.add_option("--template", arguments.painting,
                 "Write a template to paint on to PATH: the edges of the layout without a "
                 "background, as a .png with a pixel for each texel or an .svg")
      ->type_name("PATH");
  app.add_option("--preview-view", arguments.preview_view,
                 "From where the preview shows the mesh: front, back, left, right, top, bottom, "
                 "turntable (eight views), or two angles such as 30,20. Default: aslant")
      ->type_name("VIEW");
  app.add_option("--preview", arguments.preview,
                 "Write a picture of the mesh, textured with a checkerboard, to PATH (.png)")
      ->type_name("PATH");
}

void add_flags(CLI::App& app, RawArguments& raw) {
  Arguments& arguments = raw.arguments;
  app.add_option(
         "FILE", arguments.inputs,
         "The mesh: .glb, .gltf, .obj, .stl, .ply or .off, or a .zip with one of them; "
         "- reads standard input; the server reads an address (https://). Several files, a pattern "
         "in quotes, or a folder, for all meshes below it, are unwrapped side by side, in a table. "
         "compare A B: the UVs that two meshes have, side by side")
      ->type_name("");
  app.add_option(
         "-o,--out", arguments.out,
         "File to write the result to. Its extension selects the format unless --output "
         "does; GLB, glTF and OBJ are written. Default: the name of FILE with \".uv\" before the "
         "extension, which becomes .glb unless it is .glb, .gltf or .obj; - (standard output) if "
         "FILE "
         "is - or a pipe. With several meshes, --resume or --watch the folder for their results. A "
         "list of lambdas writes one file for each, with the lambda before the extension. compare "
         "writes a page (.html)")
      ->type_name("OUT");
  app.add_option("--report", arguments.report, "Write the report (JSON) to PATH")
      ->type_name("PATH");
  add_picture_flags(app, arguments);
  app.add_option("--name", arguments.name,
                 "Name of the job for people, shown in the server's list of jobs")
      ->type_name("TEXT");
  app.add_flag(
      "--json", arguments.json,
      "Print only the report (JSON) on stdout; of several meshes a line of JSON for each, of "
      "compare a list of both");
  app.add_flag("-q,--quiet", arguments.quiet, "Print no progress and no summary");
  app.add_option("--server", raw.server,
                 std::string("Address of the server, or of several nodes of a farm, with commas "
                             "between them. Default: ") +
                     kUsualServer + "; if none answers there, the job runs in this process")
      ->type_name("URL")
      ->envname("UNWRAPD_SERVER");
  app.add_flag("--local", raw.local,
               "Run the job in this process, without a server, whatever --server says");
  app.add_option("-j,--jobs", arguments.jobs,
                 "Of several meshes, unwrap so many at once. Default: as many as keep all workers "
                 "of the server busy")
      ->check(CLI::Range(1, InFlight::kMost).description(""))
      ->type_name("N");
  app.add_flag("--resume", arguments.resume,
               "Leave out meshes whose results are there and newer than they are");
  app.add_flag("--watch", arguments.watch,
               "Go on with meshes that come into the folder, or change, until Ctrl-C");
  app.add_option("--timeout", raw.timeout_seconds,
                 "Cancel the job and give up after this many seconds; 0: never")
      ->type_name("SECONDS")
      ->capture_default_str();
  app.add_option("--sample", arguments.sample,
                 "Write a sample mesh (GLB, 20,164 faces) to OUT.glb and exit")
      ->type_name("OUT.glb");
  app.set_version_flag("--version", "unwrap " UNWRAPD_VERSION);
}

/// "; did you mean --method?" after a flag that is not known and nearly one that is.
std::string hint(const CLI::App& app) {
  std::vector<std::string> flags;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) flags.push_back("--" + name);
  for (const std::string& given : app.remaining())
    if (given.starts_with("--"))
      if (const auto* flag = nearest(given.substr(0, given.find('=')), flags))
        return "; did you mean " + *flag + "?";
  return {};
}

/// The parser's words on an option that is given too often, said more simply.
std::string mismatch(const std::string& text) {
  const std::size_t end = text.find(": At Most 1 required");
  if (end == std::string::npos) return text;
  return text.substr(0, end) + " is given several times; give it once.";
}

Message refusal(ExitCode code, const std::string& why) {
  return {code, "unwrap: " + why + "\nSee unwrap --help.\n"};
}

}  // namespace

std::variant<Arguments, Message> parse_arguments(int argc, const char* const* argv) {
  CLI::App app(kAbout, "unwrap");
  app.footer(kFooter);
  RawArguments raw;
  add_flags(app, raw);
  add_option_flags(app, raw.arguments.options);
  try {
    app.parse(argc, argv);
    return complete_arguments(std::move(raw));
  } catch (const CLI::CallForHelp&) {
    return Message{ExitCode::ok, app.help()};
  } catch (const CLI::CallForVersion& version) {
    return Message{ExitCode::ok, std::string(version.what()) + "\n"};
  } catch (const CLI::ExtrasError& error) {
    return refusal(ExitCode::usage, error.what() + hint(app));
  } catch (const CLI::ArgumentMismatch& error) {
    return refusal(ExitCode::usage, mismatch(error.what()));
  } catch (const CLI::ParseError& error) {
    return refusal(ExitCode::usage, error.what());
  } catch (const Failure& failure) {
    return refusal(failure.code(), failure.what());
  }
}

}  // namespace unwrapd::client
