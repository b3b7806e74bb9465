#include "diminish/membrane.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <stdexcept>
#include <vector>

#include "laplace_equation.h"

namespace diminish {
namespace {

/// An image as others have it: rows further apart than they are long, with bytes between and around
/// them that nobody may touch.
template <class Pixel>
class Padded {
 public:
  static constexpr int channels = sizeof(Pixel);
  static constexpr std::uint8_t untouched = 77;
  static constexpr std::size_t margin = 64;

  Padded(const Image<Pixel>& image, bool bottom_up)
      : width_(image.width()), height_(image.height()), bottom_up_(bottom_up) {
    bytes_.assign(2 * margin + static_cast<std::size_t>(stride() * height_), untouched);
    for (int y = 0; y < height_; ++y) {
      std::memcpy(row(y), image.row(y), std::size_t{channels} * static_cast<std::size_t>(width_));
    }
  }

  Membrane::View view() {
    return {row(0), width_, height_, bottom_up_ ? -stride() : stride(), channels};
  }
  Image<Pixel> image() {
    Image<Pixel> result(width_, height_);
    for (int y = 0; y < height_; ++y) {
      std::memcpy(result.row(y), row(y), std::size_t{channels} * static_cast<std::size_t>(width_));
    }
    return result;
  }
  bool is_padding_untouched() {
    for (int y = 0; y < height_; ++y) std::fill_n(row(y), channels * width_, untouched);
    return std::count(bytes_.begin(), bytes_.end(), untouched) ==
           static_cast<std::ptrdiff_t>(bytes_.size());
  }

 private:
  std::ptrdiff_t stride() const { return channels * width_ + 5; }
  std::uint8_t* row(int y) {
    return bytes_.data() + margin + (bottom_up_ ? height_ - 1 - y : y) * stride();
  }

  int width_, height_;
  bool bottom_up_;
  std::vector<std::uint8_t> bytes_;
};

/// Pictures and sets of pixels, made up anew for each size and seed.
struct Scene {
  Image<Bgr> target;
  Image<Bgra> source;
  Image<std::uint8_t> layers;
  Mask mask;

  Scene(int width, int height, unsigned seed)
      : target(width, height),
        source(width, height),
        layers(width, height, 1),
        mask(width, height, 0),
        random(seed) {
    for (Bgr& pixel : target) pixel = {level(), level(), level()};
    for (Bgra& pixel : source) pixel = {level(), level(), level(), level()};
  }
  std::uint8_t level() { return static_cast<std::uint8_t>(60 + random() % 120); }
  int below(int limit) { return static_cast<int>(random() % static_cast<unsigned>(limit)); }

  std::mt19937 random;
};

using Exact = Image<Eigen::Array3d>;

/// Half a level for rounding, and what the solver may leave of noise like this; elsewhere the
/// picture is as it was.
void expect_exact(const Image<Bgr>& picture, const Image<Bgr>& before, const Exact& exact,
                  const Mask& written) {
  double squares = 0;
  double count = 0;
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      if (written(x, y) == 0) {
        ASSERT_EQ(picture(x, y), before(x, y)) << x << ' ' << y;
        continue;
      }
      const Eigen::Array3d expected = exact(x, y).max(0).min(255);
      const Eigen::Array3d error = testing::levels(picture(x, y)) - expected;
      ASSERT_LE(error.abs().maxCoeff(), 3) << x << ' ' << y;
      squares += error.square().sum();
      count += 3;
    }
  }
  // Rounding alone leaves 0.29.
  EXPECT_LE(std::sqrt(squares / std::max(count, 1.0)), 0.5);
}

struct Case {
  const char* name;
  void (*draw)(Scene& scene);
};
void PrintTo(const Case& test, std::ostream* stream) {
  *stream << test.name;
}

