// An OBJ with its MTL and images as a glTF: names, colours, textures, and texture coordinates that
// they fit.
#include <gmock/gmock.h>

#include <algorithm>

#include "core/asset/obj/mtl.hpp"
#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

using testing::HasSubstr, testing::Not;

const std::string kSomePng = "\x89PNG\r\n\x1a\n and so on", kJpeg = "\xff\xd8\xff\xe0 and so on";

/// Two quads, wood and glass, with texture coordinates of their own.
const std::string kObj = R"(mtllib chair.mtl
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 1 0 1
v 1 1 1
vt 0 0
vt 0.25 0
vt 0.25 0.5
vt 0 0.5
vt 0.75 1
usemtl wood
f 1/1 2/2 3/3 4/4
usemtl glass
f 2/2 5/5 6/5 3/1
)";

const std::string kMtl = R"(# a library
newmtl wood
Kd 0.5 0.25 0.125
map_Kd -o 0 0 0 -s 1 1 1 img\my wood.png
map_Bump -bm 0.5 img/wood_normal.jpg
map_Ks img/wood_s.png
newmtl glass
Kd 0.1 0.2 0.3
Ke 1 0.5 0
d 0.25
Ns 30
map_Ke glow.png
bump heights.png
)";

using Files = std::map<std::string, std::string>;

const Files kAll = {{"chair.mtl", kMtl},
                    {"img/my wood.png", kSomePng + "1"},
                    {"img/wood_normal.jpg", kJpeg},
                    {"glow.png", kSomePng + "2"}};

const AssetOptions kAutomaticSet = {.texcoord = TexcoordChoice::automatic,
                                    .compression = Compression::none};

Asset read_with(const Files& files, const AssetOptions& options = kAutomaticSet,
                const std::string& obj = kObj) {
  return read(input_of(obj, files), {}, options);
}

std::string glb_with(const Files& files, const AssetOptions& options = kAutomaticSet) {
  const Asset asset = read_with(files, options);
  return write(asset, split_nowhere(asset), Format::glb);
}

std::vector<Note> notes_of(const Asset& asset, Format output = Format::glb) {
  return side_effects(asset, split_nowhere(asset), output);
}

const Note* note_with(const std::vector<Note>& notes, NoteCode code) {
  const auto found = std::ranges::find(notes, code, &Note::code);
  return found == notes.end() ? nullptr : &*found;
}

/// The bytes of an image of the document.
std::string image_bytes(const Json& json, const std::string& glb, std::size_t image) {
  const Json& view = json["bufferViews"][json["images"][image]["bufferView"].get<std::size_t>()];
  const std::string json_length = glb.substr(12, 4);
  std::size_t at = 20;
  for (std::size_t k = 0; k < 4; ++k)
    at += std::size_t{static_cast<unsigned char>(json_length[k])} << 8 * k;
  return glb.substr(at + 8 + view.value("byteOffset", std::size_t{0}),
                    view["byteLength"].get<std::size_t>());
}

std::size_t image_of(const Json& json, const Json& texture) {
  return json["textures"][texture["index"].get<std::size_t>()]["source"];
}

