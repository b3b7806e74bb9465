#include "serve/settings.h"

#include "expect_error.h"

namespace diminish {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(ChangedSettings, ChangesWhatIsNamedAndNothingElse) {
  Settings current;
  current.options.mask_margin_px = 9;
  const Settings changed = changed_settings(
      current, R"({"mode": "half", "transparency": 1, "lift_shadows": false, "budget_ms": 20})");
  EXPECT_EQ(changed.options.mode, "half");
  EXPECT_EQ(changed.options.transparency, 1);
  EXPECT_FALSE(changed.options.lift_shadows);
  EXPECT_EQ(changed.budget_ms, 20);
  EXPECT_EQ(changed.options.mask_margin_px, 9);
  EXPECT_EQ(changed.options.inpaint, Options{}.inpaint);
}

TEST(ChangedSettings, EveryOptionCanBeSet) {
  const Options defaults;
  for_each_option(defaults, [](const OptionInfo& info, const auto& value) {
    const nlohmann::json request = {{info.name, value}};
    EXPECT_NO_THROW(changed_settings({}, request.dump())) << info.name;
  });
}

TEST(ChangedSettings, ComplaintsNameTheSettingAndWhatWasGiven) {
  const auto complaint = [](const char* json) {
    return error_of([&] { changed_settings({}, json); });
  };
  EXPECT_THAT(complaint("[1, 2]"), HasSubstr("expected a JSON object"));
  EXPECT_THAT(complaint("{"), HasSubstr("expected a JSON object"));
  EXPECT_THAT(complaint(""), HasSubstr("expected a JSON object"));
  EXPECT_THAT(complaint(R"({"colour": 1})"), HasSubstr("unknown setting 'colour'"));
  EXPECT_THAT(complaint(R"({"mask_margin_px": 1.5})"),
              AllOf(HasSubstr("mask_margin_px: expected a whole number"), HasSubstr("1.5")));
  EXPECT_THAT(complaint(R"({"mask_margin_px": 99999999999999})"), HasSubstr("a whole number"));
  EXPECT_THAT(complaint(R"({"transparency": "half"})"),
              HasSubstr("transparency: expected a number"));
  EXPECT_THAT(complaint(R"({"lift_shadows": 1})"), HasSubstr("expected true or false"));
  EXPECT_THAT(complaint(R"({"mode": null})"), HasSubstr("mode: expected a text"));
  EXPECT_THAT(complaint(R"({"budget_ms": -1})"), HasSubstr("budget_ms: expected 0 to"));
}

}  // namespace
}  // namespace diminish
