#include "pose/marker_dictionary.h"

#include <utility>

#include "core/text.h"
#include "diminish/error.h"

namespace diminish {
namespace {

using DictionaryName = std::pair<const char*, cv::aruco::PREDEFINED_DICTIONARY_NAME>;
#define DIMINISH_DICTIONARY(name) \
  DictionaryName {                \
#name, cv::aruco::name        \
  }
constexpr DictionaryName dictionaries[] = {
    DIMINISH_DICTIONARY(DICT_4X4_50),         DIMINISH_DICTIONARY(DICT_4X4_100),
    DIMINISH_DICTIONARY(DICT_4X4_250),        DIMINISH_DICTIONARY(DICT_4X4_1000),
    DIMINISH_DICTIONARY(DICT_5X5_50),         DIMINISH_DICTIONARY(DICT_5X5_100),
    DIMINISH_DICTIONARY(DICT_5X5_250),        DIMINISH_DICTIONARY(DICT_5X5_1000),
    DIMINISH_DICTIONARY(DICT_6X6_50),         DIMINISH_DICTIONARY(DICT_6X6_100),
    DIMINISH_DICTIONARY(DICT_6X6_250),        DIMINISH_DICTIONARY(DICT_6X6_1000),
    DIMINISH_DICTIONARY(DICT_7X7_50),         DIMINISH_DICTIONARY(DICT_7X7_100),
    DIMINISH_DICTIONARY(DICT_7X7_250),        DIMINISH_DICTIONARY(DICT_7X7_1000),
    DIMINISH_DICTIONARY(DICT_ARUCO_ORIGINAL), DIMINISH_DICTIONARY(DICT_APRILTAG_16h5),
    DIMINISH_DICTIONARY(DICT_APRILTAG_25h9),  DIMINISH_DICTIONARY(DICT_APRILTAG_36h10),
    DIMINISH_DICTIONARY(DICT_APRILTAG_36h11)};
#undef DIMINISH_DICTIONARY

}  // namespace

cv::Ptr<cv::aruco::Dictionary> find_dictionary(const std::string& name) {
  for (const auto& [candidate, id] : dictionaries) {
    if (name == candidate) return cv::aruco::getPredefinedDictionary(id);
  }
  throw Error("marker_dictionary: expected one of " + join(dictionary_names()) + ", got '" +
              printable(name) + "'");
}

const std::vector<std::string>& dictionary_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const auto& [name, id] : dictionaries) all.emplace_back(name);
    return all;
  }();
  return names;
}

}  // namespace diminish
