#include "client/figures.hpp"

#include "client/failure.hpp"

namespace unwrapd::client {
namespace {

Figures figures_of(const api::Json& report) {
  const api::Json &distortion = report.at("distortion"), &overlaps = report.at("overlaps");
  Figures figures{.faces = report.at("input").at("faces").get<long>(),
                  .charts = report.at("charts").size(),
                  .angle = distortion.at("angle").get<double>(),
                  .area = distortion.at("area").get<double>(),
                  .flipped = distortion.at("flipped").get<long>(),
                  .seam_ratio = report.at("seam_ratio").get<double>(),
                  .overlaps = {},
                  .fill = report.at("fill").get<double>(),
                  .notes = {}};
  if (!overlaps.is_null()) figures.overlaps = overlaps.get<long>();
  for (const api::Json& note : report.at("notes"))
    figures.notes.push_back("note (" + note.at("code").get<std::string>() +
                            "): " + note.at("text").get<std::string>());
  return figures;
}

}  // namespace

std::string overlaps_of(const Figures& figures) {
  return figures.overlaps ? std::to_string(*figures.overlaps) : "?";
}

Figures read_figures(const std::string& report) {
  try {
    return figures_of(api::Json::parse(report));
  } catch (const api::Json::exception&) {
    throw Failure(ExitCode::unreachable,
                  "The report is not of this version; use a server of the same version as unwrap.");
  }
}

}  // namespace unwrapd::client
