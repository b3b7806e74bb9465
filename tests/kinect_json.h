#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>

namespace diminish {

/// A calibration as an Azure Kinect keeps it, with numbers like those of real ones.
struct KinectJson {
  /// cx, cy, fx, fy, k1 .. k6, codx, cody, p2, p1; the sensor is 1 wide and high.
  std::array<double, 14> depth = {0.5164, 0.5032, 0.4928, 0.4929, 0.548, -0.021,  -0.0027,
                                  0.89,   0.086,  -0.014, 0,      0,     -7.2e-5, 2.1e-5};
  std::array<double, 14> color = {0.4998, 0.5066, 0.478, 0.6374, 0.33, -2.489,   1.454,
                                  0.209,  -2.303, 1.375, 0,      0,    -1.29e-4, -1.62e-4};
  int color_width = 4096, color_height = 3072;
  std::array<double, 9> rotation = {0.99999923, 0.00118176, -0.00044814, -0.00113875, 0.99628061,
                                    0.08616032, 0.00054829, -0.08615975, 0.99628121};
  std::array<double, 3> translation = {-0.0320834, -0.0022054, 0.0038837};

  std::string text() const {
    using nlohmann::json;
    const auto camera = [](const char* location, const auto& parameters, const json& turn,
                           const json& shift, int width, int height) {
      return json{{"Intrinsics",
                   {{"ModelParameterCount", 14},
                    {"ModelParameters", parameters},
                    {"ModelType", "CALIBRATION_LensDistortionModelBrownConrady"}}},
                  {"Location", location},
                  {"MetricRadius", 1.74},
                  {"Rt", {{"Rotation", turn}, {"Translation", shift}}},
                  {"SensorHeight", height},
                  {"SensorWidth", width}};
    };
    const json identity = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const json none = {0, 0, 0};
    return json{{"CalibrationInformation",
                 {{"Cameras",
                   {camera("CALIBRATION_CameraLocationD0", depth, identity, none, 1024, 1024),
                    camera("CALIBRATION_CameraLocationPV0", color, rotation, translation,
                           color_width, color_height)}},
                  {"InertialSensors", json::array()}}}}
        .dump();
  }
};

}  // namespace diminish
