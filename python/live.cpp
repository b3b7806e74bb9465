#include "diminish/live.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <chrono>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "bindings.h"
#include "frame.h"

namespace diminish::python {
namespace {

/// The threads of a session may wait for Python: whoever waits for them must not hold it.
struct EndWithoutPython {
  void operator()(LiveSession* session) const {
    const py::gil_scoped_release release;
    delete session;
  }
};

/// The newest pictures of live cameras, one after the other.
class Live {
 public:
  Live(const std::filesystem::path& folder, const std::map<std::string, std::string>& cameras,
       const Options& options, const std::string& detector, const std::string& pose_source,
       double budget_ms) {
    const Recording setup = load_setup(folder, detector, pose_source);
    LiveOptions live_options;
    live_options.budget_ms = budget_ms;
    const std::vector<LiveCamera> all = cameras_of(setup, cameras);
    const py::gil_scoped_release release;
    session_.reset(new LiveSession(setup.rig, setup.scene, options, all, live_options));
  }

  SharedFrame next() {
    constexpr std::chrono::milliseconds patience(100);
    while (true) {
      std::shared_ptr<const LiveFrame> frame;
      bool is_over = false;
      {
        const py::gil_scoped_release release;
        frame = session_->wait_for_frame(last_, patience);
        if (!frame) {
          const LiveStatus status = session_->status();
          is_over = status.ended || !status.running;
        }
      }
      if (frame) {
        last_ = frame->number;
        return std::make_shared<Frame>(Frame{frame, &frame->input, &frame->result});
      }
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      if (is_over) throw py::stop_iteration();
    }
  }

  py::dict status() const {
    LiveStatus status;
    {
      const py::gil_scoped_release release;
      status = session_->status();
    }
    py::list cameras;
    for (const CameraStatus& camera : status.cameras) {
      cameras.append(
          py::dict(py::arg("name") = camera.name, py::arg("uri") = camera.uri,
                   py::arg("state") = camera_state_names[static_cast<std::size_t>(camera.state)],
                   py::arg("images") = camera.images, py::arg("problem") = camera.problem));
    }
    return py::dict(py::arg("frames") = status.frames,
                    py::arg("frames_per_second") = status.frames_per_second,
                    py::arg("latency_ms") = status.latency_ms.p50, py::arg("cameras") = cameras,
                    py::arg("problems") = status.problems);
  }

  void stop() {
    const py::gil_scoped_release release;
    session_->stop();
  }

 private:
  /// The given ones; else those of the set-up; else the recording, in real time.
  static std::vector<LiveCamera> cameras_of(const Recording& setup,
                                            const std::map<std::string, std::string>& given) {
    std::vector<LiveCamera> all;
    const auto add = [&](const std::string& name) {
      const auto uri = given.find(name);
      if (uri != given.end()) all.push_back({name, uri->second});
    };
    add("color");
    for (const RgbdCamera& camera : setup.rig.rgbd) add(camera.name);
    if (all.size() != given.size() || (!given.empty() && all[0].name != "color")) {
      throw py::value_error("cameras: expected color and the names of the rig's RGB-D cameras");
    }
    if (!all.empty()) return all;
    if (!setup.rig.live.empty() && !std::filesystem::exists(setup.folder / "color.txt")) {
      return setup.rig.live;
    }
    const std::string replay = "recording:" + setup.folder.string();
    all.push_back({"color", replay});
    for (const RgbdCamera& camera : setup.rig.rgbd) all.push_back({camera.name, replay});
    return all;
  }

  std::unique_ptr<LiveSession, EndWithoutPython> session_;
  std::size_t last_ = 0;
};

}  // namespace

void add_live(py::module_& module) {
  py::class_<Live>(
      module, "Live",
      "Live cameras: iterating gives the newest frame each time, until the cameras end.\n\n"
      "    for frame in diminish.Live('my-desk', cameras={'color': 'v4l2:/dev/video0', 'rgbd0': "
      "'openni2:'}):\n"
      "        cv2.imshow('diminished', frame.picture)\n\n"
      "Without cameras: those in rig.yaml (key live), or the folder as a recording, in real time. "
      "budget_ms: quality steps down where a frame takes longer; 0: never. Further arguments: as "
      "of Pipeline.")
      .def(py::init([](const std::filesystem::path& folder,
                       const std::map<std::string, std::string>& cameras, const py::object& options,
                       const std::string& detector, double budget_ms,
                       const std::string& pose_source, const py::kwargs& values) {
             return std::make_unique<Live>(folder, cameras, chosen_options(options, values),
                                           detector, pose_source, budget_ms);
           }),
           py::arg("folder"), py::arg("cameras") = std::map<std::string, std::string>{},
           py::arg("options") = py::none(), py::arg("detector") = "", py::arg("budget_ms") = 0.0,
           py::arg("pose_source") = "")
      .def("__iter__", [](py::object self) { return self; })
      .def("__next__", &Live::next)
      .def_property_readonly("status", &Live::status, "Rates, latency, cameras, what is wrong")
      .def("stop", &Live::stop, "Ends the session; iterating ends, too");
}

}  // namespace diminish::python
