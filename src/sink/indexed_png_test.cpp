#include "sink/indexed_png.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "diminish/error.h"
#include "sink/palette.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

class IndexedPng : public ::testing::Test {
 protected:
  IndexedPng() {
    for (int y = 0; y < indices.height(); ++y) {
      for (int x = 0; x < indices.width(); ++x) {
        indices(x, y) = static_cast<std::uint8_t>(x * 37 + y * 11);
      }
    }
  }

  TemporaryFolder folder;
  std::filesystem::path file = folder.path() / "indexed.png";
  Image<std::uint8_t> indices{33, 17};
};

TEST_F(IndexedPng, ComesBackAsItWas) {
  write_indexed_png(file, indices, provenance_palette());
  EXPECT_EQ(read_indexed_png(file), indices);
}

TEST_F(IndexedPng, APaletteOfFewColorsIsPackedAndComesBackToo) {
  for (std::uint8_t& index : indices) index %= 3;
  write_indexed_png(file, indices, {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}});
  EXPECT_EQ(read_indexed_png(file), indices);
}

// Another program's view: the colours of the palette.
TEST_F(IndexedPng, OtherProgramsSeeThePalettesColors) {
  write_indexed_png(file, indices, provenance_palette());
  const cv::Mat picture = cv::imread(file.string(), cv::IMREAD_COLOR);
  ASSERT_EQ(picture.size(), cv::Size(33, 17));
  for (int y = 0; y < 17; ++y) {
    for (int x = 0; x < 33; ++x) {
      const Bgr& color = provenance_palette()[indices(x, y)];
      ASSERT_EQ(picture.at<cv::Vec3b>(y, x), cv::Vec3b(color.b, color.g, color.r));
    }
  }
}

TEST_F(IndexedPng, WhatIsNoIndexedPngIsAnErrorThatNamesTheFile) {
  const auto message = [&]() -> std::string {
    try {
      read_indexed_png(file);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(message(), file.string() + ": cannot be read, expected an indexed-colour PNG");
  cv::imwrite(file.string(), cv::Mat(5, 5, CV_8UC3, cv::Scalar(1, 2, 3)));
  EXPECT_EQ(message(), file.string() + ": expected indexed colours");
  std::filesystem::resize_file(file, 20);
  EXPECT_EQ(message().rfind(file.string(), 0), 0U);
  EXPECT_THROW(write_indexed_png("/nowhere/at/all.png", indices, provenance_palette()), Error);
}

}  // namespace
}  // namespace diminish
