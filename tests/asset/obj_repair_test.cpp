// OBJ files that break rules of the format without a doubt of what is meant: read, and told.
#include <algorithm>

#include "tests/asset/support.hpp"

namespace unwrapd::asset::test {
namespace {

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
const std::string kHouse = R"(# two materials
mtllib house.mtl
v 0 0 0
v 1 0 0

v 1 1 0
v 0 1 0
v .5 1.5 .25
usemtl wall
f 1 2 3 4
usemtl roof
f 4 3 \
  5
)";

using Repairs = std::vector<std::pair<FileRepairKind, std::int64_t>>;

/// What reading repaired, as kind and count.
Repairs repairs_of(const std::string& file) {
  const Asset asset = read_file(file);
  Repairs repairs;
  for (const FileRepair& repair : asset.repairs()) repairs.emplace_back(repair.kind, repair.count);
  return repairs;
}

TEST(ObjRepair, IndicesMissingAfterTheirSlashAreReadAndTold) {
  for (const std::string& face :
       {std::string("f 1// 2// 3//"), std::string("f 1/ 2/ 3/"), std::string("f 1/1/ 2/1/ 3/1/")}) {
    EXPECT_EQ(repairs_of(kTriangle + face), (Repairs{{FileRepairKind::empty_indices_ignored, 3}}));
    const Asset asset = read_file(kTriangle + face);
    EXPECT_EQ(asset.surfaces()[0].mesh.faces, (std::vector<Triangle>{{0, 1, 2}}));
    EXPECT_TRUE(write(asset, split_nowhere(asset), Format::obj).ends_with("f 1/1 2/2 3/3"));
  }
  EXPECT_EQ(repairs_of(kTriangle + "vn 0 0 1\nf 1//1 2/7 3"), Repairs());
  for (const char* face : {"f /1 2 3", "f 1///1 2 3", "f 1/1/1/ 2 3", "f // 2 3"})
    EXPECT_EQ(error_of(kTriangle + face).code(), ErrorCode::malformed_obj) << face;
}

std::string with_line_ends(std::string text, const std::string& end) {
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += end.size())
    text.replace(at, 1, end);
  return text;
}

TEST(ObjRepair, LinesMayEndInReturnsAlone) {
  const Asset expected = read_file(kHouse);
  const std::string answer = write(expected, split_everywhere(expected), Format::obj);
  const auto lines = std::count(kHouse.begin(), kHouse.end(), '\n');
  const std::string mac = with_line_ends(kHouse, "\r");
  EXPECT_EQ(repairs_of(mac), (Repairs{{FileRepairKind::line_ends_replaced, lines}}));
  const Asset asset = read_file(mac);
  EXPECT_EQ(asset.surfaces()[0].mesh.faces, expected.surfaces()[0].mesh.faces);
  EXPECT_EQ(asset.surfaces()[0].part, expected.surfaces()[0].part);
  EXPECT_EQ(write(asset, split_everywhere(asset), Format::obj), answer);
  EXPECT_EQ(error_of(mac + "f 1 2 99\r").where(), "line " + std::to_string(lines + 1));
  for (const char* end : {"\r\n", "\r\r\n"})
    EXPECT_EQ(repairs_of(with_line_ends(kHouse, end)), Repairs()) << end;
  const std::string mixed = "v 0 0 0\rv 1 0 0\r\nv 0 1 0\nf 1 2 3\r";  // joined of two files
  EXPECT_EQ(repairs_of(mixed), (Repairs{{FileRepairKind::line_ends_replaced, 2}}));
  EXPECT_EQ(read_file(mixed).surfaces()[0].mesh.vertex_count(), 3);
}

TEST(ObjRepair, NormalsThatAreNoneAreTold) {
  const std::string text = kTriangle + "vn nan nan nan\nvn 0 0 -inf\nvn 0 0 1\nf 1//1 2//2 3//3";
  EXPECT_EQ(repairs_of(text), (Repairs{{FileRepairKind::normals_replaced, 2}}));
  const Asset asset = read_file(text);
  EXPECT_NE(write(asset, split_nowhere(asset), Format::obj).find("vn nan nan nan\n"),
            std::string::npos);
  const auto primitives = read_naively(write(asset, split_nowhere(asset), Format::glb));
  for (const std::vector<double>& normal : primitives[0].faces[0].at("NORMAL"))
    EXPECT_EQ(normal, (std::vector<double>{0, 0, 1}));
}

TEST(ObjRepair, NothingBeforeOrInACommentHidesAVertex) {
  for (const std::string& start : {std::string("\xef\xbb\xbf"), std::string("# C:\\meshes\\\n"),
                                   std::string("# C:\\meshes\\\r\n")}) {
    const Asset asset = read_file(start + kTriangle + "v 0 0 1\nf 1 2 3\n");
    EXPECT_EQ(asset.surfaces()[0].mesh.vertex_count(), 4);
    EXPECT_TRUE(write(asset, split_nowhere(asset), Format::obj).starts_with(start + "v 0 0 0\n"));
  }
}

}  // namespace
}  // namespace unwrapd::asset::test
