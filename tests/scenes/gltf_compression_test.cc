// Compressed glTF: what the libraries' own encoders write, and damaged copies of it.

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "scenes/gltf/meshopt.h"
#include "scenes/scene_file.h"
#include "tests/scenes/glb_bytes.h"
#include "tests/testing/matchers.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

using testing::BytesOf;
using testing::GlbOf;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;

// A bumpy sheet of n x n quads, positions as three shorts and a spare one.
struct Sheet {
  explicit Sheet(int n) {
    for (int y = 0; y <= n; ++y) {
      for (int x = 0; x <= n; ++x) {
        for (const int value : {100 * x, 100 * y, (x * 7919 + y * 104729) % 97, 0}) {
          positions.push_back(static_cast<int16_t>(value));
        }
      }
    }
    for (int y = 0; y < n; ++y) {
      for (int x = 0; x < n; ++x) {
        const auto a = static_cast<unsigned int>(y * (n + 1) + x),
                   up = static_cast<unsigned int>(n + 1);
        for (const unsigned int corner : {a, a + 1, a + up + 1, a, a + up + 1, a + up}) {
          indices.push_back(corner);
        }
      }
    }
  }
  size_t num_vertices() const { return positions.size() / 4; }

  std::vector<int16_t> positions;
  std::vector<unsigned int> indices;
};

std::string PackedVertices(const void* vertices, size_t count, size_t stride) {
  std::string packed(meshopt_encodeVertexBufferBound(count, stride), '\0');
  packed.resize(meshopt_encodeVertexBuffer(
      reinterpret_cast<unsigned char*>(packed.data()), packed.size(), vertices, count, stride));
  return packed;
}

std::string PackedTriangles(const Sheet& sheet) {
  std::string packed(meshopt_encodeIndexBufferBound(sheet.indices.size(), sheet.num_vertices()),
                     '\0');
  packed.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(packed.data()),
                                          packed.size(),
                                          sheet.indices.data(),
                                          sheet.indices.size()));
  return packed;
}

// As gltfpack -c writes it: the second buffer is a fallback without bytes.
std::string MeshoptGlb(const Sheet& sheet) {
  std::string vertices = PackedVertices(sheet.positions.data(), sheet.num_vertices(), 8);
  const size_t packed_bytes = vertices.size();
  vertices.resize((vertices.size() + 3) / 4 * 4, '\0');
  const std::string triangles = PackedTriangles(sheet);
  const size_t num_indices = sheet.indices.size();
  const auto view_of = [](size_t offset,
                          size_t packed,
                          size_t packed_offset,
                          size_t stride,
                          const char* mode,
                          size_t count) {
    return absl::StrCat(R"({"buffer":1,"byteOffset":)",
                        offset,
                        R"(,"byteLength":)",
                        stride * count,
                        R"(,"extensions":{"EXT_meshopt_compression":{"buffer":0,"byteOffset":)",
                        packed_offset,
                        R"(,"byteLength":)",
                        packed,
                        R"(,"byteStride":)",
                        stride,
                        R"(,"mode":")",
                        mode,
                        R"(","count":)",
                        count,
                        "}}}");
  };
  return GlbOf(
      absl::StrCat(
          R"({"asset":{"version":"2.0"},"extensionsRequired":["KHR_mesh_quantization",)"
          R"("EXT_meshopt_compression"],"nodes":[{"mesh":0,"scale":[0.01,0.01,0.01]}],)"
          R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"accessors":[)"
          R"({"bufferView":0,"componentType":5122,"type":"VEC3","count":)",
          sheet.num_vertices(),
          R"(},{"bufferView":1,"componentType":5125,"type":"SCALAR","count":)",
          num_indices,
          R"(}],"bufferViews":[)",
          view_of(0, packed_bytes, 0, 8, "ATTRIBUTES", sheet.num_vertices()),
          ",",
          view_of(8 * sheet.num_vertices(),
                  triangles.size(),
                  vertices.size(),
                  4,
                  "TRIANGLES",
                  num_indices),
          R"(],"buffers":[{"byteLength":)",
          vertices.size() + triangles.size(),
          R"(},{"byteLength":)",
          8 * sheet.num_vertices() + 4 * num_indices,
          R"(,"extensions":{"EXT_meshopt_compression":{"fallback":true}}}]})"),
      vertices + triangles);
}

