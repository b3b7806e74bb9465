#include "source/jpeg_decoder.h"

#include <turbojpeg.h>

#include <charconv>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>

#include "diminish/error.h"

namespace diminish {
namespace {

struct Destroy {
  void operator()(tjhandle handle) const { tjDestroy(handle); }
};

/// A few bytes between the markers, as many webcams write them, change no pixel. More of them are
/// coded pixels that damaged ones made superfluous.
bool is_harmless(tjhandle handle) {
  constexpr int most_bytes = 16;
  const std::string_view warning = tjGetErrorStr2(handle);
  const std::size_t number = warning.find_first_of("0123456789");
  if (tjGetErrorCode(handle) != TJERR_WARNING || number == std::string_view::npos ||
      warning.find("extraneous bytes") == std::string_view::npos) {
    return false;
  }
  int bytes = 0;
  std::from_chars(warning.data() + number, warning.data() + warning.size(), bytes);
  return bytes <= most_bytes;
}

[[noreturn]] void fail(tjhandle handle) {
  throw Error(Error::input, std::string("the file is damaged: ") + tjGetErrorStr2(handle));
}

}  // namespace

cv::Mat decode_jpeg(std::span<const std::uint8_t> bytes) {
  // A new one for each image: it keeps an image's tables, and a damaged image's spoil the next
  // ones.
  const std::unique_ptr<std::remove_pointer_t<tjhandle>, Destroy> owner(tjInitDecompress());
  const tjhandle handle = owner.get();
  if (handle == nullptr) return {};
  int width = 0;
  int height = 0;
  int subsampling = 0;
  int colors = 0;
  if (tjDecompressHeader3(handle, bytes.data(), bytes.size(), &width, &height, &subsampling,
                          &colors) != 0 &&
      !is_harmless(handle)) {
    fail(handle);
  }
  if (colors == TJCS_CMYK || colors == TJCS_YCCK) return {};
  cv::Mat image(height, width, CV_8UC3);
  if (tjDecompress2(handle, bytes.data(), bytes.size(), image.data, width,
                    static_cast<int>(image.step), height, TJPF_BGR, 0) != 0 &&
      !is_harmless(handle)) {
    fail(handle);
  }
  return image;
}

}  // namespace diminish
