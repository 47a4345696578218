#include "client/outputs.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <string_view>

#include "client/formats.hpp"

namespace unwrapd::client {
namespace {

namespace fs = std::filesystem;

/// "1e%2B5" of "1e+5": in a query a plus is a space.
std::string in_query(const std::string& text) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  std::string encoded;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool is_plain = std::isalnum(byte) != 0 || c == '.' || c == ',' || c == '-';
    if (is_plain) encoded += c;
    if (!is_plain) encoded += {'%', digits[byte / 16], digits[byte % 16]};
  }
  return encoded;
}

std::string lambda_query(const std::string& lambda) {
  return lambda.empty() ? std::string() : "lambda=" + in_query(lambda);
}

std::string append_query(const std::string& path, const std::string& query) {
  if (query.empty()) return path;
  return path + (path.find('?') == std::string::npos ? "?" : "&") + query;
}

struct Output {
  std::string_view flag;
  fs::path path;
};

std::vector<Output> outputs_of(const Arguments& arguments) {
  std::vector<Output> all;
  const auto add = [&](std::string_view flag, const fs::path& path, const std::string& lambda) {
    if (!path.empty()) all.push_back({flag, map_path(path, lambda)});
  };
  const std::vector<std::string> one_map = {""};
  for (const std::string& lambda : arguments.lambdas.empty() ? one_map : arguments.lambdas) {
    add("--out", arguments.out, lambda);
    add("--layout", arguments.layout, lambda);
    add("--template", arguments.painting, lambda);
    add("--preview", arguments.preview, lambda);
  }
  add("--report", arguments.report, "");
  return all;
}

[[noreturn]] void refuse(const std::string& what) { throw Failure(ExitCode::usage, what); }

void check_standard_output(const Arguments& arguments, const std::vector<Output>& outputs) {
  const auto count = std::ranges::count_if(outputs, is_standard, &Output::path);
  if (count > 1)
    refuse("Standard output (-) takes one file, and " + std::to_string(count) +
           " would be written to it; name the others.");
  if (count == 1 && arguments.json)
    refuse("--json prints the report on standard output, where another file goes; name that file.");
}

}  // namespace

std::string layout_of(const Arguments& arguments) {
  std::string path = is_png(arguments.layout) ? "/layout.png" : "/layout.svg";
  if (!arguments.layout_colour.empty()) path += "?colour=" + arguments.layout_colour;
  return path;
}

std::string template_of(const Arguments& arguments) {
  return std::string(is_png(arguments.painting) ? "/layout.png?size=page" : "/layout.svg?page=1") +
         "&wireframe=1&background=none";
}

std::string preview_of(const Arguments& arguments) {
  return arguments.preview_view.empty() ? "/preview.png"
                                        : "/preview.png?view=" + in_query(arguments.preview_view);
}

fs::path map_path(const fs::path& path, const std::string& lambda) {
  if (lambda.empty() || is_standard(path)) return path;
  fs::path named = path;
  named.replace_filename(path.stem().string() + "." + lambda + path.extension().string());
  return named;
}

bool writes_to_standard_output(const Arguments& arguments) {
  return std::ranges::any_of(outputs_of(arguments), is_standard, &Output::path);
}

void check_outputs(const Arguments& arguments) {
  const std::vector<Output> outputs = outputs_of(arguments);
  check_standard_output(arguments, outputs);
  std::map<fs::path, std::string_view> taken;
  if (!is_stream(arguments.file)) taken.emplace(file_behind(arguments.file), "");
  for (const auto& [flag, path] : outputs) {
    if (is_stream(path)) continue;
    const auto [before, is_new] = taken.emplace(file_behind(path), flag);
    if (is_new) continue;
    if (before->second.empty())
      refuse(std::string(flag) + " names the input, " + path.string() + "; name another file.");
    refuse(std::string(before->second) + " and " + std::string(flag) + " name the same file, " +
           path.string() + "; name one for each.");
  }
}

Outputs::Map::Map(const Arguments& arguments, const std::string& lambda)
    : name(is_standard(arguments.out) ? "standard output"
                                      : map_path(arguments.out, lambda).string()),
      query(lambda_query(lambda)),
      layout_path(layout_of(arguments)),
      template_path(template_of(arguments)),
      preview_path(preview_of(arguments)),
      result(map_path(arguments.out, lambda)) {
  if (!arguments.layout.empty()) layout.emplace(map_path(arguments.layout, lambda));
  if (!arguments.painting.empty()) painting.emplace(map_path(arguments.painting, lambda));
  if (!arguments.preview.empty()) preview.emplace(map_path(arguments.preview, lambda));
}

std::string Outputs::Map::fetch(JobClient& client, const std::string& job_id) {
  client.fetch(job_id, append_query("/result", query),
               [&](std::string_view bytes) { result.append(bytes); });
  if (layout) layout->append(client.fetch(job_id, append_query(layout_path, query)));
  if (painting) painting->append(client.fetch(job_id, append_query(template_path, query)));
  if (preview) preview->append(client.fetch(job_id, append_query(preview_path, query)));
  return client.fetch(job_id, append_query("/report", query));
}

void Outputs::Map::commit() {
  if (layout) layout->commit();
  if (painting) painting->commit();
  if (preview) preview->commit();
  result.commit();
}

Outputs::Outputs(const Arguments& arguments) {
  for (const std::string& lambda : arguments.lambdas) maps_.emplace_back(arguments, lambda);
  if (maps_.empty()) maps_.emplace_back(arguments, "");
  if (!arguments.report.empty()) report_.emplace(arguments.report);
}

std::vector<WrittenMap> Outputs::fill(JobClient& client, const std::string& job_id) {
  std::vector<WrittenMap> written;
  for (Map& map : maps_) written.push_back({map.name, map.fetch(client, job_id)});
  if (report_) report_->append(written.front().report);
  if (report_) report_->commit();
  for (Map& map : maps_) map.commit();
  return written;
}

}  // namespace unwrapd::client
