// The table of options. A row knows how to read and write its own field, so nothing else in the
// project lists the options by name: to add one is to add its field and one row.
#include <array>
#include <cstddef>
#include <type_traits>

#include "api/options.hpp"

namespace unwrapd::api {
namespace {

using Names = std::span<const std::string_view>;

// Each in the order of its enumerators.
constexpr std::array<std::string_view, 3> kMethods = {"asap", "arap", "hybrid"};
constexpr std::array<std::string_view, 2> kLambdaUnits = {"dimensionless", "paper"};
constexpr std::array<std::string_view, 4> kInitialMaps = {"auto", "mean_value", "tutte", "lscm"};
constexpr std::array<std::string_view, 2> kPins = {"diameter", "spectral"};
constexpr std::array<std::string_view, 3> kSeams = {"auto", "keep", "none"};
constexpr std::array<std::string_view, 4> kOutputs = {"auto", "glb", "gltf", "obj"};

constexpr std::array kEveryMethod = {Method::asap, Method::arap, Method::hybrid};
constexpr std::array kIterative = {Method::arap, Method::hybrid};
constexpr std::array kOnlyHybrid = {Method::hybrid};
constexpr std::array kOnlyAsap = {Method::asap};

constexpr double kMaxPadding = 0.25 * kMaxResolution;  // and at most a quarter of resolution

/// The field of the options that a member pointer names, in UnwrapOptions or JobOptions itself.
template <auto kField>
auto& field(auto& options) {
  if constexpr (std::is_invocable_v<decltype(kField), UnwrapOptions&>) {
    return options.unwrap.*kField;
  } else {
    return options.*kField;
  }
}

template <auto kField>
using FieldOf = std::remove_reference_t<decltype(field<kField>(std::declval<JobOptions&>()))>;

template <auto kField>
void set_field(JobOptions& options, double value) {
  field<kField>(options) = static_cast<FieldOf<kField>>(value);
}

template <auto kField, const auto& kNames>
Json get_choice(const JobOptions& options) {
  return kNames[static_cast<std::size_t>(field<kField>(options))];
}

template <auto kField, const auto& kNames>
constexpr OptionRow choice(std::string_view name, std::span<const Method> methods,
                           std::string_view description) {
  return {.name = name,
          .type = OptionType::choice,
          .choices = kNames,
          .minimum = 0,
          .maximum = {},
          .description = description,
          .methods = methods,
          .get = get_choice<kField, kNames>,
          .set = [](JobOptions& options, double index) {
            field<kField>(options) = static_cast<FieldOf<kField>>(static_cast<int>(index));
          }};
}

struct Range {
  double minimum = 0;
  std::optional<double> maximum;
};

template <auto kField>
constexpr OptionRow figure(std::string_view name, Range range, std::span<const Method> methods,
                           std::string_view description) {
  return {.name = name,
          .type = std::is_integral_v<FieldOf<kField>> ? OptionType::integer : OptionType::number,
          .choices = {},
          .minimum = range.minimum,
          .maximum = range.maximum,
          .description = description,
          .methods = methods,
          .get = [](const JobOptions& options) { return Json(field<kField>(options)); },
          .set = set_field<kField>};
}

using O = UnwrapOptions;

constexpr std::array kRows = {
    choice<&O::method, kMethods>(
        "method", kEveryMethod,
        "How the map is judged: asap keeps angles, arap keeps shapes, hybrid lies between them."),
    figure<&O::lambda>("lambda", {0, {}}, kOnlyHybrid,
                       "Weight of area against angle: 0 is asap, large values approach arap."),
    choice<&O::lambda_units, kLambdaUnits>(
        "lambda_units", kOnlyHybrid,
        "Whether lambda is dimensionless or as printed in the paper's Eq. (5)."),
    OptionRow{
        .name = "iterations",
        .type = OptionType::integer,
        .choices = {},
        .minimum = 1,
        .maximum = {},
        .description = "Local/global iterations of a chart.",
        .methods = kIterative,
        .get =
            [](const JobOptions& options) {
              return Json(options.unwrap.stop.iterations.value_or(10));
            },
        .set = [](JobOptions& options,
                  double value) { options.unwrap.stop.iterations = static_cast<int>(value); }},
    choice<&O::initial, kInitialMaps>(
        "initial", kIterative,
        "The map to start from; auto takes mean_value or lscm, whichever is nearer to rigid."),
    choice<&O::pins, kPins>(
        "pins", kOnlyAsap,
        "How the conformal map is pinned: two vertices at the diameter, or spectrally."),
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
