// The GStreamer element `diminish`: what a setup's cameras see in, the picture without the objects
// out.
//
//   ... ! diminish.color  ... ! diminish.rgbd_color_0  ... ! diminish.rgbd_depth_0
//   diminish name=diminish setup=my-desk ! videoconvert ! autovideosink
#include <gst/base/gstaggregator.h>
#include <gst/video/video.h>

#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "rgbd_images.h"

#define PACKAGE "diminish"  // which GST_PLUGIN_DEFINE asks for

namespace {

using diminish::gst::look;
using diminish::gst::MappedImage;
using diminish::gst::Supply;

enum Property { none, setup_folder, detector, options, tolerance };

constexpr GstClockTime half_a_frame = GST_SECOND / 60;

GST_DEBUG_CATEGORY_STATIC(diminish_debug);
#define GST_CAT_DEFAULT diminish_debug

/// What an element has beside its pads; GObject's memory is not constructed.
struct State {
  std::string setup, detector, options;
  GstClockTime tolerance = half_a_frame;
  diminish_pipeline* pipeline = nullptr;
  double last_stamp_s = 0;
  GstAggregatorPad* color = nullptr;
  std::vector<std::pair<GstAggregatorPad*, GstAggregatorPad*>> rgbd;  ///< color, depth; null: none
};

struct GstDiminish {
  GstAggregator parent;
  State* state;
};
struct GstDiminishClass {
  GstAggregatorClass parent;
};

G_DEFINE_TYPE(GstDiminish, gst_diminish, GST_TYPE_AGGREGATOR)

GstDiminish* as_element(gpointer object) {
  return static_cast<GstDiminish*>(object);
}

GstStaticPadTemplate source_template = GST_STATIC_PAD_TEMPLATE(
    "src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(GST_VIDEO_CAPS_MAKE("BGR")));
GstStaticPadTemplate color_template = GST_STATIC_PAD_TEMPLATE(
    "color", GST_PAD_SINK, GST_PAD_REQUEST, GST_STATIC_CAPS(GST_VIDEO_CAPS_MAKE("BGR")));
GstStaticPadTemplate rgbd_color_template = GST_STATIC_PAD_TEMPLATE(
    "rgbd_color_%u", GST_PAD_SINK, GST_PAD_REQUEST, GST_STATIC_CAPS(GST_VIDEO_CAPS_MAKE("BGR")));
GstStaticPadTemplate rgbd_depth_template =
    GST_STATIC_PAD_TEMPLATE("rgbd_depth_%u", GST_PAD_SINK, GST_PAD_REQUEST,
                            GST_STATIC_CAPS(GST_VIDEO_CAPS_MAKE("GRAY16_LE")));

void set_property(GObject* object, guint id, const GValue* value, GParamSpec* spec) {
  State& state = *as_element(object)->state;
  const auto text = [value] {
    const char* given = g_value_get_string(value);
    return std::string(given == nullptr ? "" : given);
  };
  switch (id) {
    case setup_folder:
      state.setup = text();
      break;
    case detector:
      state.detector = text();
      break;
    case options:
      state.options = text();
      break;
    case tolerance:
      state.tolerance = g_value_get_uint64(value);
      break;
    default:
      G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, spec);
  }
}

void get_property(GObject* object, guint id, GValue* value, GParamSpec* spec) {
  const State& state = *as_element(object)->state;
  switch (id) {
    case setup_folder:
      g_value_set_string(value, state.setup.c_str());
      break;
    case detector:
      g_value_set_string(value, state.detector.c_str());
      break;
    case options:
      g_value_set_string(value, state.options.c_str());
      break;
    case tolerance:
      g_value_set_uint64(value, state.tolerance);
      break;
    default:
      G_OBJECT_WARN_INVALID_PROPERTY_ID(object, id, spec);
  }
}

/// "memory=off inpaint=surfaces"
diminish_status set_options(diminish_pipeline* pipeline, const std::string& text) {
  gchar** words = g_strsplit_set(text.c_str(), " ,", -1);
  diminish_status status = DIMINISH_OK;
  for (gchar** word = words; *word != nullptr && status == DIMINISH_OK; ++word) {
    if (**word == '\0') continue;
    const std::string option = *word;
    const std::size_t equals = option.find('=');
    const bool has_value = equals != std::string::npos;
    status = diminish_set_option(pipeline, option.substr(0, equals).c_str(),
                                 has_value ? option.substr(equals + 1).c_str() : "");
  }
  g_strfreev(words);
  return status;
}

gboolean start(GstAggregator* aggregator) {
  State& state = *as_element(aggregator)->state;
  diminish_status status = diminish_open(state.setup.c_str(), &state.pipeline);
  if (status == DIMINISH_OK && !state.detector.empty()) {
    status = diminish_set_detector(state.pipeline, state.detector.c_str());
  }
  if (status == DIMINISH_OK) status = set_options(state.pipeline, state.options);
  if (status == DIMINISH_OK && state.color == nullptr) {
    GST_ELEMENT_ERROR(aggregator, STREAM, WRONG_TYPE, ("color: expected to be linked"), (nullptr));
    return FALSE;
  }
  if (status == DIMINISH_OK && state.rgbd.size() > diminish_rgbd_count(state.pipeline)) {
    GST_ELEMENT_ERROR(aggregator, STREAM, WRONG_TYPE,
                      ("rgbd_color_%d: expected at most the setup's %d RGB-D cameras",
                       static_cast<int>(state.rgbd.size()) - 1,
                       static_cast<int>(diminish_rgbd_count(state.pipeline))),
                      (nullptr));
    return FALSE;
  }
  if (status == DIMINISH_OK) return TRUE;
  GST_ELEMENT_ERROR(aggregator, RESOURCE, OPEN_READ, ("%s", diminish_last_error()), (nullptr));
  return FALSE;
}

gboolean stop(GstAggregator* aggregator) {
  State& state = *as_element(aggregator)->state;
  diminish_close(state.pipeline);
  state.pipeline = nullptr;
  return TRUE;
}

GstAggregatorPad* create_new_pad(GstAggregator* aggregator, GstPadTemplate* pad_template,
                                 const gchar* name, const GstCaps* caps) {
  State& state = *as_element(aggregator)->state;
  const std::string kind = GST_PAD_TEMPLATE_NAME_TEMPLATE(pad_template);
  const auto make = [&](const std::string& pad_name) {
    return static_cast<GstAggregatorPad*>(g_object_new(GST_TYPE_AGGREGATOR_PAD, "name",
                                                       pad_name.c_str(), "direction", GST_PAD_SINK,
                                                       "template", pad_template, nullptr));
  };
  if (kind == "color") return state.color == nullptr ? state.color = make("color") : nullptr;
  if (kind != "rgbd_color_%u" && kind != "rgbd_depth_%u") {
    return GST_AGGREGATOR_CLASS(gst_diminish_parent_class)
        ->create_new_pad(aggregator, pad_template, name, caps);
  }
  const bool is_depth = kind == "rgbd_depth_%u";
  const auto pad_of = [is_depth](auto& both) -> GstAggregatorPad*& {
    return is_depth ? both.second : both.first;
  };
  std::size_t index = 0;
  if (name != nullptr && std::strchr(name, '%') == nullptr) {
    index = g_ascii_strtoull(name + kind.size() - std::strlen("%u"), nullptr, 10);
  } else {
    while (index < state.rgbd.size() && pad_of(state.rgbd[index]) != nullptr) ++index;
  }
  constexpr std::size_t most_cameras = 253;
  if (index >= most_cameras) return nullptr;
  if (state.rgbd.size() <= index) state.rgbd.resize(index + 1);
  GstAggregatorPad*& place = pad_of(state.rgbd[index]);
  if (place != nullptr) return nullptr;
  return place = make(kind.substr(0, kind.size() - 2) + std::to_string(index));
}

void release_pad(GstElement* gst_element, GstPad* pad) {
  State& state = *as_element(gst_element)->state;
  const auto forget = [pad](GstAggregatorPad*& place) {
    if (GST_PAD(place) == pad) place = nullptr;
  };
  if (state.color != nullptr) forget(state.color);
  for (auto& [color, depth] : state.rgbd) {
    if (color != nullptr) forget(color);
    if (depth != nullptr) forget(depth);
  }
  GST_ELEMENT_CLASS(gst_diminish_parent_class)->release_pad(gst_element, pad);
}

/// The result is like the user's view.
GstFlowReturn update_src_caps(GstAggregator* aggregator, GstCaps*, GstCaps** result) {
  const State& state = *as_element(aggregator)->state;
  *result = state.color == nullptr ? nullptr : gst_pad_get_current_caps(GST_PAD(state.color));
  return *result == nullptr ? GST_AGGREGATOR_FLOW_NEED_DATA : GST_FLOW_OK;
}

GstFlowReturn send(GstAggregator* aggregator, const diminish_output& output, GstClockTime stamp,
                   GstClockTime duration) {
  GstCaps* caps = gst_pad_get_current_caps(aggregator->srcpad);
  GstVideoInfo info;
  const bool is_known = caps != nullptr && gst_video_info_from_caps(&info, caps) != FALSE;
  if (caps != nullptr) gst_caps_unref(caps);
  if (!is_known) return GST_FLOW_NOT_NEGOTIATED;
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, info.size, nullptr);
  GstVideoFrame frame;
  if (gst_video_frame_map(&frame, &info, buffer, GST_MAP_WRITE) == FALSE) {
    gst_buffer_unref(buffer);
    return GST_FLOW_ERROR;
  }
  constexpr int channels = 3;
  const auto* from = static_cast<const guint8*>(output.picture.data);
  auto* to = static_cast<guint8*>(GST_VIDEO_FRAME_PLANE_DATA(&frame, 0));
  for (int y = 0; y < output.picture.height; ++y) {
    std::memcpy(to + std::ptrdiff_t{y} * GST_VIDEO_FRAME_PLANE_STRIDE(&frame, 0),
                from + y * output.picture.stride,
                static_cast<std::size_t>(output.picture.width) * channels);
  }
  gst_video_frame_unmap(&frame);
  GST_BUFFER_PTS(buffer) = stamp;
  GST_BUFFER_DURATION(buffer) = duration;
  GST_AGGREGATOR_PAD(aggregator->srcpad)->segment.position = stamp;
  return gst_aggregator_finish_buffer(aggregator, buffer);
}

