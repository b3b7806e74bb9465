#include "bindings.h"
#include "diminish/error.h"
#include "frame.h"

PYBIND11_MODULE(diminish, module) {
  namespace py = pybind11;
  module.doc() =
      "Removes real objects from a camera's picture and shows what is behind them.\n\n"
      "Pictures are NumPy arrays, height x width x 3, uint8, in OpenCV's order (BGR). Errors are\n"
      "diminish.Error, a ValueError, with the text that the program prints.";
  module.attr("__version__") = DIMINISH_VERSION;
  py::register_exception<diminish::Error>(module, "Error", PyExc_ValueError).attr("__doc__") =
      "What cannot work, with the text that the program prints.";
  diminish::python::add_frame(module);
  diminish::python::add_live(module);
  diminish::python::add_methods(module);
  diminish::python::add_options(module);
  diminish::python::add_pictures(module);
  diminish::python::add_pipeline(module);
}