std::string DracoGlb(const Sheet& sheet) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(static_cast<int>(sheet.indices.size() / 3));
  const int attribute =
      builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const auto corner = [&sheet](size_t index) {
    const int16_t* p = sheet.positions.data() + 4 * sheet.indices[index];
    return Eigen::Vector3f(0.01F * p[0], 0.01F * p[1], 0.01F * p[2]);
  };
  for (size_t i = 0; i < sheet.indices.size(); i += 3) {
    const Eigen::Vector3f a = corner(i), b = corner(i + 1), c = corner(i + 2);
    builder.SetAttributeValuesForFace(
        attribute, draco::FaceIndex(static_cast<uint32_t>(i / 3)), a.data(), b.data(), c.data());
  }
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 16);
  draco::EncoderBuffer packed;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &packed).ok());
  return GlbOf(
      absl::StrCat(
          R"({"asset":{"version":"2.0"},"extensionsRequired":["KHR_draco_mesh_compression"],)"
          R"("nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,)"
          R"("extensions":{"KHR_draco_mesh_compression":{"bufferView":0,"attributes":{"POSITION":)",
          mesh->attribute(0)->unique_id(),
          R"(}}}}]}],"accessors":[{"componentType":5126,"type":"VEC3","count":)",
          mesh->num_points(),
          R"(},{"componentType":5125,"type":"SCALAR","count":)",
          sheet.indices.size(),
          R"(}],"bufferViews":[{"buffer":0,"byteLength":)",
          packed.size(),
          R"(}],"buffers":[{"byteLength":)",
          packed.size(),
          "}]}"),
      std::string(packed.data(), packed.size()));
}

class GltfCompressionTest : public ::testing::Test {
 protected:
  absl::StatusOr<SceneFile> Read(const std::string& glb) {
    WriteFile(folder_.Path("a.glb"), glb);
    return ReadScene(folder_.Path("a.glb"));
  }

  // Each triangle of the sheet within `tolerance`, in any order.
  void ExpectSheet(const absl::StatusOr<SceneFile>& file, const Sheet& sheet, double tolerance) {
    ASSERT_THAT(file, IsOk());
    ASSERT_EQ(file->scene.triangles.size(), sheet.indices.size() / 3);
    const auto sum_of = [](const std::vector<Eigen::Vector3d>& points) {
      // Moments that no other set of triangles has.
      double sum = 0.0;
      for (const Eigen::Vector3d& p : points) sum += p.x() * p.y() + p.z() * (1.0 + p.x());
      return sum / static_cast<double>(points.size());
    };
    std::vector<Eigen::Vector3d> found, wanted;
    for (const Eigen::Vector3i& triangle : file->scene.triangles) {
      for (const int vertex : triangle) found.push_back(file->scene.WorldOf(vertex));
    }
    for (const unsigned int index : sheet.indices) {
      const int16_t* p = sheet.positions.data() + 4 * index;
      wanted.emplace_back(0.01 * p[0], 0.01 * p[1], 0.01 * p[2]);
    }
    EXPECT_NEAR(sum_of(found), sum_of(wanted), tolerance * 100.0);
    for (size_t i = 0; i < found.size(); i += 97) {
      double nearest = 1e300;
      for (const Eigen::Vector3d& p : wanted) nearest = std::min(nearest, (p - found[i]).norm());
      EXPECT_LE(nearest, tolerance);
    }
  }

  // Whatever is damaged gives a scene or an error.
  void ExpectSurvives(const std::string& glb, int first_byte) {
    constexpr int kSeed = 1404;
    std::printf("[   seed   ] %d\n", kSeed);
    std::mt19937 random(kSeed);
    int num_errors = 0;
    for (int i = 0; i < 150; ++i) {
      std::string damaged = glb;
      for (int flips = 1 + static_cast<int>(random() % 3); flips > 0; --flips) {
        damaged[first_byte + random() % (damaged.size() - first_byte)] =
            static_cast<char>(random() & 0xFF);
      }
      num_errors += Read(damaged).ok() ? 0 : 1;
    }
    EXPECT_GT(num_errors, 0);
  }

  TemporaryFolder folder_;
};

TEST_F(GltfCompressionTest, ReadsMeshoptOfGltfpack) {
  const Sheet sheet(30);
  ExpectSheet(Read(MeshoptGlb(sheet)), sheet, 1e-5);
}

TEST_F(GltfCompressionTest, ReadsDraco) {
  const Sheet sheet(20);
  // 16 bits over 20 units.
  ExpectSheet(Read(DracoGlb(sheet)), sheet, 5e-4);
}

