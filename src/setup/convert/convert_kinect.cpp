#include <fmt/format.h>

#include <array>
#include <fstream>
#include <memory>
#include <optional>
#include <string_view>

#include "core/text.h"
#include "diminish/error.h"
#include "setup/convert/convert.h"
#include "setup/convert/converted_recording.h"
#include "setup/convert/kinect_calibration.h"
#include "sink/recording_folder.h"
#include "source/image_header.h"

extern "C" {
#include <libavformat/avformat.h>
}

namespace diminish {
namespace {

constexpr std::size_t most_told = 5;

struct CloseInput {
  void operator()(AVFormatContext* context) const { avformat_close_input(&context); }
};
using Container = std::unique_ptr<AVFormatContext, CloseInput>;
struct FreePacket {
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};
using Packet = std::unique_ptr<AVPacket, FreePacket>;

Container open(const std::filesystem::path& file) {
  // It would write to the program's standard error.
  av_log_set_level(AV_LOG_QUIET);
  AVFormatContext* context = nullptr;
  const AVInputFormat* const format = av_find_input_format("matroska");
  // Local files only, whatever the name looks like.
  const std::string url = "file:" + std::filesystem::absolute(file).string();
  if (avformat_open_input(&context, url.c_str(), format, nullptr) != 0) {
    throw Error(Error::input, "expected a Matroska file (.mkv) of an Azure Kinect");
  }
  return Container(context);
}

std::string tag(const AVDictionary* tags, const char* name) {
  const AVDictionaryEntry* const entry = av_dict_get(tags, name, nullptr, 0);
  return entry ? entry->value : "";
}

/// The track that the recorder calls so: by its tag, or by its name.
const AVStream& track(const AVFormatContext& container, std::string_view name) {
  for (unsigned i = 0; i < container.nb_streams; ++i) {
    const AVStream& stream = *container.streams[i];
    if (stream.codecpar->codec_type == AVMEDIA_TYPE_ATTACHMENT) continue;
    if (!tag(stream.metadata, fmt::format("K4A_{}_TRACK", name).c_str()).empty()) return stream;
    if (tag(stream.metadata, "title") == name) return stream;
  }
  throw Error(Error::input,
              fmt::format("expected an Azure Kinect's recording with the track {}", name));
}

/// The attachment that the recorder calls so: by its tag, or by its usual name.
std::string_view calibration_of(const AVFormatContext& container) {
  constexpr const char* name = "calibration.json";
  for (unsigned i = 0; i < container.nb_streams; ++i) {
    const AVCodecParameters& part = *container.streams[i]->codecpar;
    if (part.codec_type != AVMEDIA_TYPE_ATTACHMENT) continue;
    const AVDictionary* const tags = container.streams[i]->metadata;
    if (tag(tags, "K4A_CALIBRATION_FILE").empty() && tag(tags, "filename") != name) continue;
    return {reinterpret_cast<const char*>(part.extradata),
            static_cast<std::size_t>(part.extradata_size)};
  }
  throw Error(Error::input,
              fmt::format("expected an Azure Kinect's recording with {} in it", name));
}

cv::Size size_of(const AVStream& stream) {
  return {stream.codecpar->width, stream.codecpar->height};
}

double stamp_s(const AVStream& stream, const AVPacket& packet) {
  return static_cast<double>(packet.pts) * av_q2d(stream.time_base);
}

/// 16 bits, the most significant byte first.
Image<std::uint16_t> depth_of(std::span<const std::uint8_t> bytes, cv::Size size) {
  const std::size_t expected = static_cast<std::size_t>(size.width) * size.height * 2;
  if (bytes.size() != expected) {
    throw Error(Error::input,
                fmt::format("expected {} bytes of depth, got {}", expected, bytes.size()));
  }
  Image<std::uint16_t> depth(size.width, size.height);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    depth.data()[i] = static_cast<std::uint16_t>(bytes[2 * i] << 8 | bytes[2 * i + 1]);
  }
  return depth;
}

void expect_jpeg(std::span<const std::uint8_t> bytes, cv::Size size) {
  const auto declared = is_jpeg(bytes) ? declared_size(bytes) : std::nullopt;
  if (declared == size) return;
  throw Error(Error::input, fmt::format("expected a JPEG of {}x{}", size.width, size.height));
}

/// Copies the file's packets into the recording's streams.
class Copy {
 public:
  Copy(AVFormatContext& container, const AVStream& color, const AVStream& depth,
       const std::filesystem::path& recording)
      : container_(container),
        color_(color),
        depth_(depth),
        users_view_(recording, "color"),
        color_out_(recording, "rgbd0_color"),
        depth_out_(recording, "rgbd0_depth") {}

