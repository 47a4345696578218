// The sources of option values, their precedence, and the errors for wrong values.
#include "server/config/config.hpp"

#include <unistd.h>  // environ

#include <toml++/toml.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <thread>

#include "server/config/config_row.hpp"
#include "server/config/env_typos.hpp"

namespace unwrapd::server::config {
namespace {

constexpr int kMistake = 2;
constexpr const char* kAbout =
    "unwrapd computes UV coordinates for triangle meshes, over HTTP. Every option can be a flag, "
    "an environment variable or a line of a TOML file: --max-queue 9, UNWRAPD_MAX_QUEUE=9, "
    "max-queue = 9. The flag overrides the variable, and the variable overrides the file.";

constexpr std::string_view kWorker = "worker";
constexpr const char* kCommands =
    "Other commands, each with --help: unwrapd keys (API keys), unwrapd backup, restore, check "
    "and move (copies of a data directory, and its way to PostgreSQL). unwrapd worker, with the "
    "same options: run jobs of other nodes "
    "(--database, --blobs), and listen for none.";

[[noreturn]] void wrong(const std::string& what) { throw Error(ErrorCode::invalid_option, what); }

/// "max-queue" -> "UNWRAPD_MAX_QUEUE"
std::string variable_name(std::string_view name) {
  std::string variable = "UNWRAPD_";
  for (const char c : name)
    variable += c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return variable;
}

/// Where a value was found, for errors and --print-config: "--max-queue", "UNWRAPD_MAX_QUEUE",
/// "/etc/unwrapd.toml". Empty: it is the default.
using Sources = std::map<std::string_view, std::string>;

class Reading {
 public:
  Reading() : groups_(config_groups()) {
    const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    config_.threads = std::min(2, cores);
    config_.workers = cores / config_.threads;
  }

  CommandLine run(int argc, const char* const* argv);
  Config run_file(const std::string& path) {
    read_file(path);
    return config_;
  }

 private:
  void declare(CLI::App& app);
  void read_file(const std::string& path);
  void read_environment();
  void check_environment() const;
  void read_flags(const CLI::App& app);
  void finish();
  void set(const ConfigRow& row, const std::string& text, const std::string& source);
  const ConfigRow& find(std::string_view key, const std::string& path) const;
  void print() const;

  template <class Use>
  void each_row(const Use& use) const {
    for (const ConfigGroup& group : groups_)
      for (const ConfigRow& row : group.rows) use(group, row);
  }

  std::vector<ConfigGroup> groups_;
  Config config_;
  Sources sources_;
  std::string file_;
  bool print_ = false;
  bool healthcheck_ = false;
};

void Reading::declare(CLI::App& app) {
  app.footer(kCommands);
  app.set_version_flag("--version", "unwrapd " UNWRAPD_VERSION);
  app.add_option("--config", file_, "TOML file with options")->type_name("FILE");
  app.add_flag("--print-config", print_,
               "Print the value and source of every option as a TOML file, and exit");
  app.add_flag(
      "--healthcheck", healthcheck_,
      "Check that the server running with these options answers; exit with 0 if it does, else 1");
  each_row([&](const ConfigGroup& group, const ConfigRow& row) {
    const std::string flag = "--" + std::string(row.heading.name);
    const bool is_flag = row.kind == ConfigKind::on_off;
    CLI::Option* option = is_flag ? app.add_flag(flag) : app.add_option(flag);
    option->description(std::string(row.heading.what))->group(std::string(group.title));
    if (is_flag) return;
    option->type_name(std::string(row.heading.takes));
    if (row.kind == ConfigKind::switch_of_text)
      option->expected(0, 1);
    else
      option->default_str(row.get(config_));
  });
}

void Reading::set(const ConfigRow& row, const std::string& text, const std::string& source) {
  try {
    row.set(config_, text);
  } catch (const Error& error) {
    const std::string shown = row.heading.is_secret ? "what is given" : "\"" + text + "\"";
    wrong(source + ": " + std::string(row.heading.name) + " takes " + error.what() + ", not " +
          shown + ".");
  }
  sources_[row.heading.name] = source;
}

const ConfigRow& Reading::find(std::string_view key, const std::string& path) const {
  const ConfigRow* found = nullptr;
  each_row([&](const ConfigGroup&, const ConfigRow& row) {
    if (row.heading.name == key) found = &row;
  });
  if (!found) wrong(path + ": there is no option \"" + std::string(key) + "\"; see --help.");
  return *found;
}

/// Converts a value of the file to the text of a flag.
std::string text_of(const toml::node& node, const std::string& where) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* number = node.as_integer()) return std::to_string(number->get());
  if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
  const toml::array* items = node.as_array();
  if (!items) wrong(where + " must be text, a whole number, true, false or an array of text.");
  std::vector<std::string> texts;
  for (const toml::node& item : *items) {
    if (!item.is_string()) wrong(where + " must be an array of text.");
    texts.push_back(item.as_string()->get());
  }
  return join_list(texts);
}

