#include "client/batch_files.hpp"

#include <glob.h>

#include <algorithm>
#include <map>

#include "client/failure.hpp"
#include "client/files.hpp"
#include "client/formats.hpp"

namespace unwrapd::client {
namespace {

namespace fs = std::filesystem;

/// A mesh, and its name below the input that led to it.
struct Found {
  fs::path file;
  fs::path name;
};

/// "chair.uv.glb", and "chair.uv.0.1.glb" of a list of lambdas.
bool is_result(const fs::path& path) {
  const std::string stem = path.stem().string();
  return stem.ends_with(".uv") || stem.find(".uv.") != std::string::npos;
}

void add_folder(const fs::path& folder, const fs::path& results, std::vector<Found>& found) {
  const std::size_t first = found.size();
  std::error_code error, none;
  const auto skip = fs::directory_options::skip_permission_denied;
  for (fs::recursive_directory_iterator at(folder, skip, error), end; !error && at != end;
       at.increment(error)) {
    const fs::path& path = at->path();
    if (fs::equivalent(path, results, none)) at.disable_recursion_pending();
    if (at->is_regular_file(none) && is_mesh_name(path) && !is_result(path))
      found.push_back({path, path.lexically_relative(folder)});
  }
  if (error)
    throw Failure(ExitCode::file, folder.string() + " cannot be read: " + error.message() + ".");
  std::ranges::sort(found.begin() + static_cast<std::ptrdiff_t>(first), found.end(), {},
                    &Found::file);
}

/// A name that no file has is taken for a pattern.
std::vector<fs::path> expanded(const fs::path& input) {
  std::error_code none;
  if (fs::exists(input, none)) return {input};
  glob_t matches{};
  std::vector<fs::path> paths;
  if (::glob(input.c_str(), 0, nullptr, &matches) == 0)
    paths.assign(matches.gl_pathv, matches.gl_pathv + matches.gl_pathc);
  ::globfree(&matches);
  if (paths.empty()) paths.push_back(input);  // it is told as a file that is not there
  return paths;
}

std::vector<Found> found_in(std::span<const fs::path> inputs, const fs::path& results) {
  std::vector<Found> found;
  for (const fs::path& input : inputs)
    for (const fs::path& path : expanded(input)) {
      std::error_code none;
      if (fs::is_directory(path, none)) {
        add_folder(path, results, found);
      } else {
        found.push_back({path, path.filename()});
      }
    }
  return found;
}

fs::path result_of(const Found& mesh, const fs::path& folder, const std::string& output) {
  const fs::path beside = default_out(mesh.file, output);
  if (folder.empty()) return beside;
  fs::path out = folder / mesh.name;
  return out.replace_extension(beside.extension());
}

}  // namespace

std::vector<BatchFile> batch_files(std::span<const fs::path> inputs, const fs::path& folder,
                                   const std::string& output) {
  std::vector<BatchFile> all;
  std::map<fs::path, fs::path> taken;  // mesh by result
  for (const Found& mesh : found_in(inputs, folder)) {
    if (is_stream(mesh.file))
      throw Failure(ExitCode::usage, mesh.file.string() + " is no file; name it alone.");
    BatchFile item{mesh.file, result_of(mesh, folder, output)};
    std::error_code none;
    const auto [before, is_new] = taken.emplace(file_behind(item.out), item.file);
    if (is_new) {
      all.push_back(std::move(item));
    } else if (before->second != item.file && !fs::equivalent(before->second, item.file, none)) {
      throw Failure(ExitCode::usage, before->second.string() + " and " + item.file.string() +
                                         " would both become " + item.out.string() +
                                         "; unwrap them into two folders.");
    }
  }
  return all;
}

bool is_done(const BatchFile& item) {
  std::error_code error;
  const auto made = fs::last_write_time(item.out, error);
  return !error && made >= fs::last_write_time(item.file, error) && !error;
}

}  // namespace unwrapd::client
