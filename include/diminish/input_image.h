#pragma once

#include <utility>

#include "diminish/image.h"

namespace diminish {

/// An image that a camera delivered: pixels of its own, or a view of someone else's, which are read
/// where they are. A copy of it has pixels of its own, so that it may be kept.
template <class Pixel>
class InputImage {
 public:
  InputImage() = default;
  InputImage(Image<Pixel> pixels) : own_(std::move(pixels)) {}
  /// The pixels stay where they are, until the frame is done.
  InputImage(const ImageView<Pixel>& view) : view_(view), is_view_(true) {}

  ~InputImage() = default;
  InputImage(InputImage&&) noexcept = default;
  InputImage& operator=(InputImage&&) noexcept = default;
  InputImage(const InputImage& other) { copy(other.view(), own()); }
  InputImage& operator=(const InputImage& other) {
    if (this != &other) copy(other.view(), own());
    return *this;
  }

  /// To write to: pixels of its own. A view is let go, its pixels are not copied.
  Image<Pixel>& own() {
    is_view_ = false;
    return own_;
  }

  operator ImageView<Pixel>() const { return view(); }
  ImageView<Pixel> view() const { return is_view_ ? view_ : ImageView<Pixel>(own_); }

  int width() const { return view().width(); }
  int height() const { return view().height(); }
  bool empty() const { return view().empty(); }
  Rect bounds() const { return view().bounds(); }
  const Pixel* row(int y) const { return view().row(y); }
  const Pixel& operator()(int x, int y) const { return view()(x, y); }

 private:
  Image<Pixel> own_;
  ImageView<Pixel> view_;
  bool is_view_ = false;
};

}  // namespace diminish
