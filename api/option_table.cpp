// The table of options. A row knows how to read and write its own field, so nothing else in the
// project lists the options by name: to add one is to add its field and one row.
#include <array>
#include <cstddef>
#include <limits>

#include "api/constraints.hpp"
#include "api/option_rows.hpp"
#include "api/seam_paths.hpp"

namespace unwrapd::api {
namespace {

// Each in the order of its enumerators.
constexpr std::array<std::string_view, 9> kMethods = {"asap", "arap", "hybrid", "abf", "linabf",
                                                      "cp",   "bff",  "ic",     "slim"};
constexpr std::array<std::string_view, 2> kLambdaUnits = {"dimensionless", "paper"};
constexpr std::array<std::string_view, 4> kInitialMaps = {"auto", "mean_value", "tutte", "lscm"};
constexpr std::array<std::string_view, 2> kPins = {"diameter", "spectral"};
constexpr std::array<std::string_view, 4> kSeams = {"auto", "keep", "none", "uv0"};
constexpr std::array<std::string_view, 3> kGuarantees = {"none", "flip_free", "bijective"};
constexpr std::array<std::string_view, 2> kRepairs = {"untangle", "virtual_boundary"};
constexpr std::array<std::string_view, 3> kBoundaries = {"free", "circle", "square"};
constexpr std::array<std::string_view, 4> kOutputs = {"auto", "glb", "gltf", "obj"};

constexpr std::array<std::string_view, 4> kCompressions = {"keep", "none", "draco", "meshopt"};

constexpr std::array kEveryMethod = {Method::asap, Method::arap,   Method::hybrid,
                                     Method::abf,  Method::linabf, Method::cp,
                                     Method::bff,  Method::ic,     Method::slim};
constexpr std::array kLocalGlobal = {Method::arap, Method::hybrid};
constexpr std::array kStoppable = {Method::arap, Method::hybrid, Method::slim};
constexpr std::array kHolding = {Method::asap, Method::arap, Method::hybrid};
constexpr std::array kOnlyHybrid = {Method::hybrid};
constexpr std::array kOnlyAsap = {Method::asap};

constexpr double kMaxPadding = 0.25 * kMaxResolution;  // and at most a quarter of resolution
constexpr double kMinTexelsPerUnit = 1e-9, kMaxTexelsPerUnit = 1e12;
constexpr double kMaxDistortion = 1e6, kMaxCharts = 1e6;
constexpr double kMinTolerance = 1e-12, kMaxTolerance = 0.1;

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

Json get_constraints(const JobOptions& options) { return to_json(options.unwrap.constraints); }

void set_constraints(JobOptions& options, const Json& value) {
  options.unwrap.constraints =
      constraints_from_json(value, std::numeric_limits<int>::max(), "/constraints");
}

Json get_seam_edges(const JobOptions& options) { return to_json(options.unwrap.seam_edges); }

void set_seam_edges(JobOptions& options, const Json& value) {
  options.unwrap.seam_edges = seam_paths_from_json(value, "/seam_edges");
}

using O = UnwrapOptions;
using A = AssetOptions;

constexpr std::array kRows = {
    choice<&O::method, kMethods>(
        "method", kEveryMethod,
        "How the map is judged: asap keeps angles, arap keeps shapes, hybrid lies between them."),
    OptionRow{.name = "lambda",
              .type = OptionType::numbers,
              .nullable = true,
              .description = "Weight of area against angle: 0 is asap, large values approach arap; "
                             "a list makes a map for each.",
              .methods = kOnlyHybrid,
              .get = get_lambda,
              .set = set_lambda},
    choice<&O::lambda_units, kLambdaUnits>(
        "lambda_units", kOnlyHybrid,
        "Whether lambda is dimensionless or as printed in the paper's Eq. (5)."),
    figure<&Stop::iterations>("stop.iterations", {1, {}, &Limits::max_iterations}, kStoppable,
                              "So many plain iterations of every chart, as in the paper; without "
                              "it accelerated ones, until they converge. Those of slim are alike."),
    figure<&Stop::tolerance>("stop.tolerance", {kMinTolerance, kMaxTolerance}, kStoppable,
                             "Converged is when the energy falls by less than this share."),
    figure<&Stop::max_iterations>("stop.max_iterations", {1, {}, &Limits::max_iterations},
                                  kStoppable,
                                  "Iterations of a chart that stop by tolerance, at most."),
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
              .type = OptionType::objects,
              .limit = &Limits::max_constraints,
              .description = "Vertices and the texture coordinates that they shall have.",
              .methods = kHolding,
              .get = get_constraints,
              .set = set_constraints},
    choice<&O::seams, kSeams>(
        "seams", kEveryMethod,
        "Where cuts lie that came in: between copies of a vertex (keep), nowhere (none), where "
        "the UVs that came in have theirs (uv0), or auto."),
    OptionRow{.name = "seam_edges",
              .type = OptionType::objects,
              .limit = &Limits::max_constraints,
              .description = "Paths of vertices along which the mesh is cut open as well.",
              .methods = kEveryMethod,
              .get = get_seam_edges,
              .set = set_seam_edges},
    figure<&O::max_distortion>("max_distortion", {kMinDistortion, kMaxDistortion}, kEveryMethod,
                               "Meshes are taken apart until the angles and areas of ARAP maps are "
                               "distorted by no more; without it disks stay whole, and all else "
                               "has 2.02."),
    figure<&O::max_charts>("max_charts", {1, kMaxCharts}, kEveryMethod,
                           "Charts at most, whatever the distortion, where topology allows it."),
    figure<&O::resolution>("resolution", {kMinResolution, kMaxResolution}, kEveryMethod,
                           "Side of the square texture, in texels."),
    figure<&O::padding>("padding", {0, kMaxPadding}, kEveryMethod,
                        "Texels between islands, at most a quarter of resolution."),
    figure<&Packing::texels_per_unit>(
        "texels_per_unit", {kMinTexelsPerUnit, kMaxTexelsPerUnit}, kEveryMethod,
        "Texels that a unit of the mesh gets on every island; without it as "
        "many as fit."),
    figure<&Packing::max_pages>("max_pages", {1, kMaxPages}, kEveryMethod,
                                "Pages (UDIM tiles 1001 and on, U counts them) at most."),
    plain<&Packing::stack_identical>("stack_identical", OptionType::flag, kEveryMethod,
                                     "Whether islands of the same shape share one place."),
    plain<&O::repack_only>("repack_only", OptionType::flag, kEveryMethod,
                           "Whether the islands of the UVs that are there are packed anew, and "
                           "nothing is unwrapped."),
    figure<&A::texcoord>("texcoord", {0, kMaxTexcoord}, kEveryMethod,
                         "The set of texture coordinates that is written: TEXCOORD_n."),
    plain<&A::materials>("materials", OptionType::names, kEveryMethod,
                         "Names of the materials that are unwrapped; the rest keeps its UVs."),
    plain<&A::primitives>("primitives", OptionType::names, kEveryMethod,
                          "JSON pointers of the primitives that are unwrapped; the rest keeps its "
                          "UVs."),
    choice<&JobOptions::output, kOutputs>("output", kEveryMethod,
                                          "Format of the result; auto answers as it came in."),
    choice<&A::compression, kCompressions>(
        "compression", kEveryMethod,
        "Encoding of a glTF's geometry, always without loss; keep encodes as it came in."),
    plain<&A::vertex_map>("vertex_map", OptionType::flag, kEveryMethod,
                          "Whether the report tells which vertices were copied for seams."),
};

}  // namespace

std::span<const OptionRow> option_table() { return kRows; }

std::string_view method_name(Method method) { return kMethods[static_cast<std::size_t>(method)]; }

}  // namespace unwrapd::api
