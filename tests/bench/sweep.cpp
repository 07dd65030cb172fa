// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/sweep.h"

#include <charconv>
#include <iostream>

namespace farfield::bench {

Result<Sweep> parse_sweep(const std::string& text, std::span<const Method> methods) {
  const std::size_t colon = text.find(':'), equals = text.find('=', colon == std::string::npos ? 0 : colon);
  if (colon == std::string::npos || equals == std::string::npos)
    return fail(ErrorCode::kInvalidArgument, "'{}': write METHOD:KNOB=a,b,c", text);
  Sweep sweep{text.substr(0, colon), text.substr(colon + 1, equals - colon - 1), {}};
  const Method* method = find_method(methods, sweep.method);
  if (!method) return fail(ErrorCode::kInvalidArgument, "there is no method '{}' (see --help)", sweep.method);
  for (std::size_t begin = equals + 1; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    double value = 0;
    const auto [stop, error] = std::from_chars(text.data() + begin, text.data() + end, value);
    if (error != std::errc{} || stop != text.data() + end)
      return fail(ErrorCode::kInvalidArgument, "'{}' is no number (write METHOD:KNOB=a,b,c)", text.substr(begin, end - begin));
    if (const std::string why = objection_to(*method, {sweep.knob, value}); !why.empty())
      return fail(ErrorCode::kInvalidArgument, "{}", why);
    sweep.values.push_back(value);
    begin = end + 1;
  }
  return sweep;
}

Result<Curve> run_sweep(const World& world, std::span<const Method> methods, const Sweep& sweep) {
  const Method& method = *find_method(methods, sweep.method);
  Curve curve{sweep.method, sweep.knob, {}};
  for (const double value : sweep.values) {
    std::cerr << fmt::format("{}: {} {:g}\n", sweep.method, sweep.knob, value);
    const KnobSetting setting[] = {{sweep.knob, value}};
    const Result<MethodResult> result = method.run(world, values_of(method, setting));
    if (!result) return fail_within(fmt::format("{}:{}={:g}", sweep.method, sweep.knob, value), result.error());
    curve.points.push_back(point_of(value, *result));
  }
  return curve;
}

}  // namespace farfield::bench
