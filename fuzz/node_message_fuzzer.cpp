#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "diminish/error.h"
#include "remote/asked_images.h"
#include "remote/node_worker.h"

using namespace diminish;

namespace {

constexpr std::uint64_t user = 1;
constexpr std::uint64_t frame = 1;

/// A camera whose images are small.
GlanceQuestion question() {
  GlanceQuestion asked;
  asked.camera.name = "camera";
  asked.camera.color = {64, 48, 60, 60, 32, 24, {}};
  asked.camera.depth = {40, 32, 40, 40, 20, 16, {}};
  asked.user = {96, 64, 80, 80, 48, 32, {}};
  asked.wishes.spacings_px = {1, 2, 4};
  asked.wishes.samples = 40;
  return asked;
}

NodeWorker::Images images() {
  const auto made = std::make_shared<RgbdFrame>();
  made->color = Image<Bgr>(64, 48, {90, 100, 110});
  made->depth = Image<std::uint16_t>(40, 32, 1000);
  return made;
}

/// At a node whom a user has asked before.
void ask_node(std::span<const std::uint8_t> bytes) {
  static const NodeWorker::Images found = images();
  NodeWorker worker([](double, double) { return found; }, [](const std::vector<std::uint8_t>&) {});
  worker.take(write_question({NodeTopic::glance, user, frame}, question()), 0);
  worker.take(bytes, 0);
  worker.look_again(1);
  worker.prepare(found, 0);
}

/// At a user's machine that waits for both answers.
void answer_user(std::span<const std::uint8_t> bytes) {
  AskedImages asked("camera", {NodeTopic::glance, user, frame}, question(), {},
                    [](const std::vector<std::uint8_t>&) {});
  const RigidTransform pose;
  const Mask color_mask(64, 48);
  const Mask depth_mask(40, 32);
  const TiledRegion region(Rect{8, 8, 48, 40});
  const Options options;
  asked.draw({pose, color_mask, depth_mask, region, options});
  auto answer = open_answer(bytes);
  asked.take(answer, 0);
}

}  // namespace

/// The first byte says whether the others are a question or an answer.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  try {
    if (data[0] % 2 == 0) {
      ask_node({data + 1, size - 1});
    } else {
      answer_user({data + 1, size - 1});
    }
  } catch (const Error&) {
  }
  return 0;
}
