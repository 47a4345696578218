#pragma once
// Table 1 of the paper as printed, and how its columns are run here.

#include <array>
#include <cmath>
#include <optional>

#include "core/solve/solve.hpp"
#include "core/types/options.hpp"
#include "tests/bench/cp_as_run.hpp"

namespace unwrapd::bench {

struct Printed {
  std::optional<double> angle, area;  ///< none where the paper prints a dash or has no such column
};

/// One column of the table. The last two are ours: the paper has no figures for them.
struct Column {
  const char* name;
  std::optional<Method> method;    ///< none: cp_as_run()
  const char* why;                 ///< why a figure is off, where one is (ADR 0012, 0013)
  std::array<Printed, 5> printed;  ///< by model
};

/// How far our D_angle and D_area may be from what is printed.
inline constexpr double kTolerance = 0.02;

inline bool is_off(const std::optional<double>& printed, double ours) {
  return printed && std::abs(ours - *printed) > kTolerance;
}

struct Model {
  const char* name;
  const char* file;  ///< in the folder "paper" of the test data
  InitialMap start;  ///< of ARAP: mean_value, or lscm where there are several boundaries (Sec. 4.5)
};

inline constexpr std::array<Model, 5> kModels{{
    {"Gargoyle", "Gargoyle_ABF.obj", InitialMap::mean_value},
    {"Isis", "Isis_dABF.obj", InitialMap::mean_value},
    {"Balls", "Balls.obj", InitialMap::mean_value},
    {"Cow", "Cow_dABF.obj", InitialMap::mean_value},
    {"Beetle", "Beetle_ABF.obj", InitialMap::lscm},
}};

inline constexpr std::array<Column, 9> kColumns{{
    {"LSCM",
     Method::asap,
     "pins",
     {{{2.00, 88.14}, {2.05, 15.36}, {2.02, 2.40}, {2.01, 30.09}, {2.00, 2.08}}}},
    {"dABF",
     Method::abf,
     "angles",
     {{{2.00, 2.64}, {2.08, 8.37}, {2.06, 2.35}, {2.01, 2.19}, {2.00, 2.09}}}},
    {"LABF",
     Method::linabf,
     "angles",
     {{{2.00, 2.64}, {2.12, 9.12}, {2.05, 2.34}, {2.01, 2.22}, {{}, {}}}}},
    {"IC",
     Method::ic,
     "circles",
     {{{2.05, 2.67}, {3.09, 3.91}, {2.06, 2.42}, {2.46, 2.51}, {2.02, 2.14}}}},
    {"CP",
     Method::cp,
     "mended",
     {{{2.00, 2.64}, {2.29, 11.94}, {2.36, 3.18}, {2.01, 2.18}, {2.00, 2.10}}}},
    {"CP*",
     {},
     "broken",
     {{{2.00, 2.64}, {2.29, 11.94}, {2.36, 3.18}, {2.01, 2.18}, {2.00, 2.10}}}},
    {"ARAP",
     Method::arap,
     "unknown",
     {{{2.06, 2.05}, {2.19, 2.11}, {2.07, 2.04}, {2.03, 2.03}, {2.01, 2.01}}}},
    {"bff", Method::bff, "", {}},
    {"slim", Method::slim, "", {}},
}};

/// The paper's ARAP is ten plain iterations.
inline UnwrapOptions options_of(const Model& model, Method method) {
  UnwrapOptions options{.method = method};
  if (method == Method::arap) options.stop.iterations = 10, options.initial = model.start;
  return options;
}

/// The map of a column, in disk units. Throws Error.
inline UvMap map_of(const solve::Disk& disk, const Model& model, const Column& column) {
  if (!column.method) return cp_as_run(disk);
  const UnwrapOptions options = options_of(model, *column.method);
  SerialExecutor serial;
  return solve::Solver(disk, options, {}, serial).run(options.lambda, {}).uv;
}

}  // namespace unwrapd::bench
