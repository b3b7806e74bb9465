#include <cstdint>
#include <string>
#include <vector>

#include "detect/segment/network_runtime.h"
#include "detect/segment/onnx_runtime_library.h"
#include "diminish/error.h"

namespace diminish {
namespace {

/// Something of the library's that is given back.
template <class Type, class Release>
class Owned {
 public:
  explicit Owned(const ort::Library& library) : library_(library) {}
  ~Owned() { reset(); }
  Owned(const Owned&) = delete;
  Owned& operator=(const Owned&) = delete;

  /// For a function that creates it.
  Type** fill() {
    reset();
    return &value_;
  }
  Type* get() const { return value_; }

 private:
  void reset() {
    if (value_ != nullptr) library_.get<Release>(value_);
    value_ = nullptr;
  }

  const ort::Library& library_;
  Type* value_ = nullptr;
};

/// One for the process, which keeps it.
const ort::Env* environment(const ort::Library& library) {
  static const ort::Env* const made = [&] {
    ort::Env* env = nullptr;
    library.call<ort::CreateEnv>(ort::fatal_only, "diminish", &env);
    return env;
  }();
  return made;
}

const ort::Library& installed_library() {
  const ort::Library* const library = ort::Library::find();
  if (library == nullptr) throw Error(Error::configuration, "ONNX Runtime is not installed");
  return *library;
}

class OnnxRuntime final : public NetworkRuntime {
 public:
  explicit OnnxRuntime(const std::filesystem::path& model) : library_(installed_library()) {
    Owned<ort::SessionOptions, ort::ReleaseSessionOptions> options(library_);
    library_.call<ort::CreateSessionOptions>(options.fill());
    // Threads are the caller's: the cameras' networks run side by side.
    library_.call<ort::SetIntraOpNumThreads>(options.get(), 1);
    library_.call<ort::CreateSession>(environment(library_), model.c_str(),
                                      static_cast<const ort::SessionOptions*>(options.get()),
                                      session_.fill());
    std::size_t inputs = 0;
    library_.call<ort::SessionGetInputCount>(session(), &inputs);
    if (inputs != 1) {
      throw Error("has " + std::to_string(inputs) + " inputs; expected one, a picture");
    }
    input_name_ = name<ort::SessionGetInputName>();
    output_name_ = name<ort::SessionGetOutputName>();
    library_.call<ort::CreateCpuMemoryInfo>(ort::device_allocator, ort::default_memory,
                                            memory_.fill());
  }

  cv::Mat run(const cv::Mat& input) override {
    const std::vector<std::int64_t> shape(input.size.p, input.size.p + input.dims);
    library_.call<ort::CreateTensorWithDataAsOrtValue>(
        static_cast<const ort::MemoryInfo*>(memory_.get()), static_cast<void*>(input.data),
        input.total() * sizeof(float), shape.data(), shape.size(), ort::float_elements,
        input_.fill());
    const char* const input_name = input_name_.c_str();
    const char* const output_name = output_name_.c_str();
    const ort::Value* const value = input_.get();
    library_.call<ort::Run>(session_.get(), static_cast<const ort::RunOptions*>(nullptr),
                            &input_name, &value, std::size_t{1}, &output_name, std::size_t{1},
                            output_.fill());
    return picture_of(output_.get());
  }

 private:
  const ort::Session* session() const { return session_.get(); }

  template <class Function>
  std::string name() const {
    ort::Allocator* allocator = nullptr;
    library_.call<ort::GetAllocatorWithDefaultOptions>(&allocator);
    char* name = nullptr;
    library_.call<Function>(session(), std::size_t{0}, allocator, &name);
    std::string copied = name;
    library_.call<ort::AllocatorFree>(allocator, static_cast<void*>(name));
    return copied;
  }

  /// Shares the value's memory.
  cv::Mat picture_of(ort::Value* value) const {
    int is_tensor = 0;
    library_.call<ort::IsTensor>(static_cast<const ort::Value*>(value), &is_tensor);
    if (is_tensor == 0) throw Error("its first output is no tensor");
    Owned<ort::TensorInfo, ort::ReleaseTensorInfo> info(library_);
    library_.call<ort::GetTensorTypeAndShape>(static_cast<const ort::Value*>(value), info.fill());
    const ort::TensorInfo* const tensor = info.get();
    int type = 0;
    std::size_t dimensions = 0;
    constexpr std::size_t most_dimensions = 8;
    library_.call<ort::GetTensorElementType>(tensor, &type);
    library_.call<ort::GetDimensionsCount>(tensor, &dimensions);
    if (type != ort::float_elements || dimensions > most_dimensions) {
      throw Error("its first output is not of 32-bit floats");
    }
    std::vector<std::int64_t> shape(dimensions);
    library_.call<ort::GetDimensions>(tensor, shape.data(), dimensions);
    const std::vector<int> sizes(shape.begin(), shape.end());
    void* data = nullptr;
    library_.call<ort::GetTensorMutableData>(value, &data);
    return {static_cast<int>(dimensions), sizes.data(), CV_32F, data};
  }

  const ort::Library& library_;
  Owned<ort::Session, ort::ReleaseSession> session_{library_};
  Owned<ort::MemoryInfo, ort::ReleaseMemoryInfo> memory_{library_};
  Owned<ort::Value, ort::ReleaseValue> input_{library_}, output_{library_};
  std::string input_name_, output_name_;
};

}  // namespace

std::unique_ptr<NetworkRuntime> onnx_runtime(const std::filesystem::path& model) {
  return std::make_unique<OnnxRuntime>(model);
}

bool has_onnx_runtime() {
  return ort::Library::find() != nullptr;
}

}  // namespace diminish
