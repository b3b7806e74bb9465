#include <algorithm>
#include <charconv>
#include <exception>
#include <memory>
#include <string>
#include <type_traits>

#include "core/text.h"
#include "diminish/error.h"
#include "diminish/frame_source.h"
#include "diminish/objects_of_detector.h"
#include "diminish/pipeline.h"
#include "diminish_c.h"

using namespace diminish;

/// What the C API's pipelines are.
struct diminish_pipeline {
  Recording setup;
  Options options;
  std::unique_ptr<Pipeline> pipeline;
  std::unique_ptr<FrameSource> source;  ///< of the recording, once asked for
  FrameSet frame;
  DiminishedFrame result;
  std::string messages;
  std::size_t frames = 0;

  void make_pipeline() {
    pipeline = std::make_unique<Pipeline>(setup.rig, setup.scene, options);
    pipeline->want_reconstruction(false);
  }
};

namespace {

thread_local std::string last_error;

diminish_status fail(diminish_status status, const char* message) {
  try {
    last_error = message;
  } catch (...) {
    last_error.clear();
  }
  return status;
}

/// No exception leaves the library.
template <class Work>
diminish_status guarded(const Work& work) {
  try {
    work();
    return DIMINISH_OK;
  } catch (const Error& error) {
    constexpr diminish_status by_category[] = {DIMINISH_CONFIGURATION, DIMINISH_INPUT,
                                               DIMINISH_DEVICE, DIMINISH_IO, DIMINISH_INTERNAL};
    return fail(by_category[error.category()], error.what());
  } catch (const std::exception& error) {
    return fail(DIMINISH_INTERNAL, error.what());
  } catch (...) {
    return fail(DIMINISH_INTERNAL, "unknown error");
  }
}

void expect(bool is_given, const char* what) {
  if (!is_given) throw Error(std::string(what) + ": expected a pointer, got null");
}

template <class Pixel>
ImageView<Pixel> view(const diminish_image& image, const std::string& name) {
  if (image.data == nullptr) return {};
  const std::ptrdiff_t least = std::ptrdiff_t{image.width} * static_cast<int>(sizeof(Pixel));
  if (image.width < 1 || image.height < 1 || image.stride < least ||
      image.stride % static_cast<int>(alignof(Pixel)) != 0) {
    throw Error(name + ": expected a size, and a stride of at least " + std::to_string(least) +
                " bytes, got " + std::to_string(image.width) + "x" + std::to_string(image.height) +
                " and " + std::to_string(image.stride));
  }
  return {static_cast<const Pixel*>(image.data), image.width, image.height, image.stride};
}

template <class Pixel>
diminish_image view(const Image<Pixel>& image) {
  return {image.data(), image.width(), image.height(),
          image.width() * static_cast<std::ptrdiff_t>(sizeof(Pixel))};
}

void read_value(const std::string& text, std::string& value) {
  value = text;
}
void read_value(const std::string& text, bool& value) {
  if (text != "true" && text != "false") throw Error("expected true or false, got '" + text + "'");
  value = text == "true";
}
template <class Number>
void read_value(const std::string& text, Number& value) {
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || rest != end) throw Error("expected a number, got '" + text + "'");
}

void fill(diminish_pipeline& pipeline, diminish_output& output) {
  const FrameReport& report = pipeline.result.report;
  pipeline.messages.clear();
  for (const auto* list : {&report.messages, &report.faults}) {
    for (const std::string& message : *list) pipeline.messages += message + "\n";
  }
  output.picture = view(pipeline.result.picture);
  output.mask = view(pipeline.result.mask);
  output.provenance = view(pipeline.result.provenance);
  output.mask_pixels = report.mask_pixels;
  output.seen_pixels = report.valid_pixels - report.remembered_pixels - report.estimated_pixels;
  output.remembered_pixels = report.remembered_pixels;
  output.invented_pixels = report.missing_pixels + report.estimated_pixels;
  output.milliseconds = report.frame_ms;
  output.messages = pipeline.messages.c_str();
}

