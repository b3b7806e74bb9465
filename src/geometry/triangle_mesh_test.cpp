#include "geometry/triangle_mesh.h"

#include <sstream>

#include "expect_error.h"
#include "paths.h"

namespace diminish {
namespace {

using ::testing::ElementsAre;
using Triangle = std::array<int, 3>;

TriangleMesh read(const std::string& text) {
  std::istringstream stream(text);
  return read_obj(stream, "a.obj");
}

const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.5\n";

TEST(TriangleMesh, ReadsTheBundledLamp) {
  const TriangleMesh mesh = load_obj(testing::recordings_dir() + "/workbench/lamp.obj");
  ASSERT_FALSE(mesh.vertices.empty());
  EXPECT_EQ(mesh.vertices[0], Eigen::Vector3d(-0.1, -0.085, -0.0608));
  EXPECT_EQ(mesh.vertices.size() + mesh.triangles.size(), 80U);
}

TEST(TriangleMesh, CutsFacesIntoFans) {
  const TriangleMesh mesh = read(square + "f 1 2 3 4\n");
  EXPECT_EQ(mesh.vertices[3], Eigen::Vector3d(0, 1, 0.5));
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
}

TEST(TriangleMesh, UnderstandsEveryFormOfCorner) {
  EXPECT_THAT(read(square + "f 1/9 2/8/7 3//6\n").triangles, ElementsAre(Triangle{0, 1, 2}));
  EXPECT_THAT(read(square + "f -4 -1 -2\n").triangles, ElementsAre(Triangle{0, 3, 2}));
}

TEST(TriangleMesh, IgnoresOtherLinesCommentsAndCarriageReturns) {
  const TriangleMesh mesh = read("# a mesh\r\nmtllib a.mtl\r\n\r\nvn 0 0 1\r\n" + square +
                                 "v 1 2 3 0.5 0.5 0.5 # coloured\r\ns off\r\n\tf 1 2 5\r");
  EXPECT_EQ(mesh.vertices.size(), 5U);
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 4}));
}

TEST(TriangleMesh, MalformedLinesAreNamed) {
  const std::pair<const char*, const char*> cases[] = {
      {"f 1 2\n", "a.obj:5: expected a face of at least three corners"},
      {"f 1 2 5\n", "a.obj:5: vertex 5 of 4"},
      {"f 1 2 -5\n", "a.obj:5: vertex -5 of 4"},
      {"f 1 2 0\n", "a.obj:5: expected a vertex's index, got '0'"},
      {"f 1 2 x\n", "a.obj:5: expected a vertex's index, got 'x'"},
      {"f 1 2 3.5\n", "a.obj:5: expected a vertex's index, got '3.5'"},
      {"f 1 2 99999999999\n", "a.obj:5: expected a vertex's index, got '99999999999'"},
      {"f 1 2 /1\n", "a.obj:5: expected a vertex's index, got '/1'"},
      {"v 1 2\n", "a.obj:5: expected three coordinates"},
      {"v 1 2 nan\n", "a.obj:5: expected a number, got 'nan'"},
      {"v 1 -1e308 0\n", "a.obj:5: expected metres, got more than a kilometre: '-1e308'"},
      {"", "a.obj: expected at least one face"},
  };
  for (const auto& [lines, message] : cases) {
    EXPECT_EQ(error_of([text = square + lines] { read(text); }), message);
  }
}

TEST(TriangleMesh, MissingFilesAreNamed) {
  EXPECT_THAT(error_of([] { load_obj("/nowhere/lamp.obj"); }),
              ::testing::HasSubstr("/nowhere/lamp.obj: cannot be opened"));
}

}  // namespace
}  // namespace diminish
