#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

#include "diminish/export.h"

namespace diminish {

/// 8-bit colour in OpenCV's order.
struct Bgr {
  std::uint8_t b = 0, g = 0, r = 0;
  friend bool operator==(const Bgr&, const Bgr&) = default;
};

/// 8-bit colour with alpha: 255 where the pixel was seen, 0 where nothing is known.
struct Bgra {
  std::uint8_t b = 0, g = 0, r = 0, a = 0;
  friend bool operator==(const Bgra&, const Bgra&) = default;
};

/// A rectangle of pixels: columns [x, x + width), rows [y, y + height).
struct Rect {
  int x = 0, y = 0, width = 0, height = 0;

  int right() const { return x + width; }
  int bottom() const { return y + height; }
  bool empty() const { return width <= 0 || height <= 0; }
  bool contains(int column, int row) const {
    return column >= x && column < right() && row >= y && row < bottom();
  }
  friend bool operator==(const Rect&, const Rect&) = default;
};

/// The part that both rectangles cover; empty if they do not overlap.
inline Rect intersect(const Rect& a, const Rect& b) {
  const int x = std::max(a.x, b.x);
  const int y = std::max(a.y, b.y);
  return {x, y, std::max(0, std::min(a.right(), b.right()) - x),
          std::max(0, std::min(a.bottom(), b.bottom()) - y)};
}

/// `rect` with `margin` pixels more on each side. An empty rectangle stays empty.
inline Rect grow(const Rect& rect, int margin) {
  if (rect.empty()) return {};
  return {rect.x - margin, rect.y - margin, rect.width + 2 * margin, rect.height + 2 * margin};
}

/// The smallest rectangle that contains both.
inline Rect join(const Rect& a, const Rect& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  const int x = std::min(a.x, b.x);
  const int y = std::min(a.y, b.y);
  return {x, y, std::max(a.right(), b.right()) - x, std::max(a.bottom(), b.bottom()) - y};
}

/// Extends `rect` to contain the pixel (x, y).
inline void extend(Rect& rect, int x, int y) {
  rect = join(rect, {x, y, 1, 1});
}

namespace detail {
/// For std::vector: memory of zeros, which is taken from the machine only where it is written.
template <class Pixel>
struct Zeros {
  using value_type = Pixel;

  Zeros() = default;
  template <class Other>
  Zeros(const Zeros<Other>&) {}

  Pixel* allocate(std::size_t count) {
    static_assert(alignof(Pixel) <= alignof(std::max_align_t));
    static_assert(std::is_trivially_destructible_v<Pixel>);
    void* const memory = std::calloc(count, sizeof(Pixel));
    if (memory == nullptr) throw std::bad_alloc();
    return static_cast<Pixel*>(memory);
  }
  void deallocate(Pixel* memory, std::size_t) noexcept { std::free(memory); }

  /// It is zero already.
  template <class Other>
  void construct(Other*) noexcept {}
  template <class Other, class... Arguments>
  void construct(Other* at, Arguments&&... arguments) {
    ::new (static_cast<void*>(at)) Other(std::forward<Arguments>(arguments)...);
  }
  friend bool operator==(const Zeros&, const Zeros&) { return true; }
};
}  // namespace detail

/// A row-major image without padding. Pixel centres are at integer coordinates. The pixel's type
/// has no destructor, and all bytes 0 are a value.
/// `resize` keeps its memory, so that an image that is used again does not allocate.
template <class Pixel>
class Image {
 public:
  using value_type = Pixel;

  Image() = default;
  /// All bytes are 0. Cost: next to nothing. The machine gives the memory where it is written.
  Image(int width, int height) : width_(width), height_(height), pixels_(count(width, height)) {}
  Image(int width, int height, Pixel value) { resize(width, height, value); }

