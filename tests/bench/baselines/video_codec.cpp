// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/video_codec.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/opt.h>
}

#include <cstring>

#include "tests/bench/baselines/yuv_picture.h"

namespace farfield::bench {
namespace {

template <auto Free>
struct FreeWith {
  template <class T>
  void operator()(T* pointer) const {
    Free(&pointer);
  }
};
using Context = std::unique_ptr<AVCodecContext, FreeWith<avcodec_free_context>>;
using Picture = std::unique_ptr<AVFrame, FreeWith<av_frame_free>>;
using Packet = std::unique_ptr<AVPacket, FreeWith<av_packet_free>>;

std::string reason(int error) {
  char text[AV_ERROR_MAX_STRING_SIZE] = {};
  av_strerror(error, text, sizeof text);
  return text;
}

int chroma_step(int format) {
  return format == AV_PIX_FMT_YUV444P ? 1 : 2;
}

}  // namespace

struct VideoEncoder::State {
  VideoSettings settings;
  Context context;
  Picture picture{av_frame_alloc()};
  Packet packet{av_packet_alloc()};
  std::int64_t count = 0;
};

VideoEncoder::VideoEncoder(std::unique_ptr<State> state) : state_(std::move(state)) {}
VideoEncoder::VideoEncoder(VideoEncoder&&) noexcept = default;
VideoEncoder::~VideoEncoder() = default;

Result<VideoEncoder> VideoEncoder::create(const VideoSettings& settings) {
  if (settings.width <= 0 || settings.height <= 0 || settings.width % 2 || settings.height % 2)
    return fail(ErrorCode::kInvalidArgument, "{}x{}: video needs even sizes", settings.width, settings.height);
  av_log_set_level(AV_LOG_QUIET);  // failures are told by our own one line
  const AVCodec* codec = avcodec_find_encoder_by_name("libx264");
  if (!codec) return fail(ErrorCode::kUnavailable, "libavcodec has no libx264");
  auto state = std::make_unique<State>();
  state->settings = settings;
  state->context.reset(avcodec_alloc_context3(codec));
  AVCodecContext& c = *state->context;
  c.width = settings.width, c.height = settings.height;
  c.pix_fmt = settings.has_full_chroma ? AV_PIX_FMT_YUV444P : AV_PIX_FMT_YUV420P;
  c.time_base = av_d2q(1 / settings.pictures_per_second, 1'000'000);
  c.framerate = av_inv_q(c.time_base);
  c.gop_size = 1'000'000, c.max_b_frames = 0;
  c.colorspace = AVCOL_SPC_BT709, c.color_primaries = AVCOL_PRI_BT709, c.color_trc = AVCOL_TRC_IEC61966_2_1,
  c.color_range = AVCOL_RANGE_MPEG;
  av_opt_set(c.priv_data, "preset", "superfast", 0);
  av_opt_set(c.priv_data, "tune", "zerolatency", 0);
  if (settings.kbit_s > 0) {
    c.bit_rate = c.rc_max_rate = static_cast<std::int64_t>(1000 * settings.kbit_s);
    c.rc_buffer_size = static_cast<int>(c.bit_rate);
  } else {
    av_opt_set_double(c.priv_data, "crf", settings.crf, 0);
  }
  if (const int error = avcodec_open2(&c, codec, nullptr); error < 0)
    return fail(ErrorCode::kUnavailable, "x264 does not start: {}", reason(error));
  state->picture->format = c.pix_fmt, state->picture->width = c.width, state->picture->height = c.height;
  if (const int error = av_frame_get_buffer(state->picture.get(), 0); error < 0)
    return fail(ErrorCode::kInternal, "no picture buffer: {}", reason(error));
  return VideoEncoder(std::move(state));
}

Result<Bytes> VideoEncoder::encode(std::span<const std::uint8_t> rgb) {
  State& s = *state_;
  if (const int error = av_frame_make_writable(s.picture.get()); error < 0)
    return fail(ErrorCode::kInternal, "no picture buffer: {}", reason(error));
  AVFrame& p = *s.picture;
  rgb_to_yuv(rgb, p.width, p.height, chroma_step(p.format),
             {{p.data[0], p.linesize[0]}, {p.data[1], p.linesize[1]}, {p.data[2], p.linesize[2]}});
  s.picture->pts = s.count++;
  if (const int error = avcodec_send_frame(s.context.get(), s.picture.get()); error < 0)
    return fail(ErrorCode::kInternal, "x264: {}", reason(error));
  if (const int error = avcodec_receive_packet(s.context.get(), s.packet.get()); error < 0)
    return fail(ErrorCode::kInternal, "x264 gives no picture at once: {}", reason(error));
  Bytes bytes(s.packet->data, s.packet->data + s.packet->size);
  av_packet_unref(s.packet.get());
  return bytes;
}

struct VideoDecoder::State {
  Context context;
  Picture picture{av_frame_alloc()};
  Packet packet{av_packet_alloc()};
};

VideoDecoder::VideoDecoder(std::unique_ptr<State> state) : state_(std::move(state)) {}
VideoDecoder::VideoDecoder(VideoDecoder&&) noexcept = default;
VideoDecoder::~VideoDecoder() = default;

Result<VideoDecoder> VideoDecoder::create() {
  av_log_set_level(AV_LOG_QUIET);
  const AVCodec* codec = avcodec_find_decoder(AV_CODEC_ID_H264);
  if (!codec) return fail(ErrorCode::kUnavailable, "libavcodec has no H.264 decoder");
  auto state = std::make_unique<State>();
  state->context.reset(avcodec_alloc_context3(codec));
  // Threads inside a picture only: one per picture would hold pictures back.
  state->context->thread_type = FF_THREAD_SLICE, state->context->thread_count = 0;
  state->context->flags |= AV_CODEC_FLAG_LOW_DELAY;
  if (const int error = avcodec_open2(state->context.get(), codec, nullptr); error < 0)
    return fail(ErrorCode::kUnavailable, "the H.264 decoder does not start: {}", reason(error));
  return VideoDecoder(std::move(state));
}

Result<std::vector<std::uint8_t>> VideoDecoder::decode(const Bytes& picture) {
  State& s = *state_;
  if (const int error = av_new_packet(s.packet.get(), static_cast<int>(picture.size())); error < 0)
    return fail(ErrorCode::kInternal, "no packet: {}", reason(error));
  std::memcpy(s.packet->data, picture.data(), picture.size());
  int error = avcodec_send_packet(s.context.get(), s.packet.get());
  av_packet_unref(s.packet.get());
  if (error >= 0) error = avcodec_receive_frame(s.context.get(), s.picture.get());
  if (error < 0) return fail(ErrorCode::kBadData, "H.264: {}", reason(error));
  const AVFrame& p = *s.picture;
  if (p.format != AV_PIX_FMT_YUV420P && p.format != AV_PIX_FMT_YUV444P)
    return fail(ErrorCode::kBadData, "H.264: pixel format {} is none of ours", p.format);
  return yuv_to_rgb({{p.data[0], p.linesize[0]}, {p.data[1], p.linesize[1]}, {p.data[2], p.linesize[2]}}, p.width, p.height,
                    chroma_step(p.format));
}

}  // namespace farfield::bench
