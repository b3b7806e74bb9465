#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace diminish::testing {

/// Writes an ONNX file with a single convolution of 1x1 pixels: each channel of the output is a
/// weighted sum of the input's. (ONNX is a Protocol Buffers format: onnx.proto3 has the fields.)
class OnnxModel {
 public:
  /// weights: for each channel of the output, of each channel of the input.
  static void write(const std::filesystem::path& file,
                    const std::vector<std::vector<float>>& weights,
                    const std::vector<float>& offsets, int width, int height) {
    const auto outputs = static_cast<int>(weights.size());
    const auto inputs = static_cast<int>(weights.front().size());
    std::vector<float> all;
    for (const auto& row : weights) all.insert(all.end(), row.begin(), row.end());
    const std::string shape =
        field(1, "kernel_shape") + number(8, 1) + number(8, 1) + number(20, 7);
    const std::string node = field(1, "in") + field(1, "w") + field(1, "b") + field(2, "out") +
                             field(4, "Conv") + field(5, shape);
    const std::string graph = field(1, node) + field(2, "g") +
                              field(5, tensor("w", {outputs, inputs, 1, 1}, all)) +
                              field(5, tensor("b", {outputs}, offsets)) +
                              field(11, value("in", {1, inputs, height, width})) +
                              field(12, value("out", {1, outputs, height, width}));
    std::ofstream(file, std::ios::binary)
        << number(1, 7) + field(7, graph) + field(8, number(2, 11));
  }

 private:
  static std::string varint(std::uint64_t value) {
    std::string bytes;
    for (; value >= 128; value /= 128) bytes += static_cast<char>(value % 128 + 128);
    return bytes + static_cast<char>(value);
  }
  static std::string number(std::uint64_t key, std::uint64_t value) {
    return varint(key * 8) + varint(value);
  }
  static std::string field(std::uint64_t key, const std::string& bytes) {
    return varint(key * 8 + 2) + varint(bytes.size()) + bytes;
  }
  static std::string tensor(const std::string& name, const std::vector<int>& sizes,
                            const std::vector<float>& values) {
    std::string bytes;
    for (const int size : sizes) bytes += number(1, static_cast<std::uint64_t>(size));
    std::string raw(values.size() * sizeof(float), '\0');
    std::memcpy(raw.data(), values.data(), raw.size());
    return bytes + number(2, 1) + field(8, name) + field(9, raw);
  }
  static std::string value(const std::string& name, const std::vector<int>& sizes) {
    std::string dimensions;
    for (const int size : sizes) {
      dimensions += field(1, number(1, static_cast<std::uint64_t>(size)));
    }
    return field(1, name) + field(2, field(1, number(1, 1) + field(2, dimensions)));
  }
};

}  // namespace diminish::testing
