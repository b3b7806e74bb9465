#include "sink/indexed_png.h"

#include <fmt/format.h>
#include <png.h>

#include <array>
#include <cstdint>
#include <string>

#include "core/mat.h"
#include "diminish/error.h"
#include "sink/partial_file.h"
#include "sink/png_encoder.h"

namespace diminish {
namespace {

// The simplified interface of libpng: errors are values, and indices stay as they are in the file.
struct PngImage : png_image {
  PngImage() : png_image{} { version = PNG_IMAGE_VERSION; }
  ~PngImage() { png_image_free(this); }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;
};

constexpr std::uint64_t most_pixels = 1 << 28;  ///< more than any camera has

using Palette = std::array<Bgr, 256>;

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what) {
  throw Error(Error::io, file.string() + ": " + what);
}

}  // namespace

void write_indexed_png(const std::filesystem::path& file, const Image<std::uint8_t>& indices,
                       const std::vector<Bgr>& palette) {
  if (palette.empty() || palette.size() > 256) fail(file, "expected a palette of 1 to 256 colours");
  const std::vector<std::uint8_t> bytes = encode_png(as_mat(indices), palette);
  write_file(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

Image<std::uint8_t> read_indexed_png(const std::filesystem::path& file) {
  PngImage png;
  if (png_image_begin_read_from_file(&png, file.c_str()) == 0) {
    fail(file, "cannot be read, expected an indexed-colour PNG");
  }
  if ((png.format & PNG_FORMAT_FLAG_COLORMAP) == 0) fail(file, "expected indexed colours");
  if (std::uint64_t{png.width} * png.height > most_pixels) {
    fail(file, fmt::format("expected at most {} million pixels, got {}x{}", most_pixels / 1'000'000,
                           png.width, png.height));
  }
  png.format = PNG_FORMAT_BGR | PNG_FORMAT_FLAG_COLORMAP;
  Palette palette;
  Image<std::uint8_t> indices(static_cast<int>(png.width), static_cast<int>(png.height));
  if (png_image_finish_read(&png, nullptr, indices.data(), 0, palette.data()) == 0) {
    fail(file, std::string("cannot be read: ") + png.message);
  }
  return indices;
}

}  // namespace diminish
