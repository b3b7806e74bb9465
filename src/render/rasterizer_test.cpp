#include "render/rasterizer.h"

#include <gtest/gtest.h>

#include <random>

#include "render/sdct.h"

namespace diminish {
namespace {

MeshVertex vertex(double x, double y, float z = 1, float u = 0, float v = 0) {
  return {static_cast<std::int32_t>(std::lround(x * sdct::subpixels)),
          static_cast<std::int32_t>(std::lround(y * sdct::subpixels)),
          1 / z,
          u,
          v,
          z};
}

/// A texture that says where it was looked up: blue = column, green = row.
Image<Bgr> coordinates_texture() {
  Image<Bgr> texture(200, 200);
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 200; ++x) {
      texture(x, y) = {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), 0};
    }
  }
  return texture;
}

struct Canvas {
  Canvas(int width, int height) : region{0, 0, width, height} {
    layer.clear(width, height, region);
  }
  Rect region;
  Layer layer;
};

// A fan of random triangles around a point covers every pixel inside its hull exactly once,
// whatever the subpixel positions.
TEST(DrawTriangle, NeighboursShareNoPixelAndLeaveNoneOut) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> offset(-3, 3);
  const Image<Bgr> texture(4, 4);
  for (int trial = 0; trial < 50; ++trial) {
    constexpr int size = 12;
    std::vector<MeshVertex> grid;
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const bool rim = x == 0 || y == 0 || x == size - 1 || y == size - 1;
        grid.push_back(
            vertex(5 + 8 * x + (rim ? 0 : offset(random)), 5 + 8 * y + (rim ? 0 : offset(random))));
      }
    }
    Image<int> hits(120, 120, 0);
    const auto draw = [&](int a, int b, int c) {
      const MeshVertex& va = grid[static_cast<std::size_t>(a)];
      const MeshVertex& vb = grid[static_cast<std::size_t>(b)];
      const MeshVertex& vc = grid[static_cast<std::size_t>(c)];
      if (!sdct::faces_forward(sdct::doubled_area(va.x, va.y, vb.x, vb.y, vc.x, vc.y))) {
        return false;
      }
      Canvas canvas(120, 120);
      draw_triangle(va, vb, vc, texture, canvas.region, canvas.layer);
      for (int y = 0; y < 120; ++y) {
        for (int x = 0; x < 120; ++x) hits(x, y) += canvas.layer.color(x, y).a != 0;
      }
      return true;
    };
    bool all_forward = true;
    for (int y = 0; y + 1 < size; ++y) {
      for (int x = 0; x + 1 < size; ++x) {
        const int i = y * size + x;
        all_forward = draw(i, i + 1, i + size) && all_forward;
        all_forward = draw(i + 1, i + size + 1, i + size) && all_forward;
      }
    }
    if (!all_forward) continue;  // The offsets folded the grid over.
    for (int y = 0; y < 120; ++y) {
      for (int x = 0; x < 120; ++x) {
        // The square from 5 to 93: its top and left edges belong to it, the others do not.
        const bool inside = x >= 5 && x < 93 && y >= 5 && y < 93;
        ASSERT_EQ(hits(x, y), inside ? 1 : 0) << x << ' ' << y << " in trial " << trial;
      }
    }
  }
}

// A plane tilted in depth: u = 100 on the ray through the middle, not at the edge's middle.
TEST(DrawTriangle, LooksUpTextureWithPerspective) {
  Canvas canvas(101, 101);
  const float near = 1;
  const float far = 3;
  const MeshVertex a = vertex(0, 0, near, 0, 0);
  const MeshVertex b = vertex(100, 0, far, 150, 0);
  const MeshVertex c = vertex(0, 100, near, 0, 150);
  draw_triangle(a, b, c, coordinates_texture(), canvas.region, canvas.layer);
  for (int x = 0; x < 100; x += 7) {
    const double t = x / 100.0;
    const double inverse_z = (1 - t) / near + t / far;
    const double expected_u = t / far * 150 / inverse_z;
    EXPECT_NEAR(canvas.layer.color(x, 0).b, expected_u, 0.51);
    EXPECT_NEAR(canvas.layer.depth_m(x, 0), 1 / inverse_z, 1e-4);
  }
}

