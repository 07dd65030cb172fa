// SPDX-License-Identifier: Apache-2.0
#include "client/frame/frame_renderer.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>

#include "client/frame/leaf_fade.h"
#include "client/frame/mix_frames.h"
#include "client/frame/resolve_gl_frame.h"
#include "client/gl/framebuffer.h"
#include "client/near_cpu/near_raster.h"
#include "client/warp/cpu_warper.h"
#include "client/warp/smooth_edges.h"

namespace farfield::client {
namespace {

using Clock = std::chrono::steady_clock;

/// Milliseconds since the last call.
class Lap {
 public:
  double operator()() {
    const Clock::time_point now = Clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
    return ms;
  }

 private:
  Clock::time_point last_ = Clock::now();
};

/// Close enough that nobody gets their nose behind it: a thousandth of the cell. A depth buffer that is not exact at a distance
/// resolves 2⁻²⁴ of 1/near_plane, so the plane moves out to keep far shells apart.
double near_plane_of(const LeafView& leaf, bool is_exact_at_distance) {
  return leaf.leaf_box.extent().x * (is_exact_at_distance ? 1e-3 : 1e-2);
}

/// Pixels of the CPU warper: its 2×2 samples are so many.
Display warped_display(const Display& display, int samples) {
  if (samples == 1) return display;
  return {2 * display.width, 2 * display.height, display.fovy_rad};
}

/// Of the CPU's frames: keys of the largest take 2 GB.
constexpr int kMaxFrameEdge = 16384;

}  // namespace

struct FrameRenderer::State {
  Renderer renderer = Renderer::kCpu;
  Display display;
  FrameOptions options;
  std::unique_ptr<GlContext> own_context;  // destroyed last
  GlAbilities abilities;
  Framebuffer target;
  std::unique_ptr<NearRenderer> near;  // kGl, and the context, the target and all until the warper
  std::unique_ptr<ImpostorRenderer> impostors;
  std::vector<std::uint8_t> colour;    // read back
  std::vector<float> depth;
  EdgeSmoother edges;                  // of frames with one sample per pixel
  std::shared_ptr<const LeafView> drawn;
  std::unique_ptr<CpuWarper> warper;   // kCpu
  std::unique_ptr<NearRaster> raster;
  LeafFade fade{0};
  Frame former;                        // while a leaf set fades: its frame

