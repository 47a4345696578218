#pragma once
// Table 1 of the paper as printed, and how its columns are run here.

#include <array>
#include <optional>

#include "core/options.hpp"

namespace unwrapd::bench {

struct Printed {
  std::optional<double> angle, area;  ///< none where the paper prints a dash or has no such column
};

/// One column of the table. The last two are ours: the paper has no figures for them.
struct Column {
  const char* name;
  Method method;
  std::array<Printed, 5> printed;  ///< by model
};

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

inline constexpr std::array<Column, 8> kColumns{{
    {"LSCM",
     Method::asap,
     {{{2.00, 88.14}, {2.05, 15.36}, {2.02, 2.40}, {2.01, 30.09}, {2.00, 2.08}}}},
    {"dABF", Method::abf, {{{2.00, 2.64}, {2.08, 8.37}, {2.06, 2.35}, {2.01, 2.19}, {2.00, 2.09}}}},
    {"LABF", Method::linabf, {{{2.00, 2.64}, {2.12, 9.12}, {2.05, 2.34}, {2.01, 2.22}, {{}, {}}}}},
    {"IC", Method::ic, {{{2.05, 2.67}, {3.09, 3.91}, {2.06, 2.42}, {2.46, 2.51}, {2.02, 2.14}}}},
    {"CP", Method::cp, {{{2.00, 2.64}, {2.29, 11.94}, {2.36, 3.18}, {2.01, 2.18}, {2.00, 2.10}}}},
    {"ARAP",
     Method::arap,
     {{{2.06, 2.05}, {2.19, 2.11}, {2.07, 2.04}, {2.03, 2.03}, {2.01, 2.01}}}},
    {"bff", Method::bff, {}},
    {"slim", Method::slim, {}},
}};

/// The paper's ARAP is ten plain iterations.
inline UnwrapOptions options_of(const Model& model, Method method) {
  UnwrapOptions options{.method = method};
  if (method == Method::arap) options.stop.iterations = 10, options.initial = model.start;
  return options;
}

}  // namespace unwrapd::bench
