#include "diminish/registry.h"

namespace diminish::detail {

void need_library() {}

}  // namespace diminish::detail
