// A node that draws and the user's session, on the loopback.

#include "live/render_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <functional>

#include "background_program.h"
#include "dds/dds.h"
#include "diminish/frame_source.h"
#include "diminish/live.h"
#include "diminish/pipeline.h"
#include "expect_error.h"
#include "paths.h"
#include "ros2_domain.h"

namespace diminish {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

const std::filesystem::path workbench = testing::recordings / "workbench";

std::string camera_uri(const std::string& name) {
  return "recording:" + workbench.string() + "?loop&in-step&rate=0.2" +
         (name == "color" ? "" : "&camera=" + name);
}
std::string node_uri(const std::string& name, const std::string& coding) {
  return "node:/" + name + "?wait=20000" + coding;
}

class RenderNodeTest : public ::testing::Test {
 protected:
  RenderNodeTest() {
    options_.memory = "off";
    options_.complete_sides = false;
    options_.draw_bars = false;
    options_.close_gaps = false;
    options_.smooth_colors = false;
  }

  RenderNodeOptions node(const std::string& name) const {
    return {camera_uri(name), name, "/" + name, recording_.rig};
  }
  /// coding: of the nodes' URI; without any, layers are raw.
  std::unique_ptr<LiveSession> session(const std::vector<std::string>& remote,
                                       const std::string& coding = "") const {
    std::vector<LiveCamera> cameras = {{"color", camera_uri("color")}};
    for (const RgbdCamera& camera : recording_.rig.rgbd) {
      const bool is_remote = std::find(remote.begin(), remote.end(), camera.name) != remote.end();
      cameras.push_back(
          {camera.name, is_remote ? node_uri(camera.name, coding) : camera_uri(camera.name)});
    }
    LiveOptions live;
    live.sync_wait_s = 2;
    return std::make_unique<LiveSession>(recording_.rig, recording_.scene, options_, cameras, live);
  }
  /// The next frame for which `suits` holds; null after half a minute.
  static std::shared_ptr<const LiveFrame> frame_where(
      const LiveSession& session, const std::function<bool(const LiveFrame&)>& suits) {
    std::size_t number = 0;
    for (const double end_s = monotonic_now_s() + 60; monotonic_now_s() < end_s;) {
      auto frame = session.wait_for_frame(number, milliseconds(200));
      if (!frame) continue;
      number = frame->number;
      if (suits(*frame)) return frame;
    }
    ADD_FAILURE() << "no such frame: " << ::testing::PrintToString(session.status().problems);
    return nullptr;
  }
  static bool is_complete(const LiveFrame& frame) {
    const auto& rgbd = frame.input.rgbd;
    return frame.result.report.valid_pixels > 0 &&
           std::all_of(rgbd.begin(), rgbd.end(), [&](const RgbdFrame& one) {
             return one.takes_part() && (!one.remote || one.remote->problem().empty());
           });
  }

