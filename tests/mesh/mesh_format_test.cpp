// Meshes written and read back; STL and GLB by readers of their own, from the formats' specifications.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/mesh/formats.h"
#include "sample_mesh.h"

namespace retalho {
namespace {

namespace fs = std::filesystem;

class MeshFormat : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("retalho-mesh-" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string name(const char* file) const { return (folder_ / file).string(); }
  TriangleMesh read_text(const std::string& file, const std::string& text) const {
    const std::vector<char> exact(text.begin(), text.end());
    const std::string_view bytes(exact.data(), exact.size());
    return file.ends_with(".ply") ? read_ply(bytes, name(file.c_str())) : read_obj(bytes, name(file.c_str()));
  }
  /// The message of the error that reading this text gives; it must name the file.
  std::string error_of(const char* file, const std::string& text) const {
    try {
      read_text(file, text);
    } catch (const Error& e) {
      EXPECT_TRUE(e.kind() == Error::Kind::bad_input || e.kind() == Error::Kind::cannot_read);
      EXPECT_EQ(e.file(), name(file));
      return e.what();
    }
    return "no error";
  }
  fs::path folder_;
};

template <typename T>
T at(const std::string& bytes, std::size_t offset) {
  T value{};
  if (offset + sizeof value > bytes.size()) {
    ADD_FAILURE() << "read beyond the end at " << offset;
    return value;
  }
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

void expect_near(Vec3 a, Vec3 b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

void expect_same(const TriangleMesh& read, const TriangleMesh& written, double attribute_tolerance) {
  ASSERT_EQ(read.positions.size(), written.positions.size());
  ASSERT_EQ(read.normals.size(), written.normals.size());
  ASSERT_EQ(read.texture.size(), written.texture.size());
  EXPECT_EQ(read.triangles, written.triangles);
  for (std::size_t i = 0; i < read.positions.size(); ++i)
    EXPECT_EQ(read.positions[i], written.positions[i] + written.offset);
  for (std::size_t i = 0; i < read.normals.size(); ++i)
    expect_near(read.normals[i], written.normals[i], attribute_tolerance);
  for (std::size_t i = 0; i < read.texture.size(); ++i) {
    EXPECT_NEAR(read.texture[i].x, written.texture[i].x, attribute_tolerance);
    EXPECT_NEAR(read.texture[i].y, written.texture[i].y, attribute_tolerance);
  }
}

TEST_F(MeshFormat, PlyAndObjGiveBackEveryDigit) {
  for (const bool normals : {true, false})
    for (const bool texture : {true, false}) {
      TriangleMesh mesh = test::wavy_sheet();
      if (!normals) mesh.normals.clear();
      if (!texture) mesh.texture.clear();
      write_mesh(mesh, name("m.ply"), true);
      write_mesh(mesh, name("m.obj"), true);
      expect_same(read_mesh(name("m.ply")), mesh, 1e-7);
      expect_same(read_mesh(name("m.obj")), mesh, 0);
    }
}

TEST_F(MeshFormat, EncodedBytesAreTheFiles) {
  TriangleMesh mesh = test::wavy_sheet();
  for (const char* ending : {".ply", ".obj", ".stl", ".glb", ".xml"}) {
    write_mesh(mesh, name("m") + ending);
    EXPECT_EQ(encode_mesh(mesh, ending), read_file(name("m") + ending)) << ending;
  }
  EXPECT_THROW(encode_mesh(mesh, ".fbx"), UsageError);
  mesh.triangles[3][1] = 35;
  EXPECT_THROW(encode_mesh(mesh, ".glb"), BadInput);
}

TEST_F(MeshFormat, PlyIsLaidOutAsItsHeaderSays) {
  const TriangleMesh mesh = test::wavy_sheet();
  write_mesh(mesh, name("m.ply"));
  const std::string bytes = read_file(name("m.ply"));
  const std::string end = "end_header\n";
  const std::size_t body = bytes.find(end) + end.size();
  EXPECT_EQ(bytes.substr(0, body),
            "ply\nformat binary_little_endian 1.0\ncomment retalho\nelement vertex 35\nproperty double x\nproperty "
            "double y\nproperty double z\n"
            "property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n"
            "element face 48\nproperty list uchar uint vertex_indices\nend_header\n");
  EXPECT_EQ(bytes.size(), body + 35 * (24 + 12 + 8) + 48 * 13);
  EXPECT_EQ(at<double>(bytes, body + 44), mesh.positions[1].x + mesh.offset.x);
  EXPECT_EQ(at<std::uint8_t>(bytes, body + 35 * 44), 3);
  EXPECT_EQ(at<std::uint32_t>(bytes, body + 35 * 44 + 1), 0U);
}

TEST_F(MeshFormat, StlHoldsEveryTriangleWithItsNormal) {
  const TriangleMesh mesh = test::wavy_sheet();
  write_mesh(mesh, name("m.stl"));
  const std::string bytes = read_file(name("m.stl"));
  ASSERT_EQ(bytes.size(), 84 + 50 * mesh.triangles.size());
  EXPECT_NE(bytes.find("offset 4512345.625"), std::string::npos);
  EXPECT_NE(bytes.substr(0, 5), "solid");
  EXPECT_EQ(at<std::uint32_t>(bytes, 80), mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto vec = [&](std::size_t k) {
      const std::size_t o = 84 + 50 * t + 12 * k;
      return Vec3{at<float>(bytes, o), at<float>(bytes, o + 4), at<float>(bytes, o + 8)};
    };
    for (std::size_t k = 0; k < 3; ++k) expect_near(vec(k + 1), mesh.positions[mesh.triangles[t][k]], 1e-6);
    expect_near(vec(0), normalized(cross(vec(2) - vec(1), vec(3) - vec(1))), 1e-5);
  }
}

/// glTF 2.0, section 4.4 (binary) and 3.6 (accessors), read anew.
TEST_F(MeshFormat, GlbIsValidGltf) {
  TriangleMesh mesh = test::wavy_sheet();
  write_mesh(mesh, name("m.glb"));
  const std::string bytes = read_file(name("m.glb"));
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(at<std::uint32_t>(bytes, 4), 2U);
  EXPECT_EQ(at<std::uint32_t>(bytes, 8), bytes.size());
  const std::uint32_t json_size = at<std::uint32_t>(bytes, 12);
  EXPECT_EQ(bytes.substr(16, 4), "JSON");
  EXPECT_EQ(json_size % 4, 0U);
  const nlohmann::json d = nlohmann::json::parse(bytes.substr(20, json_size));
  const std::size_t chunk = 20 + json_size;
  const std::uint32_t size = at<std::uint32_t>(bytes, chunk);
  EXPECT_EQ(bytes.substr(chunk + 4, 4), std::string("BIN\0", 4));
  EXPECT_EQ(chunk + 8 + size, bytes.size());
  EXPECT_EQ(d["asset"]["version"], "2.0");
  EXPECT_EQ(d["buffers"][0]["byteLength"], size);
  const auto start = [&](const nlohmann::json& accessor, std::size_t element, int target) {
    const auto& view = d["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    EXPECT_EQ(view["byteOffset"].get<std::size_t>() % 4, 0U);
    EXPECT_EQ(view["target"], target);
    EXPECT_EQ(view["byteLength"], accessor["count"].get<std::size_t>() * element);
    EXPECT_LE(view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>(), size);
    return chunk + 8 + view["byteOffset"].get<std::size_t>();
  };
  const auto& primitive = d["meshes"][0]["primitives"][0];
  const auto accessor = [&](const nlohmann::json& index) { return d["accessors"][index.get<std::size_t>()]; };
  const auto position = accessor(primitive["attributes"]["POSITION"]),
             normal = accessor(primitive["attributes"]["NORMAL"]);
  const auto texture = accessor(primitive["attributes"]["TEXCOORD_0"]), index = accessor(primitive["indices"]);
  EXPECT_EQ(position["count"], mesh.positions.size());
  EXPECT_EQ(normal["count"], mesh.positions.size());
  EXPECT_EQ(texture["count"], mesh.positions.size());
  EXPECT_EQ(index["count"], mesh.triangles.size() * 3);
  EXPECT_EQ(index["componentType"], 5125);
  EXPECT_EQ(position["type"], "VEC3");
  const auto& root = d["nodes"][d["scenes"][0]["nodes"][0].get<std::size_t>()];
  const auto& node = d["nodes"][root["children"][0].get<std::size_t>()];
  const Vec3 centre{node["translation"][0], node["translation"][1], node["translation"][2]};
  EXPECT_EQ(root["extras"]["offset"][0], mesh.offset.x);
  const std::size_t p0 = start(position, 12, 34962), n0 = start(normal, 12, 34962), t0 = start(texture, 8, 34962),
                    i0 = start(index, 12 / 3, 34963);
  std::array<float, 3> low{1e9F, 1e9F, 1e9F}, high{-1e9F, -1e9F, -1e9F};
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    std::array<float, 3> p{}, n{};
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = at<float>(bytes, p0 + 12 * i + 4 * k);
      n[k] = at<float>(bytes, n0 + 12 * i + 4 * k);
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
    expect_near(Vec3{p[0], p[1], p[2]} + centre, mesh.positions[i], 1e-7);
    expect_near(Vec3{n[0], n[1], n[2]}, mesh.normals[i], 1e-7);
    EXPECT_NEAR(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1, 1e-6);
    EXPECT_NEAR(at<float>(bytes, t0 + 8 * i + 4), 1 - mesh.texture[i].y, 1e-7);
  }
  EXPECT_EQ((position["min"].get<std::array<float, 3>>()), low);
  EXPECT_EQ((position["max"].get<std::array<float, 3>>()), high);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(at<std::uint32_t>(bytes, i0 + 12 * t + 4 * k), mesh.triangles[t][k]);
  // The root's rotation takes our up (0, 0, 1) to glTF's (0, 1, 0): v + 2 q x (q x v + w v).
  const Vec3 q{root["rotation"][0], root["rotation"][1], root["rotation"][2]}, up{0, 0, 1};
  const double w = root["rotation"][3];
  expect_near(up + 2.0 * cross(q, cross(q, up) + w * up), {0, 1, 0}, 1e-12);
}

TEST_F(MeshFormat, RefusesWhatCannotBeWritten) {
  TriangleMesh mesh = test::wavy_sheet();
  EXPECT_THROW(write_mesh(mesh, name("m.fbx")), UsageError);
  EXPECT_FALSE(is_mesh_name("m.tif"));
  EXPECT_TRUE(is_mesh_name("a/b.GLB"));
  write_mesh(mesh, name("m.obj"));
  EXPECT_THROW(write_mesh(mesh, name("m.obj")), CannotWrite);
  EXPECT_THROW(write_mesh(mesh, name("no/m.obj")), CannotWrite);
  mesh.triangles[3][1] = 35;
  EXPECT_THROW(write_mesh(mesh, name("n.ply")), BadInput);
  mesh = test::wavy_sheet();
  mesh.normals.pop_back();
  EXPECT_THROW(write_mesh(mesh, name("n.ply")), BadInput);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
}

TEST_F(MeshFormat, ReadsObjPolygonsFromOtherPrograms) {
  const TriangleMesh mesh = read_text(
      "cube.obj",
      "# a square and a pentagon\r\nmtllib x.mtl\r\no thing\r\nv 0 0 0 1.0\r\nv 1 0 0\r\nv 1 1 +0.5\r\nv 0 1 0\r\n"
      "v -1 .5 1e-1\r\nvt 0 0\r\nusemtl a\r\nf 1/1 2/1 3/1 4/1\r\nf -5 -4 -3 -2 -1\r\n");
  EXPECT_EQ(mesh.positions.size(), 5U);
  EXPECT_EQ(mesh.triangles,
            (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}, {0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
  EXPECT_TRUE(mesh.texture.empty()) << "not every corner has one";
}

TEST_F(MeshFormat, ReadsAsciiAndBigEndianPly) {
  const TriangleMesh ascii = read_text(
      "a.ply",
      "ply\nformat ascii 1.0\ncomment x\nelement vertex 4\nproperty float x\nproperty float y\nproperty uchar red\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_index\nproperty int id\nelement edge 1\n"
      "property int a\nend_header\n0 0 255 1\n1 0 9 2\n1 1 9 3\n0 1 9 4.5\n4 0 1 2 3 77\n5\n");
  EXPECT_EQ(ascii.positions[3], (Vec3{0, 1, 4.5}));
  EXPECT_EQ(ascii.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}}));
  std::string big =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty double z\n"
      "element face 1\nproperty list uchar ushort vertex_indices\nend_header\n";
  const auto put = [&](auto value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    for (std::size_t k = sizeof value; k-- > 0;) big.push_back(raw[k]);
  };
  for (int i = 0; i < 3; ++i) put(static_cast<float>(i)), put(static_cast<float>(i * i)), put(-0.1 * i);
  put(std::uint8_t{3}), put(std::uint16_t{2}), put(std::uint16_t{1}), put(std::uint16_t{0});
  const TriangleMesh mesh = read_text("b.ply", big);
  EXPECT_EQ(mesh.positions[2], (Vec3{2, 4, -0.2}));
  EXPECT_EQ(mesh.triangles[0], (std::array<std::uint32_t, 3>{2, 1, 0}));
}

TEST_F(MeshFormat, ErrorsNameTheLine) {
  EXPECT_NE(error_of("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 x\n").find("line 3"), std::string::npos);
  EXPECT_NE(error_of("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 4\n").find("line 5"), std::string::npos);
  EXPECT_NE(error_of("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n").find("line 3"), std::string::npos);
  EXPECT_NE(error_of("a.obj", "v 0 0 0\nf 0 1 1\n").find("line 2"), std::string::npos);
  EXPECT_NE(error_of("a.obj", "hello\n").find("no vertices"), std::string::npos);
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  EXPECT_NE(error_of("a.ply", head + "0 0 0\n1 q 0\n").find("line 9"), std::string::npos)
      << error_of("a.ply", head + "0 0 0\n1 q 0\n");
  EXPECT_NE(error_of("a.ply", head + "0 0 0\n1").find("ends"), std::string::npos);
  EXPECT_NE(
      error_of("a.ply", "ply\nformat ascii 1.0\nelement vertex 9999999999999\nproperty float x\n").find("end_header"),
      std::string::npos);
  EXPECT_NE(error_of("a.ply",
                     "ply\nformat ascii 1.0\nelement vertex 9999999999999\nproperty float x\nproperty float "
                     "y\nproperty float z\nend_header\n")
                .find("cut short"),
            std::string::npos);
  EXPECT_NE(error_of("a.ply", "plx\n").find("line 1"), std::string::npos);
}

TEST_F(MeshFormat, EveryPrefixOfABinaryPlyIsRefused) {
  write_mesh(test::tetrahedron(), name("m.ply"));
  const std::string bytes = read_file(name("m.ply"));
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_NE(error_of("p.ply", bytes.substr(0, size)), "no error") << size;
}

}  // namespace
}  // namespace retalho
