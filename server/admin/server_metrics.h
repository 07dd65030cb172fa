// SPDX-License-Identifier: Apache-2.0
// What the server counts, under the names Prometheus will know it by.
#pragma once

#include "server/admin/prometheus_text.h"
#include "server/schedule/scheduled_cell_service.h"
#include "server/session/session_metrics.h"

namespace farfield {

void write_metrics(PrometheusText& out, const SessionMetrics& metrics);
/// `services`: one per scene. Queue, pool and store are shared by all and written once.
void write_metrics(PrometheusText& out, std::span<const std::shared_ptr<MeasuredCellService>> services);
/// Of this process: resident memory, open files, processor time.
void write_process_metrics(PrometheusText& out);

}  // namespace farfield
