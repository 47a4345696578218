#pragma once
// Rows of the option table for options that are a plain field. A row is made from the field's
// address, so that it cannot read one field and write another.

#include <algorithm>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "api/options.hpp"

namespace unwrapd::api {

/// The field that a member pointer names: of UnwrapOptions, its Stop, Packing or
/// Welding, of AssetOptions,
/// or of JobOptions.
template <auto kField>
auto& field(auto& options) {
  if constexpr (std::is_invocable_v<decltype(kField), UnwrapOptions&>) {
    return options.unwrap.*kField;
  } else if constexpr (std::is_invocable_v<decltype(kField), Stop&>) {
    return options.unwrap.stop.*kField;
  } else if constexpr (std::is_invocable_v<decltype(kField), Packing&>) {
    return options.unwrap.packing.*kField;
  } else if constexpr (std::is_invocable_v<decltype(kField), Welding&>) {
    return options.unwrap.welding.*kField;
  } else if constexpr (std::is_invocable_v<decltype(kField), AssetOptions&>) {
    return options.asset.*kField;
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
          .description = description,
          .methods = methods,
          .get = get_choice<kField, kNames>,
          .set = set_choice<kField, kNames>};
}

/// The type of a field's value: T for std::optional<T>, which is null in JSON if it is empty.
template <class T>
T held(const std::optional<T>& field);
template <class T>
T held(const T& field);

template <auto kField>
using HeldBy = decltype(held(std::declval<const FieldOf<kField>&>()));

template <auto kField>
inline constexpr bool kIsOptional = !std::is_same_v<HeldBy<kField>, FieldOf<kField>>;

template <auto kField>
Json get_plain(const JobOptions& options) {
  if constexpr (kIsOptional<kField>) {
    return field<kField>(options) ? Json(*field<kField>(options)) : Json();
  } else {
    return field<kField>(options);
  }
}

template <auto kField>
void set_plain(JobOptions& options, const Json& value) {
  if constexpr (kIsOptional<kField>) {
    if (value.is_null()) return field<kField>(options).reset();
  }
  field<kField>(options) = value.get<HeldBy<kField>>();
}

struct Range {
  double minimum = 0;
  std::optional<double> maximum = {};
  int Limits::*limit = nullptr;
};

template <auto kField>
constexpr OptionRow figure(std::string_view name, Range range, std::span<const Method> methods,
                           std::string_view description) {
  const bool is_whole = std::is_integral_v<HeldBy<kField>>;
  return {.name = name,
          .type = is_whole ? OptionType::integer : OptionType::number,
          .minimum = range.minimum,
          .maximum = range.maximum,
          .limit = range.limit,
          .nullable = kIsOptional<kField>,
          .description = description,
          .methods = methods,
          .get = get_plain<kField>,
          .set = set_plain<kField>};
}

/// For lists of objects, whose number is limited.
constexpr OptionRow objects(std::string_view name, std::span<const Method> methods,
                            std::string_view description, decltype(OptionRow::get) get,
                            decltype(OptionRow::set) set) {
  return {.name = name,
          .type = OptionType::objects,
          .limit = &Limits::max_constraints,
          .description = description,
          .methods = methods,
          .get = get,
          .set = set};
}

/// For fields of type flag, names or text.
template <auto kField>
constexpr OptionRow plain(std::string_view name, OptionType type, std::span<const Method> methods,
                          std::string_view description) {
  return {.name = name,
          .type = type,
          .nullable = kIsOptional<kField>,
          .description = description,
          .methods = methods,
          .get = get_plain<kField>,
          .set = set_plain<kField>};
}

}  // namespace unwrapd::api
