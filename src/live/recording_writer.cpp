#include "diminish/recording_writer.h"

#include <fmt/format.h>

#include <mutex>
#include <thread>
#include <utility>

#include "core/bounded_queue.h"
#include "core/set_text.h"
#include "core/text.h"
#include "core/thread_name.h"
#include "diminish/error.h"
#include "setup/calibrate/yaml_edit.h"
#include "sink/partial_file.h"
#include "sink/recording_folder.h"

namespace diminish {
namespace {

constexpr std::size_t most_waiting = 8;
constexpr std::size_t most_rig_bytes = 1 << 20;

}  // namespace

struct RecordingWriter::Implementation {
  Implementation(std::filesystem::path folder, const std::filesystem::path& rig_file,
                 const Rig& rig, const std::filesystem::path& scene_file, const Scene& scene);

  void offer(std::shared_ptr<const LiveFrame> frame);
  void finish();
  void work();
  void write_rig(const std::filesystem::path& rig_file, const Rig& rig);

  RecordingFolder folder_;
  bool keeps_poses_;  ///< they come from where a recording does not reach
  BoundedQueue<std::shared_ptr<const LiveFrame>> waiting_{most_waiting};
  std::mutex mutex_;
  RecordingStatus status_;
  std::mutex ending_;  ///< guards the thread: several may finish
  std::thread thread_;
};

RecordingWriter::Implementation::Implementation(std::filesystem::path folder,
                                                const std::filesystem::path& rig_file,
                                                const Rig& rig,
                                                const std::filesystem::path& scene_file,
                                                const Scene& scene)
    : folder_(std::move(folder), rig, scene_file, scene, RecordingFolder::Pictures::jpeg),
      keeps_poses_(rig.pose_source == "tf") {
  write_rig(rig_file, rig);
  status_.active = true;
  status_.folder = folder_.path().string();
  thread_ = std::thread([this] { work(); });
}

void RecordingWriter::Implementation::write_rig(const std::filesystem::path& rig_file,
                                                const Rig& rig) {
  const std::filesystem::path copy = folder_.path() / "rig.yaml";
  copy_to(rig_file, copy);
  if (!keeps_poses_) return;
  const std::string pose = folder_.keep_poses(rig);
  const std::string text = read_text_file(copy, most_rig_bytes);
  write_file(copy, set_yaml(text, {key("pose")}, pose, rig_file));
}

void RecordingWriter::Implementation::finish() {
  waiting_.close();
  const std::lock_guard lock(ending_);
  if (thread_.joinable()) thread_.join();
}

void RecordingWriter::Implementation::offer(std::shared_ptr<const LiveFrame> frame) {
  const std::lock_guard lock(mutex_);
  if (status_.active && !waiting_.offer(std::move(frame))) ++status_.dropped;
}

void RecordingWriter::Implementation::work() {
  name_this_thread("recorder");
  while (const auto frame = waiting_.take()) {
    std::string problem;
    bool is_new = false;
    try {
      // Only this thread changes the number of frames.
      is_new = folder_.write((*frame)->input, fmt::format("{:06}", status_.frames));
      if (is_new && keeps_poses_) {
        folder_.add_poses((*frame)->input, (*frame)->result.report.poses);
      }
    } catch (const std::exception& error) {
      set_text(problem, error.what());
    } catch (...) {
      set_text(problem, "an unknown error");
    }
    const std::lock_guard lock(mutex_);
    status_.frames += is_new ? 1 : 0;
    status_.problem = std::move(problem);
    if (!status_.problem.empty()) break;
  }
  // After a problem nothing more is written: what waits goes.
  waiting_.close();
  while (waiting_.take()) {
  }
  const std::lock_guard lock(mutex_);
  status_.active = false;
}

RecordingWriter::RecordingWriter(std::filesystem::path folder,
                                 const std::filesystem::path& rig_file, const Rig& rig,
                                 const std::filesystem::path& scene_file, const Scene& scene)
    : implementation_(
          std::make_unique<Implementation>(std::move(folder), rig_file, rig, scene_file, scene)) {}

RecordingWriter::~RecordingWriter() {
  finish();
}

void RecordingWriter::offer(std::shared_ptr<const LiveFrame> frame) {
  implementation_->offer(std::move(frame));
}

RecordingStatus RecordingWriter::status() const {
  const std::lock_guard lock(implementation_->mutex_);
  return implementation_->status_;
}

void RecordingWriter::finish() {
  implementation_->finish();
}

}  // namespace diminish
