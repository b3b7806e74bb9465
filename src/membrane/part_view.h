#pragma once

#include "diminish/image.h"
#include "diminish/membrane.h"

namespace diminish {

/// A part of an image as the membrane's functions take it.
template <class Pixel>
Membrane::ConstView view_of(const ImageView<Pixel>& image, const Rect& part) {
  return {reinterpret_cast<const std::uint8_t*>(image.row(part.y) + part.x), part.width,
          part.height, image.stride(), sizeof(Pixel)};
}
template <class Pixel>
Membrane::ConstView view_of(const Image<Pixel>& image, const Rect& part) {
  return view_of(ImageView(image), part);
}
template <class Pixel>
Membrane::View view_of(Image<Pixel>& image, const Rect& part) {
  constexpr int size = sizeof(Pixel);
  return {reinterpret_cast<std::uint8_t*>(image.row(part.y) + part.x), part.width, part.height,
          std::ptrdiff_t{size} * image.width(), size};
}

}  // namespace diminish
