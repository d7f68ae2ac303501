#include "optimizer/readback/sample_options.h"

#include <cmath>

#include "absl/strings/str_format.h"

namespace lightfit {

namespace {

absl::Status OutOfRange(const char* field, double value, const char* want) {
  return absl::InvalidArgumentError(
      absl::StrFormat("options.samples.%s = %g, want %s", field, value, want));
}

}  // namespace

absl::Status ValidateSampleOptions(const SampleOptions& options) {
  // Written so that NaN fails.
  if (!(options.max_depth_bend > 0.0 && options.max_depth_bend <= 1.0)) {
    return OutOfRange("max_depth_bend", options.max_depth_bend, "more than 0, at most 1");
  }
  if (!(options.depth_noise >= 0.0 && std::isfinite(options.depth_noise))) {
    return OutOfRange("depth_noise", options.depth_noise, "0 or more");
  }
  if (!(options.min_cos_light >= 0.0 && options.min_cos_light < 1.0)) {
    return OutOfRange("min_cos_light", options.min_cos_light, "0 or more, less than 1");
  }
  if (!(options.min_cos_eye >= 0.0 && options.min_cos_eye < 1.0)) {
    return OutOfRange("min_cos_eye", options.min_cos_eye, "0 or more, less than 1");
  }
  if (options.min_samples < 1) {
    return OutOfRange("min_samples", options.min_samples, "1 or more");
  }
  if (options.edge_window < 1 || options.edge_window > 8) {
    return OutOfRange("edge_window", options.edge_window, "1 ... 8 pixels");
  }
  return absl::OkStatus();
}

}  // namespace lightfit
