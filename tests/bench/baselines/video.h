// SPDX-License-Identifier: Apache-2.0
// Video streaming: the server renders the full model, one ray per pixel, at the pose it predicts for the moment the
// picture is shown, and sends H.264 (video_codec.h); the client decodes it and turns it to where the viewer looks then.
// Which pictures are made, what delay they have and how much wider than the display they are: video_schedule.h.
#pragma once

#include "tests/bench/method.h"

namespace farfield::bench {

/// Frame time is decoding and warping, on the client; what the server takes to render and encode is not counted. Bytes
/// are those of the coded pictures, without the first of a stretch, which counts as entry.
/// Knobs: crf, kbit_s, hz, chroma. Errors: kUnavailable (libavcodec without x264).
Method video_method();

}  // namespace farfield::bench
