#include "client/batch.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <iomanip>
#include <map>
#include <mutex>
#include <ostream>
#include <sstream>

#include "client/batch_files.hpp"
#include "client/copy_beside.hpp"
#include "client/figures.hpp"
#include "client/formats.hpp"
#include "client/in_flight.hpp"
#include "client/printable.hpp"

namespace unwrapd::client {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kLook{1};      // between two looks of --watch
constexpr std::chrono::seconds kSilence{30};  // after a line that says why all wait

// An upgrade of a farm may take ten minutes, and a full queue an hour.
constexpr Patience kBatch{.lost_connections = 125, .refusals = 3600};

/// What became of one mesh.
struct Row {
  BatchFile item;
  std::string report = {};                 ///< JSON text; empty if it failed
  Figures figures = {};                    ///< of the report
  std::string failure = {};                ///< empty if it did not fail
  std::vector<std::string> warnings = {};  ///< on files that the result refers to
  double seconds = 0;
};

/// Shared by the threads of the meshes.
class Batch {
 public:
  Batch(const Arguments& arguments, const Servers& servers, const Console& console,
        const std::stop_token& stop)
      : arguments_(arguments), servers_(servers), console_(console), stop_(stop) {}

  /// Rows in the order of the items. Throws what ends all of them: unreachable, interrupted.
  std::vector<Row> run(std::vector<BatchFile> items);

 private:
  Row unwrapped(const BatchFile& item, const InFlight::OnBegun& on_begun);
  void tell(const Row& row) const;
  void tell_wait(const std::string& why);