/// One frame: the next picture of the user's view, with what the RGB-D cameras saw at that moment.
GstFlowReturn aggregate(GstAggregator* aggregator, gboolean timeout) {
  State& state = *as_element(aggregator)->state;
  GstBuffer* next = gst_aggregator_pad_peek_buffer(state.color);
  if (next == nullptr) {
    const bool is_over = gst_aggregator_pad_is_eos(state.color) != FALSE;
    return is_over ? GST_FLOW_EOS : GST_AGGREGATOR_FLOW_NEED_DATA;
  }
  const MappedImage color(state.color, next);
  const GstClockTime stamp = GST_BUFFER_PTS(next);

  std::vector<diminish_rgbd> rgbd(diminish_rgbd_count(state.pipeline));
  std::vector<std::pair<GstAggregatorPad*, diminish_image*>> taken;
  const auto look_at = [&](GstAggregatorPad* pad, diminish_image* place) {
    if (pad == nullptr) return true;
    const Supply supply = look(pad, stamp, state.tolerance);
    if (supply == Supply::now) taken.emplace_back(pad, place);
    return supply != Supply::not_yet;
  };
  bool is_complete = true;
  for (std::size_t k = 0; k < state.rgbd.size(); ++k) {
    is_complete = look_at(state.rgbd[k].first, &rgbd[k].color) && is_complete;
    is_complete = look_at(state.rgbd[k].second, &rgbd[k].depth) && is_complete;
  }
  // Live, a camera that is late is left out.
  if (!is_complete && timeout == FALSE) return GST_AGGREGATOR_FLOW_NEED_DATA;

  std::vector<std::unique_ptr<MappedImage>> images;
  for (const auto& [pad, place] : taken) {
    images.push_back(std::make_unique<MappedImage>(pad, gst_aggregator_pad_pop_buffer(pad)));
    *place = images.back()->view();
  }
  gst_aggregator_pad_drop_buffer(state.color);
  const double stamp_s = GST_CLOCK_TIME_IS_VALID(stamp) ? static_cast<double>(stamp) / GST_SECOND
                                                        : state.last_stamp_s + 1.0 / 30;
  state.last_stamp_s = stamp_s;
  const diminish_input input{color.view(), rgbd.data(), rgbd.size(), stamp_s};
  diminish_output output{};
  if (diminish_process(state.pipeline, &input, &output) != DIMINISH_OK) {
    GST_ELEMENT_ERROR(aggregator, STREAM, FAILED, ("%s", diminish_last_error()), (nullptr));
    return GST_FLOW_ERROR;
  }
  if (*output.messages != '\0') GST_INFO_OBJECT(aggregator, "%s", output.messages);
  return send(aggregator, output, stamp, GST_BUFFER_DURATION(next));
}

