#include "diminish/options.h"

#include <cmath>

#include "diminish/color_corrector.h"
#include "diminish/inpainter.h"
#include "diminish/reconstructor.h"
#include "diminish/view_mode.h"
#include "expect_error.h"

namespace diminish {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class OptionsCheck : public ::testing::Test {
 protected:
  Options options_;
};

TEST_F(OptionsCheck, AcceptsTheDefaultsAndBothEndsOfARange) {
  EXPECT_NO_THROW(check(options_));
  options_.mask_margin_px = 0;
  EXPECT_NO_THROW(check(options_));
  options_.mask_margin_px = 200;
  EXPECT_NO_THROW(check(options_));
}

TEST_F(OptionsCheck, NamesTheOptionWhatWasGivenAndWhatIsAllowed) {
  options_.mask_margin_px = 201;
  EXPECT_EQ(error_of([&] { check(options_); }),
            "mask_margin_px: expected 0 to 200 pixels, got 201");
}

TEST_F(OptionsCheck, EveryNumberHasAnUpperAndALowerEnd) {
  for_each_option(options_, [&](const OptionInfo& info, auto& value) {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, int> || std::is_same_v<Value, double>) {
      const Value good = value;
      value = static_cast<Value>(info.min - 1);
      EXPECT_THAT(error_of([&] { check(options_); }), HasSubstr(info.name));
      value = static_cast<Value>(info.max + 1);
      EXPECT_THAT(error_of([&] { check(options_); }), HasSubstr(info.name));
      if constexpr (std::is_same_v<Value, double>) {
        value = std::nan("");
        EXPECT_THAT(error_of([&] { check(options_); }),
                    AllOf(HasSubstr(info.name), HasSubstr("nan")));
      }
      value = good;
    }
  });
}

TEST_F(OptionsCheck, MethodsMustBeRegistered) {
  options_.inpaint = "magic";
  EXPECT_THAT(
      error_of([&] { check(options_); }),
      AllOf(HasSubstr("inpaint: expected one of "), HasSubstr("telea"), HasSubstr("got 'magic'")));
  options_.inpaint = "telea";
  options_.color_correct = "";
  EXPECT_THAT(error_of([&] { check(options_); }), HasSubstr("color_correct: expected one of "));
  options_ = {};
  options_.backend = "metal";
  EXPECT_THAT(error_of([&] { check(options_); }),
              AllOf(HasSubstr("backend: expected one of auto, cpu, "), HasSubstr("got 'metal'")));
  options_.backend = "auto";
  EXPECT_NO_THROW(check(options_));
#ifndef DIMINISH_HAS_GL
  options_.backend = "gl";
  EXPECT_THAT(error_of([&] { check(options_); }), HasSubstr("without libepoxy and EGL"));
#endif
}

TEST_F(OptionsCheck, SaysWhatABuildIsWithout) {
  Registry<ViewMode>::leave_out("hologram", "a laser");
  options_.mode = "hologram";
  EXPECT_THAT(error_of([&] { check(options_); }),
              AllOf(HasSubstr("mode: expected one of "),
                    HasSubstr("got 'hologram', which this build is without (it was built without "
                              "a laser)")));
}

// The kinds that options.h names are the interfaces' own.
TEST(MethodNames, AreTheRegisteredOnesAndTheChoicesBesides) {
  EXPECT_EQ(method_names("color_correct"), Registry<ColorCorrector>::names());
  EXPECT_EQ(method_names("inpaint"), Registry<Inpainter>::names());
  EXPECT_EQ(method_names("mode"), Registry<ViewMode>::names());
  std::vector<std::string> backends = Registry<Reconstructor>::names();
  backends.insert(backends.begin(), "auto");
  EXPECT_EQ(method_names("backend"), backends);
  EXPECT_EQ(method_names("merge_cameras"), (std::vector<std::string>{"blend", "choose"}));
  EXPECT_THAT(method_names("keep"), ::testing::IsEmpty());
}

}  // namespace
}  // namespace diminish