  Ros2Domain domain_;
  Recording recording_ = load_recording(workbench);
  Options options_;
};

TEST_F(RenderNodeTest, ItsContributionMakesTheLocalPicture) {
  std::vector<FrameSet> recorded;
  const auto source = open_recording(recording_, {});
  for (FrameSet frame; source->next(frame);) recorded.push_back(frame);

  const RenderNode first(node("rgbd0"));
  const RenderNode second(node("rgbd1"));
  struct Case {
    std::vector<std::string> remote;
    std::string coding;
  };
  for (const auto& [remote, coding] :
       {Case{{"rgbd1"}, "&lossless"}, Case{{"rgbd0", "rgbd1"}, ""}}) {
    const auto running = session(remote, coding);
    const auto live = frame_where(*running, is_complete);
    ASSERT_TRUE(live);
    const auto same = std::find_if(recorded.begin(), recorded.end(), [&](const FrameSet& frame) {
      return std::equal(frame.color.view().row(0), frame.color.view().row(0) + 100,
                        live->input.color.row(0));
    });
    ASSERT_NE(same, recorded.end());
    Pipeline local(recording_.rig, recording_.scene, options_);
    DiminishedFrame expected;
    local.process(*same, expected);
    ASSERT_EQ(live->result.mask, expected.mask);
    EXPECT_EQ(live->result.picture, expected.picture);
    const LiveStatus status = running->status();
    const auto camera = std::find_if(status.cameras.begin(), status.cameras.end(),
                                     [](const CameraStatus& one) { return one.name == "rgbd1"; });
    ASSERT_TRUE(camera->remote);
    EXPECT_GT(camera->remote->layers, 0U);
    EXPECT_EQ(camera->state, CameraState::running);
  }
  EXPECT_EQ(first.status().problem, "");
  EXPECT_GT(second.status().layers, first.status().layers);
}

TEST_F(RenderNodeTest, AKilledNodeIsBackWhenItIsStartedAgain) {
  const std::vector<std::string> arguments = {
      "render-node", camera_uri("rgbd1"), "--topic", "/rgbd1", "--name", "rgbd1",
      "--rig",       workbench.string()};
  auto program = std::make_unique<BackgroundProgram>(arguments);
  const auto running = session({"rgbd1"});
  ASSERT_TRUE(frame_where(*running, is_complete));
  program->kill_now();
  // The other camera is there.
  ASSERT_TRUE(frame_where(*running, [](const LiveFrame& frame) {
    return !frame.input.rgbd[1].missing.empty() && frame.result.report.valid_pixels > 0;
  }));
  program = std::make_unique<BackgroundProgram>(arguments);
  EXPECT_TRUE(frame_where(*running, is_complete));
}

TEST_F(RenderNodeTest, WhatIsBrokenIsCountedAndTheStreamGoesOn) {
  const RenderNode running_node(node("rgbd1"));
  const auto running = session({"rgbd1"});
  ASSERT_TRUE(frame_where(*running, is_complete));
  const auto network = dds::Node::open({dds::default_domain(), "", true, 0});
  dds::Publication questions(network, {"/rgbd1/question", node_question_type},
                             dds::Delivery::newest);
  dds::Publication answers(network, {"/rgbd1/answer", node_answer_type}, dds::Delivery::newest);
  const auto damaged = [&] {
    const LiveStatus status = running->status();
    return std::any_of(status.cameras.begin(), status.cameras.end(),
                       [](const CameraStatus& camera) { return camera.damaged > 0; });
  };
  const std::vector<std::uint8_t> garbage(1000, 1);
  for (const double end_s = monotonic_now_s() + 60; monotonic_now_s() < end_s;) {
    questions.send(garbage);
    answers.send(garbage);
    std::this_thread::sleep_for(milliseconds(20));
    if (damaged() && running_node.status().failed > 0) break;
  }
  EXPECT_TRUE(damaged());
  EXPECT_GT(running_node.status().failed, 0U);
  EXPECT_TRUE(frame_where(*running, is_complete));
}

TEST_F(RenderNodeTest, WrongUseIsOneLine) {
  RenderNodeOptions wrong = node("rgbd0");
  wrong.name = "x";
  EXPECT_EQ(error_of([&] { const RenderNode node(wrong); }), "the rig has no RGB-D camera 'x'");
  const auto error_with = [&](const std::vector<LiveCamera>& cameras) {
    return error_of([&] {
      const LiveSession session(recording_.rig, recording_.scene, options_, cameras, {});
    });
  };
  EXPECT_THAT(error_with({{"color", "node:/eye"}}), HasSubstr("cannot be a node that draws"));
  EXPECT_THAT(error_with({{"color", camera_uri("color")},
                          {"rgbd0", "node:/rgbd0?lossless&quality=80"},
                          {"rgbd1", camera_uri("rgbd1")}}),
              HasSubstr("expected lossless, or quality and depth_step"));
}

}  // namespace
}  // namespace diminish