  const Arguments& arguments_;
  const Servers& servers_;
  const Console& console_;
  const std::stop_token stop_;
  std::mutex mutex_;  ///< of what follows, and of the console
  std::vector<Row> rows_;
  std::size_t ended_ = 0;
  std::atomic<bool> has_succeeded_ = false;  ///< some mesh
  Clock::time_point told_wait_ = Clock::now() - kSilence;
};

std::string asked_format(const Arguments& arguments) {
  const auto output = arguments.options.find("output");
  return output == arguments.options.end() ? "auto" : output->second;
}

/// The arguments of one mesh.
Arguments arguments_of(const Arguments& batch, const BatchFile& item) {
  Arguments one = batch;
  one.file = item.file;
  one.out = item.out;
  const std::string usual = usual_output(item.file);
  if (usual != "auto" && asked_format(batch) == "auto") one.options["output"] = usual;
  return one;
}

/// Tells it once for all that wait.
void Batch::tell_wait(const std::string& why) {
  const std::scoped_lock lock(mutex_);
  if (console_.style == ProgressStyle::none || Clock::now() - told_wait_ < kSilence) return;
  told_wait_ = Clock::now();
  console_.err << "waiting: " << printable(why) << std::endl;
}

Row Batch::unwrapped(const BatchFile& item, const InFlight::OnBegun& on_begun) {
  Row row{.item = item};
  const Clock::time_point began = Clock::now();
  try {
    if (item.out.has_parent_path()) fs::create_directories(item.out.parent_path());
    const Arguments one = arguments_of(arguments_, item);
    check_outputs(one);
    std::ostringstream ignored;
    const Console silent{ignored, ignored, ProgressStyle::none};
    JobClient client(servers_, stop_, kBatch,
                     {.on_begun = on_begun, .on_wait = [&](const auto& why) { tell_wait(why); }});
    row.report = unwrap_file(client, one, silent, stop_).front().report;
    row.figures = read_figures(row.report);
    row.warnings = copy_beside(one);
    has_succeeded_ = true;
  } catch (const Failure& failure) {
    // Silence is of all meshes, and so is another service; a strange answer between others is not.
    const bool is_of_all =
        failure.code() == ExitCode::unreachable && (failure.may_pass() || !has_succeeded_.load());
    if (is_of_all || failure.code() == ExitCode::interrupted) throw;
    row.failure = failure.what();
  } catch (const fs::filesystem_error& error) {
    row.failure = error.what();
  }
  row.seconds = std::chrono::duration<double>(Clock::now() - began).count();
  return row;
}

/// With --json a line of JSON for each mesh on standard output, else one for people.
void Batch::tell(const Row& row) const {
  if (arguments_.json) {
    api::Json line = {{"file", row.item.file.string()}};
    if (row.failure.empty()) {
      line["out"] = row.item.out.string();
      line["report"] = api::Json::parse(row.report);
    } else {
      line["failure"] = row.failure;
    }
    console_.out << api::to_text(line) << std::endl;
  }
  for (const std::string& warning : row.warnings) console_.err << printable(warning) << std::endl;
  if (console_.style != ProgressStyle::none)
    console_.err << "[" << ended_ << "/" << rows_.size() << "] "
                 << printable(row.item.file.string() +
                              (row.failure.empty() ? "" : ": " + row.failure))
                 << std::endl;
}

std::vector<Row> Batch::run(std::vector<BatchFile> items) {
  rows_.assign(items.size(), {});
  ended_ = 0;
  InFlight(arguments_.jobs).run(items.size(), [&](std::size_t mine, const auto& on_begun) {
    Row row = unwrapped(items[mine], on_begun);
    const std::scoped_lock lock(mutex_);
    ++ended_;
    tell(row);
    rows_[mine] = std::move(row);
  });
  return std::move(rows_);
}

/// "chair.glb      3    2.002   2.002        0         0  0.71      1.2"
void print_row(const Row& row, int width, std::ostream& out) {
  out << std::left << std::setw(width) << printable(row.item.file.string()) << std::right;
  if (!row.failure.empty()) {
    out << "  " << printable(row.failure.substr(0, row.failure.find('\n'))) << "\n";
    return;
  }
  const Figures& figures = row.figures;
  out << std::fixed << std::setprecision(3) << std::setw(8) << figures.charts << std::setw(9)
      << figures.angle << std::setw(8) << figures.area << std::setw(9) << figures.flipped
      << std::setw(10) << overlaps_of(figures) << std::setprecision(2) << std::setw(6)
      << figures.fill << std::setprecision(1) << std::setw(9) << row.seconds << "\n";
}

std::ptrdiff_t failures(const std::vector<Row>& rows) {
  return std::ranges::count_if(rows, [](const Row& row) { return !row.failure.empty(); });
}

void print_table(const std::vector<Row>& rows, std::size_t kept, std::ostream& out) {
  std::size_t width = 4;
  for (const Row& row : rows) width = std::max(width, row.item.file.string().size());
  out << std::left << std::setw(static_cast<int>(width)) << "file" << std::right
      << "  charts  D_angle  D_area  flipped  overlaps  fill  seconds\n";
  for (const Row& row : rows) print_row(row, static_cast<int>(width), out);
  const auto failed = failures(rows);
  out << static_cast<std::ptrdiff_t>(rows.size()) - failed << " done, " << failed << " failed";
  if (kept > 0) out << ", " << kept << " there already";
  out << std::endl;
}

/// Waits for the next look, or until it is stopped.
void pause(const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any ended;
  std::unique_lock lock(mutex);
  ended.wait_for(lock, stop, kLook, [] { return false; });
  if (stop.stop_requested()) throw Failure(ExitCode::interrupted, "Stopped.");
}

/// Leaves out what was tried since it was written, and what may still be growing.
void keep_new(std::vector<BatchFile>& items, std::map<fs::path, fs::file_time_type>& tried) {
  std::erase_if(items, [&](const BatchFile& item) {
    std::error_code error;
    const auto written = fs::last_write_time(item.file, error);
    if (error || fs::file_time_type::clock::now() - written < kLook) return true;
    const bool is_same = tried.contains(item.file) && tried.at(item.file) == written;
    tried[item.file] = written;
    return is_same;
  });
}

}  // namespace

void run_batch(const Arguments& arguments, const Servers& servers, const Console& console,
               const std::stop_token& stop) {
  const std::string format = asked_format(arguments);
  std::map<fs::path, fs::file_time_type> tried;  // when what was sent had been written
  Batch batch(arguments, servers, console, stop);
  for (bool first = true; first || arguments.watch; first = false) {
    if (!first) pause(stop);
    std::vector<BatchFile> items = batch_files(arguments.inputs, arguments.out, format);
    if (items.empty() && !arguments.watch)
      throw Failure(ExitCode::file, "There is no mesh there; name files, or folders with some.");
    const std::size_t all = items.size();
    if (arguments.resume && first) std::erase_if(items, is_done);
    const std::size_t kept = all - items.size();
    if (arguments.watch) keep_new(items, tried);
    if (items.empty() && !first) continue;
    const std::vector<Row> rows = batch.run(std::move(items));
    if (!arguments.json && !arguments.quiet) print_table(rows, kept, console.out);
    if (!arguments.watch && failures(rows) > 0)
      throw Failure(ExitCode::job_failed, "Not all meshes were unwrapped.");
  }
}

}  // namespace unwrapd::client
