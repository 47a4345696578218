#include "core/asset/asset.hpp"

#include <cassert>
#include <limits>
#include <utility>
#include <variant>

#include "core/asset/codec/compress.hpp"
#include "core/asset/convert/convert.hpp"
#include "core/asset/convert/float_frame.hpp"
#include "core/asset/document.hpp"
#include "core/asset/gltf/stretched.hpp"
#include "core/asset/obj/materials.hpp"
#include "core/asset/obj/polygons.hpp"
#include "core/asset/painted.hpp"
#include "core/asset/reader/read_gltf.hpp"
#include "core/asset/recognise.hpp"
#include "core/asset/writer/patch.hpp"
#include "core/asset/zip.hpp"

namespace unwrapd::asset {

Asset::Asset(std::unique_ptr<Document> document) : document_(std::move(document)) {}
Asset::Asset(Asset&&) noexcept = default;
Asset& Asset::operator=(Asset&&) noexcept = default;
Asset::~Asset() = default;

Format Asset::format() const { return document_->format; }

std::span<const Surface> Asset::surfaces() const { return document_->surfaces; }

int Asset::texcoord() const { return texcoord(usual_output(document_->format)); }

int Asset::texcoord(Format output) const {
  if (const Gltf* gltf = std::get_if<Gltf>(&document_->source)) return gltf->texcoord.back() - '0';
  const obj::Obj* obj = std::get_if<obj::Obj>(&document_->source);
  return obj != nullptr && output != Format::obj && obj::keeps_texcoords(*obj, document_->options)
             ? 1
             : 0;
}

std::span<const FileRepair> Asset::repairs() const {
  return std::visit([](const auto& source) { return std::span(source.repairs); },
                    document_->source);
}

namespace {

constexpr ReadLimits kNoLimits = {.max_vertices = std::numeric_limits<Index>::max(),
                                  .max_faces = std::numeric_limits<Index>::max()};

/// All formats but glTF have one set of texture coordinates, and no primitives. A surface has all
/// their materials.
void check_for_one_mesh(const AssetOptions& options, Format format) {
  const std::string name =
      format == Format::obj ? "an OBJ" : "a mesh in " + std::string(format_name(format));
  const auto refuse = [&](const char* option, const std::string& why) {
    throw Error(ErrorCode::invalid_option, name + why, option);
  };
  if (const int* set = std::get_if<int>(&options.texcoord); set != nullptr && *set != 0)
    refuse("/texcoord", " has one set of texture coordinates; leave texcoord out, or send a glTF");
  if (!options.materials.empty())
    refuse("/materials", " is unwrapped whole; leave materials out, or send a glTF");
  if (options.textures == TextureMode::transfer)
    refuse("/textures",
           " has no images that could be resampled; leave textures out, or send a glTF");
  if (!options.primitives.empty())
    refuse("/primitives", " has no primitives; leave them out, or send a glTF");
}

/// An uncompressed document.
struct Plain {
  std::string glb;
  const Aside* aside = nullptr;  ///< members of the document outside of json
  std::stop_token stop;
};

/// Draco, and meshopt for an OBJ, first need the finished document.
std::string compressed(Plain plain, Format output, Compression compression, bool with_fallback,
                       std::optional<int> draco_bits) {
  std::vector<Surface> surfaces;
  const Gltf again =
      reader::read_gltf({plain.glb, {}, plain.stop}, Format::glb, kNoLimits, {}, surfaces);
  plain.glb = {};
  if (compression != Compression::draco)
    return writer::assemble(again, {again.json, {}, &again.aside}, output, codec::MeshoptStyle{});
  PatchedDocument packed = codec::draco_compressed(again, with_fallback, draco_bits);
  packed.aside = plain.aside != nullptr ? plain.aside : &again.aside;
  return writer::assemble(again, std::move(packed), output);
}

bool is_compressed(Compression compression) {
  return compression == Compression::draco || compression == Compression::meshopt;
}

std::string write_from_gltf(const Gltf& gltf, std::span<const UnwrappedSurface> unwrapped,
                            Format output, const AssetOptions& options) {
  const bool is_kept = options.compression == Compression::keep;
  const Compression compression = is_kept ? gltf.came_as : options.compression;
  const bool with_fallback = is_kept && gltf.came_with_fallback;
  PatchedDocument patched = writer::patch(gltf, unwrapped, output);
  if (compression == Compression::draco) {
    patched.aside = nullptr;  // so that unread members are not read again
    return compressed(
        {writer::assemble(gltf, std::move(patched), Format::glb), &gltf.aside, gltf.stop}, output,
        compression, with_fallback, is_kept ? std::nullopt : options.draco_bits);
  }
  if (compression != Compression::meshopt)
    return writer::assemble(gltf, std::move(patched), output);
  const codec::MeshoptStyle style =
      is_kept ? codec::MeshoptStyle{gltf.meshopt_name, with_fallback} : codec::MeshoptStyle{};
  return writer::assemble(gltf, std::move(patched), output, style);
}

/// How positions are rounded, if they are.
std::optional<int> rounding_bits(const AssetOptions& options, Format output) {
  const bool is_draco = output != Format::obj && options.compression == Compression::draco;
  return is_draco ? options.draco_bits : std::nullopt;
}

/// The GLB or glTF of a document that was none. make: the uncompressed one, in a format.
template <class Make>
std::string write_gltf(const Document& document, const std::stop_token& stop, Format output,
                       const Make& make) {
  const Compression compression = document.options.compression;
  if (!is_compressed(compression)) return make(output);
  return compressed({make(Format::glb), nullptr, stop}, output, compression, false,
                    document.options.draco_bits);
}

std::string write_from_obj(const Document& document, const UnwrappedSurface& unwrapped,
                           Format output) {
  const obj::Obj& obj = std::get<obj::Obj>(document.source);
  if (output == Format::obj) return obj::write_obj(obj, unwrapped);
  return write_gltf(document, obj.stop, output, [&](Format format) {
    return convert::obj_as_gltf(obj, document.surfaces.front(), unwrapped,
                                obj::keeps_texcoords(obj, document.options), format);
  });
}

std::string write_from_mesh_file(const Document& document, const UnwrappedSurface& unwrapped,
                                 Format output) {
  const mesh_files::MeshFile& file = std::get<mesh_files::MeshFile>(document.source);
  const Surface& surface = document.surfaces.front();
  if (output == Format::obj) return convert::mesh_file_as_obj(file, surface, unwrapped);
  return write_gltf(document, file.stop, output, [&](Format format) {
    return convert::mesh_file_as_gltf(file, surface, unwrapped, format);
  });
}

/// Reads all formats but glTF, which have one surface.
std::variant<Gltf, obj::Obj, mesh_files::MeshFile> read_one_mesh(const Input& input,
                                                                 const ReadLimits& limits,
                                                                 Format format, Surface& surface) {
  surface.name = format_name(format);
  if (format == Format::stl) return mesh_files::read_stl(input, limits, surface);
  if (format == Format::ply) return mesh_files::read_ply(input, limits, surface);
  if (format == Format::off) return mesh_files::read_off(input, limits, surface);
  return obj::read_obj(input, limits, surface);
}

Asset read_document(const Input& input, const ReadLimits& limits, const AssetOptions& options) {
  auto document = std::make_unique<Document>();
  document->options = options;
  document->format = recognise(input.document, input.stop);
  if (document->format == Format::glb || document->format == Format::gltf) {
    document->source =
        reader::read_gltf(input, document->format, limits, options, document->surfaces);
  } else {
    check_for_one_mesh(options, document->format);
    document->surfaces.resize(1);
    document->source = read_one_mesh(input, limits, document->format, document->surfaces.front());
  }
  read_painted(input, *document);
  return Asset(std::move(document));
}

}  // namespace

Asset read(const Input& input, const ReadLimits& limits, const AssetOptions& options) {
  if (!is_zip(input.document)) return read_document(input, limits, options);
  const Unzipped unzipped = unzip(input.document, limits.max_unzipped_bytes, input.stop);
  Input inner{unzipped.document, {}, input.stop};
  for (const auto& [path, bytes] : unzipped.files) inner.buffers.emplace(path, bytes);
  return read_document(inner, limits, options);
}

std::string write(const Asset& asset, std::span<const UnwrappedSurface> unwrapped, Format output) {
  const Document& document = asset.document();
  assert(unwrapped.size() == document.surfaces.size());
  assert(output == usual_output(output));
  if (std::holds_alternative<obj::Obj>(document.source))
    return write_from_obj(document, unwrapped.front(), output);
  if (std::holds_alternative<mesh_files::MeshFile>(document.source))
    return write_from_mesh_file(document, unwrapped.front(), output);
  const Gltf& gltf = std::get<Gltf>(document.source);
  return output == Format::obj ? convert::gltf_as_obj(gltf, document.surfaces, unwrapped)
                               : write_from_gltf(gltf, unwrapped, output, document.options);
}

std::vector<VertexMap> vertex_maps(const Asset& asset, std::span<const UnwrappedSurface> unwrapped,
                                   Format output) {
  const Document& document = asset.document();
  if (const obj::Obj* obj = std::get_if<obj::Obj>(&document.source)) {
    const Surface& surface = document.surfaces.front();
    if (output == Format::obj) return {{surface.name, surface.mesh.vertex_count(), {}}};
    const bool keeps = obj::keeps_texcoords(*obj, document.options);
    return {{surface.name, 0, convert::sources_in_gltf(*obj, surface, unwrapped.front(), keeps)}};
  }
  if (const mesh_files::MeshFile* file = std::get_if<mesh_files::MeshFile>(&document.source)) {
    const Surface& surface = document.surfaces.front();
    if (output == Format::obj) return {{surface.name, surface.mesh.vertex_count(), {}}};
    return {{surface.name, 0, convert::sources_in_gltf(*file, surface, unwrapped.front())}};
  }
  const Gltf& gltf = std::get<Gltf>(document.source);
  if (output != Format::obj) return writer::vertex_maps_of_patch(gltf, unwrapped);
  std::vector<VertexMap> maps;
  for (std::size_t s = 0; s < document.surfaces.size(); ++s)
    maps.push_back({document.surfaces[s].name, 0, gltf.vertices[s]});
  return maps;
}

std::vector<Note> side_effects(const Asset& asset, std::span<const UnwrappedSurface> unwrapped,
                               Format output) {
  const Document& document = asset.document();
  std::vector<Note> notes;
  if (output == Format::obj && is_compressed(document.options.compression))
    notes.push_back({NoteCode::option_unused,
                     "An OBJ cannot be compressed; the option compression has no effect."});
  if (output == Format::obj && document.options.textures == TextureMode::transfer)
    notes.push_back(
        {NoteCode::option_unused, "An OBJ has no images; the option textures has no effect."});
  convert::FloatFrame frame;
  if (output != Format::obj && !std::holds_alternative<Gltf>(document.source))
    frame = convert::float_frame(document.surfaces.front().mesh, {});
  const std::vector<Note> on_floats = convert::notes_on(frame);
  notes.insert(notes.end(), on_floats.begin(), on_floats.end());
  if (const std::optional<int> bits = rounding_bits(document.options, output))
    notes.push_back(codec::note_on_rounding(document.surfaces, frame.origin, *bits));
  std::vector<Note> more;
  if (const obj::Obj* obj = std::get_if<obj::Obj>(&document.source)) {
    more = output == Format::obj ? obj::note_on_polygons(*obj, unwrapped.front())
                                 : obj::note_on_materials(*obj);
    if (output != Format::obj && obj::keeps_texcoords(*obj, document.options))
      notes.push_back({NoteCode::set_chosen,
                       "The new texture coordinates are TEXCOORD_1. TEXCOORD_0 has those of the "
                       "OBJ, so that images of its materials keep fitting. Send texcoord=0 to "
                       "replace them."});
    else if (obj->has_materials() && !obj->texcoord_lines.empty())
      notes.push_back(
          {NoteCode::textures_lost,
           std::string("The OBJ had texture coordinates, which are replaced: images of "
                       "its materials no longer fit. ") +
               (output == Format::obj ? "Send output=glb, with the files of its materials, "
                                      : "Send the files of its materials, and no texcoord, ") +
               "to keep them in a set of their own."});
  }
  if (const mesh_files::MeshFile* file = std::get_if<mesh_files::MeshFile>(&document.source))
    more = mesh_files::note_on_mesh_file(*file, document.format, output);
  if (const Gltf* gltf = std::get_if<Gltf>(&document.source)) {
    const std::vector<Note> stretched = notes_on_stretched(*gltf, document.surfaces);
    notes.insert(notes.end(), stretched.begin(), stretched.end());
    more = output == Format::obj ? convert::notes_on_obj_of_gltf(*gltf)
                                 : writer::side_effects_of_patch(*gltf, unwrapped, output);
  }
  notes.insert(notes.end(), more.begin(), more.end());
  return notes;
}

}  // namespace unwrapd::asset
