#include "client/run.hpp"

#include <array>
#include <cstdio>
#include <ostream>
#include <vector>

#include "client/batch.hpp"
#include "client/compare.hpp"
#include "client/copy_beside.hpp"
#include "client/figures.hpp"
#include "client/files.hpp"
#include "client/printable.hpp"
#include "client/sample.hpp"
#include "client/workplace.hpp"

namespace unwrapd::client {
namespace {

/// "2 overlaps"; overlaps that were not counted are told as such.
std::string overlaps_text(const Figures& figures) {
  return figures.overlaps ? std::to_string(*figures.overlaps) + " overlaps"
                          : "overlaps not counted";
}

/// "chair.uv.glb: 20164 faces, 3 charts, D_angle 2.002, D_area 2.002, 0 flipped, 0 overlaps, fill
/// 0.71".
std::string summary(const std::string& name, const Figures& figures) {
  std::array<char, 256> text;
  std::snprintf(text.data(), text.size(),
                ": %ld faces, %zu chart%s, D_angle %.3f, D_area %.3f, %ld flipped, %s, fill %.2f\n",
                figures.faces, figures.charts, figures.charts == 1 ? "" : "s", figures.angle,
                figures.area, figures.flipped, overlaps_text(figures).c_str(), figures.fill);
  return name + text.data();
}

/// Prints a line for each map, then the notes, which are the same for all.
void tell_maps(const std::vector<WrittenMap>& maps, std::ostream& out) {
  for (const WrittenMap& map : maps) out << summary(map.result, read_figures(map.report));
  for (const std::string& note : read_figures(maps.front().report).notes) out << note << "\n";
  out << std::flush;
}

void tell(const Arguments& arguments, const std::vector<WrittenMap>& maps, const Console& console) {
  if (arguments.json) {
    console.out << maps.front().report << std::endl;
  } else if (!arguments.quiet) {
    tell_maps(maps, writes_to_standard_output(arguments) ? console.err : console.out);
  }
}

}  // namespace

void run(const Arguments& arguments, const Console& console, const std::stop_token& stop) {
  if (!arguments.sample.empty()) {
    write_file(arguments.sample, sample_glb());
    return;
  }
  if (arguments.inputs.empty()) check_outputs(arguments);
  const Workplace workplace(arguments, stop);
  if (workplace.is_here() && arguments.place == Place::any && !arguments.quiet)
    console.err << "No server answers at " << arguments.servers.front().origin
                << ": the job runs in this process." << std::endl;
  if (arguments.compares) {
    compare(arguments, workplace.servers(), console, stop);
  } else if (arguments.inputs.empty()) {
    JobClient client(workplace.servers(), stop);
    tell(arguments, unwrap_file(client, arguments, console, stop), console);
    for (const std::string& sentence : copy_beside(arguments))
      console.err << printable(sentence) << std::endl;
  } else {
    run_batch(arguments, workplace.servers(), console, stop);
  }
}

}  // namespace unwrapd::client
