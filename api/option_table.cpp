// The table of options. A row reads and writes its own field, and nothing else in the project lists
// the options by name: a new option needs its field and one row.
#include <array>
#include <cstddef>

#include "api/option_rows.hpp"
#include "api/special_options.hpp"

namespace unwrapd::api {
namespace {

// Each in the order of its enumerators.
constexpr std::array<std::string_view, 4> kPresets = {"texture", "lightmap", "chart", "paper"};
constexpr std::array<std::string_view, 9> kMethods = {"asap", "arap", "hybrid", "abf", "linabf",
                                                      "cp",   "bff",  "ic",     "slim"};
constexpr std::array<std::string_view, 2> kLambdaUnits = {"dimensionless", "paper"};
constexpr std::array<std::string_view, 4> kInitialMaps = {"auto", "mean_value", "tutte", "lscm"};
constexpr std::array<std::string_view, 2> kPins = {"diameter", "spectral"};
constexpr std::array<std::string_view, 4> kSeams = {"auto", "keep", "none", "uv0"};
constexpr std::array<std::string_view, 2> kWeldModes = {"auto", "exact"};
constexpr std::array<std::string_view, 3> kGuarantees = {"none", "flip_free", "bijective"};
constexpr std::array<std::string_view, 2> kRepairs = {"untangle", "virtual_boundary"};
constexpr std::array<std::string_view, 3> kEfforts = {"fast", "balanced", "best"};
constexpr std::array<std::string_view, 3> kRotations = {"any", "90", "none"};
constexpr std::array<std::string_view, 3> kGroups = {"scene", "material", "mesh"};
constexpr std::array<std::string_view, 2> kStraightenings = {"off", "auto"};
constexpr std::array<std::string_view, 2> kSymmetries = {"off", "auto"};
constexpr std::array<std::string_view, 3> kBoundaries = {"free", "circle", "square"};
constexpr std::array<std::string_view, 4> kOutputs = {"auto", "glb", "gltf", "obj"};

constexpr std::array<std::string_view, 2> kTextureModes = {"keep", "transfer"};
constexpr std::array<std::string_view, 4> kCompressions = {"keep", "none", "draco", "meshopt"};

constexpr std::array kEveryMethod = {Method::asap, Method::arap,   Method::hybrid,
                                     Method::abf,  Method::linabf, Method::cp,
                                     Method::bff,  Method::ic,     Method::slim};
constexpr std::array kLocalGlobal = {Method::arap, Method::hybrid};
constexpr std::array kStoppable = {Method::arap, Method::hybrid, Method::slim};
constexpr std::array kHolding = {Method::asap, Method::arap, Method::hybrid};
constexpr std::array kOnlyHybrid = {Method::hybrid};
constexpr std::array kOnlyAsap = {Method::asap};

constexpr double kMaxPadding = 0.25 * kMaxResolution;  // and at most a quarter of a side
constexpr double kMinTexelsPerUnit = 1e-9, kMaxTexelsPerUnit = 1e12;
constexpr double kMaxDistortion = 1e6, kMaxCharts = 1e6;
constexpr double kMaxWeldDistance = 1e100;
constexpr double kMinTolerance = 1e-12, kMaxTolerance = 0.1;

using O = UnwrapOptions;
using A = AssetOptions;

constexpr std::array kRows = {
    choice<&JobOptions::preset, kPresets>(
        "preset", kEveryMethod,
        "What the result is for; all other options override it. texture: charts of little "
        "distortion, and no texel is used twice. lightmap: the same in an unused set of texture "
        "coordinates. chart: a disk stays one chart, at any distortion. paper: ten iterations, "
        "one chart, no guarantee, for comparison."),
    choice<&O::method, kMethods>(
        "method", kEveryMethod,
        "The energy that the map minimizes. arap keeps angles and areas together (textures, light "
        "maps); asap keeps angles; hybrid balances the two by lambda; slim keeps shape and never "
        "flips a triangle; abf, linabf, bff and cp keep angles with less area distortion than "
        "asap; ic is for comparison."),
    OptionRow{.name = "lambda",
              .type = OptionType::numbers,
              .nullable = true,
              .description = "Weight of area against angle. 0 equals asap, larger values approach "
                             "arap. A list computes one map for each of its values. As they grow, "
                             "angles are never kept better, nor areas worse.",
              .methods = kOnlyHybrid,
              .get = get_lambda,
              .set = set_lambda},
    choice<&O::lambda_units, kLambdaUnits>(
        "lambda_units", kOnlyHybrid,
        "The scale of lambda. dimensionless: independent of the mesh's size and resolution; paper: "
        "as in the paper's Eq. (5), in the mesh's own units, for comparison with published "
        "figures."),
    figure<&Stop::iterations>(
        "stop.iterations", {1, {}, &Limits::max_iterations}, kStoppable,
        "Unset: iterate until convergence, with acceleration. N: exactly N unaccelerated "
        "iterations of every chart, as in the paper; slim iterates the same way in both cases."),
    figure<&Stop::tolerance>("stop.tolerance", {kMinTolerance, kMaxTolerance}, kStoppable,
                             "Iterations have converged when the energy falls by less than this "
                             "share. Lower values take longer and lower the energy further."),
    figure<&Stop::max_iterations>("stop.max_iterations", {1, {}, &Limits::max_iterations},
                                  kStoppable,
                                  "The most iterations of a chart that does not converge earlier. "
                                  "Higher values take longer on charts that converge slowly."),
    choice<&O::initial, kInitialMaps>(
        "initial", kLocalGlobal,
        "The map to start from. auto: the start with the lowest expected energy; mean_value, "
        "tutte: a map into a convex boundary; lscm: the conformal map. Other starts than auto are "
        "for comparison."),
    choice<&O::pins, kPins>(
        "pins", kOnlyAsap,
        "How asap fixes position and scale. diameter: pins the two boundary vertices farthest "
        "apart; spectral: pins none, which distorts areas less."),
    choice<&O::guarantee, kGuarantees>(
        "guarantee", kEveryMethod,
        "A property that the result must have, or the job fails. flip_free: no triangle is "
        "flipped; bijective: in addition, no two triangles of a chart overlap; none: the raw map."),
    choice<&O::repair, kRepairs>(
        "repair", kEveryMethod,
        "How flipped triangles are repaired. untangle: moves few vertices around each flip; "
        "virtual_boundary: the paper's convex virtual boundary."),
    choice<&O::boundary, kBoundaries>(
        "boundary", kHolding,
        "The shape of every chart's longest boundary. free: chosen by the map, with the least "
        "distortion; circle or square: exactly that shape."),
    objects("constraints", kHolding,
            "Vertices and the texture coordinates that they must have: exactly or, with a weight, "
            "in least squares.",
            get_constraints, set_constraints),
    choice<&O::seams, kSeams>("seams", kEveryMethod,
                              "Which cuts of the input remain cuts. keep: wherever vertices are "
                              "duplicated; none: nowhere; uv0: at the seams of the existing UVs; "
                              "auto: as keep if that gives a few disks, else as none."),
    OptionRow{.name = "weld",
              .type = OptionType::choice,
              .choices = kWeldModes,
              .description =
                  "Which vertices at different positions are taken for one where open edges meet. "
                  "auto: those apart by rounding, by a tolerance found in the mesh or by "
                  "weld_distance; exact: none. The file keeps its vertices.",
              .methods = kEveryMethod,
              .get = get_weld,
              .set = set_weld},
    figure<&Welding::distance>("weld_distance", {0, kMaxWeldDistance}, kEveryMethod,
                               "The greatest distance of vertices that weld=auto welds, in the "
                               "mesh's units. Unset: found in the mesh."),
    objects("seam_edges", kEveryMethod,
            "Paths of vertices along which the mesh is cut, in addition to the cuts of seams.",
            get_seam_edges, set_seam_edges),
    objects("keep_edges", kEveryMethod,
            "Paths of vertices along which no seam runs: charts grow across these edges first, at "
            "any distortion, and are cut elsewhere.",
            get_keep_edges, set_keep_edges),
    plain<&A::seam_avoid>(
        "seam_avoid", OptionType::text, kEveryMethod,
        "A painted attribute of vertices, from 0 to 1, such as COLOR_0.r or _AVOID: where it is "
        "high, seams run elsewhere if that is not much longer. Unset: seams are as short as they "
        "can be."),
    figure<&O::max_distortion>(
        "max_distortion", {kMinDistortion, kMaxDistortion}, kEveryMethod,
        "The most distortion of angles and of areas of ARAP maps, as means over "
        "the whole surface; 2 is ideal. One chart may lie four times as far "
        "above 2. Surfaces are split into charts until it holds. Lower "
        "values result in more charts. Unset: unlimited for a disk, else "
        "2.02."),
    figure<&O::max_charts>(
        "max_charts", {1, kMaxCharts}, kEveryMethod,
        "The most charts, at any distortion. Every component is at least one chart. "
        "Lower values result in fewer charts with longer seams inside them, then in more "
        "distortion. Unset: unlimited."),
    choice<&O::symmetry, kSymmetries>(
        "symmetry", kEveryMethod,
        "auto: seams of a surface with a mirror plane, which is detected, are symmetric; off: "
        "charts are searched for without regard to it."),
    choice<&O::effort, kEfforts>(
        "effort", kEveryMethod,
        "How long charts and their places on the page are searched for. fast: briefly, with more "
        "charts and longer seams; balanced: for most assets; best: much longer."),
    OptionRow{
        .name = "resolution",
        .type = OptionType::integer,
        .choices = kPageSizeChoices,
        .minimum = kMinResolution,
        .maximum = kMaxResolution,
        .description =
            "Side of the square texture, in texels. Set it to the size of the texture that "
            "will be painted or baked. auto: with texels_per_unit the smallest multiple of "
            "four that holds all islands, else 1024; power_of_two: the same with the smallest "
            "power of two.",
        .methods = kEveryMethod,
        .get = get_resolution,
        .set = set_resolution},
    figure<&O::width>("width", {kMinResolution, kMaxResolution}, kEveryMethod,
                      "Width of the texture, along U, in texels. Unset: resolution."),
    figure<&O::height>("height", {kMinResolution, kMaxResolution}, kEveryMethod,
                       "Height of the texture, along V, in texels. Unset: resolution."),
    figure<&O::padding>(
        "padding", {0, kMaxPadding}, kEveryMethod,
        "Least gap between islands, in texels; at most a quarter of the texture's shorter side. "
        "Higher values prevent bleeding between islands at lower mip levels, but fill less of the "
        "page."),
    figure<&Packing::texels_per_unit>(
        "texels_per_unit", {kMinTexelsPerUnit, kMaxTexelsPerUnit}, kEveryMethod,
        "Texels for each unit of length on every island; in a glTF, of the scene: the scales of "
        "its nodes count. Unset: as many as fit. Set it to give several assets the same texel "
        "density; resolution is then auto unless given."),
    plain<&A::texel_density>(
        "texel_density", OptionType::text, kEveryMethod,
        "A painted attribute of vertices, from 0 to 1, such as COLOR_0.g or _DENSITY: charts get "
        "up "
        "to four times as many texels for each unit of length where it is high. Unset: all charts "
        "have the same texel density."),
    figure<&Packing::max_pages>(
        "max_pages", {1, kMaxPages}, kEveryMethod,
        "The most pages. Page k is the UDIM tile 1001 + k and lies at U from k to k + 1."),
    choice<&O::straighten, kStraightenings>(
        "straighten", kEveryMethod,
        "auto: charts that are nearly rectangles become rectangles, where that keeps "
        "max_distortion "
        "(2.02 without one) and flips no triangle; off: maps stay as they are."),
    choice<&Packing::group, kGroups>(
        "group", kEveryMethod,
        "What has a page of its own, all at one texel density. scene: everything shares the pages; "
        "material: each material, and charts end where materials do; mesh: each mesh. Page k is "
        "the UDIM tile 1001 + k, and page_names of the report tell what lies on it."),
    choice<&Packing::rotation, kRotations>(
        "rotation", kEveryMethod,
        "How islands may be turned. any: as they fit best; 90: with their straight sides, or their "
        "smallest rectangle, along the page; none: as their map lies, or with repack_only their "
        "UVs."),
    plain<&Packing::stack_identical>("stack_identical", OptionType::flag, kEveryMethod,
                                     "true: islands of the same shape share one place, and so "
                                     "their texels; false: every island has its own place."),
    plain<&O::repack_only>(
        "repack_only", OptionType::flag, kEveryMethod,
        "true: packs the islands of the existing UVs again, without unwrapping; false: unwraps."),
    objects("locked_islands", kEveryMethod,
            "With repack_only: islands, each named by one of its faces, that keep their UVs or are "
            "turned and moved by hand. The others are packed around them, at the sizes that they "
            "have.",
            get_locked_islands, set_locked_islands),
    plain<&O::measure_only>("measure_only", OptionType::flag, kEveryMethod,
                            "true: measures the existing UVs where they are: charts, seams, "
                            "distortion, flips, overlaps and fill; false: unwraps."),
    OptionRow{.name = "texcoord",
              .type = OptionType::integer,
              .choices = kTexcoordChoices,
              .maximum = kMaxTexcoord,
              .description =
                  "The set of texture coordinates to write, n of TEXCOORD_n. All other sets are "
                  "kept. auto: 0 unless textures of the asset sample it, else the first unused "
                  "set; free: the first unused set, for light maps.",
              .methods = kEveryMethod,
              .get = get_texcoord,
              .set = set_texcoord},
    choice<&A::textures, kTextureModes>(
        "textures", kEveryMethod,
        "What becomes of images that sample the set of texture coordinates that is written. keep: "
        "they stay as they are; transfer: they are resampled for the new coordinates, normal maps "
        "turned, and auto writes the set that they sample. Needs guarantee=bijective or "
        "repack_only, one page, no constraints and no stacked islands."),
    plain<&A::materials>(
        "materials", OptionType::names, kEveryMethod,
        "Names of the materials to unwrap; all other surfaces keep their UVs. Empty: all."),
    plain<&A::primitives>(
        "primitives", OptionType::names, kEveryMethod,
        "JSON pointers of the primitives to unwrap; all others keep their UVs. Empty: all."),
    choice<&JobOptions::output, kOutputs>(
        "output", kEveryMethod,
        "Format of the result. auto: the format of the input, or GLB for STL, PLY and OFF, which "
        "are only read. "
        "Conversion to another kind of file keeps geometry, normals, texture coordinates and "
        "colours of vertices, and from an OBJ to a glTF its materials; a note names what is lost. "
        "GLB and glTF lose nothing to each other."),
    choice<&A::compression, kCompressions>(
        "compression", kEveryMethod,
        "Encoding of a glTF's geometry. keep: as in the input; none: uncompressed; meshopt: "
        "smaller files for readers that support the extension, lossless; draco: the smallest "
        "files, with positions and normals rounded as draco_bits says."),
    figure<&A::draco_bits>(
        "draco_bits", {kMinDracoBits, kMaxDracoBits}, kEveryMethod,
        "Bits of a position with compression=draco: positions are rounded to the nearest of "
        "2^draco_bits places along the mesh's longest side. Texture coordinates stay exact. "
        "Unset: all values do."),
    plain<&A::vertex_map>("vertex_map", OptionType::flag, kEveryMethod,
                          "true: the report lists the vertices that were duplicated for seams."),
};

}  // namespace

std::span<const OptionRow> option_table() { return kRows; }

std::string_view preset_name(Preset preset) { return kPresets[static_cast<std::size_t>(preset)]; }

std::string_view method_name(Method method) { return kMethods[static_cast<std::size_t>(method)]; }

}  // namespace unwrapd::api
