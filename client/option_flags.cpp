#include "client/option_flags.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

#include "api/options.hpp"
#include "client/failure.hpp"
#include "client/files.hpp"
#include "core/base/error.hpp"

namespace unwrapd::client {
namespace {

std::string value_text(const api::Json& value) {
  if (value.is_null()) return "unset";
  if (value.is_array()) return "empty";
  return value.is_string() ? value.get<std::string>() : value.dump();
}

constexpr double kMostDigits = 1e9;  // larger numbers have an exponent

/// "asap|arap|hybrid", "INT >= 1", "NUMBER[,NUMBER...] >= 0", "INT in [16, 16384]".
std::string range_text(const api::OptionRow& row) {
  if (row.type == api::OptionType::objects) return "FILE.json";
  if (row.type == api::OptionType::names) return "NAME[,NAME...]";
  if (row.type == api::OptionType::text) return can_unset(row) ? "NAME|none" : "NAME";
  if (row.type == api::OptionType::choice) {
    std::string text;
    for (const std::string_view choice : row.choices)
      text += (text.empty() ? "" : "|") + std::string(choice);
    return text;
  }
  std::string kind = row.type == api::OptionType::integer ? "INT" : "NUMBER";
  if (row.type == api::OptionType::numbers) kind += "[,NUMBER...]";
  const auto figure = [](double value) {
    const bool is_whole = std::trunc(value) == value && std::abs(value) < kMostDigits;
    return is_whole ? std::to_string(std::lround(value)) : api::Json(value).dump();
  };
  std::string text = kind + " >= " + figure(row.minimum);
  if (row.maximum) text = kind + " in [" + figure(row.minimum) + ", " + figure(*row.maximum) + "]";
  for (const std::string_view word : row.choices) text += "|" + std::string(word);
  return can_unset(row) ? text + "|none" : text;
}

/// The text of a list of objects. Throws Failure{file} where it is no JSON.
std::string read_list(const std::string& path) {
  std::string text = read_file(path);
  try {
    api::parse_json(text, {.max_bytes = text.size()});
  } catch (const Error& error) {
    throw Failure(ExitCode::file, path + ": " + error.what());
  }
  return text;
}

}  // namespace

std::string flag_name(std::string_view option) {
  std::string flag(option);
  std::ranges::replace(flag, '_', '-');
  std::ranges::replace(flag, '.', '-');
  return "--" + flag;
}

void add_option_flags(CLI::App& app, OptionTexts& options) {
  for (const api::OptionRow& row : api::option_table()) {
    const std::string name(row.name);
    const std::string text = std::string(row.description) +
                             " Default: " + value_text(api::option_default(row, {})) + ".";
    const bool is_file = row.type == api::OptionType::objects;
    if (row.type == api::OptionType::flag) {
      app.add_flag_callback(
             flag_name(row.name), [&options, name] { options[name] = "true"; }, text)
          ->group("Options of the job");
      continue;
    }
    app.add_option_function<std::string>(
           flag_name(row.name),
           [&options, name, is_file](const std::string& value) {
             options[name] = is_file ? read_list(value) : value;
           },
           text)
        ->type_name(range_text(row))
        ->group("Options of the job");
  }
}

}  // namespace unwrapd::client
