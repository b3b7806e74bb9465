#include "inpaint/surface_inpainting.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/channels.h"

namespace diminish {
namespace {

constexpr std::uint8_t wall_label = surface_label::first_plane;
constexpr std::uint8_t table_label = wall_label + 1;
const Bgr wall_paint{120, 130, 140};
const Bgr table_paint{40, 90, 160};
const Bgr box_paint{200, 30, 30};

/// A wall above a table, a box in front, and an object to remove that hides all three.
struct Room {
  Image<Bgr> picture{200, 160};
  Mask occlusion{200, 160, 0};
  Mask missing{200, 160, 0};
  Surfaces surfaces;

  Room() {
    surfaces.region = picture.bounds();
    surfaces.label.resize(200, 160);
    for (int y = 0; y < 160; ++y) {
      for (int x = 0; x < 200; ++x) {
        const bool box = x < 70 && y > 30;
        picture(x, y) = box ? box_paint : y < 90 ? wall_paint : table_paint;
        surfaces.label(x, y) = box ? surface_label::foreground : y < 90 ? wall_label : table_label;
      }
    }
    remove({60, 20, 100, 110});
  }
  void remove(const Rect& object) {
    occlusion.fill(object, 255);
    for (int y = object.y; y < object.bottom(); ++y) {
      for (int x = object.x; x < object.right(); ++x) {
        if (x < 70 && y > 30) continue;  // the box's part is seen by an RGB-D camera
        missing(x, y) = 255;
        picture(x, y) = {0, 255, 0};
        surfaces.label(x, y) = y < 90 ? wall_label : table_label;
      }
    }
  }
  Image<Bgr> fill(const char* method = "surfaces") const {
    Image<Bgr> filled = picture;
    EXPECT_TRUE(
        Registry<Inpainter>::get(method)()->inpaint({missing, occlusion, surfaces}, {}, filled));
    return filled;
  }
};

TEST(SurfaceInpainting, FillsEachPlaneFromItself) {
  const Room room;
  const Image<Bgr> filled = room.fill();
  for (int y = 20; y < 130; ++y) {
    for (int x = 60; x < 160; ++x) {
      if (room.missing(x, y) == 0) continue;
      EXPECT_EQ(filled(x, y), y < 90 ? wall_paint : table_paint) << x << ' ' << y;
    }
  }
  EXPECT_NE(room.fill("harmonic")(75, 60), wall_paint) << "the box would bleed";
}

TEST(SurfaceInpainting, LeavesEverythingElseAlone) {
  const Room room;
  const Image<Bgr> filled = room.fill();
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 200; ++x) {
      if (room.missing(x, y) != 0) continue;
      ASSERT_EQ(filled(x, y), room.picture(x, y));
    }
  }
}

// The object darkened the table beside it.
TEST(SurfaceInpainting, DoesNotSpreadAContactShadow) {
  Room room;
  for (int y = 130; y < 134; ++y) {
    for (int x = 55; x < 165; ++x) room.picture(x, y) = {10, 20, 35};
  }
  const Image<Bgr> filled = room.fill();
  EXPECT_EQ(filled(110, 125), table_paint);
  EXPECT_EQ(filled(110, 131), room.picture(110, 131)) << "it stays where the camera sees it";
}

// A hole that borders on what is in front of its plane is rather a hole in that.
TEST(SurfaceInpainting, AHoleInTheForegroundIsFilledFromAround) {
  Room room;
  room.occlusion.fill({20, 60, 20, 20}, 255);
  for (int y = 60; y < 80; ++y) {
    for (int x = 20; x < 40; ++x) {
      room.missing(x, y) = 255;
      room.picture(x, y) = {0, 255, 0};
      room.surfaces.label(x, y) = wall_label;
    }
  }
  EXPECT_EQ(room.fill()(30, 70), box_paint);
}

// Its plane has no other hole.
TEST(SurfaceInpainting, AHoleInTheForegroundAloneChangesNothingElse) {
  Room room;
  const Rect hole{20, 60, 20, 20};
  room.occlusion.fill(0);
  room.missing.fill(0);
  room.occlusion.fill(hole, 255);
  room.missing.fill(hole, 255);
  room.picture.fill(hole, {0, 255, 0});
  room.surfaces.label.fill(hole, wall_label);
  const Image<Bgr> filled = room.fill();
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 200; ++x) {
      ASSERT_EQ(filled(x, y), hole.contains(x, y) ? box_paint : room.picture(x, y));
    }
  }
}

// Without planes it is nearly the harmonic filling.
TEST(SurfaceInpainting, ResemblesHarmonicWithoutPlanes) {
  Room room;
  room.surfaces.label = {};
  const Image<Bgr> ours = room.fill();
  const Image<Bgr> harmonic = room.fill("harmonic");
  double squares = 0;
  int count = 0;
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 200; ++x) {
      const Eigen::Array3f difference = to_channels(ours(x, y)) - to_channels(harmonic(x, y));
      squares += static_cast<double>(difference.square().mean());
      count += room.missing(x, y) != 0 ? 1 : 0;
    }
  }
  // Its known colours are up to 120 levels apart.
  EXPECT_LT(std::sqrt(squares / count), 1.5);
}

// --- Holes beside what stands in front

const Bgr cone_color{40, 180, 40};

/// Something 2 m away, the colour of which depends on the place alone, and a thing 1 m away in
/// front of it. What the thing hides from an RGB-D camera to its left is to be invented. There are
/// no planes.
struct Disocclusion {
  static constexpr int width = 200, height = 120;
  Image<Bgr> truth{width, height};
  Image<float> depth_m{width, height, 2};
  Mask missing{width, height, 0};
  Mask occlusion{width, height, 255};
  Surfaces surfaces;

