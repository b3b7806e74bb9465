#pragma once

#include <cstddef>
#include <cstdint>

namespace diminish::ort {

// ONNX Runtime's C interface, as far as it is used here. Its library exports OrtGetApiBase(); that
// gives, for version 1 of the interface, a table of function pointers whose order never changes.
// Debian 12 has no package of it, so there is no header to include: the names below are its names,
// and the numbers are the functions' places in the table.

struct Status;
struct Env;
struct Session;
struct SessionOptions;
struct RunOptions;
struct Allocator;
struct MemoryInfo;
struct Value;
struct TensorInfo;

// Values of its enumerations.
inline constexpr int fatal_only = 4;        ///< OrtLoggingLevel
inline constexpr int device_allocator = 0;  ///< OrtAllocatorType
inline constexpr int default_memory = 0;    ///< OrtMemType
inline constexpr int float_elements = 1;    ///< ONNXTensorElementDataType

/// A function and its place in the table.
template <std::size_t number, class Type>
struct Place {
  static constexpr std::size_t place = number;
  using Function = Type*;
};

using GetErrorMessage = Place<2, const char*(const Status*)>;
using CreateEnv = Place<3, Status*(int logging_level, const char* id, Env**)>;
using CreateSession =
    Place<7, Status*(const Env*, const char* path, const SessionOptions*, Session**)>;
using Run =
    Place<9, Status*(Session*, const RunOptions*, const char* const* input_names,
                     const Value* const* inputs, std::size_t input_count,
                     const char* const* output_names, std::size_t output_count, Value** outputs)>;
using CreateSessionOptions = Place<10, Status*(SessionOptions**)>;
using SetIntraOpNumThreads = Place<24, Status*(SessionOptions*, int count)>;
using SessionGetInputCount = Place<30, Status*(const Session*, std::size_t*)>;
using SessionGetInputName = Place<36, Status*(const Session*, std::size_t, Allocator*, char**)>;
using SessionGetOutputName = Place<37, Status*(const Session*, std::size_t, Allocator*, char**)>;
using CreateTensorWithDataAsOrtValue =
    Place<49, Status*(const MemoryInfo*, void* data, std::size_t bytes, const std::int64_t* shape,
                      std::size_t dimensions, int element_type, Value**)>;
using IsTensor = Place<50, Status*(const Value*, int*)>;
using GetTensorMutableData = Place<51, Status*(Value*, void**)>;
using GetTensorElementType = Place<60, Status*(const TensorInfo*, int*)>;
using GetDimensionsCount = Place<61, Status*(const TensorInfo*, std::size_t*)>;
using GetDimensions = Place<62, Status*(const TensorInfo*, std::int64_t*, std::size_t count)>;
using GetTensorTypeAndShape = Place<65, Status*(const Value*, TensorInfo**)>;
using CreateCpuMemoryInfo = Place<69, Status*(int allocator_type, int memory_type, MemoryInfo**)>;
using AllocatorFree = Place<76, Status*(Allocator*, void*)>;
using GetAllocatorWithDefaultOptions = Place<78, Status*(Allocator**)>;
using ReleaseStatus = Place<93, void(Status*)>;
using ReleaseMemoryInfo = Place<94, void(MemoryInfo*)>;
using ReleaseSession = Place<95, void(Session*)>;
using ReleaseValue = Place<96, void(Value*)>;
using ReleaseTensorInfo = Place<99, void(TensorInfo*)>;  ///< ReleaseTensorTypeAndShapeInfo
using ReleaseSessionOptions = Place<100, void(SessionOptions*)>;

/// The loaded library. It stays loaded.
class Library {
 public:
  /// Looked for once; null if it is not installed, or none that gives version 1.
  static const Library* find();

  /// Calls what returns no status.
  template <class Function, class... Arguments>
  auto get(Arguments... arguments) const {
    return reinterpret_cast<typename Function::Function>(table_[Function::place])(arguments...);
  }
  /// Calls what returns a status. Throws Error.
  template <class Function, class... Arguments>
  void call(Arguments... arguments) const {
    check(get<Function>(arguments...));
  }

 private:
  using Entry = void (*)();

  explicit Library(const Entry* table) : table_(table) {}
  void check(Status* status) const;

  const Entry* table_;
};

}  // namespace diminish::ort
