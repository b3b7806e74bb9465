#include <gtest/gtest.h>

#include "core/channels.h"
#include "diminish/inpainter.h"

namespace diminish {
namespace {

constexpr std::uint8_t wall = surface_label::first_plane;
constexpr std::uint8_t table = wall + 1;
const Bgr wall_color{120, 130, 140};
const Bgr table_color{40, 90, 160};
const Bgr box_color{200, 30, 30};

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
        picture(x, y) = box ? box_color : y < 90 ? wall_color : table_color;
        surfaces.label(x, y) = box ? surface_label::foreground : y < 90 ? wall : table;
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
        surfaces.label(x, y) = y < 90 ? wall : table;
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
      EXPECT_EQ(filled(x, y), y < 90 ? wall_color : table_color) << x << ' ' << y;
    }
  }
  EXPECT_NE(room.fill("harmonic")(75, 60), wall_color) << "the box would bleed";
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
  EXPECT_EQ(filled(110, 125), table_color);
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
      room.surfaces.label(x, y) = wall;
    }
  }
  EXPECT_EQ(room.fill()(30, 70), box_color);
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
  room.surfaces.label.fill(hole, wall);
  const Image<Bgr> filled = room.fill();
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 200; ++x) {
      ASSERT_EQ(filled(x, y), hole.contains(x, y) ? box_color : room.picture(x, y));
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

TEST(SurfaceInpainting, SaysThatNothingIsKnown) {
  Image<Bgr> picture(40, 30, {9, 9, 9});
  const Mask all(40, 30, 255);
  EXPECT_FALSE(Registry<Inpainter>::get("surfaces")()->inpaint({all, all, {}}, {}, picture));
  EXPECT_EQ(picture(20, 15), Bgr{});
}

}  // namespace
}  // namespace diminish
