// calls/checked_readback.h
//
// A read-back whose background is settled, and what may be wrong with it.
// In:   a read-back and its lights.
// Out:  the same, to be used instead, and v1::ReadbackInfo's fields of it.
#pragma once

#include <string>
#include <vector>

#include "calls/request_lights.h"
#include "lightfit/v1/result.pb.h"
#include "optimizer/readback/readback.h"

namespace lightfit {

struct CheckedReadback {
  Readback readback;
  std::vector<std::string> warnings;

  // Sets background and warnings.
  void PutInto(v1::ReadbackInfo* info) const;
};

// `is_tracked`: of a sequence, whose shadows are not checked in every frame.
CheckedReadback CheckReadback(const Readback& readback,
                              const std::vector<RequestLight>& lights,
                              bool is_tracked = false);

}  // namespace lightfit
