// jobs/shot/csv.h
//
// A shot as comma-separated values: one line for each mode, frame and light.
#pragma once

#include <string>

#include "jobs/shot/result.h"

namespace lightfit {

// Starts with a line of names. Fields that a line does not have are empty: figures where there is
// no matrix, ratios without per-frame matrices; crawl in the first frame, after frames that are
// missing, and where the light has moved.
std::string ShotCsv(const ShotJob& job, const ShotRows& rows);

}  // namespace lightfit