const Case cases[] = {
    {"inside",
     [](Scene& s) {
       s.mask.fill({5, 4, s.mask.width() - 9, s.mask.height() - 8}, 255);
     }},
    // One side, a corner, and three sides of the picture.
    {"at_the_left",
     [](Scene& s) {
       s.mask.fill({0, 3, 20, s.mask.height() - 6}, 255);
     }},
    {"in_the_corner",
     [](Scene& s) {
       s.mask.fill({s.mask.width() - 17, s.mask.height() - 11, 17, 11}, 255);
     }},
    {"all_but_a_column",
     [](Scene& s) {
       s.mask.fill({1, 0, s.mask.width() - 1, s.mask.height()}, 255);
     }},
    {"all_but_a_pixel",
     [](Scene& s) {
       s.mask.fill(255);
       s.mask(s.mask.width() / 2, s.mask.height() / 3) = 0;
     }},
    {"frame",
     [](Scene& s) {
       s.mask.fill(255);
       s.mask.fill({2, 2, s.mask.width() - 4, s.mask.height() - 4}, 0);
     }},
    {"lines",
     [](Scene& s) {
       for (int x = 0; x < s.mask.width(); x += 3) s.mask.fill({x, 0, 1, s.mask.height()}, 255);
       s.mask.fill({0, s.mask.height() / 2, s.mask.width(), 1}, 255);
     }},
    {"speckle",
     [](Scene& s) {
       for (std::uint8_t& pixel : s.mask) pixel = s.below(5) < 2 ? 1 : 0;
     }},
    {"nothing", [](Scene&) {}},
};

class Membranes : public ::testing::TestWithParam<Case> {
 protected:
  /// Sizes that fill no block of vectors, and ones that fill several.
  template <class Test>
  void for_each_scene(const Test& test) {
    unsigned seed = 0;
    for (const auto& [width, height] :
         {std::pair(23, 17), std::pair(64, 33), std::pair(97, 140), std::pair(193, 61)}) {
      SCOPED_TRACE(std::to_string(width) + "x" + std::to_string(height));
      Scene scene(width, height, ++seed);
      GetParam().draw(scene);
      test(scene);
      if (HasFatalFailure()) return;
    }
  }

  Membrane membrane;
};
INSTANTIATE_TEST_SUITE_P(Masks, Membranes, ::testing::ValuesIn(cases),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(Membranes, FillAsADirectSolveDoes) {
  for_each_scene([&](Scene& scene) {
    Padded<std::uint8_t> mask(scene.mask, false);
    Padded<Bgr> picture(scene.target, scene.mask.width() > 64);
    ASSERT_TRUE(membrane.fill(mask.view(), picture.view()));
    expect_exact(picture.image(), scene.target, testing::exact_filling(scene.target, scene.mask),
                 scene.mask);
    EXPECT_TRUE(picture.is_padding_untouched());
    EXPECT_EQ(mask.image(), scene.mask);
  });
}

TEST_P(Membranes, CloneAsADirectSolveDoes) {
  for_each_scene([&](Scene& scene) {
    const Exact exact =
        testing::exact_cloning(scene.target, scene.source, scene.mask, scene.layers);
    Image<Bgr> three(scene.source.width(), scene.source.height());
    for (std::size_t i = 0; i < three.size(); ++i) {
      const Bgra& color = scene.source.data()[i];
      three.data()[i] = {color.b, color.g, color.r};
    }
    Padded<std::uint8_t> mask(scene.mask, true);
    Padded<Bgr> target(scene.target, false);
    Padded<Bgra> source(scene.source, true);
    Padded<Bgr> source_of_three(three, false);
    // Into another picture, and in place.
    Image<Bgr> other = scene.target;
    std::fill(other.begin(), other.end(), Bgr{3, 2, 1});
    Padded<Bgr> picture(other, true);
    membrane.clone({target.view(), source.view(), mask.view()}, picture.view());
    expect_exact(picture.image(), other, exact, scene.mask);
    EXPECT_TRUE(picture.is_padding_untouched());
    membrane.clone({target.view(), source_of_three.view(), mask.view()}, target.view());
    expect_exact(target.image(), scene.target, exact, scene.mask);
    EXPECT_TRUE(target.is_padding_untouched());
  });
}

// Free borders inside the mask and on its rim, parts that no boundary holds, seams; labels of 255.
TEST_P(Membranes, CloneSeveralLayersAsADirectSolveDoes) {
  for_each_scene([&](Scene& scene) {
    const int width = scene.mask.width();
    const int height = scene.mask.height();
    scene.layers.fill({width / 2, 0, width - width / 2, height}, 255);
    for (int k = 0; k < 6; ++k) {
      const int x = scene.below(width - 4);
      const int y = scene.below(height - 4);
      scene.layers.fill({x, y, 1 + scene.below(width - x), 1}, 0);
      scene.layers.fill({x, y, 1, 1 + scene.below(height - y)}, 0);
    }
    Mask written = scene.mask;
    for (std::size_t i = 0; i < written.size(); ++i) {
      if (scene.layers.data()[i] == 0) written.data()[i] = 0;
    }
    Padded<std::uint8_t> mask(scene.mask, false);
    Padded<std::uint8_t> layers(scene.layers, true);
    Padded<Bgra> source(scene.source, false);
    Padded<Bgr> picture(scene.target, false);
    membrane.clone({picture.view(), source.view(), mask.view(), layers.view()}, picture.view());
    expect_exact(picture.image(), scene.target,
                 testing::exact_cloning(scene.target, scene.source, scene.mask, scene.layers),
                 written);
    EXPECT_TRUE(picture.is_padding_untouched());
  });
}

TEST(Membrane, LeavesThePictureAloneWhereNothingIsKnown) {
  Padded<Bgr> picture(Image<Bgr>(12, 9, {5, 6, 7}), false);
  Padded<std::uint8_t> mask(Mask(12, 9, 255), false);
  Membrane membrane;
  EXPECT_FALSE(membrane.fill(mask.view(), picture.view()));
  EXPECT_EQ(picture.image(), Image<Bgr>(12, 9, {5, 6, 7}));
}

// No pixel of the target is beside the mask: the source as it is.
TEST(Membrane, CopiesWhereThereIsNoTarget) {
  const Scene scene(12, 9, 1);
  Padded<Bgr> picture(scene.target, false);
  Padded<Bgra> source(scene.source, false);
  Padded<std::uint8_t> mask(Mask(12, 9, 255), false);
  Membrane().clone({picture.view(), source.view(), mask.view()}, picture.view());
  const Image<Bgr> cloned = picture.image();
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 12; ++x) {
      const Bgra& color = scene.source(x, y);
      EXPECT_EQ(cloned(x, y), (Bgr{color.b, color.g, color.r}));
    }
  }
}

