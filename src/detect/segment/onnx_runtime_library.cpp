#include "detect/segment/onnx_runtime_library.h"

#include <dlfcn.h>

#include <algorithm>
#include <string>

#include "diminish/error.h"

namespace diminish::ort {

const Library* Library::find() {
  static const Library* const library = []() -> const Library* {
    void* handle = nullptr;
    for (const char* const name : {"libonnxruntime.so.1", "libonnxruntime.so"}) {
      handle = handle != nullptr ? handle : dlopen(name, RTLD_NOW | RTLD_LOCAL);
    }
    if (handle == nullptr) return nullptr;
    struct Base {
      const Entry* (*get_table)(std::uint32_t version);
    };
    const auto get_base = reinterpret_cast<const Base* (*)()>(dlsym(handle, "OrtGetApiBase"));
    const Base* const base = get_base != nullptr ? get_base() : nullptr;
    const Entry* const table = base != nullptr ? base->get_table(1) : nullptr;
    return table != nullptr ? new Library(table) : nullptr;
  }();
  return library;
}

void Library::check(Status* status) const {
  if (status == nullptr) return;
  std::string message = get<GetErrorMessage>(static_cast<const Status*>(status));
  get<ReleaseStatus>(status);
  std::replace(message.begin(), message.end(), '\n', ' ');
  throw Error(message);
}

}  // namespace diminish::ort