  Conversion run() {
    const Packet packet(av_packet_alloc());
    while (av_read_frame(&container_, packet.get()) >= 0) {
      try {
        take(*packet);
      } catch (const Error& error) {
        if (error.category() != Error::input) throw;
        ++conversion_.left_out;
        if (conversion_.problems.size() < most_told) {
          conversion_.problems.emplace_back(error.what());
        }
      }
      av_packet_unref(packet.get());
    }
    conversion_.streams = {{"color", "COLOR", users_view_.images()},
                           {"rgbd0_color", "COLOR", color_out_.images()},
                           {"rgbd0_depth", "DEPTH", depth_out_.images()}};
    return std::move(conversion_);
  }

 private:
  void take(const AVPacket& packet) {
    const std::span<const std::uint8_t> bytes(packet.data, static_cast<std::size_t>(packet.size));
    bool is_taken = true;
    if (packet.stream_index == color_.index) {
      expect_jpeg(bytes, size_of(color_));
      const double time_s = stamp_s(color_, packet);
      is_taken = color_out_.add(time_s, {reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                                ".jpg");
      if (is_taken) users_view_.add_file(time_s, color_out_.last_file());
    } else if (packet.stream_index == depth_.index) {
      is_taken = depth_out_.add(stamp_s(depth_, packet), depth_of(bytes, size_of(depth_)));
    }
    if (!is_taken) ++conversion_.left_out;
  }

  AVFormatContext& container_;
  const AVStream &color_, &depth_;
  ConvertedStream users_view_, color_out_, depth_out_;
  Conversion conversion_;
};

}  // namespace

bool is_matroska(const std::filesystem::path& file) {
  constexpr std::array<unsigned char, 4> ebml = {0x1A, 0x45, 0xDF, 0xA3};
  std::array<char, 4> first{};
  std::ifstream(file, std::ios::binary).read(first.data(), first.size());
  return std::equal(first.begin(), first.end(), ebml.begin(),
                    [](char a, unsigned char b) { return static_cast<unsigned char>(a) == b; });
}

Conversion convert_kinect(const std::filesystem::path& file,
                          const std::filesystem::path& recording) {
  try {
    const Container container = open(file);
    const AVStream& color = track(*container, "COLOR");
    const AVStream& depth = track(*container, "DEPTH");
    if (color.codecpar->codec_id != AV_CODEC_ID_MJPEG) {
      throw Error(Error::input, "expected colour as MJPEG, the recorder's default");
    }
    const KinectCalibration calibration =
        read_kinect_calibration(calibration_of(*container), size_of(color), size_of(depth));
    Rig rig;
    rig.color = calibration.color;
    rig.rgbd.push_back({.name = "rgbd0",
                        .color = calibration.color,
                        .depth = calibration.depth,
                        .depth_unit_m = 0.001,
                        .color_from_depth = calibration.color_from_depth});
    make_recording_folder(recording);
    Conversion conversion = Copy(*container, color, depth, recording).run();
    write_set_up(recording, rig, true, "");
    return conversion;
  } catch (const Error& error) {
    const std::string message = error.what();
    if (error.category() != Error::input) throw;
    throw Error(Error::input, file.string() + ": " + message);
  }
}

}  // namespace diminish
