#include "client/compare.hpp"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>
#include <ostream>

#include "client/figures.hpp"
#include "client/files.hpp"
#include "client/outputs.hpp"
#include "client/printable.hpp"

namespace unwrapd::client {
namespace {

/// In place of a problem that advises to leave out an option which compare sets itself.
constexpr const char* kNothingToCompare =
    "It has no texture coordinates to compare; unwrap it first, or name another set by --texcoord. "
    "(code no_texture_coordinates)";

struct Measured {
  std::string name;
  std::string report = {};
  std::string layout = {}, preview = {};  ///< SVG and PNG, where a page is asked for
};

/// A row of the table: what is told, and of either mesh.
struct TableRow {
  std::string what;
  std::array<std::string, 2> of;
};

Measured measured(const Arguments& arguments, std::size_t which, const Servers& servers,
                  const Console& console, const std::stop_token& stop) {
  Arguments own = arguments;
  own.file = arguments.inputs[which];
  Measured mesh{.name = printable(own.file.string())};
  try {
    JobClient client(servers, stop);
    const std::string job = finished_job(client, own, console, stop);
    mesh.report = client.fetch(job, "/report");
    if (arguments.out.empty()) return mesh;
    mesh.layout = client.fetch(job, layout_of(arguments));
    mesh.preview = client.fetch(job, preview_of(arguments));
    return mesh;
  } catch (const Failure& failure) {
    const std::string what = failure.what();
    const bool has_none = what.find("no_texture_coordinates") != std::string::npos;
    throw Failure(failure.code(), mesh.name + ": " + (has_none ? kNothingToCompare : what));
  }
}

std::string number(double value, int decimals) {
  std::array<char, 64> text;
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

std::vector<TableRow> rows_of(const std::array<Measured, 2>& meshes) {
  const std::array<Figures, 2> figures = {read_figures(meshes[0].report),
                                          read_figures(meshes[1].report)};
  std::vector<TableRow> rows{{"", {meshes[0].name, meshes[1].name}}};
  const auto add = [&](const std::string& what, const auto& text) {
    rows.push_back({what, {text(figures[0]), text(figures[1])}});
  };
  add("faces", [](const Figures& f) { return std::to_string(f.faces); });
  add("charts", [](const Figures& f) { return std::to_string(f.charts); });
  add("seam length", [](const Figures& f) { return number(f.seam_ratio, 2); });
  add("D_angle", [](const Figures& f) { return number(f.angle, 3); });
  add("D_area", [](const Figures& f) { return number(f.area, 3); });
  add("flipped", [](const Figures& f) { return std::to_string(f.flipped); });
  add("overlaps", [](const Figures& f) { return overlaps_of(f); });
  add("fill", [](const Figures& f) { return number(f.fill, 2); });
  return rows;
}

/// Columns as wide as their longest text, numbers to the right.
std::string table_of(const std::vector<TableRow>& rows) {
  std::array<std::size_t, 3> width{};
  for (const TableRow& row : rows)
    width = {std::max(width[0], row.what.size()), std::max(width[1], row.of[0].size()),
             std::max(width[2], row.of[1].size())};
  std::string text;
  for (const TableRow& row : rows) {
    text += row.what + std::string(width[0] - row.what.size(), ' ');
    for (std::size_t k = 0; k < 2; ++k)
      text += std::string(2 + width[k + 1] - row.of[k].size(), ' ') + row.of[k];
    text += "\n";
  }
  return text + "(seam length: in units of the square root of the surface's area)\n";
}

std::string escaped(const std::string& text) {
  std::string html;
  for (const char c : text) {
    if (c == '<')
      html += "&lt;";
    else if (c == '&')
      html += "&amp;";
    else if (c == '"')
      html += "&quot;";
    else
      html += c;
  }
  return html;
}

std::string base64(const std::string& bytes) {
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');  // EVP ends it with a zero
  const int length = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                                     reinterpret_cast<const unsigned char*>(bytes.data()),
                                     static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(length));
  return text;
}

/// Without what stands before it in a file of its own.
std::string svg_of(const Measured& mesh) {
  const std::size_t begin = mesh.layout.find("<svg");
  if (begin == std::string::npos)
    throw Failure(ExitCode::unreachable, mesh.name + ": the layout that came is no SVG.");
  return mesh.layout.substr(begin);
}

/// One file without scripts, the pictures within it.
std::string page_of(const std::array<Measured, 2>& meshes, const std::vector<TableRow>& rows) {
  std::string html =
      "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<title>UVs compared</title>\n"
      "<style>body{font-family:sans-serif;margin:2em}td,th{padding:.2em 1em;text-align:right}"
      "th:first-child{text-align:left}img,svg{width:100%;height:auto}"
      ".both{display:grid;grid-template-columns:1fr 1fr;gap:1em}</style>\n<table>\n";
  for (const TableRow& row : rows) {
    const std::string cell = row.what.empty() ? "th" : "td";
    html += "<tr><th>" + row.what + "</th>";
    for (const std::string& text : row.of)
      html += "<" + cell + ">" + escaped(text) + "</" + cell + ">";
    html += "</tr>\n";
  }
  html += "</table>\n<div class=\"both\">\n";
  for (const Measured& mesh : meshes) html += "<div>" + svg_of(mesh) + "</div>\n";
  for (const Measured& mesh : meshes)
    html += "<img alt=\"" + escaped(mesh.name) +
            " with a checkerboard\" src=\"data:image/png;base64," + base64(mesh.preview) + "\">\n";
  return html + "</div>\n</html>\n";
}

}  // namespace

void compare(const Arguments& arguments, const Servers& servers, const Console& console,
             const std::stop_token& stop) {
  std::optional<NewFile> page;  // tried before anything is sent
  if (!arguments.out.empty()) page.emplace(arguments.out);
  const std::array<Measured, 2> meshes = {measured(arguments, 0, servers, console, stop),
                                          measured(arguments, 1, servers, console, stop)};
  const std::vector<TableRow> rows = rows_of(meshes);
  if (arguments.json)
    console.out << "[" << meshes[0].report << "," << meshes[1].report << "]" << std::endl;
  else if (!arguments.quiet)
    console.out << table_of(rows) << std::flush;
  if (!page) return;
  page->append(page_of(meshes, rows));
  page->commit();
}

}  // namespace unwrapd::client