TEST_F(GltfCompressionTest, SurvivesDamagedMeshopt) { ExpectSurvives(MeshoptGlb(Sheet(8)), 20); }

TEST_F(GltfCompressionTest, SurvivesDamagedDraco) {
  const std::string glb = DracoGlb(Sheet(8));
  ExpectSurvives(glb, static_cast<int>(glb.find("DRACO")) + 12);
}

TEST(DecodeMeshopt, UndoesEveryFilterAndMode) {
  const Sheet sheet(4);
  const auto packed = PackedVertices(sheet.positions.data(), sheet.num_vertices(), 8);
  const auto count = static_cast<int64_t>(sheet.num_vertices());
  const auto plain = gltf::DecodeMeshopt({"ATTRIBUTES", "NONE", count, 8}, packed);
  ASSERT_THAT(plain, IsOk());
  EXPECT_EQ(*plain, BytesOf(sheet.positions));

  const std::vector<float> floats = {1.5F, -2.25F, 1000.0F, 0.0F, 0.125F, 7.0F};
  std::vector<float> exponents(floats.size());
  meshopt_encodeFilterExp(exponents.data(), floats.size() / 3, 12, 20, floats.data());
  const auto exponential = gltf::DecodeMeshopt({"ATTRIBUTES", "EXPONENTIAL", 2, 12},
                                               PackedVertices(exponents.data(), 2, 12));
  ASSERT_THAT(exponential, IsOk());
  EXPECT_EQ(*exponential, BytesOf(floats));

  const std::vector<float> turns = {0.5F, 0.5F, 0.5F, 0.5F, 0.0F, 0.6F, 0.0F, 0.8F};
  std::vector<int16_t> quaternions(turns.size());
  meshopt_encodeFilterQuat(quaternions.data(), 2, 8, 16, turns.data());
  const auto turned = gltf::DecodeMeshopt({"ATTRIBUTES", "QUATERNION", 2, 8},
                                          PackedVertices(quaternions.data(), 2, 8));
  ASSERT_THAT(turned, IsOk());
  for (size_t i = 0; i < turns.size(); ++i) {
    int16_t value;
    std::memcpy(&value, turned->data() + 2 * i, 2);
    EXPECT_NEAR(value / 32767.0, turns[i], 1e-4);
  }

  const std::vector<unsigned int> indices = {5, 2, 9, 9, 1};
  std::string sequence(meshopt_encodeIndexSequenceBound(indices.size(), 10), '\0');
  sequence.resize(meshopt_encodeIndexSequence(reinterpret_cast<unsigned char*>(sequence.data()),
                                              sequence.size(),
                                              indices.data(),
                                              indices.size()));
  const auto listed = gltf::DecodeMeshopt({"INDICES", "", 5, 4}, sequence);
  ASSERT_THAT(listed, IsOk());
  EXPECT_EQ(*listed, BytesOf(indices));
}

TEST(DecodeMeshopt, RefusesLayoutsThatAreNotAllowedAndCountsThatCannotBe) {
  const std::string bytes(64, '\0');
  const gltf::MeshoptLayout kLayouts[] = {{"ATTRIBUTES", "", 4, 0},
                                          {"ATTRIBUTES", "", 4, 6},
                                          {"ATTRIBUTES", "", 4, 260},
                                          {"ATTRIBUTES", "OCTAHEDRAL", 4, 12},
                                          {"ATTRIBUTES", "QUATERNION", 4, 4},
                                          {"ATTRIBUTES", "COLOR", 4, 4},
                                          {"TRIANGLES", "", 4, 4},
                                          {"TRIANGLES", "", 3, 8},
                                          {"INDICES", "EXPONENTIAL", 3, 4},
                                          {"", "", 3, 4}};
  for (const gltf::MeshoptLayout& layout : kLayouts) {
    EXPECT_THAT(gltf::DecodeMeshopt(layout, bytes), StatusIs(kInvalid, HasSubstr("not allowed")))
        << layout.mode << " " << layout.filter << " " << layout.stride;
  }
  EXPECT_THAT(gltf::DecodeMeshopt({"ATTRIBUTES", "", int64_t{1} << 50, 256}, bytes),
              StatusIs(kInvalid, HasSubstr("cannot hold")));
  EXPECT_THAT(gltf::DecodeMeshopt({"ATTRIBUTES", "", 100, 16}, bytes),
              StatusIs(kInvalid, HasSubstr("cannot be unpacked")));
}

}  // namespace
}  // namespace lightfit
