#include "sink/video_file.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

#include <string_view>
#include <utility>

#include "diminish/error.h"
#include "sink/partial_file.h"

namespace diminish {
namespace {

void expect(bool works, const char* what) {
  if (!works) throw Error(Error::io, what);
}

const AVCodec* find_encoder() {
  const AVCodec* x264 = avcodec_find_encoder_by_name("libx264");
  return x264 ? x264 : avcodec_find_encoder(AV_CODEC_ID_MPEG4);
}

struct Free {
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  void operator()(SwsContext* context) const { sws_freeContext(context); }
  void operator()(AVFormatContext* context) const {
    avio_closep(&context->pb);
    avformat_free_context(context);
  }
};
template <class Thing>
using Owned = std::unique_ptr<Thing, Free>;

}  // namespace

/// Uses FFmpeg itself: OpenCV cannot choose x264's preset, and the usual one takes three times as
/// long, more than all else that is done for a frame. Throws Error without the file's name.
class VideoFile::Writer {
 public:
  /// Encoders need even sizes, so the last column or row of an odd one is dropped.
  Writer(const std::filesystem::path& target, double frames_per_second, int width, int height)
      : file_(target) {
    av_log_set_level(AV_LOG_ERROR);  // for the whole process, as OpenCV does
    const AVCodec* const encoder = find_encoder();
    expect(encoder, "FFmpeg has no encoder for MP4 here");
    encoder_.reset(avcodec_alloc_context3(encoder));
    encoder_->width = width & ~1;
    encoder_->height = height & ~1;
    encoder_->pix_fmt = AV_PIX_FMT_YUV420P;
    constexpr int largest_denominator = 100000;
    encoder_->framerate = av_d2q(frames_per_second, largest_denominator);
    encoder_->time_base = av_inv_q(encoder_->framerate);
    encoder_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    encoder_->thread_count = 0;  // one per core
    if (encoder->name == std::string_view("libx264")) {
      av_opt_set(encoder_->priv_data, "preset", "veryfast", 0);
    } else {
      encoder_->flags |= AV_CODEC_FLAG_QSCALE;
      encoder_->global_quality = 3 * FF_QP2LAMBDA;
    }
    expect(avcodec_open2(encoder_.get(), encoder, nullptr) >= 0, "the encoder does not open");

    AVFormatContext* container = nullptr;
    avformat_alloc_output_context2(&container, nullptr, "mp4", nullptr);
    container_.reset(container);
    stream_ = avformat_new_stream(container, nullptr);
    avcodec_parameters_from_context(stream_->codecpar, encoder_.get());
    stream_->time_base = encoder_->time_base;
    stream_->avg_frame_rate = encoder_->framerate;
    expect(avio_open(&container->pb, file_.path().c_str(), AVIO_FLAG_WRITE) >= 0 &&
               avformat_write_header(container, nullptr) >= 0,
           "the file cannot be written");

    converter_.reset(sws_getContext(encoder_->width, encoder_->height, AV_PIX_FMT_BGR24,
                                    encoder_->width, encoder_->height, encoder_->pix_fmt,
                                    SWS_BILINEAR, nullptr, nullptr, nullptr));
  }

  void append(const Image<Bgr>& picture) {
    // The encoder may still hold the last one, so each is new.
    av_frame_unref(frame_.get());
    frame_->format = encoder_->pix_fmt;
    frame_->width = encoder_->width;
    frame_->height = encoder_->height;
    frame_->pts = frames_++;
    expect(av_frame_get_buffer(frame_.get(), 0) >= 0, "no memory");
    const auto* const pixels = reinterpret_cast<const std::uint8_t*>(picture.data());
    const int stride = picture.width() * static_cast<int>(sizeof(Bgr));
    sws_scale(converter_.get(), &pixels, &stride, 0, encoder_->height, frame_->data,
              frame_->linesize);
    encode(frame_.get());
  }

  void finish() {
    encode(nullptr);
    expect(av_write_trailer(container_.get()) >= 0 && avio_closep(&container_->pb) >= 0,
           "the file cannot be written");
    file_.commit();
  }

 private:
  /// Null: what the encoder still holds.
  void encode(const AVFrame* frame) {
    expect(avcodec_send_frame(encoder_.get(), frame) >= 0, "a picture cannot be encoded");
    while (avcodec_receive_packet(encoder_.get(), packet_.get()) >= 0) {
      av_packet_rescale_ts(packet_.get(), encoder_->time_base, stream_->time_base);
      packet_->stream_index = stream_->index;
      expect(av_interleaved_write_frame(container_.get(), packet_.get()) >= 0,
             "the file cannot be written");
    }
  }

  PartialFile file_;
  Owned<AVCodecContext> encoder_;
  Owned<AVFormatContext> container_;
  AVStream* stream_ = nullptr;
  Owned<SwsContext> converter_;
  Owned<AVFrame> frame_{av_frame_alloc()};
  Owned<AVPacket> packet_{av_packet_alloc()};
  std::int64_t frames_ = 0;
};

VideoFile::VideoFile(std::filesystem::path file, double frames_per_second)
    : file_(std::move(file)), frames_per_second_(frames_per_second > 0 ? frames_per_second : 30) {}
VideoFile::~VideoFile() = default;

void VideoFile::append(const Image<Bgr>& picture) {
  attempt([&] {
    if (!writer_) {
      writer_ =
          std::make_unique<Writer>(file_, frames_per_second_, picture.width(), picture.height());
    }
    writer_->append(picture);
  });
}

std::string VideoFile::finish() {
  attempt([&] {
    if (writer_) writer_->finish();
    writer_.reset();
  });
  return problem_;
}

template <class Action>
void VideoFile::attempt(const Action& action) {
  if (!problem_.empty()) return;
  try {
    action();
  } catch (const Error& error) {
    problem_ = file_.string() + ": not written: " + error.what();
    writer_.reset();
  }
}

}  // namespace diminish