TEST(DrawTriangle, ShowsTheNearerSurfaceWhateverTheOrder) {
  for (const bool near_first : {true, false}) {
    Canvas canvas(20, 20);
    const auto draw = [&](float z, float u) {
      draw_triangle(vertex(0, 0, z, u, 0), vertex(18, 0, z, u, 0), vertex(0, 18, z, u, 0),
                    coordinates_texture(), canvas.region, canvas.layer);
    };
    draw(near_first ? 1.F : 2.F, near_first ? 10.F : 20.F);
    draw(near_first ? 2.F : 1.F, near_first ? 20.F : 10.F);
    EXPECT_EQ(canvas.layer.color(3, 3), (Bgra{10, 0, 0, 255}));
    EXPECT_FLOAT_EQ(canvas.layer.depth_m(3, 3), 1);
  }
}

TEST(DrawTriangle, DrawsNothingOutsideTheRegion) {
  Canvas canvas(40, 40);
  draw_triangle(vertex(-1000, -1000), vertex(3000, -1000), vertex(-1000, 3000),
                coordinates_texture(), {10, 12, 5, 6}, canvas.layer);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) {
      EXPECT_EQ(canvas.layer.color(x, y).a != 0, (Rect{10, 12, 5, 6}.contains(x, y)));
    }
  }
}

TEST(DrawMesh, TearsWhereDepthsStepAndWhereVerticesAreMissing) {
  Image<MeshVertex> vertices(5, 3);
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 5; ++x) vertices(x, y) = vertex(10 * x, 10 * y, x < 3 ? 1.F : 1.06F);
  }
  Canvas canvas(60, 40);
  const Image<Bgr> texture(4, 4);
  draw_mesh(vertices, texture, sdct::Threshold(0.05F, 0), canvas.region, canvas.layer);
  EXPECT_NE(canvas.layer.color(15, 5).a, 0);
  EXPECT_EQ(canvas.layer.color(25, 5).a, 0) << "a step of 6 cm must be torn at a threshold of 5";
  EXPECT_NE(canvas.layer.color(35, 5).a, 0);

  canvas.layer.clear(60, 40, canvas.region);
  vertices(1, 1) = {};
  draw_mesh(vertices, texture, sdct::Threshold(0.1F, 0), canvas.region, canvas.layer);
  EXPECT_NE(canvas.layer.color(25, 5).a, 0) << "joined at a threshold of 10 cm";
  EXPECT_EQ(canvas.layer.color(8, 8).a, 0) << "no triangle without its vertex";
}

TEST(DrawMesh, LeavesOutSurfacesSeenFromBehind) {
  Image<MeshVertex> vertices(2, 2);
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 2; ++x) vertices(x, y) = vertex(30 - 20 * x, 20 * y);  // mirrored
  }
  Canvas canvas(60, 40);
  draw_mesh(vertices, Image<Bgr>(4, 4), sdct::Threshold(0.05F, 0), canvas.region, canvas.layer);
  for (const Bgra& pixel : canvas.layer.color) EXPECT_EQ(pixel.a, 0);
}

TEST(SampleBilinear, InterpolatesARampExactly) {
  const Image<Bgr> texture = coordinates_texture();
  EXPECT_EQ(sample_bilinear(texture, 10, 20), (Bgr{10, 20, 0}));
  EXPECT_EQ(sample_bilinear(texture, 10.4F, 20.6F), (Bgr{10, 21, 0}));
  EXPECT_EQ(sample_bilinear(texture, 199, 199), (Bgr{199, 199, 0}));
}

}  // namespace
}  // namespace diminish
