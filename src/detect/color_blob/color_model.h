#pragma once

#include <Eigen/Core>
#include <filesystem>

namespace diminish {

/// In standard deviations.
struct ColorDeviation {
  double tint = 0;  ///< the larger of hue's and saturation's
  double value = 0;
};

/// How an object's colour is distributed over its training images' pixels, in HSV (section 3.2 of
/// Meerits & Saito 2015). Saturation and value are from 0 to 1.
struct ColorModel {
  double hue_deg = 0;  ///< circular mean, weighted by chroma: grey pixels have no hue
  double hue_spread_deg = 0;
  double saturation = 0;
  double saturation_spread = 0;
  double value = 0;
  double value_spread = 0;
  /// The smallest of the training images' objects, as a part of the picture.
  double smallest_area = 0;

  /// How far a mean colour (blue, green, red; 0 to 255) is from the model's.
  ColorDeviation deviation(const Eigen::Vector3d& bgr) const;
};

/// Learns from all images NAME.jpg (or png, bmp) in `folder` with their NAME_mask.png, which is 255
/// on the object. Throws Error, naming the file, if there are none, or if a mask is missing, of
/// another size, or empty.
ColorModel train_color_model(const std::filesystem::path& folder);

/// Where `folder`'s model is kept.
std::filesystem::path color_model_file(const std::filesystem::path& folder);

/// Returns whether the file could be written.
bool save_color_model(const ColorModel& model, const std::filesystem::path& file);

/// The kept model of `folder` if it is newer than its images; else trains, and keeps the model if
/// the folder can be written. Throws Error as training does, and on a malformed model file.
ColorModel load_color_model(const std::filesystem::path& folder);

/// The folder of camera `camera` ("color" or an RGB-D camera's name) in `training`, or `color`'s.
std::filesystem::path training_folder(const std::filesystem::path& training,
                                      const std::string& camera);

}  // namespace diminish