  Status make_target(const Display& size);
  void render_cpu(const LeafView& leaf, const Pose& eye, Frame& frame, FrameReport& report);
  void render_gl(const LeafView& leaf, const Pose& eye, Frame& frame, FrameReport& report);
  void render_leaf(const LeafView& leaf, const Pose& eye, Frame& frame, FrameReport& report) {
    renderer == Renderer::kCpu ? render_cpu(leaf, eye, frame, report) : render_gl(leaf, eye, frame, report);
  }
};

Status FrameRenderer::State::make_target(const Display& size) {
  if (renderer == Renderer::kCpu) {
    if (std::min(size.width, size.height) < 1 || std::max(size.width, size.height) > kMaxFrameEdge)
      return fail(ErrorCode::kLimitExceeded, "frame of {} x {} pixels: 1 to {} are possible along an edge", size.width, size.height, kMaxFrameEdge);
    display = size;
    return {};
  }
  Result<Framebuffer> made = Framebuffer::create(abilities, size.width, size.height, options.samples_per_pixel);
  if (!made) return tl::unexpected<Error>(made.error());
  target = std::move(*made);
  display = size;
  return {};
}

void FrameRenderer::State::render_cpu(const LeafView& leaf, const Pose& eye, Frame& frame, FrameReport& report) {
  Lap lap;
  if (!leaf.chunks.empty()) {
    report.near = raster->begin(leaf, eye, warped_display(display, options.samples_per_pixel), near_plane_of(leaf, true));
    report.times.near_ms = lap();
  }
  warper->draw(leaf, eye, display, leaf.chunks.empty() ? nullptr : raster.get(), frame);
  report.times.impostors_ms = lap();
}

void FrameRenderer::State::render_gl(const LeafView& leaf, const Pose& eye, Frame& frame, FrameReport& report) {
  Lap lap;
  const double near_plane = near_plane_of(leaf, abilities.has_clip_control);
  const ViewTransform view = ViewTransform::of(display, eye, near_plane);
  target.begin();
  report.near = near->draw(leaf, view);
  // Waiting here would only serve the clock: without a GPU it costs nothing, with one it would idle it.
  if (abilities.is_software) glFinish();
  report.times.near_ms = lap();
  report.impostors = impostors->draw(leaf, view);
  target.resolve();
  glFinish();
  report.times.impostors_ms += lap();
  const std::size_t pixels = static_cast<std::size_t>(display.width) * static_cast<std::size_t>(display.height);
  colour.resize(4 * pixels);
  depth.resize(pixels);
  target.read_colour(colour);
  target.read_depth(depth);
  report.times.read_back_ms = lap();
  frame.statistics = {};
  resolve_gl_frame({display.width, display.height, colour, depth, near_plane},
                   {leaf.background,
                    {leaf.background_visible ? leaf.sky : DirectionMask(),
                     glm::dmat3(glm::mat3_cast(eye.world_from_camera)), display}},
                   frame);
  if (options.samples_per_pixel == 1) edges.smooth(frame);
  frame.statistics.triangles_drawn = report.impostors.triangles;
  frame.statistics.tiles_drawn = report.impostors.tiles_drawn;
  report.times.resolve_ms = lap();
}

std::size_t store_bytes(std::size_t memory_bytes, Renderer renderer, bool is_software) {
  if (renderer == Renderer::kCpu || !is_software) return memory_bytes;
  // More than the budget: pages in use stay even beyond it, in a dense plant a third, and the multisampled frame buffers
  // stand beside them.
  return memory_bytes - std::min(memory_bytes * 3 / 5, FrameOptions().impostors.budget_bytes * 8 / 5);
}

FrameRenderer::FrameRenderer() = default;
FrameRenderer::~FrameRenderer() = default;

Result<std::unique_ptr<FrameRenderer>> FrameRenderer::create(Renderer renderer, const Display& display,
                                                             const FrameOptions& options, GlContext* context) {
  const int wanted = options.samples_per_pixel;
  if (wanted != FrameOptions::kChosen && wanted != 1 && wanted != 4)
    return fail(ErrorCode::kInvalidArgument, "{} samples per pixel: 1 and 4 are possible", wanted);
  std::unique_ptr<FrameRenderer> result(new FrameRenderer);
  result->state_ = std::make_unique<State>();
  State& s = *result->state_;
  s.renderer = renderer, s.options = options, s.fade = LeafFade(options.fade_seconds);
  if (wanted == FrameOptions::kChosen) s.options.samples_per_pixel = 1;
  if (renderer == Renderer::kCpu) {
    if (Status made = s.make_target(display); !made) return tl::unexpected<Error>(made.error());
    s.warper = std::make_unique<CpuWarper>(CpuWarperOptions{s.options.samples_per_pixel, options.cpu_threads});
    s.raster = std::make_unique<NearRaster>(options.near);
    return result;
  }
  if (!context) {
    Result<std::unique_ptr<GlContext>> own = GlContext::create_surfaceless();
    if (!own) return tl::unexpected<Error>(own.error());
    s.own_context = std::move(*own);
    context = s.own_context.get();
  }
  s.abilities = context->abilities();
  if (wanted == FrameOptions::kChosen && !s.abilities.is_software) s.options.samples_per_pixel = 4;
  if (Status made = s.make_target(display); !made) return tl::unexpected<Error>(made.error());
  Result<std::unique_ptr<NearRenderer>> near = NearRenderer::create(s.abilities, options.near);
  if (!near) return tl::unexpected<Error>(near.error());
  s.near = std::move(*near);
  Result<std::unique_ptr<ImpostorRenderer>> impostors = ImpostorRenderer::create(s.abilities, options.impostors);
  if (!impostors) return tl::unexpected<Error>(impostors.error());
  s.impostors = std::move(*impostors);
  return result;
}

Status FrameRenderer::resize(const Display& display) {
  return state_->make_target(display);
}

FrameReport FrameRenderer::render(std::shared_ptr<const LeafView> leaf, const Pose& eye, Frame& frame, std::optional<double> time_s) {
  State& s = *state_;
  FrameReport report;
  Lap total;
  const bool is_empty = !leaf;
  if (is_empty) {
    auto empty = std::make_shared<LeafView>();
    empty->leaf_box = Box{eye.position, eye.position}.grown(0.5);
    empty->near_region = empty->leaf_box;
    empty->background = s.options.background;
    leaf = empty;
  } else if (s.renderer == Renderer::kGl) {
    Lap lap;
    const auto upload = s.impostors->upload(*leaf, s.options.frame_upload_bytes, s.fade.in_use(time_s));
    report.times.impostors_ms = lap();
    // A fuller version of what is drawn already is better even while it is being uploaded.
    const bool is_refinement = s.drawn && s.drawn->is_same_set(*leaf);
    if (!upload.is_complete && s.drawn && !is_refinement) {
      report.is_previous_leaf = true;
      leaf = s.drawn;
    } else {
      s.drawn = leaf;
    }
  }
  if (!is_empty) report.drawn = leaf;
  const LeafFade::Mix mix = s.fade.next(leaf, eye.position, time_s);
  s.render_leaf(*mix.shown, eye, frame, report);
  if (mix.former) {
    Lap lap;
    FrameReport former;
    s.render_leaf(*mix.former, eye, s.former, former);
    mix_frames(s.former, mix.share, frame);
    report.drawn_share = mix.share, report.times.former_ms = lap();
  }
  report.times.total_ms = total();
  return report;
}

FramePromise FrameRenderer::promise(const LeafView& leaf, const Pose& eye) const {
  const State& s = *state_;
  return promise_of(leaf, eye, display(), s.options.samples_per_pixel, s.renderer == Renderer::kGl);
}

const Display& FrameRenderer::display() const {
  return state_->display;
}
const GlAbilities& FrameRenderer::abilities() const {
  return state_->abilities;
}

}  // namespace farfield::client
