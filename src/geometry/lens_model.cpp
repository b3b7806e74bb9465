#include "diminish/intrinsics.h"

namespace diminish {

const char* name_of(LensModel model) {
  switch (model) {
    case LensModel::rational:
      return "rational";
    case LensModel::fisheye:
      return "fisheye";
    case LensModel::plumb_bob:
      break;
  }
  return "plumb_bob";
}

std::optional<LensModel> find_lens_model(const std::string& name) {
  if (name == "plumb_bob") return LensModel::plumb_bob;
  if (name == "rational" || name == "rational_polynomial") return LensModel::rational;
  if (name == "fisheye" || name == "equidistant") return LensModel::fisheye;
  return std::nullopt;
}

}  // namespace diminish