TEST(ObjMaterials, ColoursAndTexturesAreThoseOfTheMtl) {
  const std::string glb = glb_with(kAll);
  const Json json = json_of(glb);
  const Json &wood = json["materials"][0], &glass = json["materials"][1];
  EXPECT_EQ(wood["name"], "wood");
  EXPECT_EQ(wood["pbrMetallicRoughness"]["baseColorFactor"], Json({0.5, 0.25, 0.125, 1.0}));
  EXPECT_EQ(wood["pbrMetallicRoughness"]["metallicFactor"], 0.0);
  EXPECT_EQ(
      image_bytes(json, glb, image_of(json, wood["pbrMetallicRoughness"]["baseColorTexture"])),
      kSomePng + "1");
  EXPECT_EQ(image_bytes(json, glb, image_of(json, wood["normalTexture"])), kJpeg);
  EXPECT_EQ(json["images"][image_of(json, wood["normalTexture"])]["mimeType"], "image/jpeg");
  EXPECT_EQ(wood["normalTexture"]["scale"], 0.5);
  EXPECT_FALSE(wood.contains("alphaMode"));
  EXPECT_EQ(glass["pbrMetallicRoughness"]["baseColorFactor"], Json({0.1, 0.2, 0.3, 0.25}));
  EXPECT_EQ(glass["pbrMetallicRoughness"]["roughnessFactor"], 0.25);  // sqrt(2 / 32)
  EXPECT_EQ(glass["emissiveFactor"], Json({1.0, 0.5, 0.0}));
  EXPECT_EQ(image_bytes(json, glb, image_of(json, glass["emissiveTexture"])), kSomePng + "2");
  EXPECT_EQ(glass["alphaMode"], "BLEND");
  EXPECT_FALSE(glass.contains("normalTexture"));  // a map of heights
  EXPECT_EQ(json["images"].size(), 3);
  const auto& primitives = json["meshes"][0]["primitives"];
  for (std::size_t p = 0; p < 2; ++p) EXPECT_EQ(primitives[p]["material"], p);
}

TEST(ObjMaterials, TexturesKeepTheTextureCoordinatesThatTheyFit) {
  const std::vector<ReadPrimitive> primitives = read_naively(glb_with(kAll));
  ASSERT_EQ(primitives.size(), 2U);
  const Face& first = primitives[0].faces[0];
  const std::array<std::array<double, 2>, 3> old = {{{0, 1}, {0.25, 1}, {0.25, 0.5}}};
  const Asset asset = read_with(kAll);
  const UnwrappedSurface unwrapped = split_nowhere(asset)[0];
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(first.at("TEXCOORD_0")[i], (std::vector<double>{old[i][0], old[i][1]}));
    const Vec2& uv = unwrapped.uv[std::size_t(asset.surfaces()[0].mesh.faces[0][i])];
    EXPECT_FLOAT_EQ(float(first.at("TEXCOORD_1")[i][0]), float(uv.x()));
    EXPECT_FLOAT_EQ(float(first.at("TEXCOORD_1")[i][1]), float(1 - uv.y()));
  }
  EXPECT_EQ(asset.texcoord(Format::glb), 1);
  EXPECT_EQ(asset.texcoord(Format::obj), 0);
  EXPECT_NE(note_with(notes_of(asset), NoteCode::set_chosen), nullptr);
  EXPECT_EQ(note_with(notes_of(asset), NoteCode::textures_lost), nullptr);
  EXPECT_NE(note_with(notes_of(asset, Format::obj), NoteCode::textures_lost), nullptr);
}

TEST(ObjMaterials, ASetThatIsNamedIsReplaced) {
  const Asset asset = read_with(kAll, kPlain);  // texcoord=0
  const Json json = json_of(write(asset, split_nowhere(asset), Format::glb));
  EXPECT_FALSE(json["meshes"][0]["primitives"][0]["attributes"].contains("TEXCOORD_1"));
  EXPECT_EQ(asset.texcoord(Format::glb), 0);
  const std::vector<Note> notes = notes_of(asset);
  const Note* lost = note_with(notes, NoteCode::textures_lost);
  ASSERT_NE(lost, nullptr);
  EXPECT_THAT(lost->text, Not(HasSubstr("output=glb")));  // which it is
}

TEST(ObjMaterials, WithoutTheMtlNamesStayAndANoteTellsTheRest) {
  for (const Files& files : {Files{}, Files{{"other.mtl", kMtl}, {"glow.png", kSomePng}}}) {
    const Asset asset = read_with(files);
    const Json json = json_of(write(asset, split_nowhere(asset), Format::glb));
    EXPECT_EQ(json["materials"], Json::parse(R"([{"name": "wood"}, {"name": "glass"}])"));
    EXPECT_FALSE(json.contains("images"));
    EXPECT_FALSE(json["meshes"][0]["primitives"][0]["attributes"].contains("TEXCOORD_1"));
    const std::vector<Note> notes = notes_of(asset);
    ASSERT_NE(note_with(notes, NoteCode::data_dropped), nullptr);
    EXPECT_THAT(note_with(notes, NoteCode::data_dropped)->text, HasSubstr("(2)"));
  }
}

