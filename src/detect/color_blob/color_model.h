#pragma once

#include <Eigen/Core>
#include <filesystem>

namespace diminish {

/// A colour's deviations from a model, in standard deviations.
struct ColorDeviation {
  double tint = 0;  ///< the larger of the hue's and the saturation's
  double value = 0;
};

/// The distribution of an object's colour over its training images' pixels, in HSV (section 3.2 of
/// Meerits & Saito 2015). Saturation and value are from 0 to 1.
struct ColorModel {
  double hue_deg = 0;  ///< circular mean, weighted by chroma: grey pixels have no hue
  double hue_spread_deg = 0;
  double saturation = 0;
  double saturation_spread = 0;
  double value = 0;
  double value_spread = 0;
  /// The smallest object in the training images, as a share of the picture.
  double smallest_area = 0;

  /// How far a mean colour (blue, green, red; 0 to 255) is from the model's.
  ColorDeviation deviation(const Eigen::Vector3d& bgr) const;
};

/// Learns from all images NAME.jpg (or png, bmp) in `folder` with their NAME_mask.png, which is 255
/// on the object. Throws Error that names the file if there are no images, or if a mask is missing,
/// has another size or is empty.
ColorModel train_color_model(const std::filesystem::path& folder);

/// The file that holds `folder`'s model.
std::filesystem::path color_model_file(const std::filesystem::path& folder);

/// Writes the model. Returns whether that worked.
bool save_color_model(const ColorModel& model, const std::filesystem::path& file);

/// Loads the model of `folder` if it is newer than its images. Otherwise trains, and saves the
/// model if the folder is writable. Throws Error like training, and on a malformed model file.
ColorModel load_color_model(const std::filesystem::path& folder);

/// The folder of camera `camera` ("color" or an RGB-D camera's name) in `training`, or `color`'s.
std::filesystem::path training_folder(const std::filesystem::path& training,
                                      const std::string& camera);

}  // namespace diminish
