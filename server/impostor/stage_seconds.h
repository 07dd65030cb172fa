// SPDX-License-Identifier: Apache-2.0
// Where the time of making tiles goes, by stage: thread seconds of one tile, or summed up.
#pragma once

#include "common/base/thread_clock.h"

namespace farfield {

struct StageSeconds {
  double intra = 0;    // one ray per sample of dense views, with its shading
  double search = 0;   // for patches of delta views that no earlier view holds
  double delta = 0;    // rays of those patches, and which of them earlier views hold after all
  double cuts = 0;     // between neighbouring samples of different surfaces
  double colours = 0;  // several rays or look-ups per sample, sharpening
  double encode = 0;
  double certify = 0;

  StageSeconds& operator+=(const StageSeconds& other) {
    intra += other.intra, search += other.search, delta += other.delta, cuts += other.cuts, colours += other.colours;
    encode += other.encode, certify += other.certify;
    return *this;
  }
};

/// Of one thread: time since it was made or last asked goes to the stage that ends.
class StageClock {
 public:
  void lap(double& stage) {
    const double now = thread_seconds();
    stage += now - since_;
    since_ = now;
  }

 private:
  double since_ = thread_seconds();
};

}  // namespace farfield