  /// Resizes the image. Its pixels are unspecified unless the size stays the same.
  void resize(int width, int height) {
    if (count(width, height) > pixels_.capacity()) {
      *this = Image(width, height);
    } else {
      width_ = width;
      height_ = height;
      pixels_.resize(count(width, height));
    }
  }
  void resize(int width, int height, Pixel value) {
    resize(width, height);
    fill(value);
  }
  void fill(Pixel value) { std::fill(pixels_.begin(), pixels_.end(), value); }
  void fill(const Rect& part, Pixel value) {
    for (int y = part.y; y < part.bottom(); ++y) std::fill_n(row(y) + part.x, part.width, value);
  }

  int width() const { return width_; }
  int height() const { return height_; }
  bool empty() const { return pixels_.empty(); }
  Rect bounds() const { return {0, 0, width_, height_}; }
  std::size_t size() const { return pixels_.size(); }

  Pixel* row(int y) { return pixels_.data() + index(0, y); }
  const Pixel* row(int y) const { return pixels_.data() + index(0, y); }
  Pixel& operator()(int x, int y) { return pixels_[index(x, y)]; }
  const Pixel& operator()(int x, int y) const { return pixels_[index(x, y)]; }
  Pixel* data() { return pixels_.data(); }
  const Pixel* data() const { return pixels_.data(); }
  auto begin() { return pixels_.begin(); }
  auto end() { return pixels_.end(); }
  auto begin() const { return pixels_.begin(); }
  auto end() const { return pixels_.end(); }

  friend bool operator==(const Image&, const Image&) = default;

 private:
  static std::size_t count(int width, int height) {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }

  int width_ = 0;
  int height_ = 0;
  std::vector<Pixel, detail::Zeros<Pixel>> pixels_;
};

/// Pixels that belong to someone else, to read: rows from top to bottom, `stride` bytes apart. The
/// owner keeps them, unchanged, for as long as the view is used.
template <class Pixel>
class ImageView {
 public:
  using value_type = Pixel;

  ImageView() = default;
  /// The stride is a multiple of the pixel's alignment and not smaller than a row of pixels.
  ImageView(const Pixel* data, int width, int height, std::ptrdiff_t stride)
      : data_(data), width_(width), height_(height), stride_(stride) {}
  ImageView(const Image<Pixel>& image)
      : ImageView(image.data(), image.width(), image.height(),
                  image.width() * std::ptrdiff_t{sizeof(Pixel)}) {}

  int width() const { return width_; }
  int height() const { return height_; }
  std::ptrdiff_t stride() const { return stride_; }  ///< bytes
  bool empty() const { return width_ == 0 || height_ == 0; }
  Rect bounds() const { return {0, 0, width_, height_}; }

  const Pixel* data() const { return data_; }
  const Pixel* row(int y) const {
    return reinterpret_cast<const Pixel*>(reinterpret_cast<const std::byte*>(data_) + y * stride_);
  }
  const Pixel& operator()(int x, int y) const { return row(y)[x]; }

 private:
  const Pixel* data_ = nullptr;
  int width_ = 0;
  int height_ = 0;
  std::ptrdiff_t stride_ = 0;
};

template <class Pixel>
void copy(const ImageView<Pixel>& from, Image<Pixel>& to) {
  to.resize(from.width(), from.height());
  for (int y = 0; y < from.height(); ++y) std::copy_n(from.row(y), from.width(), to.row(y));
}

/// A mask is 255 where something is (an object, a valid pixel), else 0.
using Mask = Image<std::uint8_t>;

/// The smallest rectangle that contains all non-zero pixels of `mask`. Cost: one pass.
DIMINISH_EXPORT Rect bounding_box(const Mask& mask);
/// The same for the part of the mask inside `part`, which must lie within the mask.
DIMINISH_EXPORT Rect bounding_box(const Mask& mask, const Rect& part);

/// The number of pixels inside `part` that are `value`.
DIMINISH_EXPORT std::size_t count_equal(const Image<std::uint8_t>& image, std::uint8_t value,
                                        const Rect& part);

/// The number of non-zero pixels of `mask` inside `part`.
DIMINISH_EXPORT std::size_t count_nonzero(const Mask& mask, const Rect& part);

}  // namespace diminish