void Reading::read_file(const std::string& path) {
  if (std::filesystem::is_directory(path))  // which the parser takes for an empty file
    wrong(path + " is a directory; name a file in it.");
  toml::table table;
  try {
    table = toml::parse_file(path);
  } catch (const toml::parse_error& error) {
    const auto line = error.source().begin.line;
    wrong(path + (line > 0 ? " line " + std::to_string(line) : "") + ": " +
          std::string(error.description()) + ".");
  }
  for (const auto& [key, node] : table) {
    const ConfigRow& row = find(key.str(), path);
    set(row, text_of(node, path + ": " + std::string(key.str())), path);
  }
}

void Reading::read_environment() {
  each_row([&](const ConfigGroup&, const ConfigRow& row) {
    const std::string variable = variable_name(row.heading.name);
    const char* value = std::getenv(variable.c_str());  // NOLINT(concurrency-mt-unsafe)
    if (value) set(row, value, variable);
  });
}

/// An unknown variable with our prefix is an error, like an unknown key of the file.
void Reading::check_environment() const {
  std::vector<std::string> known = {"UNWRAPD_CONFIG"};
  each_row([&](const ConfigGroup&, const ConfigRow& row) {
    known.push_back(variable_name(row.heading.name));
  });
  if (const std::optional<std::string> mistake = unknown_variable(environ, known)) wrong(*mistake);
}

void Reading::read_flags(const CLI::App& app) {
  each_row([&](const ConfigGroup&, const ConfigRow& row) {
    const std::string flag = "--" + std::string(row.heading.name);
    const CLI::Option* option = app.get_option(flag);
    if (option->count() == 0) return;
    const std::string& given = option->results().back();
    const bool is_bare = row.kind == ConfigKind::switch_of_text && given.empty();
    set(row, is_bare ? "true" : given, flag);
  });
}

void Reading::finish() {
  if (!sources_.contains("admin-listen")) {
    const int port = config_.listen.port;
    if (port == http::kMaxPort) wrong("--listen uses the last port; set --admin-listen too.");
    config_.admin = http::Address{"127.0.0.1", port == 0 ? 0 : port + 1};
  }
  check_together(config_);
  if (healthcheck_ && (!config_.admin || config_.admin->port == 0))
    wrong("--healthcheck needs an --admin-listen with a port; set one.");
}

/// text as TOML writes it.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c >= 0 && c < ' ') {
      constexpr std::string_view digits = "0123456789ABCDEF";
      out.append("\\u00").append({digits[c >> 4], digits[c & 15]});
      continue;
    }
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

std::string toml_value(const ConfigRow& row, const Config& config) {
  const std::string value = row.get(config);
  if (row.heading.is_secret) return value.empty() ? "\"\"" : "\"********\"";
  if (row.kind == ConfigKind::text || row.kind == ConfigKind::switch_of_text) return quoted(value);
  if (row.kind != ConfigKind::list) return value;
  std::string items;
  for (const std::string& item : split_list(value))
    items += (items.empty() ? "" : ", ") + quoted(item);
  return "[" + items + "]";
}

void Reading::print() const {
  std::string text;
  for (const ConfigGroup& group : groups_) {
    text += (text.empty() ? "# " : "\n# ") + std::string(group.title) + "\n";
    for (const ConfigRow& row : group.rows) {
      const auto source = sources_.find(row.heading.name);
      const std::string from = source == sources_.end() ? "" : "  # from " + source->second;
      text += std::string(row.heading.name) + " = " + toml_value(row, config_) + from + "\n";
    }
  }
  std::fputs(text.c_str(), stdout);
}

CommandLine Reading::run(int argc, const char* const* argv) {
  CLI::App app(kAbout, "unwrapd");
  if (argc > 1 && std::string_view(argv[1]) == kWorker) {
    config_.serves = false;
    --argc;
    ++argv;
  }
  declare(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return {.task = Task::leave, .config = {}, .exit_code = app.exit(error) == 0 ? 0 : kMistake};
  }
  const char* file = std::getenv("UNWRAPD_CONFIG");  // NOLINT(concurrency-mt-unsafe)
  if (file_.empty() && file) file_ = file;
  if (!file_.empty()) read_file(file_);
  check_environment();
  read_environment();
  read_flags(app);
  finish();
  if (print_) print();
  const Task task = print_ ? Task::leave : healthcheck_ ? Task::healthcheck : Task::serve;
  return {.task = task, .config = config_, .exit_code = 0};
}

}  // namespace

Config config_of_file(const std::string& path) { return Reading().run_file(path); }

CommandLine parse_command_line(int argc, const char* const* argv) {
  try {
    return Reading().run(argc, argv);
  } catch (const Error& error) {
    std::fprintf(stderr, "unwrapd: %s\n", error.what());
    return {.task = Task::leave, .config = {}, .exit_code = kMistake};
  }
}

}  // namespace unwrapd::server::config
