#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>

#include "diminish/image.h"

namespace diminish::python {

namespace py = pybind11;

// What an array must be to be read without a copy; others are converted.
using Bytes = py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>;
using Depths = py::array_t<std::uint16_t, py::array::c_style | py::array::forcecast>;

/// height x width x 3. Throws py::value_error that names what was given. The array must outlive it.
ImageView<Bgr> as_picture(const Bytes& array, const char* name);
/// height x width.
ImageView<std::uint8_t> as_mask(const Bytes& array, const char* name);
ImageView<std::uint16_t> as_depth(const Depths& array, const char* name);

/// Read-only views of an image that `owner` keeps.
py::array view_of(const Image<Bgr>& image, const std::shared_ptr<void>& owner);
py::array view_of(const Image<std::uint8_t>& image, const std::shared_ptr<void>& owner);
py::array view_of(ImageView<std::uint8_t> image, const std::shared_ptr<void>& owner);
py::array view_of(ImageView<Bgr> image, const std::shared_ptr<void>& owner);
py::array view_of(ImageView<std::uint16_t> image, const std::shared_ptr<void>& owner);

void add_live(py::module_& module);
void add_methods(py::module_& module);
void add_options(py::module_& module);
void add_pictures(py::module_& module);
void add_pipeline(py::module_& module);

}  // namespace diminish::python
