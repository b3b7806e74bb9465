#include "diminish/error.h"

#include <gtest/gtest.h>

#include "diminish/camera_source.h"
#include "diminish/frame_source.h"
#include "diminish/options.h"

namespace diminish {
namespace {

template <class Action>
Error::Category category_of(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.category();
  }
  ADD_FAILURE() << "expected an Error";
  return Error::internal;
}

TEST(ErrorCategory, SaysWhatAProgramMayDoAboutIt) {
  EXPECT_EQ(category_of([] { check({.mask_margin_px = -1}); }), Error::configuration);
  EXPECT_EQ(category_of([] { load_recording("/"); }), Error::io);
  EXPECT_EQ(category_of([] { load_recording("/no/such/folder"); }), Error::input);
  EXPECT_EQ(category_of([] { open_camera("v4l2:/no/such/device", {}); }), Error::device);
  EXPECT_EQ(category_of([] { open_camera("telepathy:x", {}); }), Error::configuration);
}

}  // namespace
}  // namespace diminish