TEST(Membrane, SaysWhichViewDoesNotFit) {
  std::vector<std::uint8_t> bytes(std::size_t{4} * 8 * 6);
  const auto view = [&](int width, int height, int channels) {
    return Membrane::View{bytes.data(), width, height, std::ptrdiff_t{width} * channels, channels};
  };
  Membrane membrane;
  const auto message = [&](const auto& call) -> std::string {
    try {
      call();
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message([&] { membrane.fill(view(8, 6, 1), view(8, 5, 3)); }),
            "picture: expected 8x6, channels: 3; got 8x5, channels: 3");
  EXPECT_EQ(message([&] { membrane.fill(view(8, 6, 3), view(8, 6, 3)); }),
            "mask: expected 8x6, channels: 1; got 8x6, channels: 3");
  EXPECT_EQ(message([&] {
              membrane.clone({view(8, 6, 3), view(8, 6, 1), view(8, 6, 1)}, view(8, 6, 3));
            }),
            "source: expected 8x6, channels: 3 or 4; got 8x6, channels: 1");
  EXPECT_EQ(message([&] {
              membrane.clone({view(7, 6, 3), view(8, 6, 4), view(8, 6, 1)}, view(8, 6, 3));
            }),
            "target: expected 8x6, channels: 3 or 4; got 7x6, channels: 3");
  EXPECT_EQ(
      message([&] {
        membrane.clone({view(8, 6, 3), view(8, 6, 4), view(8, 6, 1), view(8, 5, 1)}, view(8, 6, 3));
      }),
      "layers: expected 8x6, channels: 1; got 8x5, channels: 1");
}

// Threads share a grid by bands of 64 rows; the last one may have a single row.
TEST(Membrane, FillsTheSameWhateverTheThreads) {
  namespace tbb = oneapi::tbb;
  const tbb::global_control enough(tbb::global_control::max_allowed_parallelism, 4);
  std::mt19937 random(11);
  std::uniform_int_distribution<int> level(0, 255);
  for (const int height : {129, 130, 193, 257}) {
    Image<Bgr> picture(90, height);
    for (Bgr& pixel : picture) {
      for (std::uint8_t* c : {&pixel.b, &pixel.g, &pixel.r}) {
        *c = static_cast<std::uint8_t>(level(random));
      }
    }
    Mask missing(90, height, 0);
    for (std::uint8_t& pixel : missing) pixel = level(random) < 235 ? 255 : 0;
    const auto fill = [&](int threads) {
      Image<Bgr> filled = picture;
      tbb::task_arena(threads).execute([&] {
        Membrane().fill({missing.data(), 90, height, 90, 1},
                        {reinterpret_cast<std::uint8_t*>(filled.data()), 90, height, 270, 3});
      });
      return filled;
    };
    const Image<Bgr> alone = fill(1);
    for (int i = 0; i < 20; ++i) ASSERT_EQ(fill(4), alone) << height << " rows";
  }
}

}  // namespace
}  // namespace diminish