  /// behind(x, y): a colour. front(y): the thing's columns in a row. hidden: columns beside it.
  Disocclusion(auto&& behind, auto&& front, int hidden) {
    surfaces.region = truth.bounds();
    surfaces.label.resize(width, height, surface_label::foreground);
    for (int y = 0; y < height; ++y) {
      const auto [first, last] = front(y);
      for (int x = 0; x < width; ++x) {
        const bool is_front = x >= first && x < last;
        truth(x, y) = is_front ? cone_color : behind(x, y);
        if (is_front) depth_m(x, y) = 1;
        if (first == last || x < last || x >= last + hidden) continue;
        missing(x, y) = 255;
        surfaces.label(x, y) = surface_label::unknown;
        depth_m(x, y) = 0;
      }
    }
  }
  /// The root mean square error of what is filled.
  double error(FillFrom from) const {
    Image<Bgr> filled = truth;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        if (missing(x, y) != 0) filled(x, y) = {};
      }
    }
    EXPECT_TRUE(make_surface_inpainting(from)->inpaint({missing, occlusion, surfaces, depth_m}, {},
                                                       filled));
    double squares = 0;
    int count = 0;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        if (missing(x, y) == 0) {
          EXPECT_EQ(filled(x, y), truth(x, y));
          continue;
        }
        squares += static_cast<double>(
            (to_channels(filled(x, y)) - to_channels(truth(x, y))).square().mean());
        ++count;
      }
    }
    return std::sqrt(squares / count);
  }
};

std::pair<int, int> cone(int y) {
  if (y < 30 || y >= 100) return {0, 0};
  return {80 - y / 3, 80 + y / 3};
}

// A green cone in front of a face: its colour does not run into the face.
TEST(FarSide, AConeDoesNotSmearIntoTheTextureBehindIt) {
  const Disocclusion scene(
      [](int x, int y) {
        const double wave = std::sin(0.15 * x) * std::cos(0.1 * y);
        return Bgr{static_cast<std::uint8_t>(120 + 12 * wave),
                   static_cast<std::uint8_t>(150 + 12 * wave),
                   static_cast<std::uint8_t>(200 + 12 * wave)};
      },
      cone, 24);
  EXPECT_LT(scene.error(FillFrom::far_side), 12);
  EXPECT_GT(scene.error(FillFrom::all_sides), 25) << "the cone lends its colour";
}

// A bright table top in front of a dark floor.
TEST(FarSide, ATableTopDoesNotFillTheDarkBelowIt) {
  const Disocclusion scene(
      [](int, int) {
        return Bgr{20, 18, 16};
      },
      [](int y) { return y < 20 || y > 99 ? std::pair(0, 0) : std::pair(0, 90); }, 40);
  EXPECT_LT(scene.error(FillFrom::far_side), 1);
  EXPECT_GT(scene.error(FillFrom::all_sides), 25);
}

// A slanted surface has a near and a far end, but neither stands in front of the other.
TEST(FarSide, BothEndsOfASlantedSurfaceLend) {
  Disocclusion scene(
      [](int x, int) {
        return Bgr{60, 60, static_cast<std::uint8_t>(x)};
      },
      cone, 24);
  for (int y = 0; y < scene.height; ++y) {
    for (int x = 0; x < scene.width; ++x) {
      scene.truth(x, y) = {60, 60, static_cast<std::uint8_t>(x)};
      // Along a row, as far as at 45 degrees.
      if (scene.missing(x, y) == 0)
        scene.depth_m(x, y) = 200.F / (200.F - 0.5F * static_cast<float>(x));
    }
  }
  EXPECT_LT(scene.error(FillFrom::far_side), 2);
  EXPECT_EQ(scene.error(FillFrom::far_side), scene.error(FillFrom::all_sides));
}

// Camera pixels on which no depth was measured may show anything: a pipe before the wall.
TEST(FarSide, WhatWasNotMeasuredIsNotTakenForThePlane) {
  Room room;
  Image<float> depth_m(200, 160, 2);
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 200; ++x) {
      if (room.missing(x, y) != 0) depth_m(x, y) = 0;
      // On the wall above the hole.
      if (y < 20 && x > 80 && x < 100) {
        room.picture(x, y) = box_paint;
        depth_m(x, y) = 0;
      }
    }
  }
  Image<Bgr> filled = room.picture;
  EXPECT_TRUE(make_surface_inpainting(FillFrom::far_side)
                  ->inpaint({room.missing, room.occlusion, room.surfaces, depth_m}, {}, filled));
  EXPECT_EQ(filled(90, 22), wall_paint);
  EXPECT_NE(room.fill()(90, 22), wall_paint);

  // Where nothing at all was measured, all of it lends.
  depth_m.fill(0);
  filled = room.picture;
  EXPECT_TRUE(make_surface_inpainting(FillFrom::far_side)
                  ->inpaint({room.missing, room.occlusion, room.surfaces, depth_m}, {}, filled));
  EXPECT_EQ(filled, room.fill());
}

TEST(SurfaceInpainting, SaysThatNothingIsKnown) {
  Image<Bgr> picture(40, 30, {9, 9, 9});
  const Mask all(40, 30, 255);
  EXPECT_FALSE(Registry<Inpainter>::get("surfaces")()->inpaint({all, all, {}}, {}, picture));
  EXPECT_EQ(picture(20, 15), Bgr{});
}

}  // namespace
}  // namespace diminish
