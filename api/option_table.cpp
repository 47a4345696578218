// The table of options. A row knows how to read and write its own field, so nothing else in the
// project lists the options by name: to add one is to add its field and one row.
#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <type_traits>

#include "api/constraints.hpp"
#include "api/options.hpp"

namespace unwrapd::api {
namespace {

// Each in the order of its enumerators.
constexpr std::array<std::string_view, 9> kMethods = {"asap", "arap", "hybrid", "abf", "linabf",
                                                      "cp",   "bff",  "ic",     "slim"};
constexpr std::array<std::string_view, 2> kLambdaUnits = {"dimensionless", "paper"};
constexpr std::array<std::string_view, 4> kInitialMaps = {"auto", "mean_value", "tutte", "lscm"};
constexpr std::array<std::string_view, 2> kPins = {"diameter", "spectral"};
constexpr std::array<std::string_view, 3> kSeams = {"auto", "keep", "none"};
constexpr std::array<std::string_view, 3> kGuarantees = {"none", "flip_free", "bijective"};
constexpr std::array<std::string_view, 2> kRepairs = {"untangle", "virtual_boundary"};
constexpr std::array<std::string_view, 3> kBoundaries = {"free", "circle", "square"};
constexpr std::array<std::string_view, 4> kOutputs = {"auto", "glb", "gltf", "obj"};

constexpr std::array kEveryMethod = {Method::asap, Method::arap,   Method::hybrid,
                                     Method::abf,  Method::linabf, Method::cp,
                                     Method::bff,  Method::ic,     Method::slim};
constexpr std::array kLocalGlobal = {Method::arap, Method::hybrid};
constexpr std::array kHolding = {Method::asap, Method::arap, Method::hybrid};
constexpr std::array kOnlyHybrid = {Method::hybrid};
constexpr std::array kOnlyAsap = {Method::asap};

constexpr double kMaxPadding = 0.25 * kMaxResolution;  // and at most a quarter of resolution
constexpr double kMinTolerance = 1e-12, kMaxTolerance = 0.1;

/// The field of the options that a member pointer names: of UnwrapOptions, its Stop, or JobOptions.
template <auto kField>
auto& field(auto& options) {
  if constexpr (std::is_invocable_v<decltype(kField), UnwrapOptions&>) {
    return options.unwrap.*kField;
  } else if constexpr (std::is_invocable_v<decltype(kField), Stop&>) {
    return options.unwrap.stop.*kField;
  } else {
    return options.*kField;
  }
}

template <auto kField>
using FieldOf = std::remove_reference_t<decltype(field<kField>(std::declval<JobOptions&>()))>;

template <auto kField, const auto& kNames>
Json get_choice(const JobOptions& options) {
  return kNames[static_cast<std::size_t>(field<kField>(options))];
}

template <auto kField, const auto& kNames>
void set_choice(JobOptions& options, const Json& name) {
  const auto found = std::ranges::find(kNames, name.get_ref<const std::string&>());
  field<kField>(options) = static_cast<FieldOf<kField>>(found - kNames.begin());
}

template <auto kField, const auto& kNames>
constexpr OptionRow choice(std::string_view name, std::span<const Method> methods,
                           std::string_view description) {
  return {.name = name,
          .type = OptionType::choice,
          .choices = kNames,
          .minimum = 0,
          .maximum = {},
          .limit = nullptr,
          .nullable = false,
          .description = description,
          .methods = methods,
          .get = get_choice<kField, kNames>,
          .set = set_choice<kField, kNames>};
}

struct Range {
  double minimum = 0;
  std::optional<double> maximum = {};
  int Limits::*limit = nullptr;
};

template <auto kField>
constexpr OptionRow figure(std::string_view name, Range range, std::span<const Method> methods,
                           std::string_view description) {
  using Field = FieldOf<kField>;
  return {.name = name,
          .type = std::is_integral_v<Field> ? OptionType::integer : OptionType::number,
          .choices = {},
          .minimum = range.minimum,
          .maximum = range.maximum,
          .limit = range.limit,
          .nullable = false,
          .description = description,
          .methods = methods,
          .get = [](const JobOptions& options) { return Json(field<kField>(options)); },
          .set = [](JobOptions& options,
                    const Json& value) { field<kField>(options) = value.get<Field>(); }};
}

Json get_lambda(const JobOptions& options) {
  const UnwrapOptions& unwrap = options.unwrap;
  return unwrap.lambda_curve.empty() ? Json(unwrap.lambda) : Json(unwrap.lambda_curve);
}

void set_lambda(JobOptions& options, const Json& value) {
  if (value.is_array()) {
    options.unwrap.lambda_curve = value.get<std::vector<double>>();
  } else {
    options.unwrap.lambda = value.get<double>();
  }
}

Json get_iterations(const JobOptions& options) {
  const std::optional<int> iterations = options.unwrap.stop.iterations;
  return iterations ? Json(*iterations) : Json();
}

void set_iterations(JobOptions& options, const Json& value) {
  options.unwrap.stop.iterations = value.get<int>();
}

Json get_constraints(const JobOptions& options) { return to_json(options.unwrap.constraints); }

void set_constraints(JobOptions& options, const Json& value) {
  options.unwrap.constraints =
      constraints_from_json(value, std::numeric_limits<int>::max(), "/constraints");
}

using O = UnwrapOptions;

constexpr std::array kRows = {
    choice<&O::method, kMethods>(
        "method", kEveryMethod,
        "How the map is judged: asap keeps angles, arap keeps shapes, hybrid lies between them."),
    OptionRow{.name = "lambda",
              .type = OptionType::numbers,
              .choices = {},
              .minimum = 0,
              .maximum = {},
              .limit = nullptr,
              .nullable = true,
              .description = "Weight of area against angle: 0 is asap, large values approach arap; "
                             "a list makes a map for each.",
              .methods = kOnlyHybrid,
              .get = get_lambda,
              .set = set_lambda},
    choice<&O::lambda_units, kLambdaUnits>(
        "lambda_units", kOnlyHybrid,
        "Whether lambda is dimensionless or as printed in the paper's Eq. (5)."),
    OptionRow{.name = "stop.iterations",
              .type = OptionType::integer,
              .choices = {},
              .minimum = 1,
              .maximum = {},
              .limit = &Limits::max_iterations,
              .nullable = true,
              .description = "So many plain iterations of every chart, as in the paper; without "
                             "it accelerated ones, until they converge.",
              .methods = kLocalGlobal,
              .get = get_iterations,
              .set = set_iterations},
    figure<&Stop::tolerance>("stop.tolerance", {kMinTolerance, kMaxTolerance}, kLocalGlobal,
                             "Converged is when the energy falls by less than this share."),
    figure<&Stop::max_iterations>("stop.max_iterations", {1, {}, &Limits::max_iterations},
                                  kLocalGlobal, "Accelerated iterations of a chart, at most."),
    choice<&O::initial, kInitialMaps>(
        "initial", kLocalGlobal,
        "The map to start from; auto takes the one that promises the least energy."),
    choice<&O::pins, kPins>(
        "pins", kOnlyAsap,
        "How the conformal map is pinned: two vertices at the diameter, or spectrally."),
    choice<&O::guarantee, kGuarantees>(
        "guarantee", kEveryMethod,
        "What holds of the result: nothing, no triangle flipped, or no two overlapping."),
    choice<&O::repair, kRepairs>(
        "repair", kEveryMethod,
        "How flips are mended: in small patches, or by the convex virtual boundary."),
    choice<&O::boundary, kBoundaries>("boundary", kHolding,
                                      "The shape of every chart's longest boundary."),
    OptionRow{.name = "constraints",
              .type = OptionType::constraints,
              .choices = {},
              .minimum = 0,
              .maximum = {},
              .limit = &Limits::max_constraints,
              .nullable = false,
              .description = "Vertices and the texture coordinates that they shall have.",
              .methods = kHolding,
              .get = get_constraints,
              .set = set_constraints},
    choice<&O::seams, kSeams>(
        "seams", kEveryMethod,
        "Vertices at equal positions: keep the cuts between them, weld them (none), or auto."),
    figure<&O::resolution>("resolution", {kMinResolution, kMaxResolution}, kEveryMethod,
                           "Side of the square texture, in texels."),
    figure<&O::padding>("padding", {0, kMaxPadding}, kEveryMethod,
                        "Texels between islands, at most a quarter of resolution."),
    choice<&JobOptions::output, kOutputs>("output", kEveryMethod,
                                          "Format of the result; auto answers as it came in."),
};

}  // namespace

std::span<const OptionRow> option_table() { return kRows; }

std::string_view method_name(Method method) { return kMethods[static_cast<std::size_t>(method)]; }

}  // namespace unwrapd::api
