#pragma once
// The files that a command writes: the result and the pictures of every map, and one report. A job
// with a list of lambdas has a map for each, whose file names contain it.

#include <filesystem>
#include <list>
#include <optional>
#include <string>
#include <vector>

#include "client/arguments.hpp"
#include "client/files.hpp"

namespace unwrapd::client {

/// "folder/bust.glb" and "0.1" become "folder/bust.0.1.glb"; without a lambda, and for
/// standard output, the path stays.
std::filesystem::path map_path(const std::filesystem::path& path, const std::string& lambda);

/// What shows the layout in the colours that are asked for: an SVG, unless --layout names a PNG.
std::string layout_of(const Arguments& arguments);

/// What shows the template that --template names, and the preview.
std::string template_of(const Arguments& arguments);
std::string preview_of(const Arguments& arguments);

/// Whether the result, the report or a picture goes to standard output.
bool writes_to_standard_output(const Arguments& arguments);

/// Throws Failure{usage} where two outputs would be one file, or one would be the input.
void check_outputs(const Arguments& arguments);

/// The output of one map, for the summary.
struct WrittenMap {
  std::string result;  ///< where the asset was written
  std::string report;  ///< JSON text
};

/// Opens the files before anything is sent, so that an unwritable file is reported at once.
/// Requires check_outputs().
class Outputs {
 public:
  explicit Outputs(const Arguments& arguments);

  /// Fetches and writes all of them. Throws Failure.
  std::vector<WrittenMap> fill(JobClient& client, const std::string& job_id);

 private:
  struct Map {
    Map(const Arguments& arguments, const std::string& lambda);
    std::string fetch(JobClient& client, const std::string& job_id);
    void commit();

    std::string name;
    std::string query;  ///< "lambda=0.1", or nothing
    std::string layout_path, template_path, preview_path;
    NewFile result;
    std::optional<NewFile> layout, painting, preview;
  };

  std::list<Map> maps_;
  std::optional<NewFile> report_;
};

}  // namespace unwrapd::client
