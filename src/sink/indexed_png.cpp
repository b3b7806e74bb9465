#include "sink/indexed_png.h"

#include <png.h>

#include <array>
#include <cstdio>
#include <memory>
#include <string>

#include "diminish/error.h"

namespace diminish {
namespace {

// libpng's simplified interface: errors are values, no longjmp across C++ frames.
struct PngImage : png_image {
  PngImage() : png_image{} { version = PNG_IMAGE_VERSION; }
  ~PngImage() { png_image_free(this); }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;
};

using Palette = std::array<Bgr, 256>;

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what) {
  throw Error(file.string() + ": " + what);
}

}  // namespace

void write_indexed_png(const std::filesystem::path& file, const Image<std::uint8_t>& indices,
                       const std::vector<Bgr>& palette) {
  if (palette.empty() || palette.size() > 256) fail(file, "expected a palette of 1 to 256 colours");
  PngImage png;
  png.width = static_cast<png_uint_32>(indices.width());
  png.height = static_cast<png_uint_32>(indices.height());
  png.format = PNG_FORMAT_BGR | PNG_FORMAT_FLAG_COLORMAP;
  png.flags = PNG_IMAGE_FLAG_FAST;
  png.colormap_entries = static_cast<png_uint_32>(palette.size());
  if (png_image_write_to_file(&png, file.c_str(), 0, indices.data(), 0, palette.data()) == 0) {
    fail(file, std::string("cannot be written: ") + png.message);
  }
}

Image<std::uint8_t> read_indexed_png(const std::filesystem::path& file) {
  struct Close {
    void operator()(std::FILE* stream) const { std::fclose(stream); }
  };
  const std::unique_ptr<std::FILE, Close> stream(std::fopen(file.c_str(), "rb"));
  if (!stream) fail(file, "cannot be read, expected an indexed-colour PNG");
  png_structp reader = png_create_read_struct(
      PNG_LIBPNG_VER_STRING, nullptr,
      [](png_structp, png_const_charp message) { throw Error(message); },
      [](png_structp, png_const_charp) {});
  png_infop info = png_create_info_struct(reader);
  const auto destroy = [&] { png_destroy_read_struct(&reader, &info, nullptr); };
  try {
    png_init_io(reader, stream.get());
    png_read_info(reader, info);
    if (png_get_color_type(reader, info) != PNG_COLOR_TYPE_PALETTE ||
        png_get_interlace_type(reader, info) != PNG_INTERLACE_NONE) {
      throw Error("expected indexed colours");
    }
    png_set_packing(reader);
    png_read_update_info(reader, info);
    Image<std::uint8_t> indices(static_cast<int>(png_get_image_width(reader, info)),
                                static_cast<int>(png_get_image_height(reader, info)));
    for (int y = 0; y < indices.height(); ++y) png_read_row(reader, indices.row(y), nullptr);
    destroy();
    return indices;
  } catch (const Error& error) {
    destroy();
    fail(file, error.what());
  }
}

}  // namespace diminish
