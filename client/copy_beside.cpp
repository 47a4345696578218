#include "client/copy_beside.hpp"

#include <algorithm>
#include <mutex>

#include "client/files.hpp"
#include "client/files_beside.hpp"
#include "client/formats.hpp"
#include "client/outputs.hpp"

namespace unwrapd::client {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostNames = 5;  // that a sentence lists

/// The format that is asked for, or else that of the input.
std::string result_format(const Arguments& arguments) {
  const auto output = arguments.options.find("output");
  const bool is_asked = output != arguments.options.end() && output->second != "auto";
  return is_asked ? output->second : extension_of(local_name(arguments.file));
}

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

/// Whether the file would lie below the folder, through symbolic links.
bool is_below(const fs::path& file, const fs::path& folder) {
  std::error_code error;
  const fs::path inner = fs::weakly_canonical(file, error);
  const fs::path outer = error ? fs::path() : fs::weakly_canonical(folder, error);
  return !error && std::ranges::mismatch(outer, inner).in1 == outer.end();
}

bool are_same(const fs::path& a, const fs::path& b) {
  std::error_code error;
  if (fs::equivalent(a, b, error)) return true;
  return file_bytes(a) == file_bytes(b) && read_file(a) == read_file(b);
}

/// A file that the result refers to.
struct Needed {
  std::string name;  ///< as the document tells it
  fs::path below;    ///< below the folder of the document; empty if it lies outside
};

std::vector<Needed> needed_files(const Arguments& arguments, const fs::path& result) {
  const std::string format = result_format(arguments);
  std::vector<Needed> files;
  if (format == "obj" && extension_of(arguments.file) == "obj")
    for (const FileBeside& file : files_beside(arguments.file, {.materials = true}))
      files.push_back({file.uri, file.uri});
  if (format == "gltf")
    for (const std::string& uri : image_uris(result))
      files.push_back({uri, path_below(uri).value_or(fs::path())});
  return files;
}

enum class Outcome { there, missing, differs };

Outcome copy_one(const fs::path& below, const fs::path& source, const fs::path& folder) {
  static std::mutex of_one_at_a_time;  // meshes of a folder share images
  const std::scoped_lock lock(of_one_at_a_time);
  if (below.empty()) return Outcome::missing;
  const fs::path from = source / below, to = folder / below;
  std::error_code error;
  const bool has_source = fs::is_regular_file(from, error);
  if (fs::exists(fs::symlink_status(to, error)))
    return !has_source || are_same(from, to) ? Outcome::there : Outcome::differs;
  if (!has_source || !is_below(to, folder)) return Outcome::missing;
  fs::create_directories(to.parent_path(), error);
  write_file(to, read_file(from));
  return Outcome::there;
}

/// "a.png, b.png", the first few of them.
std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t k = 0; k < std::min(names.size(), kMostNames); ++k)
    text += (k == 0 ? "" : ", ") + names[k];
  return names.size() > kMostNames ? text + " and others" : text;
}

}  // namespace

std::vector<std::string> copy_beside(const Arguments& arguments) {
  const std::string lambda = arguments.lambdas.empty() ? "" : arguments.lambdas.front();
  const fs::path result = map_path(arguments.out, lambda);
  const fs::path folder = folder_of(result), source = folder_of(arguments.file);
  std::error_code error;
  if (is_stream(result) || fs::equivalent(folder, source, error)) return {};
  std::vector<std::string> missing, different;
  for (const Needed& needed : needed_files(arguments, result)) {
    Outcome outcome = Outcome::missing;
    try {
      outcome = copy_one(needed.below, source, folder);
    } catch (const Failure&) {  // a file that cannot be read or written
    }
    if (outcome == Outcome::missing) missing.push_back(needed.name);
    if (outcome == Outcome::differs) different.push_back(needed.name);
  }
  std::vector<std::string> sentences;
  if (!missing.empty())
    sentences.push_back(result.string() + " refers to files that could not be copied from beside " +
                        arguments.file.string() +
                        "; put them beside the result: " + listed(missing));
  if (!different.empty())
    sentences.push_back("Files beside " + result.string() + " differ from those beside " +
                        arguments.file.string() + " and were not replaced: " + listed(different));
  return sentences;
}

}  // namespace unwrapd::client