TEST(ObjMaterials, ImagesThatWereNotSentAreReferredTo) {
  const Asset asset = read_with({{"chair.mtl", kMtl}});
  const Json json = json_of(write(asset, split_nowhere(asset), Format::glb));
  std::vector<std::string> uris;
  for (const Json& image : json["images"]) uris.push_back(image["uri"]);
  EXPECT_EQ(uris,
            (std::vector<std::string>{"img/my%20wood.png", "img/wood_normal.jpg", "glow.png"}));
  const std::vector<Note> notes = notes_of(asset);
  const Note* beside = note_with(notes, NoteCode::images_separate);
  ASSERT_NE(beside, nullptr);
  EXPECT_THAT(beside->text, HasSubstr("3 images"));
}

TEST(ObjMaterials, WhatAGltfCannotHaveIsNamed) {
  const std::vector<Note> notes = notes_of(read_with(kAll));
  const Note* dropped = note_with(notes, NoteCode::data_dropped);
  ASSERT_NE(dropped, nullptr);
  EXPECT_THAT(dropped->text, HasSubstr("bump, map_ks"));
  Files tga = kAll;
  tga["glow.png"] = "no image that a glTF has";
  const Asset asset = read_with(tga);
  EXPECT_FALSE(json_of(write(asset, split_nowhere(asset), Format::glb))["materials"][1].contains(
      "emissiveTexture"));
  EXPECT_THAT(note_with(notes_of(asset), NoteCode::data_dropped)->text,
              HasSubstr("other than PNG and JPEG"));
}

TEST(ObjMaterials, ImagesAreNotMultipliedByColoursOfVertices) {
  const std::string obj =
      "mtllib a.mtl\nv 0 0 0 .5 .5 .5\nv 1 0 0 1 1 1\nv 0 1 0 0 0 0\nv 1 1 0 0 1 0\nvt 0 0\n"
      "usemtl image\nf 1/1 2/1 3/1\nusemtl plain\nf 2/1 4/1 3/1\n";
  const Asset asset = read_with({{"a.mtl", "newmtl image\nmap_Kd a.png\nnewmtl plain\nKd 1 1 1\n"}},
                                kAutomaticSet, obj);
  const auto answer = read_naively(write(asset, split_nowhere(asset), Format::glb));
  ASSERT_EQ(answer.size(), 2U);
  EXPECT_FALSE(answer[0].faces[0].contains("COLOR_0"));
  EXPECT_TRUE(answer[1].faces[0].contains("COLOR_0"));
  EXPECT_THAT(note_with(notes_of(asset), NoteCode::data_dropped)->text,
              HasSubstr("colours of vertices where the material has an image"));
}

TEST(ObjMaterials, OtherPartsOfTheObjThatAGltfLacksAreNamed) {
  const auto dropped = [](const std::string& text, Format output) {
    const Asset asset = read_file(text);
    const std::vector<Note> notes = side_effects(asset, split_nowhere(asset), output);
    const Note* note = note_with(notes, NoteCode::data_dropped);
    return note == nullptr ? std::string() : note->text;
  };
  const std::string all =
      "o Part\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\ng A\nf 1 2 3\nl 1 3\np 2\n";
  EXPECT_THAT(dropped(all, Format::glb),
              HasSubstr("converted: lines, points, names of objects and groups. Send"));
  EXPECT_EQ(dropped(all, Format::obj), "");
  EXPECT_EQ(dropped("v 0 0 0 1\nv 1 0 0\nv 1 1 0\nf 1 2 3\n", Format::glb), "");  // a weight
}

