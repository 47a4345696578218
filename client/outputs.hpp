#pragma once
// The files that a command writes: of every map of the job the result and its pictures, and one
// report. A job with a list of lambdas has a map for each; their files carry it in their names.

#include <filesystem>
#include <list>
#include <optional>
#include <string>
#include <vector>

#include "client/arguments.hpp"
#include "client/files.hpp"

namespace unwrapd::client {

/// "folder/bust.glb" and "0.1" become "folder/bust.0.1.glb"; without a lambda nothing changes.
std::filesystem::path map_path(const std::filesystem::path& path, const std::string& lambda);

/// What there is to tell of one map.
struct WrittenMap {
  std::string result;  ///< where the asset was written
  std::string report;  ///< JSON text
};

/// The files are opened before anything is sent: what cannot be written is known at once.
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
    std::string layout_path;
    NewFile result;
    std::optional<NewFile> layout, preview;
  };

  std::list<Map> maps_;
  std::optional<NewFile> report_;
};

}  // namespace unwrapd::client