void finalize(GObject* object) {
  delete as_element(object)->state;
  G_OBJECT_CLASS(gst_diminish_parent_class)->finalize(object);
}

void gst_diminish_init(GstDiminish* self) {
  self->state = new State;
}

void add_properties(GObjectClass* object_class) {
  const auto flags = static_cast<GParamFlags>(G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS |
                                              GST_PARAM_MUTABLE_READY);
  g_object_class_install_property(
      object_class, setup_folder,
      g_param_spec_string("setup", "Setup", "The folder with rig.yaml and scene.yaml", "", flags));
  g_object_class_install_property(
      object_class, detector,
      g_param_spec_string("detector", "Detector",
                          "Remove what this detector finds, such as difference, instead of the "
                          "objects in scene.yaml",
                          "", flags));
  g_object_class_install_property(
      object_class, options,
      g_param_spec_string("options", "Options",
                          "Options of the pipeline, such as \"memory=off inpaint=surfaces\"", "",
                          flags));
  g_object_class_install_property(
      object_class, tolerance,
      g_param_spec_uint64("tolerance", "Tolerance",
                          "Largest difference in time between a picture and the RGB-D cameras' "
                          "images that belong to it, in nanoseconds",
                          0, GST_SECOND, half_a_frame, flags));
}

void gst_diminish_class_init(GstDiminishClass* klass) {
  GObjectClass* object_class = G_OBJECT_CLASS(klass);
  object_class->set_property = set_property;
  object_class->get_property = get_property;
  object_class->finalize = finalize;
  add_properties(object_class);

  GstElementClass* element_class = GST_ELEMENT_CLASS(klass);
  element_class->release_pad = release_pad;
  gst_element_class_add_static_pad_template_with_gtype(element_class, &source_template,
                                                       GST_TYPE_AGGREGATOR_PAD);
  for (GstStaticPadTemplate* sink : {&color_template, &rgbd_color_template, &rgbd_depth_template}) {
    gst_element_class_add_static_pad_template_with_gtype(element_class, sink,
                                                         GST_TYPE_AGGREGATOR_PAD);
  }
  gst_element_class_set_static_metadata(
      element_class, "Diminished reality", "Filter/Effect/Video",
      "Removes real objects from a camera's picture and shows what RGB-D cameras see behind them",
      "The diminish developers");

  GstAggregatorClass* aggregator_class = GST_AGGREGATOR_CLASS(klass);
  aggregator_class->start = start;
  aggregator_class->stop = stop;
  aggregator_class->create_new_pad = create_new_pad;
  aggregator_class->update_src_caps = update_src_caps;
  aggregator_class->aggregate = aggregate;
  GST_DEBUG_CATEGORY_INIT(diminish_debug, "diminish", 0, "diminished reality");
}

gboolean register_element(GstPlugin* plugin) {
  return gst_element_register(plugin, "diminish", GST_RANK_NONE, gst_diminish_get_type());
}

}  // namespace

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, diminish, "Diminished reality",
                  register_element, DIMINISH_VERSION, "Apache 2.0", "diminish", "diminish")