TEST(ObjMaterials, FilesAreFoundByTheirNamesInOtherFolders) {
  Files flat;
  for (const auto& [path, bytes] : kAll) flat["./" + path.substr(path.rfind('/') + 1)] = bytes;
  EXPECT_EQ(json_of(glb_with(flat)), json_of(glb_with(kAll)));
}

TEST(ObjMaterials, EveryEncodingOfTheResultHasThem) {
  for (const Compression compression :
       {Compression::none, Compression::meshopt, Compression::draco}) {
    const Asset asset =
        read_with(kAll, {.texcoord = TexcoordChoice::automatic, .compression = compression});
    for (const Format format : {Format::glb, Format::gltf}) {
      const std::string file = write(asset, split_nowhere(asset), format);
      const Json json = json_of(file);
      EXPECT_EQ(json["images"].size(), 3);
      const Asset again = read_file(file);
      EXPECT_EQ(again.surfaces()[0].mesh.face_count(), 4);
      const Json plain = json_of(write(again, split_nowhere(again), Format::glb));
      EXPECT_TRUE(plain["meshes"][0]["primitives"][1]["attributes"].contains("TEXCOORD_1"));
    }
  }
}

TEST(ObjMaterials, AnImageThatManyPathsLeadToIsTakenOnce) {
  std::string mtl, obj = "mtllib a.mtl\nmtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int k = 0; k < 50; ++k) {
    const std::string name = "m" + std::to_string(k);
    mtl += "newmtl " + name + "\nmap_Kd folder" + std::to_string(k) + "/wood.png\n";
    obj += "usemtl " + name + "\nf 1 2 3\n";
  }
  const Asset asset = read_with({{"a.mtl", mtl}, {"wood.png", kSomePng}}, kAutomaticSet, obj);
  const Json json = json_of(write(asset, split_nowhere(asset), Format::glb));
  EXPECT_EQ(json["materials"].size(), 50U);
  EXPECT_EQ(json["images"].size(), 1U);
}

TEST(Mtl, ReadsWhatExportersWrite) {
  obj::MtlLibrary library;
  Pace pace({});
  obj::read_mtl(
      "newmtl a b\r\nKd 0.5\r\nTr 0.25\r\nPr .3\r\nPm 1\r\nmap_Kd C:\\tex\\a.png\r\n"
      "newmtl c\nKd spectral x.rfl\nKd 9 -1 nan\nd -halo 0.5\nnorm -bm inf -clamp on n.png\n"
      "map_d ../up.png\nnewmtl a b\nKd 0 0 0\n",
      pace, library);
  ASSERT_EQ(library.size(), 2U);
  const obj::MtlMaterial &a = library.at("a b"), &c = library.at("c");
  EXPECT_EQ(a.colour, (std::array<double, 3>{0.5, 0.5, 0.5}));  // the first of a name counts
  EXPECT_EQ(a.alpha, 0.75);
  EXPECT_EQ(a.roughness, 0.3);
  EXPECT_EQ(a.metallic, 1);
  EXPECT_EQ(a.colour_map, "a.png");
  EXPECT_EQ(c.colour, (std::array<double, 3>{1, 1, 1}));
  EXPECT_EQ(c.alpha, 0.5);
  EXPECT_EQ(c.normal_map, "n.png");
  EXPECT_EQ(c.normal_scale, 1);
  EXPECT_EQ(c.alpha_map, "up.png");
}

TEST(Mtl, AnyBytesAreRead) {
  std::string text = kMtl;
  for (std::size_t k = 0; k < text.size(); ++k) {
    obj::MtlLibrary library;
    Pace pace({});
    obj::read_mtl(text.substr(0, k), pace, library);
    std::string broken = text;
    broken[k] = static_cast<char>(k * 37);
    obj::read_mtl(broken, pace, library);
  }
}

}  // namespace
}  // namespace unwrapd::asset::test
