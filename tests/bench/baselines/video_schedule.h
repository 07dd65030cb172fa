// SPDX-License-Identifier: Apache-2.0
// Which pictures a video server renders, for which poses, and with how wide a view: arithmetic over a trace.
#pragma once

#include <cstdint>
#include <vector>

#include "common/net/link_model.h"
#include "common/trace/trace.h"

namespace farfield::bench {

struct VideoPicture {
  Pose predicted, shown;        // the pose it is rendered for, and the pose when it is shown; the trace's frame
  bool is_first = false;        // of a stretch: the only one that stands alone
  bool is_before_walk = false;  // the viewer still stands at the trace's beginning
  int judged = -1;              // index of the sampled frame it is shown for, or none
};

struct VideoSchedule {
  double interval_s = 1.0 / 30;  // between pictures
  std::vector<VideoPicture> pictures;
  double margin_rad = 0;  // added to the view on each side

  /// The view that is rendered: `display` with the margin on all sides at the same pixel pitch, both sizes even.
  Display rendered(const Display& display) const;
};

/// From reading a pose to the picture on the screen, but for the time a picture's own bits take on the wire: twice the
/// link's delay with half its jitter, and 10 ms for rendering and encoding, as on a server with a GPU. No link: 0.
double video_delay_s(const LinkModel& link);

/// A picture about every 1/`pictures_per_second`, for `frames` sampled frames spread evenly over the trace: the interval
/// is such that each of these is a picture's moment, which favours video. Pictures are made during the second before each
/// sampled frame, so that rate control and prediction from earlier pictures are in their steady state; where these
/// seconds overlap the stream goes on, so that 12 sampled frames in 12 s are one stream of the whole trace.
///
/// Prediction: positions by the server's own MotionFilter, fed with 60 poses a second up to `delay_s` ago; rotation goes on
/// at the speed of the last 50 ms. The margin is the 99th percentile of the angle between predicted and shown rotation,
/// at most 30 degrees: what the client's rotation then lacks only one picture in a hundred.
/// Requires: a trace with at least one frame, frames > 0.
VideoSchedule make_video_schedule(const Trace& trace, std::size_t frames, double pictures_per_second, double delay_s);

}  // namespace farfield::bench
