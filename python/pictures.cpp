#include <algorithm>
#include <string>

#include "bindings.h"
#include "diminish/membrane.h"

namespace diminish::python {
namespace {

std::string shape_of(const py::array& array) {
  std::string shape;
  for (py::ssize_t i = 0; i < array.ndim(); ++i) {
    shape += (i > 0 ? " x " : "") + std::to_string(array.shape(i));
  }
  return shape.empty() ? "a number" : shape;
}

template <class Pixel>
ImageView<Pixel> as_image(const py::array& array, int channels, const char* name) {
  const bool fits =
      channels == 1 ? array.ndim() == 2 : array.ndim() == 3 && array.shape(2) == channels;
  constexpr py::ssize_t largest = 1 << 20;
  if (!fits || array.shape(0) > largest || array.shape(1) > largest) {
    throw py::value_error(std::string(name) + ": expected height x width" +
                          (channels == 1 ? "" : " x " + std::to_string(channels)) + ", got " +
                          shape_of(array));
  }
  return {static_cast<const Pixel*>(array.data()), static_cast<int>(array.shape(1)),
          static_cast<int>(array.shape(0)), array.strides(0)};
}

py::array read_only(py::array array) {
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

/// A capsule that keeps `owner` for as long as an array refers to it.
py::capsule keeper(const std::shared_ptr<void>& owner) {
  return {new std::shared_ptr<void>(owner),
          [](void* kept) { delete static_cast<std::shared_ptr<void>*>(kept); }};
}

Membrane::ConstView as_view(const Bytes& array, int channels) {
  return {array.data(), static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)),
          array.strides(0), channels};
}

py::array inpaint(const Bytes& picture, const Bytes& mask, double, int) {
  as_picture(picture, "src");
  as_mask(mask, "inpaintMask");
  Bytes result(picture.request());
  const Membrane::View filled{result.mutable_data(), static_cast<int>(picture.shape(1)),
                              static_cast<int>(picture.shape(0)), result.strides(0), 3};
  const Membrane::ConstView hole = as_view(mask, 1);
  const py::gil_scoped_release release;
  Membrane().fill(hole, filled);
  return result;
}

/// Of the pixels that are set; empty if there are none.
Rect box_of(const Membrane::ConstView& mask) {
  Rect box;
  for (int y = 0; y < mask.height; ++y) {
    const std::uint8_t* const row = mask.row(y);
    const std::uint8_t* const end = row + mask.width;
    const auto is_set = [](std::uint8_t value) { return value != 0; };
    const std::uint8_t* const first = std::find_if(row, end, is_set);
    if (first == end) continue;
    const std::uint8_t* last = end - 1;
    while (*last == 0) --last;
    extend(box, static_cast<int>(first - row), y);
    extend(box, static_cast<int>(last - row), y);
  }
  return box;
}

py::array seamless_clone(const Bytes& source, const Bytes& target, const Bytes& mask,
                         std::pair<int, int> center, int flags) {
  constexpr int normal_clone = 1;
  if (flags != normal_clone) {
    throw py::value_error("flags: expected 1 (NORMAL_CLONE), got " + std::to_string(flags));
  }
  const ImageView<Bgr> from = as_picture(source, "src");
  const ImageView<Bgr> to = as_picture(target, "dst");
  if (as_mask(mask, "mask").bounds() != from.bounds()) {
    throw py::value_error("mask: expected the size of src, " + shape_of(source) + ", got " +
                          shape_of(mask));
  }
  Bytes result(target.request());
  const Rect box = box_of(as_view(mask, 1));
  if (box.empty()) return result;
  const int right = center.first - box.width / 2 - box.x;
  const int down = center.second - box.height / 2 - box.y;
  const Rect moved{box.x + right, box.y + down, box.width, box.height};
  if (intersect(moved, to.bounds()) != moved) {
    throw py::value_error("p: expected a place where all of the mask is inside dst");
  }
  // A pixel more on each side, where both pictures have one: the rim to join.
  const Rect around =
      intersect(intersect(grow(box, 1), from.bounds()), {-right, -down, to.width(), to.height()});
  const auto part = [&](auto view, int x, int y) {
    return view.part(around.x + x, around.y + y, around.width, around.height);
  };
  const Membrane::View cloned{result.mutable_data(), to.width(), to.height(), result.strides(0), 3};
  const Membrane::ConstView here = cloned;
  const Membrane::Cloning cloning{part(here, right, down), part(as_view(source, 3), 0, 0),
                                  part(as_view(mask, 1), 0, 0)};
  const py::gil_scoped_release release;
  Membrane().clone(cloning, part(cloned, right, down));
  return result;
}

}  // namespace

ImageView<Bgr> as_picture(const Bytes& array, const char* name) {
  return as_image<Bgr>(array, 3, name);
}
ImageView<std::uint8_t> as_mask(const Bytes& array, const char* name) {
  return as_image<std::uint8_t>(array, 1, name);
}
ImageView<std::uint16_t> as_depth(const Depths& array, const char* name) {
  return as_image<std::uint16_t>(array, 1, name);
}

py::array view_of(const Image<Bgr>& image, const std::shared_ptr<void>& owner) {
  return view_of(ImageView<Bgr>(image), owner);
}
py::array view_of(const Image<std::uint8_t>& image, const std::shared_ptr<void>& owner) {
  return view_of(ImageView<std::uint8_t>(image), owner);
}
py::array view_of(ImageView<std::uint8_t> image, const std::shared_ptr<void>& owner) {
  return read_only(py::array_t<std::uint8_t>({image.height(), image.width()},
                                             {static_cast<int>(image.stride()), 1}, image.data(),
                                             keeper(owner)));
}
py::array view_of(ImageView<Bgr> image, const std::shared_ptr<void>& owner) {
  return read_only(py::array_t<std::uint8_t>(
      {image.height(), image.width(), 3}, {static_cast<int>(image.stride()), 3, 1},
      reinterpret_cast<const std::uint8_t*>(image.data()), keeper(owner)));
}
py::array view_of(ImageView<std::uint16_t> image, const std::shared_ptr<void>& owner) {
  return read_only(py::array_t<std::uint16_t>({image.height(), image.width()},
                                              {static_cast<int>(image.stride()), 2}, image.data(),
                                              keeper(owner)));
}

void add_pictures(py::module_& module) {
  module.def("inpaint", &inpaint, py::arg("src"), py::arg("inpaintMask"),
             py::arg("inpaintRadius") = 3.0, py::arg("flags") = 0,
             "Fills the pixels where the mask is not 0 with the smoothest filling (harmonic).\n\n"
             "A drop-in for cv2.inpaint; radius and flags have no meaning.\n"
             "src: height x width x 3, uint8. inpaintMask: height x width, uint8.");
  module.def("seamless_clone", &seamless_clone, py::arg("src"), py::arg("dst"), py::arg("mask"),
             py::arg("p"), py::arg("flags") = 1,
             "Clones the masked part of src into dst without a seam (Perez, Gangnet & Blake "
             "2003).\n\n"
             "A drop-in for cv2.seamlessClone with NORMAL_CLONE. p: (x, y) in dst of the middle of "
             "the mask's bounding box.");
}

}  // namespace diminish::python