/// Views of the caller's images.
void take(const diminish_input& input, diminish_pipeline& pipeline) {
  const Rig& rig = pipeline.setup.rig;
  FrameSet& frame = pipeline.frame;
  if (input.rgbd_count != rig.rgbd.size()) {
    throw Error("rgbd_count: expected " + std::to_string(rig.rgbd.size()) + ", got " +
                std::to_string(input.rgbd_count));
  }
  expect(input.rgbd != nullptr || input.rgbd_count == 0, "rgbd");
  frame = {};
  frame.index = pipeline.frames++;
  frame.name = std::to_string(frame.index);
  frame.stamp_s = input.stamp_s;
  frame.color = view<Bgr>(input.color, "color");
  for (std::size_t k = 0; k < rig.rgbd.size(); ++k) {
    RgbdFrame& images = frame.rgbd.emplace_back();
    const std::string& name = rig.rgbd[k].name;
    images.color = view<Bgr>(input.rgbd[k].color, name + " color");
    images.depth = view<std::uint16_t>(input.rgbd[k].depth, name + " depth");
    images.color_stamp_s = images.depth_stamp_s = input.stamp_s;
    const bool lacks_depth = images.depth.empty() && rig.rgbd[k].measures_depth;
    if (images.color.empty() || lacks_depth) images.missing = name + ": no images given";
  }
}

}  // namespace

const char* diminish_version(void) {
  return DIMINISH_VERSION;
}

const char* diminish_last_error(void) {
  return last_error.c_str();
}

diminish_status diminish_open(const char* folder, diminish_pipeline** pipeline) {
  return guarded([&] {
    expect(pipeline != nullptr, "pipeline");
    *pipeline = nullptr;
    expect(folder != nullptr, "folder");
    auto made = std::make_unique<diminish_pipeline>();
    made->setup = load_recording(folder);
    made->make_pipeline();
    *pipeline = made.release();
  });
}

size_t diminish_rgbd_count(const diminish_pipeline* pipeline) {
  return pipeline == nullptr ? 0 : pipeline->setup.rig.rgbd.size();
}

const char* diminish_rgbd_name(const diminish_pipeline* pipeline, size_t index) {
  if (index >= diminish_rgbd_count(pipeline)) return nullptr;
  return pipeline->setup.rig.rgbd[index].name.c_str();
}

diminish_status diminish_set_detector(diminish_pipeline* pipeline, const char* detector) {
  return guarded([&] {
    expect(pipeline != nullptr, "pipeline");
    expect(detector != nullptr, "detector");
    Scene scene = pipeline->setup.scene;
    scene.occluders = objects_of_detector(detector, "detector");
    std::swap(scene, pipeline->setup.scene);
    try {
      pipeline->make_pipeline();
    } catch (...) {
      std::swap(scene, pipeline->setup.scene);
      throw;
    }
  });
}

diminish_status diminish_set_option(diminish_pipeline* pipeline, const char* name,
                                    const char* value) {
  return guarded([&] {
    expect(pipeline != nullptr, "pipeline");
    expect(name != nullptr && value != nullptr, "name and value");
    Options options = pipeline->options;
    bool is_known = false;
    for_each_option(options, [&](const OptionInfo& info, auto& option) {
      if (std::string(name) != info.name) return;
      is_known = true;
      try {
        read_value(value, option);
      } catch (const Error& error) {
        throw Error(std::string(name) + ": " + error.what());
      }
    });
    if (!is_known) throw Error(printable(name) + ": there is no such option");
    pipeline->pipeline->set_options(options);
    pipeline->options = options;
  });
}

diminish_status diminish_process(diminish_pipeline* pipeline, const diminish_input* input,
                                 diminish_output* output) {
  return guarded([&] {
    expect(pipeline != nullptr, "pipeline");
    expect(input != nullptr && output != nullptr, "input and output");
    take(*input, *pipeline);
    pipeline->pipeline->process(pipeline->frame, pipeline->result);
    fill(*pipeline, *output);
  });
}

diminish_status diminish_next(diminish_pipeline* pipeline, diminish_output* output, int* more) {
  return guarded([&] {
    expect(pipeline != nullptr, "pipeline");
    expect(output != nullptr && more != nullptr, "output and more");
    *more = 0;
    if (!pipeline->source) pipeline->source = open_recording(pipeline->setup, pipeline->options);
    if (!pipeline->source->next(pipeline->frame)) return;
    pipeline->pipeline->process(pipeline->frame, pipeline->result);
    fill(*pipeline, *output);
    *more = 1;
  });
}

void diminish_close(diminish_pipeline* pipeline) {
  delete pipeline;
}
